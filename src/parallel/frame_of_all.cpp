#include "gridlock/parallel/detail/frame_of_all.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <map>
#include <span>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "gridlock/core/detail/message.hpp"
#include "gridlock/core/detail/rows_in_order.hpp"
#include "gridlock/parallel/communicator.hpp"
#include "gridlock/parallel/detail/collectives.hpp"
#include "parallel/keys_at.hpp"

namespace gridlock {

namespace {

/// Number of agents in a block; blocks divide all agents in the order of their Ids.
constexpr std::uint64_t rows_of_block = std::uint64_t{1} << 15;

/// A request of the root: for the values of a column in a block, for its Ids, or that the frame is done.
struct BlockAsked {
  static constexpr std::uint64_t ids = std::numeric_limits<std::uint64_t>::max();
  static constexpr std::uint64_t nothing = ids - 1;
  std::uint64_t column = nothing;
  std::uint64_t block = 0;
};

/// The rows of this process by block.
class OwnRows {
 public:
  /// All processes construct it together.
  OwnRows(AllProcesses processes, AgentsView const& own) : own_(own), all_(processes.sum(own.size())) {
    std::vector<std::uint64_t> places;
    for (std::uint64_t first = 0; first < all_; first += rows_of_block) places.push_back(first);
    auto const ids = own.ids();
    auto const count_below = [&](Id id) { return std::ranges::lower_bound(ids, id) - ids.begin(); };
    for (Id const id : keys_at(places, highest_bit_of_all(processes.communicator(), ids.empty() ? Id{0} : ids.back()),
                               count_below, [&](std::span<std::uint64_t> counts) { processes.sum(counts); })) {
      first_of_block_.push_back(static_cast<std::size_t>(count_below(id)));
    }
    first_of_block_.push_back(ids.size());
  }

  /// The number of agents of all processes.
  [[nodiscard]] std::uint64_t all() const { return all_; }
  [[nodiscard]] std::span<Id const> ids(std::uint64_t block) const { return rows_in(block, own_.ids()); }
  /// Calls visit(values) for the rows of a block.
  template <class Visit>
  void visit(BlockAsked const& asked, Visit visit) const {
    if (asked.column == BlockAsked::ids) {
      visit(ids(asked.block));
    } else {
      std::visit([&](auto values) { visit(rows_in(asked.block, values)); }, own_.columns()[asked.column].second);
    }
  }

 private:
  template <class Value>
  [[nodiscard]] std::span<Value const> rows_in(std::uint64_t block, std::span<Value const> values) const {
    return values.subspan(first_of_block_[block], first_of_block_[block + 1] - first_of_block_[block]);
  }

  AgentsView const& own_;
  std::uint64_t all_;
  std::vector<std::size_t> first_of_block_;
};

/// The rows of all ranks, as the root sees them.
class FrameOfAll final : public FrameSource {
 public:
  FrameOfAll(Communicator& ranks, Frame const& head, AgentsView const& own, OwnRows const& rows)
      : FrameSource(head, rows.all(), {}, {}), ranks_(ranks), own_(own), rows_(rows) {}

  [[nodiscard]] std::vector<Id> ids(std::size_t first, std::size_t count) const override {
    std::vector<Id> ids;
    for_each_block(first, count, [&](std::uint64_t block, std::size_t begin, std::size_t end) {
      look_at(block);
      ids.insert(ids.end(), ids_.begin() + begin, ids_.begin() + end);
    });
    return ids;
  }
  [[nodiscard]] FrameValues values(std::size_t column, std::size_t first, std::size_t count) const override {
    return std::visit(
        [&](auto own) {
          using Value = typename decltype(own)::value_type;
          std::vector<Value> values;
          values.reserve(count);
          for_each_block(first, count, [&](std::uint64_t block, std::size_t begin, std::size_t end) {
            look_at(block);
            auto const [of_block, is_new] = columns_.try_emplace(column);
            if (is_new) of_block->second = in_order(gather<Value>({.column = column, .block = block}));
            auto const& all = std::get<std::vector<Value>>(of_block->second);
            values.insert(values.end(), all.begin() + begin, all.begin() + end);
          });
          return FrameValues(std::move(values));
        },
        own_.columns()[column].second);
  }

