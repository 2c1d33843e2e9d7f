#pragma once

#include <cstddef>

#include "gridlock/core/disks.hpp"

namespace gridlock::reference {

/// Returns the place of a disk beyond the edges that it has crossed.
inline Vector unwrapped_place(State const& state, std::size_t row) {
  auto const crossed_x = state.agents.column<ImageX>()[row];
  auto const crossed_y = state.agents.column<ImageY>()[row];
  return position(state.agents, row) + state.box.offset_of_image(crossed_x, crossed_y);
}

}  // namespace gridlock::reference
