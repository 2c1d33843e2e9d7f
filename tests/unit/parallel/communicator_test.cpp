#include "gridlock/parallel/communicator.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "gridlock/core/detail/message.hpp"
#include "gridlock/parallel/detail/collectives.hpp"
#include "thread_ranks.hpp"

namespace gridlock {
namespace {

using test::ThreadRanks;

/// A different text for each rank, of any length: that of rank 0 is empty.
std::string text_of_rank(std::size_t rank) {
  std::string text;
  for (std::size_t k = 0; k < 7 * rank % 23; ++k) text += std::to_string(rank) + ".";
  return text;
}

Message message_with(std::string_view text) { return message_of_all(std::span<char const>(text)); }

std::string text_in(Message const& message) {
  std::vector<char> const letters = MessageReader(message).rest<char>();
  return {letters.begin(), letters.end()};
}

std::vector<std::string> texts_in(std::vector<Message> const& messages) {
  std::vector<std::string> texts;
  for (Message const& message : messages) texts.push_back(text_in(message));
  return texts;
}

std::vector<std::string> texts_of(std::size_t ranks) {
  std::vector<std::string> texts;
  for (std::size_t rank = 0; rank < ranks; ++rank) texts.push_back(text_of_rank(rank));
  return texts;
}

std::string one_text_of(std::size_t ranks) {
  std::string all;
  for (std::string const& text : texts_of(ranks)) all += text;
  return all;
}

/// The order of the ranks shows.
Message joined(Message left, Message const& right) {
  left.insert(left.end(), right.begin(), right.end());
  return left;
}

class TreeOfRanks : public testing::TestWithParam<std::size_t> {};

INSTANTIATE_TEST_SUITE_P(Counts, TreeOfRanks, testing::Values(1, 2, 3, 4, 5, 6, 7, 8, 9, 16, 21),
                         testing::PrintToStringParamName());

TEST_P(TreeOfRanks, GathersForAllWhatEachGives) {
  std::size_t const count = GetParam();
  ThreadRanks all(count);
  all.run([&](Communicator& ranks) {
    for (int n = 0; n < 3; ++n) {
      std::string const own = text_of_rank(ranks.rank()) + std::to_string(n);
      std::vector<std::string> expected = texts_of(count);
      for (std::string& text : expected) text += std::to_string(n);
      EXPECT_EQ(texts_in(all_gather(ranks, message_with(own))), expected) << "rank " << ranks.rank();
    }
  });
  EXPECT_EQ(all.messages(), 3 * count * static_cast<std::size_t>(std::bit_width(count - 1))) << "⌈log₂ count⌉ of each";
}

TEST_P(TreeOfRanks, GathersForTheLeaderAlone) {
  ThreadRanks all(GetParam());
  all.run([&](Communicator& ranks) {
    std::vector<std::string> const texts = texts_in(gather(ranks, message_with(text_of_rank(ranks.rank()))));
    EXPECT_EQ(texts, ranks.rank() == 0 ? texts_of(GetParam()) : std::vector<std::string>()) << "rank " << ranks.rank();
  });
  EXPECT_EQ(all.messages(), GetParam() - 1);
}

TEST_P(TreeOfRanks, MergesInTheOrderOfTheRanks) {
  ThreadRanks all(GetParam());
  all.run([&](Communicator& ranks) {
    Message const own = message_with(text_of_rank(ranks.rank()));
    EXPECT_EQ(text_in(reduce(ranks, own, joined)), ranks.rank() == 0 ? one_text_of(GetParam()) : "");
    EXPECT_EQ(text_in(all_reduce(ranks, own, joined)), one_text_of(GetParam())) << "rank " << ranks.rank();
  });
  EXPECT_EQ(all.messages(), 3 * (GetParam() - 1));
}

TEST_P(TreeOfRanks, HandsDownWhatTheLeaderGives) {
  ThreadRanks all(GetParam());
  all.run([&](Communicator& ranks) {
    for (std::string_view const text : {"forward", "", "back"}) {
      EXPECT_EQ(text_in(broadcast(ranks, message_with(ranks.rank() == 0 ? text : "nobody hears this"))), text);
    }
  });
  EXPECT_EQ(all.messages(), 3 * (GetParam() - 1));
}

}  // namespace
}  // namespace gridlock
