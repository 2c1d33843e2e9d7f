#include "gridlock/parallel/detail/frame_of_all.hpp"

#include <cstdint>
#include <limits>
#include <type_traits>
#include <utility>
#include <variant>

#include "gridlock/core/detail/message.hpp"
#include "gridlock/parallel/communicator.hpp"
#include "gridlock/parallel/detail/collectives.hpp"

namespace gridlock {

namespace {

/// Rows that the root asks for: of a column by its place, or the Ids; none of them: the frame is done with.
struct RowsAsked {
  static constexpr std::uint64_t ids = std::numeric_limits<std::uint64_t>::max();
  std::uint64_t column = 0;
  std::uint64_t first = 0;
  std::uint64_t count = 0;
};

/// The rows of all ranks, on the root.
class FrameOfAll final : public FrameSource {
 public:
  FrameOfAll(Communicator& ranks, Frame const& head, AgentsView const& own, RowDivision const& rows)
      : FrameSource(head, rows.rows()), ranks_(ranks), own_(own), rows_(rows) {}

  [[nodiscard]] std::vector<Id> ids(std::size_t first, std::size_t count) const override {
    return gather(RowsAsked::ids, first, count, own_.ids());
  }
  [[nodiscard]] FrameValues values(std::size_t column, std::size_t first, std::size_t count) const override {
    return std::visit([&](auto own) { return FrameValues(gather(column, first, count, own)); },
                      own_.columns()[column].second);
  }

 private:
  template <class Value>
  [[nodiscard]] std::vector<Value> gather(std::uint64_t column, std::size_t first, std::size_t count,
                                          std::span<Value const> own) const {
    std::vector<Value> values;
    values.reserve(count);
    for (std::uint64_t row = first; row < first + count;) {
      std::size_t const rank = rows_.rank_of(row);
      std::uint64_t const end = std::min<std::uint64_t>(rows_.end(rank), first + count);
      RowsAsked const asked{.column = column, .first = row - rows_.first(rank), .count = end - row};
      if (rank == 0) {
        auto const piece = own.subspan(asked.first, asked.count);
        values.insert(values.end(), piece.begin(), piece.end());
      } else {
        ranks_.send(rank, message_of(asked));
        Message const bytes = ranks_.receive(rank);
        std::vector<Value> const piece = MessageReader(bytes).template rest<Value>();
        values.insert(values.end(), piece.begin(), piece.end());
      }
      row = end;
    }
    return values;
  }

  Communicator& ranks_;
  AgentsView const& own_;
  RowDivision const& rows_;
};

/// Sends the root what it asks for, until it is done.
void serve_root(Communicator& ranks, AgentsView const& own) {
  while (true) {
    auto const asked = MessageReader(ranks.receive(0)).next<RowsAsked>();
    if (asked.count == 0) return;
    auto const send = [&](auto values) { ranks.send(0, message_of_all(values.subspan(asked.first, asked.count))); };
    asked.column == RowsAsked::ids ? send(own.ids()) : std::visit(send, own.columns()[asked.column].second);
  }
}

/// Lets all others go on, however the use of a frame ends.
class EndOfFrame {
 public:
  explicit EndOfFrame(Communicator& ranks) : ranks_(ranks) {}
  ~EndOfFrame() {
    for (std::size_t rank = 1; rank < ranks_.count(); ++rank) ranks_.send(rank, message_of(RowsAsked{}));
  }
  EndOfFrame(EndOfFrame const&) = delete;
  EndOfFrame& operator=(EndOfFrame const&) = delete;

 private:
  Communicator& ranks_;
};

}  // namespace

void give_rows(AllProcesses processes, Frame const& head, AgentsView const& own, RowDivision const& rows,
               UseFrame const& use) {
  Communicator& ranks = processes.communicator();
  processes.agree([&] {
    if (ranks.rank() > 0) {
      serve_root(ranks, own);
      return;
    }
    EndOfFrame const end(ranks);
    use(FrameOfAll(ranks, head, own, rows));
  });
}

bool are_in_order(AllProcesses processes, std::span<Id const> own) {
  struct Ends {
    Id first, last;
    std::uint64_t count, ascends;
  };
  bool const ascends = std::ranges::adjacent_find(own, std::greater_equal()) == own.end();
  Ends const ends{.first = own.empty() ? 0 : own.front(),
                  .last = own.empty() ? 0 : own.back(),
                  .count = own.size(),
                  .ascends = ascends ? std::uint64_t{1} : 0};
  bool is_first = true;
  Id last = 0;
  for (Message const& bytes : all_gather(processes.communicator(), message_of(ends))) {
    auto const next = MessageReader(bytes).next<Ends>();
    if (next.count == 0) continue;
    if (next.ascends == 0 || (!is_first && next.first <= last)) return false;
    last = next.last;
    is_first = false;
  }
  return true;
}

}  // namespace gridlock
