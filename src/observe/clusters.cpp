#include "gridlock/observe/clusters.hpp"

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <utility>
#include <vector>

#include "gridlock/core/vector.hpp"
#include "gridlock/observe/pairs.hpp"
#include "gridlock/parallel/communicator.hpp"

namespace gridlock {

namespace {

/// Disjoint sets of rows; the first row of a set stands for it.
class RowSets {
 public:
  explicit RowSets(std::size_t rows) : parents_(rows) { std::iota(parents_.begin(), parents_.end(), 0U); }

  void join(std::size_t i, std::size_t j) {
    std::uint32_t const one = first_of(i);
    std::uint32_t const other = first_of(j);
    parents_[std::max(one, other)] = std::min(one, other);
  }
  [[nodiscard]] std::uint32_t first_of(std::size_t row) {
    auto at = static_cast<std::uint32_t>(row);
    while (parents_[at] != at) {
      parents_[at] = parents_[parents_[at]];
      at = parents_[at];
    }
    return at;
  }

 private:
  std::vector<std::uint32_t> parents_;
};

/// Returns the number of the set of each row, the largest set first, and of two of one size that with the first row.
std::vector<std::uint32_t> numbers_of(RowSets& sets, std::size_t count) {
  std::vector<std::uint64_t> sizes(count, 0);
  for (std::size_t i = 0; i < count; ++i) ++sizes[sets.first_of(i)];
  std::vector<std::uint32_t> firsts;
  for (std::uint32_t row = 0; row < count; ++row) {
    if (sizes[row] > 0) firsts.push_back(row);
  }
  std::ranges::stable_sort(firsts, [&](std::uint32_t one, std::uint32_t other) { return sizes[one] > sizes[other]; });
  std::vector<std::uint32_t> number_of(count, 0);
  for (std::uint32_t cluster = 0; cluster < firsts.size(); ++cluster) number_of[firsts[cluster]] = cluster;
  std::vector<std::uint32_t> clusters(count);
  for (std::size_t i = 0; i < count; ++i) clusters[i] = number_of[sets.first_of(i)];
  return clusters;
}

/// Calls visit(i, j, separation) for all pairs nearer than the cutoff, and for some others.
template <class Visit>
void visit_pairs(Box const& box, std::span<double const> x, std::span<double const> y, double cutoff, Visit visit) {
  bool const is_small = cutoff > 0.5 * box.shortest_period();
  if (!is_small) {
    LocalPoints(box, x, y, cutoff, Communicator::alone(), x.size()).for_each_pair(visit);
    return;
  }
  for (std::size_t i = 0; i < x.size(); ++i) {
    for (std::size_t j = i + 1; j < x.size(); ++j) visit(i, j, box.displacement({x[i], y[i]}, {x[j], y[j]}));
  }
}

}  // namespace

std::vector<std::uint32_t> cluster_of_each(Box const& box, std::span<double const> x, std::span<double const> y,
                                           std::span<double const> radius, double cutoff) {
  std::size_t const count = x.size();
  RowSets sets(count);
  double const max_radius = count == 0 ? 0.0 : std::ranges::max(radius);
  if (max_radius * cutoff > 0.0) {
    visit_pairs(box, x, y, 2.0 * max_radius * cutoff, [&](std::size_t i, std::size_t j, Vector separation) {
      double const near = cutoff * (radius[i] + radius[j]);
      if (squared_length(separation) < near * near) sets.join(i, j);
    });
  }
  return numbers_of(sets, count);
}

std::vector<std::uint32_t> cluster_of_each(std::size_t count, std::span<std::uint32_t const> i,
                                           std::span<std::uint32_t const> j) {
  RowSets sets(count);
  for (std::size_t k = 0; k < i.size(); ++k) sets.join(i[k], j[k]);
  return numbers_of(sets, count);
}

std::vector<std::uint64_t> sizes_of_clusters(std::span<std::uint32_t const> cluster_of_each) {
  std::vector<std::uint64_t> sizes(cluster_of_each.empty() ? 0 : std::ranges::max(cluster_of_each) + std::size_t{1}, 0);
  for (std::uint32_t const cluster : cluster_of_each) ++sizes[cluster];
  return sizes;
}

}  // namespace gridlock
