#include "grid/linked_grid.hpp"

#include <algorithm>

#include "grid/require.hpp"
#include "gridlock/grid/detail/neighbour_grid.hpp"

namespace gridlock {

static_assert(NeighbourGrid<LinkedGrid>);

LinkedGrid::LinkedGrid(CellLayout const& layout, std::size_t agents)
    : layout_(layout), heads_(static_cast<std::size_t>(layout.count()), none) {
  grow(agents);
}

LinkedGrid::LinkedGrid(CellLayout const& layout, std::span<double const> x, std::span<double const> y)
    : LinkedGrid(layout, x.size()) {
  require_points(x, y);
  for (std::size_t i = 0; i < x.size(); ++i) insert(i, {x[i], y[i]});
}

void LinkedGrid::grow(std::size_t agents) {
  next_.resize(agents, none);
  previous_.resize(agents, none);
  cell_.resize(agents, outside);
}

void LinkedGrid::move_all(std::span<double const> x, std::span<double const> y) {
  require_equal_lengths(x, y);
  std::size_t const agents = std::min(cell_.size(), x.size());
  std::size_t moved = 0;
  for (std::size_t i = 0; i < agents; ++i) {
    if (cell_[i] == outside) continue;
    move(i, {x[i], y[i]});
    ++moved;
  }
  require_all_moved(moved, size_, x.size());
}

void LinkedGrid::link(std::size_t agent, int cell) {
  std::int32_t& head = heads_[static_cast<std::size_t>(cell)];
  auto const self = static_cast<std::int32_t>(agent);
  next_[agent] = head;
  previous_[agent] = none;
  if (head != none) previous_[static_cast<std::size_t>(head)] = self;
  head = self;
  cell_[agent] = cell;
}

void LinkedGrid::unlink(std::size_t agent) {
  std::int32_t const before = previous_[agent];
  std::int32_t const after = next_[agent];
  if (before != none) {
    next_[static_cast<std::size_t>(before)] = after;
  } else {
    heads_[static_cast<std::size_t>(cell_[agent])] = after;
  }
  if (after != none) previous_[static_cast<std::size_t>(after)] = before;
}

bool LinkedGrid::is_consistent() const {
  std::size_t linked = 0;
  for (int cell = 0; cell < layout_.count(); ++cell) {
    std::int32_t before = none;
    for (std::int32_t i = heads_[static_cast<std::size_t>(cell)]; i != none;) {
      auto const agent = static_cast<std::size_t>(i);
      // A loop in a list would never end; it shows as more links than agents.
      if (++linked > size_ || cell_[agent] != cell || previous_[agent] != before) return false;
      before = i;
      i = next_[agent];
    }
  }
  return linked == size_;
}

}  // namespace gridlock
