#include "gridlock/grid/cell_layout.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "grid/require.hpp"
#include "gridlock/core/error.hpp"

namespace gridlock {

namespace {

constexpr std::uint64_t max_cells = std::uint64_t{1} << 31;

/// Returns the number of cells at least as wide as the cutoff that fit along a side; at least one.
std::uint64_t cells_along(double side, double cutoff, double most) {
  // Cells are slightly wider than the cutoff, so that the margin of columns_within() does not require a second ring of
  // cells. The rounding of a point's position is some 1e-16 of the number of cells; without a margin for it, points one
  // cutoff apart could be two cells apart.
  double const margin = std::max(1e-9, 1e-15 * std::min(side / cutoff, most));
  double const cells = std::min(std::floor(side / (cutoff * (1.0 + margin))), std::floor(most));
  return cells > 1.0 ? static_cast<std::uint64_t>(cells) : 1;
}

}  // namespace

CellLayout::CellLayout(Box const& box, std::uint64_t columns, std::uint64_t rows)
    : columns_(static_cast<int>(columns)),
      rows_(static_cast<int>(rows)),
      width_(box.width()),
      height_(box.height()),
      cell_width_(box.width() / static_cast<double>(columns)),
      cell_height_(box.height() / static_cast<double>(rows)),
      columns_per_length_(static_cast<double>(columns) / box.width()),
      rows_per_length_(static_cast<double>(rows) / box.height()),
      is_periodic_x_(box.is_periodic_x()),
      is_periodic_y_(box.is_periodic_y()) {
  if (columns == 0 || rows == 0 || columns >= max_cells / rows) {
    throw Error(
        {.what = "a grid of " + std::to_string(columns) + " × " + std::to_string(rows) + " cells cannot be made",
         .hint = "use at least 1 and at most 46340 cells a side",
         .key = "engine.cells"});
  }
}

CellLayout layout_for_cutoff(Box const& box, double cutoff, std::size_t agents, double cells_per_agent) {
  require_cutoff(cutoff);
  // Far fewer cells than agents would make long lists; far more would waste memory.
  double const most =
      std::min(cells_per_agent * static_cast<double>(agents) + 1.0, 0.99 * static_cast<double>(max_cells));
  double const columns = std::sqrt(most * (box.width() / box.height()));
  double const rows = std::sqrt(most * (box.height() / box.width()));
  return {box, cells_along(box.width(), cutoff, std::min(columns + 1.0, most)),
          cells_along(box.height(), cutoff, std::min(rows + 1.0, most))};
}

}  // namespace gridlock
