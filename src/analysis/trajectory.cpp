#include "analysis/trajectory.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "gridlock/core/error.hpp"

namespace gridlock {

namespace {

void require_finite_positions(TrajectoryInMemory const& trajectory) {
  for (std::size_t k = 0; k < 2 * trajectory.frames * trajectory.agents; ++k) {
    if (std::isfinite(trajectory.positions[k])) continue;
    std::size_t const row = k / 2;
    throw Error({.what = fmt::format("the position of agent {} in frame {} is not finite", row % trajectory.agents,
                                     row / trajectory.agents),
                 .hint = "every coordinate must be finite"});
  }
}

void require_kinds(TrajectoryInMemory const& trajectory) {
  if (trajectory.kinds.empty()) return;
  if (trajectory.kinds.size() != trajectory.agents) {
    throw Error(
        {.what = fmt::format("there are kinds of {} agents, but {} agents", trajectory.kinds.size(), trajectory.agents),
         .hint = "give one kind for each agent"});
  }
  std::vector<std::uint32_t> sorted(trajectory.kinds.begin(), trajectory.kinds.end());
  std::ranges::sort(sorted);
  for (std::uint32_t expected = 0; std::uint32_t const kind : sorted) {
    if (kind > expected) {
      throw Error({.what = fmt::format("there are agents of kind {} and none of kind {}", kind, expected),
                   .hint = "number the kinds from 0 without a gap"});
    }
    expected = kind + 1;
  }
}

}  // namespace

void require_trajectory(TrajectoryInMemory const& trajectory) {
  if (trajectory.agents == 0) {
    throw Error(Problem{.what = "a trajectory without agents", .hint = "use at least one agent"});
  }
  if (trajectory.times.size() != trajectory.frames) {
    throw Error(
        {.what = fmt::format("there are times of {} frames, but {} frames", trajectory.times.size(), trajectory.frames),
         .hint = "give one time for each frame"});
  }
  require_kinds(trajectory);
  require_finite_positions(trajectory);
}

std::vector<Agents> agents_by_kind(TrajectoryInMemory const& trajectory) {
  std::vector<Agents> result(1);
  for (std::uint32_t i = 0; i < trajectory.agents; ++i) {
    std::size_t const kind = trajectory.kinds.empty() ? 0 : trajectory.kinds[i];
    if (kind >= result.size()) result.resize(kind + 1);
    result[kind].push_back(i);
  }
  return result;
}

}  // namespace gridlock
