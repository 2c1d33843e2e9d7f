#pragma once

#include <cstddef>
#include <optional>

#include "gridlock/grid/cell_layout.hpp"

namespace gridlock {

/// The cells of a step: coarse cells, and finer cells for crowded agents if these would save time.
struct CellsOfStep {
  CellLayout layout;
  std::optional<CellLayout> finer;
};
CellsOfStep cells_of_step(Box const& box, double cutoff, std::size_t agents);

}  // namespace gridlock
