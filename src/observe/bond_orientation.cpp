#include "observe/bond_orientation.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstdint>
#include <numbers>
#include <vector>

#include "grid/pairs.hpp"

namespace gridlock {

namespace {

double neighbour_distance(Box const& box, std::size_t agents) {
  double const density = static_cast<double>(agents) / box.area();
  double const cutoff = 1.5 * std::sqrt(2.0 / (std::numbers::sqrt3 * density));
  if (!box.is_periodic()) return cutoff;
  return std::min(cutoff, 0.5 * std::min(box.width(), box.height()));
}

/// ψ6 of each agent: the mean of exp(6 i θ_jk) over its neighbours k.
std::vector<std::complex<double>> bond_orientations(Box const& box, AgentsView const& agents) {
  double const cutoff = neighbour_distance(box, agents.size());
  PointsInBox const points{box, agents.column<X>(), agents.column<Y>()};
  PackedGrid const grid(layout_for_cutoff(box, cutoff, agents.size()), points.x, points.y);
  std::vector<std::complex<double>> sums(agents.size());
  std::vector<std::uint32_t> counts(agents.size());
  for_each_pair(points, grid, cutoff, [&](std::size_t i, std::size_t j, Vector separation) {
    if (!(squared_length(separation) > 0.0)) return;
    // Six is even: the direction back gives the same number.
    std::complex<double> const bond = sixth_power_of_direction(separation);
    sums[i] += bond;
    sums[j] += bond;
    ++counts[i];
    ++counts[j];
  });
  for (std::size_t i = 0; i < sums.size(); ++i) {
    if (counts[i] > 0) sums[i] /= static_cast<double>(counts[i]);
  }
  return sums;
}

}  // namespace

std::optional<BondOrientationOrder> bond_orientation_order(Box const& box, AgentsView const& agents) {
  if (agents.empty()) return std::nullopt;
  std::complex<double> global;
  double local = 0.0;
  for (std::complex<double> const order : bond_orientations(box, agents)) {
    global += order;
    local += std::abs(order);
  }
  auto const count = static_cast<double>(agents.size());
  return BondOrientationOrder{.global_order = std::abs(global) / count, .local_order = local / count};
}

std::vector<double> local_bond_orientation_orders(Box const& box, AgentsView const& agents) {
  std::vector<double> values;
  if (agents.empty()) return values;
  for (std::complex<double> const order : bond_orientations(box, agents)) values.push_back(std::abs(order));
  return values;
}

void BondOrientation::begin(Snapshot const&) {
  reset({{"global_bond_orientation_order", "", "|⟨ψ6⟩|, the sixfold order of the whole system."},
         {"local_bond_orientation_order", "", "⟨|ψ6|⟩, the sixfold order around each agent."}});
  schedule_.reset();
}

void BondOrientation::sample(Snapshot const& now, std::span<double> row, bool counts_for_average) {
  std::ranges::fill(row, no_value);
  if (!schedule_.is_due(counts_for_average)) return;
  auto const order = bond_orientation_order(now.box, now.agents);
  if (!order) return;
  row[0] = order->global_order;
  row[1] = order->local_order;
  if (!counts_for_average) return;
  average(0, order->global_order);
  average(1, order->local_order);
}

void BondOrientation::serialize(Archive& archive) {
  AveragingObservable::serialize(archive);
  schedule_.serialize(archive);
}

}  // namespace gridlock
