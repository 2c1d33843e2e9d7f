#pragma once

#include <cstddef>
#include <random>
#include <vector>

#include "gridlock/grid/neighbour_lists.hpp"

namespace gridlock {

/// Random points of a rectangle, as rows of two numbers.
struct RandomPoints {
  std::vector<double> values;

  RandomPoints(std::size_t count, double width, double height, unsigned seed = 5) {
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> part;
    for (std::size_t i = 0; i < count; ++i) {
      values.push_back(width * part(random));
      values.push_back(height * part(random));
    }
  }

  [[nodiscard]] PointsInMemory view() const {
    return {.x = values.data(), .y = values.data() + 1, .count = values.size() / 2, .stride = 2};
  }
  [[nodiscard]] Vector operator[](std::size_t i) const { return {values[2 * i], values[2 * i + 1]}; }
};

}  // namespace gridlock
