#include "gridlock/simulation/event.hpp"

#include <gtest/gtest.h>

#include <set>
#include <string>

namespace gridlock {
namespace {

TEST(Event, OfEveryKindHasANameAndATextOfItsOwn) {
  std::set<std::string> names;
  std::set<std::string> texts;
  auto const last = static_cast<std::size_t>(EventKind::ended);
  for (std::size_t kind = 0; kind <= last; ++kind) {
    Event const event{.kind = static_cast<EventKind>(kind), .key = "run.steps"};
    names.emplace(to_text(event.kind));
    texts.insert(to_text(event));
  }
  EXPECT_EQ(names.size(), last + 1);
  EXPECT_EQ(texts.size(), last + 1);
  EXPECT_FALSE(names.contains(""));
}

TEST(Event, IsSaidInWordsWithItsValues) {
  EXPECT_EQ(to_text(Event{.kind = EventKind::checkpoint_failed, .step = 12, .values = {{"why", "the disk is full"}}}),
            "no checkpoint at step 12: the disk is full");
  EXPECT_EQ(to_text(Event{.kind = EventKind::frames_beyond_end,
                          .key = "trajectory.steps",
                          .values = {{"beyond", std::uint64_t{1}},
                                     {"asked_for", std::uint64_t{3}},
                                     {"unit", std::string("step")},
                                     {"end", 40.0}}}),
            "1 of 3 in trajectory.steps lies beyond the end of the run at step 40: no frame there");
}

}  // namespace
}  // namespace gridlock
