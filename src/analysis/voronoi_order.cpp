#include <complex>

#include "gridlock/analysis/voronoi.hpp"
#include "observe/bond_orientation.hpp"

namespace gridlock {

std::vector<double> local_bond_orientation_orders(Box const& box, PointsInMemory const& points,
                                                  NeighbourLists const& neighbours) {
  auto const place = [&](std::size_t i) { return Vector{points.x[i * points.stride], points.y[i * points.stride]}; };
  std::vector<double> orders(points.count);
  for (std::size_t i = 0; i < points.count; ++i) {
    std::complex<double> sum = 0.0;
    double directions = 0.0;
    for (std::uint64_t k = neighbours.begin[i]; k < neighbours.begin[i + 1]; ++k) {
      Vector const separation = box.displacement(place(i), place(neighbours.neighbours[k]));
      if (!(squared_length(separation) > 0.0)) continue;  // an image of the point itself, in a box of few points
      sum += sixth_power_of_direction(separation);
      directions += 1.0;
    }
    if (directions > 0.0) orders[i] = std::abs(sum) / directions;
  }
  return orders;
}

}  // namespace gridlock
