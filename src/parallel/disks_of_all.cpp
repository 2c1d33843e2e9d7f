#include "parallel/disks_of_all.hpp"

#include <algorithm>
#include <cstddef>
#include <functional>
#include <utility>
#include <vector>

#include "gridlock/core/detail/large_array.hpp"
#include "gridlock/core/detail/message.hpp"
#include "gridlock/core/detail/rows_in_order.hpp"
#include "gridlock/parallel/communicator.hpp"
#include "gridlock/parallel/detail/collectives.hpp"
#include "gridlock/parallel/detail/row_division.hpp"
#include "parallel/sort_among_ranks.hpp"

namespace gridlock {

namespace {

/// Number of rows in a message.
constexpr std::uint64_t rows_of_message = std::uint64_t{1} << 15;

/// Rows that arrive one after the other and become Disks.
class ComingRows {
 public:
  explicit ComingRows(std::size_t rows) {
    ids_.resize(rows);
    values_.resize(rows);
  }
  void add(DiskRow const& row) {
    ids_[next_] = row.id;
    values_.put(next_, {row.x, row.y, row.velocity_x, row.velocity_y, row.radius, row.mass, row.image_x, row.image_y});
    ++next_;
  }
  [[nodiscard]] bool are_all_here() const { return next_ == ids_.size(); }
  [[nodiscard]] Disks take() {
    Disks disks;
    disks.become(ids_, values_);
    return disks;
  }

 private:
  LargeArray<Id> ids_;
  Disks::AllValues values_;
  std::size_t next_ = 0;
};

DiskRow row_of(Disks const& disks, std::size_t i) {
  return {.id = disks.ids()[i],
          .x = disks.column<X>()[i],
          .y = disks.column<Y>()[i],
          .velocity_x = disks.column<VelocityX>()[i],
          .velocity_y = disks.column<VelocityY>()[i],
          .radius = disks.column<Radius>()[i],
          .mass = disks.column<Mass>()[i],
          .image_x = disks.column<ImageX>()[i],
          .image_y = disks.column<ImageY>()[i]};
}

/// Sends another rank its rows; the root calls it.
void send_rows(Communicator& ranks, std::size_t rank, RowDivision const& rows,
               std::function<DiskRow(std::uint64_t k)> const& row_of) {
  std::vector<DiskRow> piece;
  for (std::uint64_t k = rows.first(rank); k < rows.end(rank); ++k) {
    piece.push_back(row_of(k));
    if (piece.size() < rows_of_message && k + 1 < rows.end(rank)) continue;
    ranks.send(rank, message_of_all(std::span<DiskRow const>(piece)));
    piece.clear();
  }
}

}  // namespace

Disks disks_of(std::span<DiskRow const> rows) {
  ComingRows all(rows.size());
  for (DiskRow const& row : rows) all.add(row);
  return all.take();
}

DisksOverview overview_of_all(Disks const& own, AllProcesses processes) {
  DisksOverview all;
  for (Message const& bytes : all_gather(processes.communicator(), message_of(overview_of(own)))) {
    all.add(MessageReader(bytes).next<DisksOverview>());
  }
  return all;
}

Disks deal_out(AllProcesses processes, std::uint64_t count, std::function<DiskRow(std::uint64_t k)> const& row_of) {
  Communicator& ranks = processes.communicator();
  RowDivision const rows = RowDivision::even(processes.of_root(count), ranks.count());
  ComingRows own(rows.rows_of(ranks.rank()));
  if (ranks.rank() == 0) {
    for (std::uint64_t k = 0; k < rows.end(0); ++k) own.add(row_of(k));
    for (std::size_t rank = 1; rank < ranks.count(); ++rank) send_rows(ranks, rank, rows, row_of);
  }
  while (!own.are_all_here()) {
    Message const bytes = ranks.receive(0);
    for (DiskRow const& row : MessageReader(bytes).rest<DiskRow>()) own.add(row);
  }
  return own.take();
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

void sort_by_ids(AllProcesses processes, Disks& own) {
  if (are_in_order(processes, own.ids())) return;
  std::vector<DiskRow> rows;
  rows.reserve(own.size());
  for (std::size_t i = 0; i < own.size(); ++i) rows.push_back(row_of(own, i));
  sort_among_ranks(processes.communicator(), rows, RowDivision::even(processes.sum(own.size()), processes.count()),
                   [](DiskRow const& disk) { return disk.id; });
  own = disks_of(rows);
}

State deal_out(AllProcesses processes, State whole) {
  if (processes.count() == 1) return whole;
  std::vector<std::uint32_t> const order = rows_in_order(whole.agents.ids());
  return {.box = processes.of_root(whole.box),
          .agents = deal_out(processes, order.size(), [&](std::uint64_t k) { return row_of(whole.agents, order[k]); }),
          .clock = processes.of_root(whole.clock),
          .seed = processes.of_root(whole.seed)};
}

}  // namespace gridlock
