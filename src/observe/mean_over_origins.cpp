#include "observe/mean_over_origins.hpp"

#include <algorithm>
#include <cstddef>

namespace gridlock {

std::uint64_t early_lag_of(std::uint64_t max_lag) { return std::max<std::uint64_t>(1, (max_lag + 1) / 3); }

std::vector<std::uint64_t> lags_of_curve(std::uint64_t max_lag) {
  std::vector<std::uint64_t> lags{early_lag_of(max_lag), max_lag};
  for (std::uint64_t lag = 1; lag < max_lag; lag = lag < 16 ? lag + 1 : lag + lag / 10) lags.push_back(lag);
  std::ranges::sort(lags);
  lags.erase(std::unique(lags.begin(), lags.end()), lags.end());
  return lags;
}

void MeanOverOrigins::add(double value, std::uint64_t origins_of_group) {
  pending.add({.sum = value, .weight = 1.0});
  if (pending.weight < static_cast<double>(origins_of_group)) return;
  groups.add(pending.sum / pending.weight, pending.weight);
  pending = {};
}

std::optional<Estimate> MeanOverOrigins::estimate() const {
  BlockAverage all = groups;
  if (pending.weight > 0.0) all.add(pending.sum / pending.weight, pending.weight);
  std::optional<Estimate> estimate = all.estimate();
  // A group that is not complete is no second one to compare the first with.
  if (estimate && groups.samples() < 2) estimate->error.reset();
  return estimate;
}

double MeanOverOrigins::origins(std::uint64_t origins_of_group) const {
  return static_cast<double>(groups.samples() * origins_of_group) + pending.weight;
}

void serialize(Archive& archive, std::string_view name, std::span<MeanOverOrigins> means) {
  std::vector<BlockAverage> groups;
  std::vector<Block> pending;
  for (MeanOverOrigins const& mean : means) groups.push_back(mean.groups), pending.push_back(mean.pending);
  serialize_inside(archive, name, [&] {
    serialize(archive, "groups", groups);
    serialize(archive, "pending", pending);
  });
  for (std::size_t k = 0; k < means.size(); ++k) means[k] = {.groups = groups[k], .pending = pending[k]};
}

}  // namespace gridlock
