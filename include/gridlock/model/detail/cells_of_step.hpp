#pragma once

#include <cstddef>
#include <optional>

#include "gridlock/grid/cell_layout.hpp"

namespace gridlock {

/// The cells of a step of a synchronous model: coarse ones, and finer ones for agents that crowd, where those would
/// help.
struct CellsOfStep {
  CellLayout layout;
  std::optional<CellLayout> finer;
};
CellsOfStep cells_of_step(Box const& box, double cutoff, std::size_t agents);

}  // namespace gridlock
