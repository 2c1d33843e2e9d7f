#include "gridlock/analysis/bond_orientations.hpp"

#include <fmt/format.h>

#include <cmath>

#include "core/bond_direction.hpp"

namespace gridlock {

namespace {

/// Returns exp(i k θ) for the angle θ of a vector that is not zero, without trigonometry.
std::complex<double> power_of_direction(Vector r, unsigned k) {
  if (k == 6) {
    Vector const power = sixth_power_of_direction(r);
    return {power.x, power.y};
  }
  double const length = std::sqrt(squared_length(r));
  std::complex<double> const unit(r.x / length, r.y / length);
  std::complex<double> power = unit;
  for (unsigned n = 1; n < k; ++n) power *= unit;
  return power;
}

}  // namespace

std::vector<std::complex<double>> bond_orientations(Box const& box, PointsInMemory const& points,
                                                    NeighbourLists const& neighbours, std::span<double const> weights,
                                                    unsigned k) {
  if (!weights.empty() && weights.size() != neighbours.neighbours.size()) {
    throw Error(
        {.what = fmt::format("there are {} weights of {} neighbours", weights.size(), neighbours.neighbours.size()),
         .hint = "give one for each entry of the lists"});
  }
  if (k == 0) throw Error(Problem{.what = "the order ψ_k has k = 0", .hint = "use 1 or more, such as 6 for hexagons"});
  auto const place = [&](std::size_t i) { return Vector{points.x[i * points.stride], points.y[i * points.stride]}; };
  std::vector<std::complex<double>> orders(points.count);
  for (std::size_t i = 0; i < points.count; ++i) {
    std::complex<double> sum = 0.0;
    double all = 0.0;
    for (std::uint64_t n = neighbours.begin[i]; n < neighbours.begin[i + 1]; ++n) {
      Vector const separation = box.displacement(place(i), place(neighbours.neighbours[n]));
      if (!(squared_length(separation) > 0.0)) continue;  // an image of the point itself, in a box of few points
      double const weight = weights.empty() ? 1.0 : weights[n];
      sum += weight * power_of_direction(separation, k);
      all += weight;
    }
    if (all > 0.0) orders[i] = sum / all;
  }
  return orders;
}

}  // namespace gridlock
