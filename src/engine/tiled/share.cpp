#include "engine/tiled/share.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <iterator>
#include <utility>

#include "core/sorted.hpp"
#include "grid/validate_rows.hpp"
#include "gridlock/parallel/detail/collectives.hpp"

namespace gridlock::tiled {

namespace {

using Neighbour = Halo::Neighbour;

/// The first part of a process's message about its late disks, which are too fast for their tile.
struct LateHead {
  int needed_reach;
  bool may_jump;
};

/// Permutes in place: disks[k] becomes the former disks[order[k]].
void put_in_order(LargeArray<DiskInTurn>& disks, std::vector<std::uint32_t> order) {
  for (std::uint32_t first = 0; first < order.size(); ++first) {
    if (order[first] == first) continue;
    DiskInTurn const moved = disks[first];
    std::uint32_t to = first;
    while (order[to] != first) {
      std::uint32_t const from = order[to];
      disks[to] = disks[from];
      order[to] = to;
      to = from;
    }
    disks[to] = moved;
    order[to] = to;
  }
}

std::vector<std::uint32_t> tiles_of(Tiling const& tiling, Tiling::Rectangle const& rectangle) {
  std::vector<std::uint32_t> tiles;
  rectangle.for_each_tile([&](std::size_t column, std::size_t row) { tiles.push_back(tiling.number_of(column, row)); });
  std::ranges::sort(tiles);
  return tiles;
}

/// Returns the bits of a disk's record: −0 is not 0.
std::array<std::uint64_t, 8> bits_of(DiskInTurn const& disk) {
  return std::bit_cast<std::array<std::uint64_t, 8>>(disk);
}

}  // namespace

Share::Share(Domain&& domain, TurnRule const& rule, std::uint64_t threads, std::uint64_t step,
             LargeArray<DiskInTurn>&& disks)
    : domain_(std::move(domain)),
      processes_(domain_.processes()),
      rule_(rule),
      layout_(domain_.cells()),
      tiling_(layout_),
      thread_pool_(threads),
      step_(step) {
  // A ring of two cells is twice as wide as a local turn needs; disks are hardly ever faster than that.
  constexpr int usual_reach = 2;
  place(std::move(disks), usual_reach);
}

/// Puts the disks of this process in the order of their turns, and gets the disks of the rim from other processes.
void Share::place(LargeArray<DiskInTurn>&& own, int reach) {
  if (reach != reach_) {
    reach_ = reach;
    window_ = domain_.own_window(reach_);
    halo_ = Halo(domain_, reach_);
    rings_before_.resize(halo_.neighbours().size());
    find_rounds();
  }
  std::vector<std::uint32_t> tiles = tiles_of(tiling_, domain_.own_tiles());
  put_in_order(own,
               CellOfTurn(layout_, tiling_, tiles).order(own.size(), [&](std::size_t k) { return own[k].position; }));
  steps_.emplace(HotDisks(std::move(own)), rule_, layout_, tiling_, window_, std::move(tiles));
  steps_since_sort_ = 0;
  for (Neighbour const& neighbour : halo_.neighbours()) {
    send_cells(neighbour.process, common_cells(layout_, domain_.own_window(0), neighbour.window));
  }
  for (Neighbour const& neighbour : halo_.neighbours()) receive_cells(neighbour.process);
}

/// Calls place() for another reach, in the middle of a step.
void Share::place_anew(int reach) {
  std::vector<TileResult> results = std::move(steps_->results());
  place(take_own_disks(), reach);
  steps_->results() = std::move(results);
}

/// Chooses the round of each tile, and whether its turns come before messages are sent or while they travel.
void Share::find_rounds() {
  rounds_ = {};
  std::vector<Tiling::Round> rounds = tiling_.rounds(domain_.own_tiles(), thread_pool_.size());
  std::vector<std::uint8_t> const latest = latest_phases(rounds);
  for (std::size_t k = 1; k < Tiling::colours; ++k) rounds_[k].before_sending = std::move(rounds[k]);
  for (Tiling::Part& part : rounds[0]) {
    // Tiles with early deadlines come first; otherwise the order stays.
    std::ranges::stable_sort(part, {}, [&](std::uint32_t tile) { return latest[tile]; });
    fill_rounds(part, latest, rounds[0].size());
  }
  for (std::size_t k = 0; k < Tiling::colours; ++k) halo_.plan(k, rounds_[k].before_sending, layout_, tiling_);
}

/// Returns for each tile of the first round its deadline: the latest phase by which its turns must have been taken. It
/// is 0, before anything is sent, for a tile that changes cells which other processes store; k, before round k, for a
/// tile next to a tile of that round; and no later than that of any tile of the first round which must follow it.
std::vector<std::uint8_t> Share::latest_phases(std::vector<Tiling::Round> const& rounds) const {
  std::vector<std::uint8_t> latest(tiling_.tiles().size(), Tiling::colours);
  for (std::size_t k = 1; k < rounds.size(); ++k) {
    for (Tiling::Part const& part : rounds[k]) {
      for (std::uint32_t const tile : part) latest[tile] = static_cast<std::uint8_t>(k);
    }
  }
  std::vector<bool> is_first(latest.size(), false);
  for (Tiling::Part const& part : rounds[0]) {
    for (std::uint32_t const tile : part) is_first[tile] = true;
  }
  std::vector<std::uint32_t> tiles = tiles_of(tiling_, domain_.own_tiles());
  std::ranges::reverse(tiles);
  for (std::uint32_t const tile : tiles) {
    if (!is_first[tile]) continue;
    CellWindow const changed = window_around(layout_, tiling_.tiles()[tile], 1);
    bool const is_seen = std::ranges::any_of(
        halo_.neighbours(), [&](Neighbour const& neighbour) { return overlap(layout_, changed, neighbour.seen); });
    if (is_seen) latest[tile] = 0;
    // Tiles of higher number have been handled already.
    tiling_.for_each_around(tile, [&](std::uint32_t other) {
      if (other > tile) latest[tile] = std::min(latest[tile], latest[other]);
    });
  }
  return latest;
}

/// Divides a part of the first round, of `parts`, among all rounds, so that rounds take equally long in every process.
void Share::fill_rounds(Tiling::Part const& part, std::vector<std::uint8_t> const& latest, std::size_t parts) {
  double const tiles_of_round =
      static_cast<double>(domain_.own_tiles().tiles()) / static_cast<double>(Tiling::colours * parts);
  auto const seen = std::ranges::find_if(part, [&](std::uint32_t tile) { return latest[tile] > 0; });
  rounds_[0].before_sending.emplace_back(part.begin(), seen);
  auto next = seen;
  for (std::size_t k = 0; k < Tiling::colours; ++k) {
    double others = k == 0 ? static_cast<double>(rounds_[0].before_sending.back().size()) : 0.0;
    if (k > 0) {
      for (Tiling::Part const& left : rounds_[k].before_sending) others += static_cast<double>(left.size());
      others /= static_cast<double>(parts);
    }
    auto const first = next;
    auto const is_due = [&](std::uint32_t tile) {
      bool const has_room = others + static_cast<double>(next - first) < tiles_of_round;
      return latest[tile] <= k + 1 || has_room || k + 1 == Tiling::colours;
    };
    while (next != part.end() && is_due(*next)) ++next;
    rounds_[k].meanwhile.emplace_back(first, next);
  }
}

void Share::take_step() {
  if (steps_since_sort_ == steps_between_sorts) place_anew(reach_);
  ++steps_since_sort_;
  steps_->begin_step(step_++);
  late_.clear();
  for (std::size_t round = 0; round < Tiling::colours; ++round) exchange(round);
  take_late_turns();
  find_jump();
  count_step();
}

void Share::take_round(Tiling::Round const& round) {
  thread_pool_.for_each(round.size(), [&](std::size_t part) { steps_->take_part(round[part]); });
  std::uint64_t turns = 0;
  for (Tiling::Part const& part : round) {
    for (std::uint32_t const tile : part) {
      turns += steps_->result_of(tile).counters.moves;
      note_late(tile);
    }
  }
  processes_.note_turns(turns);
}

void Share::exchange(std::size_t round) {
  std::span<Neighbour const> const neighbours = halo_.neighbours();
  for (std::size_t k = 0; k < neighbours.size(); ++k) {
    rings_before_[k].clear();
    copy_cells(neighbours[k].changed[round].ring(), rings_before_[k]);
  }
  take_round(rounds_[round].before_sending);
  for (std::size_t k = 0; k < neighbours.size(); ++k) {
    message_.clear();
    copy_cells(neighbours[k].changed[round].own(), message_);
    add_changed_cells(rings_before_[k], message_);
    send(neighbours[k].process, message_);
  }
  take_round(rounds_[round].meanwhile);
  for (Neighbour const& neighbour : neighbours) receive_cells(neighbour.process);
}

/// Stores disks too fast for their tile by Id and cell, because messages change the rows of disks.
void Share::note_late(std::uint32_t tile) {
  std::vector<std::uint32_t>& rows = steps_->result_of(tile).not_local;
  for (std::uint32_t const row : rows) {
    DiskInTurn const& disk = steps_->disks()[row];
    late_.push_back({.tile = tile,
                     .id_index = disk.id_index,
                     .cell = steps_->grid().cell_of(row),
                     .process = static_cast<std::uint32_t>(processes_.rank()),
                     .energy = 0.0,
                     .smallest_mass = disk.mass,
                     .largest_radius = disk.radius,
                     .smallest_radius = disk.radius});
  }
  rows.clear();
}

namespace {

/// Returns the row of a disk that is too fast for its tile.
std::uint32_t row_of(Steps const& steps, LateDisk const& late) {
  std::uint32_t found = 0;
  steps.grid().for_each_in_cell(late.cell, [&](std::size_t row) {
    if (steps.disks()[row].id_index == late.id_index) found = static_cast<std::uint32_t>(row);
  });
  return found;
}

}  // namespace

/// Takes the turns of disks too fast for their tile, in the order of tiles wherever the order matters.
void Share::take_late_turns() {
  std::ranges::stable_sort(late_, {}, &LateDisk::tile);
  for (LateDisk& late : late_) {
    Vector const v = steps_->disks()[row_of(*steps_, late)].velocity;
    // The last factor covers the rounding of energy in collisions.
    late.energy = 0.5 * late.smallest_mass * squared_length(v) * (1.0 + 1e-6);
  }
  int needed_reach = 0;
  std::vector<LateDisk> shared = late_of_all(needed_reach);
  while (needed_reach > reach_) {
    place_anew(needed_reach);
    shared = late_of_all(needed_reach);
  }
  show_neighbourhoods(shared);
  take_waves(shared);
}

/// Sends to each process the cells that its late disks may look at, beyond the cells that are kept up to date for it.
void Share::show_neighbourhoods(std::vector<LateDisk> const& shared) {
  if (reach_ <= 1) return;
  exchange_zones(
      [&](Neighbour const& neighbour) { return cells_of_zones(shared, neighbour.process, domain_.own_window(0)); },
      [&](Neighbour const& neighbour) { return cells_of_zones(shared, processes_.rank(), neighbour.own); });
}

/// Sends to each neighbour the cells in its window that these late disks have changed, and receives such cells from it.
void Share::tell_of_turns(std::vector<LateDisk> const& taken) {
  exchange_zones([&](Neighbour const& neighbour) { return cells_of_zones(taken, processes_.rank(), neighbour.window); },
                 [&](Neighbour const& neighbour) { return cells_of_zones(taken, neighbour.process, window_); });
}

/// Exchanges cells with each neighbour, if there are any: the list of all late disks tells which messages to expect.
template <class CellsSent, class CellsReceived>
void Share::exchange_zones(CellsSent cells_sent, CellsReceived cells_received) {
  for (Neighbour const& neighbour : halo_.neighbours()) {
    std::vector<int> const cells = cells_sent(neighbour);
    if (!cells.empty()) send_cells(neighbour.process, cells);
  }
  for (Neighbour const& neighbour : halo_.neighbours()) {
    if (!cells_received(neighbour).empty()) receive_cells(neighbour.process);
  }
}

/// Returns the cells of a window in the zones of a process's late disks.
std::vector<int> Share::cells_of_zones(std::vector<LateDisk> const& late, std::size_t process,
                                       CellWindow const& window) const {
  std::vector<int> cells;
  for (LateDisk const& disk : late) {
    if (disk.process == process)
      std::ranges::copy(common_cells(layout_, zone_of(disk), window), std::back_inserter(cells));
  }
  sort_and_drop_repeats(cells);
  return cells;
}

/// Returns the late disks of all processes whose turns other processes may see, in the order of their turns. Sets
/// `needed_reach` to the largest number of cells to each side that a late disk may look at.
std::vector<LateDisk> Share::late_of_all(int& needed_reach) {
  LateGroups const own = groups_of(layout_, late_, reach_);
  LateHead head{.needed_reach = 0, .may_jump = false};
  for (LateGroup const& group : own.groups) {
    head.needed_reach = std::max(head.needed_reach, reach_of(group));
    head.may_jump = head.may_jump || may_jump(group);
  }
  MessageWriter message;
  message.add(head);
  for (std::size_t k = 0; k < late_.size(); ++k) {
    if (!is_seen_by_others(late_[k])) continue;
    LateDisk seen = late_[k];
    LateGroup const& group = own.groups[own.group_of[k]];
    seen.energy = group.energy;
    seen.smallest_mass = group.smallest_mass;
    seen.largest_radius = group.largest_radius;
    seen.smallest_radius = group.smallest_radius;
    message.add(seen);
  }
  std::vector<LateDisk> all;
  needed_reach = 0;
  may_jump_ = false;
  for (Message const& bytes : all_gather(processes_, message.take())) {
    MessageReader reader(bytes);
    auto const head_of_process = reader.next<LateHead>();
    needed_reach = std::max(needed_reach, head_of_process.needed_reach);
    may_jump_ = may_jump_ || head_of_process.may_jump;
    std::vector<LateDisk> const disks = reader.rest<LateDisk>();
    all.insert(all.end(), disks.begin(), disks.end());
  }
  std::ranges::stable_sort(all, {}, &LateDisk::tile);
  for (LateGroup const& group : groups_of(layout_, all, reach_).groups) {
    needed_reach = std::max(needed_reach, reach_of(group));
    may_jump_ = may_jump_ || may_jump(group);
  }
  return all;
}

/// Returns the cells to each side that any disk of the group may look at, whatever collisions happen in the group.
int Share::reach_of(LateGroup const& group) const {
  return steps_->reach(group.largest_radius, 2.0 * group.energy / group.smallest_mass);
}

bool Share::may_jump(LateGroup const& group) const {
  return !steps_->is_short_at(2.0 * group.energy / group.smallest_mass, group.smallest_radius);
}

/// Returns the cells that the turn of a disk too fast for its tile may look at and change.
CellWindow Share::zone_of(LateDisk const& late) const {
  int const column = late.cell % layout_.columns();
  int const row = late.cell / layout_.columns();
  return within(layout_, {.first_column = column - reach_,
                          .end_column = column + reach_ + 1,
                          .first_row = row - reach_,
                          .end_row = row + reach_ + 1});
}

bool Share::is_seen_by_others(LateDisk const& late) const {
  return std::ranges::any_of(halo_.neighbours(), [&](Neighbour const& neighbour) {
    return overlap(layout_, zone_of(late), neighbour.window);
  });
}

void Share::take_waves(std::vector<LateDisk> const& shared) {
  std::vector<std::size_t> const levels = levels_of(layout_, shared, reach_);
  std::size_t const end = levels.empty() ? 0 : std::ranges::max(levels) + 1;
  // The late disks of this process are in the same order in both lists.
  std::size_t next = 0;
  auto const skip_others = [&] {
    while (next < shared.size() && shared[next].process != processes_.rank()) ++next;
  };
  skip_others();
  auto late = late_.begin();
  for (std::size_t level = 0; level < end; ++level) {
    for (; late != late_.end(); ++late) {
      if (next < shared.size() && shared[next].id_index == late->id_index) {
        if (levels[next] > level) break;
        ++next;
        skip_others();
      }
      take_late(*late);
    }
    std::vector<LateDisk> taken;
    for (std::size_t k = 0; k < shared.size(); ++k) {
      if (levels[k] == level) taken.push_back(shared[k]);
    }
    tell_of_turns(taken);
  }
  for (; late != late_.end(); ++late) take_late(*late);
}

void Share::take_late(LateDisk const& late) { steps_->take_late(row_of(*steps_, late), steps_->result_of(late.tile)); }

void Share::find_jump() {
  jump_.reset();
  if (!may_jump_) return;
  MessageWriter message;
  for (std::size_t k = 0; k < steps_->results().size(); ++k) {
    std::optional<TooFast> const& disk = steps_->results()[k].too_fast;
    if (!disk) continue;
    message.add(Jump{.tile = tiles()[k], .row_in_state = disk->row_in_state, .displacement = disk->displacement});
    break;
  }
  for (Message const& bytes : all_gather(processes_, message.take())) {
    for (Jump const& jump : MessageReader(bytes).rest<Jump>()) {
      if (!jump_ || jump.tile < jump_->tile) jump_ = jump;
    }
  }
}

void Share::count_step() {
  CountersOfStep& of_step = counters_.emplace_back();
  for (TileResult& result : steps_->results()) {
    of_step.add(result.counters);
    result.counters = {};
  }
}

/// Returns the rows of the disks in the tiles of this process.
std::vector<std::uint32_t> Share::own_disks() const {
  std::vector<std::uint32_t> own;
  own.reserve(steps_->disks().size());
  for (int const cell : common_cells(layout_, domain_.own_window(0), domain_.own_window(0))) {
    steps_->grid().for_each_in_cell(cell, [&](std::size_t row) { own.push_back(static_cast<std::uint32_t>(row)); });
  }
  return own;
}

LargeArray<DiskInTurn> Share::take_own_disks() {
  std::vector<bool> is_own(steps_->disks().size(), false);
  for (std::uint32_t const number : own_disks()) is_own[number] = true;
  LargeArray<DiskInTurn> disks = steps_->take_disks();
  steps_.reset();
  std::size_t kept = 0;
  for (std::size_t k = 0; k < disks.size(); ++k) {
    if (is_own[k]) disks[kept++] = disks[k];
  }
  disks.resize(kept);
  return disks;
}

std::vector<Overlap> Share::find_overlaps(double tolerance) const {
  std::vector<Overlap> overlaps;
  PackedGrid const& grid = steps_->grid();
  for (std::uint32_t const number : own_disks()) {
    DiskInTurn const& one = steps_->disks()[number];
    // A cell is as wide as two disks in contact, and this process stores the cells around its tiles too.
    grid.for_each_in_block(grid.cell_of(number), 1, 1, [&](std::size_t row) {
      DiskInTurn const& other = steps_->disks()[row];
      if (one.id_index >= other.id_index) return;
      double const squared = squared_length(rule_.box.displacement(one.position, other.position));
      double const gap = gap_of_overlap(one.radius + other.radius, squared, tolerance);
      if (gap < 0.0) overlaps.push_back({.row = one.row_in_state, .other_row = other.row_in_state, .gap = gap});
    });
  }
  return overlaps;
}

void Share::copy_cells(std::span<int const> cells, CellsMessage& to) const {
  for (int const cell : cells) {
    std::size_t const first = to.disks.size();
    steps_->grid().for_each_in_cell(cell, [&](std::size_t row) {
      to.disks.push_back(steps_->disks()[row]);
      to.has_turned.push_back(steps_->has_turned(static_cast<std::uint32_t>(row)) ? 1 : 0);
    });
    to.cells.push_back({.cell = cell, .disks = static_cast<std::uint32_t>(to.disks.size() - first)});
  }
}

/// Adds to `to` the cells whose disks have changed since `before`.
void Share::add_changed_cells(CellsMessage const& before, CellsMessage& to) const {
  DiskInTurn const* old = before.disks.data();
  for (CellsMessage::Cell const& head : before.cells) {
    std::uint32_t same = 0;
    std::uint32_t disks = 0;
    steps_->grid().for_each_in_cell(head.cell, [&](std::size_t row) {
      if (disks < head.disks && bits_of(old[disks]) == bits_of(steps_->disks()[row])) ++same;
      ++disks;
    });
    if (disks != head.disks || same != disks) copy_cells(std::span(&head.cell, 1), to);
    old += head.disks;
  }
}

void Share::send_cells(std::size_t to, std::span<int const> cells) {
  message_.clear();
  copy_cells(cells, message_);
  send(to, message_);
}

void Share::send(std::size_t to, CellsMessage const& cells) {
  MessageWriter message;
  message.reserve(16 + cells.cells.size() * sizeof(CellsMessage::Cell) + cells.disks.size() * (sizeof(DiskInTurn) + 1));
  message.add(std::uint64_t{cells.cells.size()});
  message.add(std::uint64_t{cells.disks.size()});
  message.add_all(std::span<CellsMessage::Cell const>(cells.cells));
  message.add_all(std::span<DiskInTurn const>(cells.disks));
  message.add_all(std::span<std::uint8_t const>(cells.has_turned));
  processes_.send(to, message.take());
}

void Share::receive_cells(std::size_t from) {
  Message const bytes = processes_.receive(from);
  MessageReader message(bytes);
  auto& [heads, disks, has_turned] = message_;
  heads.resize(message.next<std::uint64_t>());
  disks.resize(message.next<std::uint64_t>());
  has_turned.resize(disks.size());
  message.read_into(std::span(heads));
  message.read_into(std::span(disks));
  message.read_into(std::span(has_turned));
  std::size_t first = 0;
  for (CellsMessage::Cell const& head : heads) {
    steps_->replace_cell(head.cell, std::span<DiskInTurn const>(disks).subspan(first, head.disks),
                         std::span<std::uint8_t const>(has_turned).subspan(first, head.disks));
    first += head.disks;
  }
}

}  // namespace gridlock::tiled
