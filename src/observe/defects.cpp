#include "gridlock/observe/defects.hpp"

#include <cmath>
#include <cstdlib>

#include "gridlock/observe/clusters.hpp"

namespace gridlock {

namespace {

DefectKind kind_of(DefectCluster const& cluster, std::uint32_t strength) {
  if (cluster.points == 1 && strength == 1) return DefectKind::disclination;
  if (cluster.charge == 0 && strength == 2) return DefectKind::dislocation;
  if (cluster.charge == 0 && strength == 4) return DefectKind::dislocation_pair;
  return DefectKind::other;
}

std::int32_t charge_of(NeighbourLists const& neighbours, std::size_t i) {
  return 6 - static_cast<std::int32_t>(neighbours.begin[i + 1] - neighbours.begin[i]);
}

/// Returns the number of the cluster of each of the points that are defects.
std::vector<std::uint32_t> clusters_of(NeighbourLists const& neighbours, std::vector<std::uint32_t> const& defects,
                                       std::vector<std::uint32_t> const& number) {
  std::vector<std::uint32_t> first, second;
  for (std::uint32_t const i : defects) {
    for (std::uint64_t k = neighbours.begin[i]; k < neighbours.begin[i + 1]; ++k) {
      std::uint32_t const j = neighbours.neighbours[k];
      if (j >= i || number[j] == Defects::none) continue;
      first.push_back(number[i]);
      second.push_back(number[j]);
    }
  }
  return cluster_of_each(defects.size(), first, second);
}

}  // namespace

std::size_t Defects::points_in(DefectKind kind) const {
  std::size_t count = 0;
  for (DefectCluster const& one : clusters) count += one.kind == kind ? one.points : 0;
  return count;
}

Defects find_defects(Box const& box, PointsInMemory const& points, NeighbourLists const& neighbours) {
  Defects found{.points = 0, .cluster = std::vector<std::uint32_t>(points.count, Defects::none), .clusters = {}};
  std::vector<std::uint32_t> defects;
  std::vector<std::uint32_t> number(points.count, Defects::none);  // of each defect among the defects
  for (std::uint32_t i = 0; i < points.count; ++i) {
    if (charge_of(neighbours, i) == 0) continue;
    number[i] = static_cast<std::uint32_t>(defects.size());
    defects.push_back(i);
  }
  found.points = defects.size();
  std::vector<std::uint32_t> const clusters = clusters_of(neighbours, defects, number);
  auto const place = [&](std::size_t i) { return Vector{points.x[i * points.stride], points.y[i * points.stride]}; };
  std::vector<std::uint32_t> first_of, strengths;
  for (std::size_t k = 0; k < defects.size(); ++k) {
    std::uint32_t const i = defects[k];
    std::uint32_t const cluster = found.cluster[i] = clusters[k];
    if (cluster >= found.clusters.size()) {
      found.clusters.resize(cluster + std::size_t{1});
      first_of.resize(cluster + std::size_t{1}, Defects::none);
      strengths.resize(cluster + std::size_t{1}, 0);
    }
    if (first_of[cluster] == Defects::none) first_of[cluster] = i;
    DefectCluster& one = found.clusters[cluster];
    std::int32_t const charge = charge_of(neighbours, i);
    ++one.points;
    one.charge += charge;
    strengths[cluster] += static_cast<std::uint32_t>(std::abs(charge));
    one.moment = one.moment + static_cast<double>(charge) * box.displacement(place(first_of[cluster]), place(i));
  }
  for (std::size_t c = 0; c < found.clusters.size(); ++c)
    found.clusters[c].kind = kind_of(found.clusters[c], strengths[c]);
  return found;
}

}  // namespace gridlock