 private:
  /// Calls visit(block, begin, end) for the wanted rows of each block.
  template <class Visit>
  static void for_each_block(std::uint64_t first, std::uint64_t count, Visit visit) {
    for (std::uint64_t row = first; row < first + count;) {
      std::uint64_t const block = row / rows_of_block;
      std::uint64_t const begin = block * rows_of_block;
      std::uint64_t const end = std::min(begin + rows_of_block, first + count);
      visit(block, static_cast<std::size_t>(row - begin), static_cast<std::size_t>(end - begin));
      row = end;
    }
  }

  /// Loads this block, if another is loaded.
  void look_at(std::uint64_t block) const {
    if (block == block_) return;
    columns_.clear();
    block_ = block;
    ids_ = gather<Id>({.column = BlockAsked::ids, .block = block});
    order_ = rows_in_order(ids_);
    ids_ = in_order(ids_);
  }
  template <class Value>
  [[nodiscard]] std::vector<Value> in_order(std::vector<Value> const& values) const {
    std::vector<Value> sorted;
    sorted.reserve(values.size());
    for (std::uint32_t const row : order_) sorted.push_back(values[row]);
    return sorted;
  }
  /// Returns the values of a block, those of rank 0 first, then those of rank 1, …
  template <class Value>
  [[nodiscard]] std::vector<Value> gather(BlockAsked const& asked) const {
    for (std::size_t rank = 1; rank < ranks_.count(); ++rank) ranks_.send(rank, message_of(asked));
    std::vector<Value> values;
    rows_.visit(asked, [&](auto own) {
      if constexpr (std::is_same_v<typename decltype(own)::value_type, Value>) values.assign(own.begin(), own.end());
    });
    for (std::size_t rank = 1; rank < ranks_.count(); ++rank) {
      Message const bytes = ranks_.receive(rank);
      std::vector<Value> const piece = MessageReader(bytes).template rest<Value>();
      values.insert(values.end(), piece.begin(), piece.end());
    }
    return values;
  }

  Communicator& ranks_;
  AgentsView const& own_;
  OwnRows const& rows_;
  mutable std::uint64_t block_ = std::numeric_limits<std::uint64_t>::max();  ///< number of the loaded block
  mutable std::vector<Id> ids_;
  mutable std::vector<std::uint32_t> order_;  ///< order of the rows that ranks send
  mutable std::map<std::size_t, FrameValues> columns_;
};

/// Answers the requests of the root until the frame is done.
void serve_root(Communicator& ranks, OwnRows const& own) {
  while (true) {
    auto const asked = MessageReader(ranks.receive(0)).next<BlockAsked>();
    if (asked.column == BlockAsked::nothing) return;
    own.visit(asked, [&](auto values) { ranks.send(0, message_of_all(values)); });
  }
}

/// Ends serve_root() in all other ranks, also after an exception.
class EndOfFrame {
 public:
  explicit EndOfFrame(Communicator& ranks) : ranks_(ranks) {}
  ~EndOfFrame() {
    for (std::size_t rank = 1; rank < ranks_.count(); ++rank) ranks_.send(rank, message_of(BlockAsked{}));
  }
  EndOfFrame(EndOfFrame const&) = delete;
  EndOfFrame& operator=(EndOfFrame const&) = delete;

 private:
  Communicator& ranks_;
};

}  // namespace

void give_rows(AllProcesses processes, Frame const& head, AgentsView const& own, UseFrame const& use) {
  Communicator& ranks = processes.communicator();
  OwnRows const rows(processes, own);
  processes.agree([&] {
    if (ranks.rank() > 0) {
      serve_root(ranks, rows);
      return;
    }
    EndOfFrame const end(ranks);
    use(FrameOfAll(ranks, head, own, rows));
  });
}

}  // namespace gridlock
