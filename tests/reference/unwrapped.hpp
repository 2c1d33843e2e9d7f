#pragma once

#include <cstddef>
#include <vector>

#include "gridlock/core/disks.hpp"

namespace gridlock::reference {

/// The position of a disk that crossed edges of a periodic box, as if it had not been put back into the box.
inline Vector unwrapped(State const& state, std::size_t row) {
  return {state.agents.column<X>()[row] + state.box.width() * state.agents.column<ImageX>()[row],
          state.agents.column<Y>()[row] + state.box.height() * state.agents.column<ImageY>()[row]};
}

inline std::vector<Vector> unwrapped(State const& state) {
  std::vector<Vector> places;
  for (std::size_t row = 0; row < state.agents.size(); ++row) places.push_back(unwrapped(state, row));
  return places;
}

/// The mean of (Δr)² over all disks, whose places are in the same order in both.
inline double mean_squared_displacement(std::vector<Vector> const& from, std::vector<Vector> const& to) {
  double sum = 0.0;
  for (std::size_t i = 0; i < from.size(); ++i) sum += squared_length(to[i] - from[i]);
  return sum / static_cast<double>(from.size());
}

}  // namespace gridlock::reference
