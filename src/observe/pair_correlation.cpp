#include "observe/pair_correlation.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <cstdint>
#include <numbers>
#include <optional>
#include <utility>
#include <vector>

#include "gridlock/observe/pairs.hpp"
#include "observe/bond_orientation.hpp"
#include "observe/pair_products.hpp"

namespace gridlock {

namespace {

/// Returns the mean radius; for agents without a radius half the mean spacing √(A/N).
double mean_radius(Snapshot const& now) {
  auto const count = static_cast<double>(now.count());
  if (!now.agents.has<Radius>()) return 0.5 * std::sqrt(now.box.area() / count);
  auto const radius = now.agents.column<Radius>();
  return now.sum([&](std::size_t i) { return radius[i]; }) / count;
}

/// Returns the part of the box that centres can reach; nothing for no agents and where the walls leave no area.
std::optional<Box> domain_of_centres(Snapshot const& now) {
  Box const& box = now.box;
  if (now.count() == 0) return std::nullopt;
  if (box.is_periodic() || !now.agents.has<Radius>()) return box;
  double const margin = 2.0 * mean_radius(now);
  double const width = box.is_periodic_x() ? box.width() : box.width() - margin;
  double const height = box.is_periodic_y() ? box.height() : box.height() - margin;
  if (!(width > 0.0 && height > 0.0)) return std::nullopt;
  return Box(width, height, box.edge_x(), box.edge_y());
}

}  // namespace

double probability_of_nearer_points(Box const& box, double r) {
  double const area = box.area();
  double const disk = std::numbers::pi * r * r;
  if (box.is_periodic()) return disk / area;
  if (box.has_images()) {
    // Across the walls, two points of a channel of height H differ by y with the density (1 − |y|/H)/H.
    double const height = box.is_periodic_x() ? box.height() : box.width();
    return (disk * height - (4.0 / 3.0) * r * r * r) / (area * height);
  }
  double const sides = box.width() + box.height();
  return (disk * area - (4.0 / 3.0) * sides * r * r * r + 0.5 * r * r * r * r) / (area * area);
}

void PairCorrelation::begin(Snapshot const& start) {
  schedule_.reset();
  bin_width_ = 0.0;
  if (auto const domain = domain_of_centres(start)) {
    double const most = 0.5 * std::min(domain->width(), domain->height());
    bin_width_ = std::min(range_ * 2.0 * mean_radius(start), most) / static_cast<double>(bins_);
  }
  counts_.assign(bin_width_ > 0.0 ? bins_ : 0, 0);
  correlation_.assign(counts_.size(), {});
  orientation_.assign(has_orientation_ ? counts_.size() : 0, {});
}

std::size_t PairCorrelation::bin_of(Vector separation) const {
  auto const bin = static_cast<std::size_t>(std::sqrt(squared_length(separation)) / bin_width_);
  return std::min(bin, counts_.size() - 1);
}

std::vector<double> PairCorrelation::count_with_orientation(Snapshot const& now, double range) {
  std::size_t const all = now.count();
  LocalPoints const near(now, neighbour_distance(now.box, all));
  std::vector<std::complex<double>> const orders = bond_orientations_of(near, all);
  LocalPoints const points(now.box, near.own_x(), near.own_y(), range, now.processes.communicator(), all, &orders);
  double const units = units_of_products(1.0, all);
  std::vector<std::uint64_t> products(counts_.size(), 0);  // modulo 2⁶⁴, as negative sums are too
  points.for_each_pair([&](std::size_t i, std::size_t j, Vector separation) {
    std::uint64_t const own = (i < points.own() ? 1U : 0U) + (j < points.own() ? 1U : 0U);
    if (own == 0) return;
    std::size_t const bin = bin_of(separation);
    counts_[bin] += own;
    std::int64_t const product = product_in_units(points.values()[i], points.values()[j], units);
    products[bin] += own * static_cast<std::uint64_t>(product);
  });
  now.counts(products);
  std::vector<double> sums(products.size());
  for (std::size_t b = 0; b < sums.size(); ++b) {
    sums[b] = static_cast<double>(static_cast<std::int64_t>(products[b])) / units;
  }
  return sums;
}

void PairCorrelation::sample(Snapshot const& now, std::span<double>, bool counts_for_average) {
  // Samples that do not count for averages fill no column, so they are not measured.
  if (!schedule_.is_due(counts_for_average) || !counts_for_average || counts_.empty()) return;
  auto const domain = domain_of_centres(now);
  double const range = bin_width_ * static_cast<double>(counts_.size());
  auto const n = static_cast<double>(now.count());
  // In a box that has shrunk below the range, or without agents, g(r) is undefined.
  if (!domain || n < 2.0 || range > 0.5 * std::min(domain->width(), domain->height()) * (1.0 + 1e-12)) return;

  std::ranges::fill(counts_, 0);
  std::vector<double> orientations;
  if (has_orientation_) {
    orientations = count_with_orientation(now, range);
  } else {
    now.pairs(range, [&](NearPair const& pair) { counts_[bin_of(pair.separation)] += pair.own; });
  }
  now.counts(counts_);
  double const pairs = 0.5 * n * (n - 1.0);
  for (std::size_t b = 0; b < counts_.size(); ++b) {
    double const expected = pairs * (probability_of_nearer_points(*domain, static_cast<double>(b + 1) * bin_width_) -
                                     probability_of_nearer_points(*domain, static_cast<double>(b) * bin_width_));
    correlation_[b].add(0.5 * static_cast<double>(counts_[b]) / expected);
    // A bin without pairs has no g₆; a mean over pairs weights a sample by its pairs.
    if (!has_orientation_ || counts_[b] == 0) continue;
    auto const found = static_cast<double>(counts_[b]);
    orientation_[b].add(orientations[b] / found, found);
  }
}

std::vector<Distribution> PairCorrelation::distributions() const {
  if (correlation_.empty() || correlation_.front().samples() == 0) return {};
  std::vector<double> distance, value, error;
  for (std::size_t b = 0; b < correlation_.size(); ++b) {
    Estimate const estimate = *correlation_[b].estimate();
    distance.push_back((static_cast<double>(b) + 0.5) * bin_width_);
    value.push_back(estimate.value);
    error.push_back(estimate.error.value_or(no_value));
  }
  Distribution found{.name = "pair_correlation",
                     .columns = {{"distance", "length", "Middle of the bin."},
                                 {"pair_correlation", "", "g(r): pairs in the bin for each one of an ideal gas."},
                                 {"error", "", "One standard error of g, from blocks of samples."}},
                     .columns_of_values = {std::move(distance), std::move(value), std::move(error)}};
  if (has_orientation_) {
    std::vector<double> order, order_error;
    for (BlockAverage const& average : orientation_) {
      std::optional<Estimate> const estimate = average.estimate();
      order.push_back(estimate ? estimate->value : no_value);
      order_error.push_back(estimate ? estimate->error.value_or(no_value) : no_value);
    }
    found.columns.push_back({"orientation_correlation", "", "g₆(r): mean of ψ6* ψ6 over the pairs in the bin."});
    found.columns.push_back({"orientation_correlation_error", "", "One standard error of g₆, from blocks of samples."});
    found.columns_of_values.push_back(std::move(order));
    found.columns_of_values.push_back(std::move(order_error));
  }
  return {std::move(found)};
}

void PairCorrelation::serialize(Archive& archive) {
  schedule_.serialize(archive);
  gridlock::serialize(archive, "correlation", correlation_);
  if (has_orientation_) gridlock::serialize(archive, "orientation", orientation_);
}

}  // namespace gridlock
