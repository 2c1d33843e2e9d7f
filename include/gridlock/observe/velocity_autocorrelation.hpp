#pragma once

#include <optional>
#include <vector>

#include "gridlock/core/vector.hpp"
#include "gridlock/observe/observable.hpp"
#include "gridlock/observe/rows_by_id.hpp"

namespace gridlock {

/// How much of their velocity the disks remember since the first sample that counts for averages.
///
///     velocity_autocorrelation(t) = Σ_i v_i(t₀)·v_i(t₀ + t) / Σ_i v_i(t₀)²          pure number, 1 at t = 0
///
/// One origin t₀ only: the curve has the noise of N disks, not of a long average. The distribution
/// "velocity_autocorrelation" lists it against t with errors from 16 blocks of disks with neighbouring Ids. The spacing
/// of the curve is that of the samples, so choose observe.every well below the mean free time. Undefined at rest. Only
/// disks alive since t₀ enter.
/// Cost: one pass over the disks. Memory: 24 bytes a disk and 24 a sample.
/// Source: B. J. Alder & T. E. Wainwright (1970), doi:10.1103/PhysRevA.1.18.
class VelocityAutocorrelation final : public Observable {
 public:
  static constexpr std::size_t disk_blocks = 16;

  [[nodiscard]] std::vector<ColumnInfo> columns() const override;
  void begin(Moment const& start) override;
  void sample(Moment const& now, std::span<double> row, bool counts_for_average) override;
  [[nodiscard]] std::vector<NamedEstimate> results() const override { return {}; }
  [[nodiscard]] std::vector<Distribution> distributions() const override;
  void carry(Archive& archive) override;

 private:
  void set_origin(State const& state);

  struct Point {
    double lag;
    Estimate correlation;
  };

  bool has_origin_ = false;
  double origin_time_ = 0.0;
  RowsById rows_;
  std::vector<Vector> velocities_;  ///< at the origin, in Id order
  std::vector<Point> curve_;
};

}  // namespace gridlock
