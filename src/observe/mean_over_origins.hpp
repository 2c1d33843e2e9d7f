#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "gridlock/core/archive.hpp"
#include "gridlock/observe/estimate.hpp"

namespace gridlock {

/// Returns the lags of a curve, in samples: each up to 16, then each a tenth larger than the one before, up to max_lag.
/// One third of max_lag is among them, rounded, and at least 1.
std::vector<std::uint64_t> lags_of_curve(std::uint64_t max_lag);

/// Returns the first lag of the window of a slope: a third of the longest.
std::uint64_t early_lag_of(std::uint64_t max_lag);

/// A mean over time origins that come one after the other, with an error from groups of neighbouring origins. There is
/// none with fewer than two whole groups. The error is right if a group spans about twice the time that an origin
/// looks at, or more.
struct MeanOverOrigins {
  BlockAverage groups;
  Block pending;  ///< the group that is not complete

  void add(double value, std::uint64_t origins_of_group);
  [[nodiscard]] std::optional<Estimate> estimate() const;
  [[nodiscard]] double origins(std::uint64_t origins_of_group) const;
};
/// Serializes means; it restores into the same number of means.
void serialize(Archive& archive, std::string_view name, std::span<MeanOverOrigins> means);

}  // namespace gridlock
