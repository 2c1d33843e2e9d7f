#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "gridlock/core/disks.hpp"
#include "gridlock/core/vector.hpp"
#include "gridlock/observe/detail/id_index.hpp"
#include "gridlock/observe/estimate.hpp"
#include "gridlock/observe/observable.hpp"
#include "observe/id_blocks.hpp"

namespace gridlock {

/// The velocity autocorrelation: how much of the velocities is left after a time t.
///
///     velocity_autocorrelation(t) = Σ_i v_i(t₀)·v_i(t₀ + t) / Σ_i v_i(t₀)²          pure number, 1 at t = 0
///
/// The first origin t₀ is the first sample that counts for averages. With origin_every = n every n-th sample after it
/// is an origin too: the series has the correlation with the last origin, and the distribution
/// "velocity_autocorrelation", n values of t, is the mean over origins with errors from blocks of origins. With
/// origin_every = 0 there is one origin: the curve has the noise of N agents, and errors from 16 blocks of agents with
/// neighbouring Ids. The points of the curve are those of the samples, so choose observe.every well below the mean free
/// time. Undefined at rest. Only agents alive since t₀ are counted.
/// Cost: one pass over the agents. Memory: 24 bytes an agent, and 24 a sample, or 550 for each of n points.
/// Source: B. J. Alder & T. E. Wainwright (1970), doi:10.1103/PhysRevA.1.18.
class VelocityAutocorrelation final : public Observable {
 public:
  static constexpr std::size_t agent_blocks = IdBlocks::count;

  explicit VelocityAutocorrelation(std::uint64_t origin_every = 0) : origin_every_(origin_every) {}

  [[nodiscard]] Requirements requirements(Box const& /*box*/) const override {
    return {.columns = {VelocityX::name, VelocityY::name}};
  }
  [[nodiscard]] std::vector<ColumnInfo> columns() const override;
  void begin(Snapshot const& start) override;
  void sample(Snapshot const& now, std::span<double> row, bool counts_for_average) override;
  [[nodiscard]] std::vector<NamedEstimate> results() const override { return {}; }
  [[nodiscard]] std::vector<Distribution> distributions() const override;
  void serialize(Archive& archive) override;

 private:
  void set_origin(Snapshot const& now);

  struct Point {
    double lag;
    Estimate correlation;  ///< correlation with the first origin
  };
  [[nodiscard]] Estimate correlation_at(std::size_t place) const;

  std::uint64_t origin_every_;
  bool has_origin_ = false;
  std::uint64_t samples_since_origin_ = 0;
  double origin_time_ = 0.0;
  Attached<Vector> velocities_;     ///< velocity of each agent at the origin
  std::optional<IdBlocks> blocks_;  ///< blocks of the agents at the origin; absent right after restoring
  std::vector<Point> curve_;
  std::vector<BlockAverage> over_origins_;  ///< mean of each point of the curve, if there are several origins
};

}  // namespace gridlock
