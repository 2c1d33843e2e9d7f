#pragma once

#include <cstdint>
#include <vector>

#include "gridlock/core/disks.hpp"
#include "gridlock/observe/observable.hpp"

namespace gridlock {

/// The speeds of disks, compared with Maxwell's distribution of thermal equilibrium.
///
///     mean_speed         = (1/N) Σ_i |v_i|                                          length / time
///     speed_moment_ratio = N Σ_i (m_i v_i²)² / (Σ_i m_i v_i²)²                      pure number
///
/// For equal masses the ratio is ⟨v⁴⟩/⟨v²⟩²: 1 if all speeds are equal, 4/3 for velocities uniform in a disk, 2 for
/// Maxwell's distribution in two dimensions (2N/(N+1) for N disks of fixed total energy between walls). In terms of
/// energies it is 2 in equilibrium for mixtures too. The mean speed of equal masses in equilibrium is √(πkT/2m). At
/// rest the ratio is undefined.
///
/// The distribution "speed_distribution" is the histogram of |v| over all samples that count, per unit of speed and
/// normalised by all disks, with errors from blocks. Beside it stands Maxwell's curve, averaged over the same bins at
/// the measured temperature:
///
///     f(v) = (1/N) Σ_i (m_i v / kT) exp(−m_i v² / 2kT)
///
/// with m_i to 16 binary digits where more than 65,536 masses differ.
/// Cost: one pass over the disks, one square root each.
/// Source: J. C. Maxwell (1860), doi:10.1080/14786446008642818, here for two dimensions.
class Speed final : public AveragingObservable {
 public:
  Speed(double range, std::uint64_t bins) : range_(range), bins_(bins) {}

  [[nodiscard]] Requirements requirements(Box const& /*box*/) const override {
    return {.columns = {VelocityX::name, VelocityY::name, Mass::name}};
  }
  void begin(Snapshot const& start) override;
  void sample(Snapshot const& now, std::span<double> row, bool counts_for_average) override;
  [[nodiscard]] std::vector<Distribution> distributions() const override;
  void serialize(Archive& archive) override;

 private:
  struct MassShare {
    double mass;
    double share;  ///< fraction of all disks
  };
  /// Returns the probability of a speed below v in Maxwell's distribution.
  [[nodiscard]] double maxwell_below(double v, double temperature) const;

  double range_;
  std::uint64_t bins_;
  double bin_width_ = 0.0;  ///< 0 where no disk moves at begin(), so there is no histogram
  std::vector<MassShare> masses_;
  std::vector<std::uint64_t> counts_;  ///< counts of the present sample
  std::vector<BlockAverage> shares_;   ///< fraction of all disks in each bin
  BlockAverage temperature_;
};

}  // namespace gridlock
