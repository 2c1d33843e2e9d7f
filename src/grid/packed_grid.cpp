#include "gridlock/grid/detail/packed_grid.hpp"

#include <mutex>
#include <string>

#include "grid/require.hpp"
#include "gridlock/core/error.hpp"
#include "gridlock/grid/detail/neighbour_grid.hpp"

namespace gridlock {

static_assert(NeighbourGrid<PackedGrid>);

namespace {

constexpr std::size_t max_blocks = std::size_t{1} << 30;

}  // namespace

PackedGrid::PackedGrid(CellLayout const& layout, std::size_t agents)
    : PackedGrid(layout, {.end_column = layout.columns(), .end_row = layout.rows()}, agents) {}

PackedGeometry::PackedGeometry(CellLayout const& layout, CellWindow const& window) : layout_(layout), window_(window) {
  int const columns = layout.columns();
  int const rows = layout.rows();
  bool const has_all_columns = window.end_column - window.first_column >= columns;
  bool const has_all_rows = window.end_row - window.first_row >= rows;
  if (has_all_columns) window_.first_column = 0, window_.end_column = columns;
  if (has_all_rows) window_.first_row = 0, window_.end_row = rows;
  assert(layout.is_periodic_x() || (window_.first_column >= 0 && window_.end_column <= columns));
  assert(layout.is_periodic_y() || (window_.first_row >= 0 && window_.end_row <= rows));
  stride_ = static_cast<std::size_t>(window_.end_column - window_.first_column) + 1;
  std::size_t const first_of_cells = stride_ + 1;
  first_ = window_.first_row * static_cast<std::ptrdiff_t>(stride_) + window_.first_column -
           static_cast<std::ptrdiff_t>(first_of_cells);
  blocks_of_cells_ = first_of_cells + stride_ * (static_cast<std::size_t>(window_.end_row - window_.first_row) + 1);
  if (blocks_of_cells_ > max_blocks) {
    throw Error(
        {.what = "a packed grid of " + std::to_string(columns) + " × " + std::to_string(rows) + " cells cannot be made",
         .hint = "use at most " + std::to_string(max_blocks) + " cells",
         .key = "engine.cells"});
  }
  auto const beyond = [](bool is_periodic, int at_wall, int around, int next, bool has_all) {
    return !is_periodic ? at_wall : has_all ? around : next;
  };
  left_of_first_ = beyond(layout.is_periodic_x(), window_.end_column, columns - 1, -1, has_all_columns);
  right_of_last_ = beyond(layout.is_periodic_x(), window_.end_column, 0, columns, has_all_columns);
  below_first_ = beyond(layout.is_periodic_y(), window_.end_row, rows - 1, -1, has_all_rows);
  above_last_ = beyond(layout.is_periodic_y(), window_.end_row, 0, rows, has_all_rows);
  double const longer = std::max(layout.cell_width(), layout.cell_height());
  locals_per_length_ = 1.0 / longer;
  local_width_ = static_cast<float>(layout.cell_width() / longer);
  local_height_ = static_cast<float>(layout.cell_height() / longer);
}

PackedGrid::PackedGrid(CellLayout const& layout, CellWindow const& window_of_cells, std::size_t agents)
    : PackedGeometry(layout, window_of_cells) {
  Block empty{.x = {},
              .y = {},
              .agent = {},
              .next = none,
              .count = 0,
              .marks = 0,
              .column = layout.columns(),
              .row = layout.rows()};
  empty.x.fill(nowhere);
  empty.y.fill(nowhere);
  blocks_.reserve(agents == 0 ? blocks_of_cells() : max_blocks_for(agents));
  for (std::ptrdiff_t k = 0; k < blocks_in_row() + 1; ++k) blocks_.push_back(empty);
  // Cells of the window have their numbers in the box; empty cells beside the window have numbers of no cell in it.
  auto const in_box = [&](int index, int end, int all) {
    if (index == end) return all;
    return index < 0 ? index + all : index >= all ? index - all : index;
  };
  CellWindow const& of = window();
  for (int row = of.first_row; row <= of.end_row; ++row) {
    for (int column = of.first_column; column <= of.end_column; ++column) {
      empty.column = in_box(column, of.end_column, layout.columns());
      empty.row = in_box(row, of.end_row, layout.rows());
      blocks_.push_back(empty);
    }
  }
  if (agents > 0) grow(agents);
}

PackedGrid::PackedGrid(CellLayout const& layout, std::span<double const> x, std::span<double const> y)
    : PackedGrid(layout, x.size()) {
  require_points(x, y);
  // Agents are in no order: an agent's cell is prefetched while earlier agents are inserted.
  constexpr std::size_t ahead = 16;
  std::array<CellPoint, ahead> waiting;
  for (std::size_t i = 0; i < x.size() + ahead; ++i) {
    CellPoint& cell_point = waiting[i % ahead];
    if (i >= ahead) put(i - ahead, cell_point);
    if (i >= x.size()) continue;
    cell_point = cell_point_of({x[i], y[i]});
    gridlock::prefetch(&blocks_[index_of(cell_point.column, cell_point.row)]);
  }
  size_ = x.size();
}

void PackedGrid::grow(std::size_t agents) {
  place_.resize(agents, none);
  std::size_t const most = max_blocks_for(place_.capacity());
  if (blocks_.capacity() < most) blocks_.reserve(most);
}

std::size_t PackedGrid::max_blocks_for(std::size_t agents) const {
  // A cell of n > 4 agents has at most n/4 further blocks. All have memory, so blocks never move while threads work.
  return blocks_of_cells() + agents / slots + 1;
}

void PackedGrid::put(std::size_t agent, CellPoint const& cell_point) {
  assert(stores(cell_point.column, cell_point.row));
  std::size_t const base_index = index_of(cell_point.column, cell_point.row);
  std::size_t index = base_index;
  if (blocks_[base_index].count == slots) {
    // Behind a full first block only the second can have a free slot: all further blocks are full.
    index = blocks_[base_index].next;
    if (index == none || blocks_[index].count == slots) index = add_block(blocks_[base_index]);
  }
  blocks_[base_index].marks |= changed;
  Block& block = blocks_[index];
  std::uint32_t const slot = block.count++;
  block.marks = static_cast<std::uint16_t>(block.marks & ~(1U << slot));
  block.agent[slot] = static_cast<std::uint32_t>(agent);
  write_place(block, slot, local(cell_point.p, cell_point.column, cell_point.row));
  place_[agent] = static_cast<std::uint32_t>(index * slots + slot);
}

void PackedGrid::take_out(std::size_t agent) {
  std::uint32_t const place = place_[agent];
  Block& hole = blocks_[place / slots];
  Block& base = blocks_[index_of(hole.column, hole.row)];
  Block& top = base.next == none ? base : blocks_[base.next];
  base.marks |= changed;
  // The last agent of the only block that is not full fills the hole.
  std::uint32_t const last = --top.count;
  std::uint32_t const slot = place % slots;
  std::uint32_t const filler = top.agent[last];
  store(hole.x, with_lane(load(hole.x), slot, top.x[last]));
  store(hole.y, with_lane(load(hole.y), slot, top.y[last]));
  hole.agent[slot] = filler;
  place_[filler] = place;
  unsigned const mark_of_filler = (top.marks >> last) & 1U;
  hole.marks = static_cast<std::uint16_t>((hole.marks & ~(1U << slot)) | mark_of_filler << slot);
  store(top.x, with_lane(load(top.x), last, nowhere));
  store(top.y, with_lane(load(top.y), last, nowhere));
  if (last == 0 && base.next != none) drop_second_block(base);
}

void PackedGrid::move_to_cell(std::size_t agent, Vector p) {
  unsigned const mark = (block_of(agent).marks >> place_[agent] % slots) & 1U;
  take_out(agent);
  put(agent, cell_point_of(p));
  block_of(agent).marks |= static_cast<std::uint16_t>(mark << place_[agent] % slots);
}

std::uint32_t PackedGrid::add_block(Block& base) {
  std::scoped_lock const guard(further_blocks_);
  std::uint32_t index = first_free_;
  if (index != none) {
    first_free_ = blocks_[index].next;
  } else {
    assert(blocks_.size() < blocks_.capacity() && blocks_.size() < max_blocks);
    index = static_cast<std::uint32_t>(blocks_.size());
    blocks_.emplace_back();
  }
  Block& block = blocks_[index];
  block.x.fill(nowhere);
  block.y.fill(nowhere);
  block.count = 0;
  block.marks = 0;
  block.column = base.column;
  block.row = base.row;
  block.next = base.next;
  base.next = index;
  std::atomic_ref(further_blocks_in_use_).fetch_add(1, std::memory_order_relaxed);
  return index;
}

void PackedGrid::drop_second_block(Block& base) {
  std::scoped_lock const guard(further_blocks_);
  std::uint32_t const index = base.next;
  base.next = blocks_[index].next;
  blocks_[index].next = first_free_;
  first_free_ = index;
  std::atomic_ref(further_blocks_in_use_).fetch_sub(1, std::memory_order_relaxed);
}

void PackedGrid::move_all(std::span<double const> x, std::span<double const> y) {
  require_equal_lengths(x, y);
  // Agents are in no order: an agent's cell is prefetched while earlier agents are moved.
  constexpr std::size_t ahead = 16;
  std::size_t const agents = std::min(place_.size(), x.size());
  std::size_t moved = 0;
  for (std::size_t i = 0; i < agents; ++i) {
    if (i + ahead < agents) prefetch_block_of(i + ahead);
    if (place_[i] == none) continue;
    move(i, {x[i], y[i]});
    ++moved;
  }
  require_all_moved(moved, size_, x.size());
}

bool PackedGrid::is_consistent() const {
  std::size_t found = 0;
  for (std::size_t base = 0; base < blocks_of_cells(); ++base) {
    std::size_t position = 0;
    for (std::size_t index = base; index != none; index = blocks_[index].next, ++position) {
      Block const& block = blocks_[index];
      bool const is_outside = block.column == layout().columns() || block.row == layout().rows();
      if (is_outside && (block.count != 0 || block.next != none)) return false;
      if (block.column != blocks_[base].column || block.row != blocks_[base].row) return false;
      // Only the last block of a chain of one, or the second of a longer chain, may have a free slot.
      bool const may_have_room = position == 1 || (position == 0 && block.next == none);
      if (block.count > slots || (block.count < slots && !may_have_room)) return false;
      if (position > 0 && block.count == 0) return false;
      for (std::uint32_t s = 0; s < slots; ++s) {
        bool const is_empty = block.x[s] == nowhere && block.y[s] == nowhere;
        if (is_empty != (s >= block.count)) return false;
        if (!is_empty && place_[block.agent[s]] != index * slots + s) return false;
      }
      // A loop in a chain would never end; it shows as more agents than there are.
      found += block.count;
      if (found > size_) return false;
    }
  }
  return found == size_;
}

}  // namespace gridlock
