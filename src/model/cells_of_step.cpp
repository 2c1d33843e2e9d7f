#include "gridlock/model/detail/cells_of_step.hpp"

#include <algorithm>
#include <bit>

#include "gridlock/grid/detail/stored_cells.hpp"

namespace gridlock {

CellsOfStep cells_of_step(Box const& box, double cutoff, std::size_t agents) {
  // Rounded up to a power of two, so that the cells change seldom while agents come and go.
  std::size_t const bound = std::bit_ceil(std::max<std::size_t>(16, agents));
  CellLayout const layout = layout_for_cutoff(box, cutoff, bound);
  return {.layout = layout, .finer = layout_for_crowd(box, cutoff, bound, layout)};
}

}  // namespace gridlock
