#pragma once

#include <cmath>
#include <cstddef>
#include <random>
#include <vector>

#include "gridlock/analysis/dynamics.hpp"

namespace gridlock {

/// Independent walkers with Gaussian steps of variance 1 in each component: D = 1/2.
struct RandomWalk {
  std::vector<double> positions;
  std::vector<double> times;
  std::size_t agents;

  RandomWalk(std::size_t frames, std::size_t agent_count, unsigned seed = 7) : agents(agent_count) {
    std::mt19937_64 random(seed);
    std::normal_distribution<double> step;
    for (std::size_t f = 0; f < frames; ++f) {
      times.push_back(static_cast<double>(f));
      for (std::size_t k = 0; k < 2 * agents; ++k) {
        double const before = f == 0 ? 0.0 : positions[positions.size() - 2 * agents];
        positions.push_back(before + step(random));
      }
    }
  }

  [[nodiscard]] TrajectoryInMemory view() const {
    return {.positions = positions.data(), .frames = times.size(), .agents = agents, .times = times};
  }

  [[nodiscard]] double squared(std::size_t agent, std::size_t from, std::size_t to) const {
    std::size_t const a = 2 * (from * agents + agent);
    std::size_t const b = 2 * (to * agents + agent);
    return std::pow(positions[b] - positions[a], 2) + std::pow(positions[b + 1] - positions[a + 1], 2);
  }
};

}  // namespace gridlock
