#include "grid/oblique_lists.hpp"

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "grid/require.hpp"
#include "gridlock/grid/detail/oblique_points.hpp"

namespace gridlock {

namespace {

/// Returns the pairs of points of an oblique box among pairs of points and images, where are_near(i, j) holds.
template <class AreNear>
PointPairs pairs_of_oblique(ObliquePoints const& all, PointPairs const& found, AreNear are_near) {
  std::vector<AgentPair> kept;
  for (std::size_t k = 0; k < found.size(); ++k) {
    if (!all.counts(found.first()[k], found.second()[k])) continue;
    std::uint32_t const i = all.point(found.first()[k]);
    std::uint32_t const j = all.point(found.second()[k]);
    if (i != j && are_near(i, j)) kept.push_back({i, j});
  }
  return in_columns(kept);
}

Vector at(PointsInMemory const& points, std::uint32_t i) {
  return {points.x[i * points.stride], points.y[i * points.stride]};
}

ObliquePoints with_images(Box const& box, double cutoff, PointsInMemory const& points) {
  require_search(points, cutoff);
  require_box_for(box, cutoff);
  return {box,           searched_distance(cutoff),   points.x, points.y, points.count,
          points.stride, ObliquePoints::Images::above};
}

}  // namespace

PointPairs in_columns(std::span<AgentPair const> list) {
  PointPairs pairs;
  pairs.indices.resize(2 * list.size());
  for (std::size_t k = 0; k < list.size(); ++k) {
    pairs.indices[k] = list[k].first;
    pairs.indices[list.size() + k] = list[k].second;
  }
  return pairs;
}

PointPairs find_pairs_in_oblique(Box const& box, double cutoff, PointsInMemory const& points, std::uint64_t threads) {
  ObliquePoints const all = with_images(box, cutoff, points);
  PointPairs const found = find_pairs(all.frame(), std::min(searched_distance(cutoff), 0.5 * box.width()),
                                      {.x = all.x().data(), .y = all.y().data(), .count = all.size()}, threads);
  return pairs_of_oblique(all, found, [&](std::uint32_t i, std::uint32_t j) {
    return squared_length(box.displacement(at(points, i), at(points, j))) < cutoff * cutoff;
  });
}

PointPairs find_pairs_of_disks_in_oblique(Box const& box, DiskReach const& reach, PointsInMemory const& centres,
                                          std::span<double const> radius, std::uint64_t threads) {
  auto const contact = [&](double one, double other) { return reach.factor * (one + other) + reach.gap; };
  double const largest = std::ranges::max(radius);
  ObliquePoints const all = with_images(box, contact(largest, largest), centres);
  std::vector<double> radii(radius.begin(), radius.end());
  for (std::size_t k = all.own(); k < all.size(); ++k) radii.push_back(radius[all.point(k)]);
  // The factor covers the rounding of images, as far as the width allows.
  double const widest = 0.5 * box.width() / contact(largest, largest);
  double const margin = std::min(searched_distance(1.0), widest);
  PointPairs const found =
      find_pairs_of_disks(all.frame(), {.factor = reach.factor * margin, .gap = reach.gap * margin},
                          {.x = all.x().data(), .y = all.y().data(), .count = all.size()}, radii, threads);
  return pairs_of_oblique(all, found, [&](std::uint32_t i, std::uint32_t j) {
    double const distance = contact(radius[i], radius[j]);
    return squared_length(box.displacement(at(centres, i), at(centres, j))) < distance * distance;
  });
}

NeighbourLists lists_of(PointPairs const& pairs, std::size_t count) {
  NeighbourLists lists{.begin = std::vector<std::uint64_t>(count + 1, 0), .neighbours = {}};
  for (std::uint32_t const i : pairs.indices) ++lists.begin[i + 1];
  for (std::size_t i = 0; i < count; ++i) lists.begin[i + 1] += lists.begin[i];
  lists.neighbours.resize(pairs.indices.size());
  std::vector<std::uint64_t> next(lists.begin.begin(), lists.begin.end() - 1);
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    lists.neighbours[next[pairs.first()[k]]++] = pairs.second()[k];
    lists.neighbours[next[pairs.second()[k]]++] = pairs.first()[k];
  }
  for (std::size_t i = 0; i < count; ++i) {
    std::sort(lists.neighbours.data() + lists.begin[i], lists.neighbours.data() + lists.begin[i + 1]);
  }
  return lists;
}

}  // namespace gridlock
