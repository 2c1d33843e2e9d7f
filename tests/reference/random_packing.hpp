#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>

#include "gridlock/core/random.hpp"
#include "gridlock/packing/soft_disks.hpp"

namespace gridlock::reference {

/// Points anywhere in a box of area 1, half of them disks of diameter D and half of 1.4 D. The box is no square, so
/// that what takes x for y is found out; where published numbers are for squares, `width` is 1.
inline Packing random_packing(std::size_t disks, double packing_fraction, std::uint64_t seed,
                              Edge edge = Edge::periodic, double width = 1.25) {
  Packing packing{.box = Box(width, 1.0 / width, edge), .x = {}, .y = {}, .radius = {}};
  RandomStream random(seed, 0, 0, Purpose::model_start);
  double sum = 0.0;
  for (std::size_t i = 0; i < disks; ++i) {
    packing.x.push_back(packing.box.width() * random.uniform());
    packing.y.push_back(packing.box.height() * random.uniform());
    packing.radius.push_back(i % 2 == 0 ? 1.0 : 1.4);
    sum += packing.radius.back() * packing.radius.back();
  }
  double const scale = std::sqrt(packing_fraction / (std::numbers::pi * sum));
  for (double& radius : packing.radius) radius *= scale;
  return packing;
}

}  // namespace gridlock::reference
