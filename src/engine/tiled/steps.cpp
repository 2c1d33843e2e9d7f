#include "engine/tiled/steps.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "engine/stepped.hpp"
#include "engine/turn.hpp"
#include "gridlock/core/target.hpp"

namespace gridlock::tiled {

namespace {

/// Returns the number of tiles that take turns together. Registers of one or two numbers are full with one tile, and
/// copying the groups of more would cost up to 8 % of the time.
std::size_t team_size() { return target() == Target::avx2 || target() == Target::avx512 ? Tiling::tiles_of_team : 1; }

PackedGrid grid_of_window(CellLayout const& layout, CellWindow const& window, HotDisks const& disks) {
  // Memory for disks of other processes, which are added later, is included.
  PackedGrid grid(layout, window, disks.room());
  for (std::size_t k = 0; k < disks.size(); ++k) grid.insert(k, disks[k].position);
  return grid;
}

}  // namespace

bool goes_around_box(CellLayout const& layout, Tiling const& tiling) {
  return (layout.is_periodic_x() && tiling.columns() == 1) || (layout.is_periodic_y() && tiling.rows() == 1);
}

Steps::Steps(HotDisks&& disks, TurnRule const& rule, CellLayout const& layout, Tiling const& tiling,
             CellWindow const& window, std::vector<std::uint32_t> tiles)
    : rule_(rule),
      tiling_(tiling),
      disks_(std::move(disks)),
      view_{.box = rule_.box,
            .disks = disks_.all(),
            .substep = rule.duration / static_cast<double>(rule.substeps),
            .substeps = rule.substeps,
            .contact = rule.contact,
            .heading = rule.heading.is_on() ? &heading_ : nullptr,
            .walls = rule_.walls.view()},
      grid_(grid_of_window(layout, window, disks_)),
      turns_(view_, grid_, rule.radii, rule.duration),
      cutoff_(rule_.box, rule.radii.largest, rule.duration, rule.substeps),
      group_size_(goes_around_box(layout, tiling) ? 1 : PackedTurns::largest_batch),
      team_size_(team_size()),
      tiles_(std::move(tiles)),
      place_of_tile_(tiling.tiles().size()),
      results_(tiles_.size()),
      turns_of_tile_(tiles_.size(),
                     static_cast<std::uint32_t>(disks_.size() / std::max<std::size_t>(1, tiles_.size()))) {
  set_speeds(rule_.heading, disks_.all());
  id_indices_.reserve(disks_.size());
  for (std::size_t k = 0; k < disks_.size(); ++k) id_indices_.push_back(disks_[k].id_index);
  for (std::size_t k = 0; k < tiles_.size(); ++k) place_of_tile_[tiles_[k]] = static_cast<std::uint32_t>(k);
}

static_assert(ClassOrder::beyond >= PackedTurns::read_behind);

void Steps::take_part(Tiling::Part const& part) {
  static thread_local ClassOrder order;
  FetchAhead ahead(grid_, view_, id_indices_, tiling_);
  auto const first_team = [this](std::span<std::uint32_t const> of) { return tiling_.first_team(of, team_size_); };
  std::span<std::uint32_t const> rest = part;
  std::span<std::uint32_t const> tiles = first_team(rest);
  while (!tiles.empty()) {
    rest = rest.subspan(tiles.size());
    std::span<std::uint32_t const> const next = first_team(rest);
    std::array<TurnResult*, Tiling::tiles_of_team> results;
    std::size_t turns = 0;
    for (std::size_t k = 0; k < tiles.size(); ++k) {
      results[k] = &result_of(tiles[k]);
      turns += turns_of_tile_[place_of_tile_[tiles[k]]];
    }
    ahead.aim(next, first_team(rest.subspan(next.size())), turns);
    auto const take_waiting = [turned = marks_of_turned_](PackedGrid::Block& block) {
      unsigned const marks = block.marks;
      block.marks = static_cast<std::uint16_t>((marks & ~WaitingInBlock::all_slots) | turned);
      return marks ^ turned;
    };
    std::size_t taken = 0;
    for (std::size_t of_class = 0; of_class < ClassOrder::classes; ++of_class) {
      order.find(
          grid_, tiling_, tiles, of_class, [this](std::uint32_t row) { return id_indices_[row]; }, take_waiting);
      TurnsInOrder const in_order{.rows = order.rows(),
                                  .blocks = order.blocks(),
                                  .slots = order.slots(),
                                  .places = order.tiles(),
                                  .results = results.data()};
      for (std::size_t first = 0; first < order.size();) {
        std::size_t const end = order.next_batch(grid_, first, group_size_);
        // A local disk moves less than a contact distance in the whole step, so no sub-step can be too long.
        turns_.take_batch(in_order, first, end - first);
        ahead.advance(end - first);
        first = end;
      }
      taken += order.size();
    }
    for (std::uint32_t const tile : tiles) {
      turns_of_tile_[place_of_tile_[tile]] = static_cast<std::uint32_t>(taken / tiles.size());
    }
    tiles = next;
  }
}

void Steps::take_late(std::uint32_t row, TileResult& result) {
  if (is_short_at(squared_length(disks_[row].velocity), disks_[row].radius)) {
    turns_.take_any(row, result.counters);
  } else if (!result.too_fast) {
    double const displacement = std::sqrt(squared_length(disks_[row].velocity)) * view_.substep;
    result.too_fast = {.row_in_state = disks_[row].row_in_state, .displacement = displacement};
  }
}

bool Steps::is_short_at(double squared_speed, double radius) const {
  return is_short(squared_speed * view_.substep * view_.substep, radius + rule_.radii.smallest);
}

int Steps::reach(double radius, double squared_speed) const {
  double const distance = cutoff_.of(radius, squared_speed);
  return std::max(grid_.layout().columns_within(distance), grid_.layout().rows_within(distance));
}

bool Steps::has_turned(std::uint32_t row) const {
  return ((grid_.block_of(row).marks ^ marks_of_turned_) >> grid_.slot_of(row) & 1U) == 0;
}

void Steps::replace_cell(int cell, std::span<DiskInTurn const> disks, std::span<std::uint8_t const> has_turned) {
  rows_of_cell_.clear();
  grid_.for_each_in_cell(cell, [&](std::size_t row) { rows_of_cell_.push_back(static_cast<std::uint32_t>(row)); });
  // Most disks of the cell were in it before and keep their rows.
  std::vector<std::uint32_t>& old = rows_of_cell_;
  for (std::size_t k = 0; k < disks.size(); ++k) {
    auto const same = std::ranges::find(old, disks[k].id_index, [&](std::uint32_t row) { return id_indices_[row]; });
    if (same == old.end()) continue;
    disks_[*same] = disks[k];
    grid_.move(*same, disks[k].position);
    set_mark(*same, has_turned[k] != 0);
  }
  for (std::uint32_t const row : old) {
    bool const has_left = std::ranges::find(disks, id_indices_[row], &DiskInTurn::id_index) == disks.end();
    if (!has_left) continue;
    grid_.erase(row);
    free_rows_.push_back(row);
  }
  for (std::size_t k = 0; k < disks.size(); ++k) {
    bool const is_new =
        std::ranges::find(old, disks[k].id_index, [&](std::uint32_t row) { return id_indices_[row]; }) == old.end();
    if (is_new) insert(disks[k], has_turned[k] != 0);
  }
}

void Steps::insert(DiskInTurn const& disk, bool has_turned) {
  auto row = static_cast<std::uint32_t>(disks_.size());
  if (!free_rows_.empty()) {
    row = free_rows_.back();
    free_rows_.pop_back();
    disks_[row] = disk;
    id_indices_[row] = disk.id_index;
  } else {
    disks_.add(disk);
    view_.disks = disks_.all();
    id_indices_.push_back(disk.id_index);
  }
  grid_.insert(row, disk.position);
  set_mark(row, has_turned);
}

void Steps::set_mark(std::uint32_t row, bool has_turned) {
  PackedGrid::Block& block = grid_.block_of(row);
  unsigned const slot = grid_.slot_of(row);
  unsigned const mark = (has_turned ? marks_of_turned_ : ~marks_of_turned_) & 1U;
  block.marks = static_cast<std::uint16_t>((block.marks & ~(1U << slot)) | mark << slot);
}

CellOfTurn::CellOfTurn(CellLayout const& layout, Tiling const& tiling, std::span<std::uint32_t const> tiles)
    : layout_(layout) {
  if (tiles.empty()) return;
  first_column_ = layout.columns();
  first_row_ = layout.rows();
  int end_column = 0;
  int end_row = 0;
  for (std::uint32_t const number : tiles) {
    Tiling::Tile const& tile = tiling.tiles()[number];
    first_column_ = std::min(first_column_, tile.first_column);
    first_row_ = std::min(first_row_, tile.first_row);
    end_column = std::max(end_column, tile.end_column);
    end_row = std::max(end_row, tile.end_row);
  }
  columns_ = static_cast<std::size_t>(end_column - first_column_);
  turns_.resize(columns_ * static_cast<std::size_t>(end_row - first_row_));
  std::uint32_t next = 0;
  for (std::uint32_t const number : tiles) {
    Tiling::Tile const& tile = tiling.tiles()[number];
    for (int row = tile.first_row; row < tile.end_row; ++row) {
      for (int column = tile.first_column; column < tile.end_column; ++column) turns_[index_of(column, row)] = next++;
    }
  }
}

}  // namespace gridlock::tiled
