#pragma once

#include <cstdint>
#include <vector>

#include "gridlock/core/box.hpp"
#include "gridlock/core/disks.hpp"
#include "gridlock/observe/estimate.hpp"
#include "gridlock/observe/observable.hpp"
#include "observe/structure_schedule.hpp"

namespace gridlock {

/// Returns the probability that two independent uniform points of the box are nearer to each other than r.
///
///     periodic: π r² / A
///     walls:    ∫₀ʳ 2πs γ(s) ds / A² = (π A r² − (4/3)(W + H) r³ + r⁴/2) / A²
///
/// γ(r) = A − (2/π)(W + H) r + r²/π is the set covariance of the rectangle averaged over directions: the area of points
/// that are still inside after a shift by r.
/// Contract: r ≤ half the shorter side of a periodic box, r ≤ the shorter side between walls.
/// Source: S. N. Chiu, D. Stoyan, W. S. Kendall & J. Mecke, Stochastic Geometry and its Applications (2013).
double probability_of_nearer_points(Box const& box, double r);

/// The pair correlation function: the number of pairs at a distance near r divided by that of an ideal gas.
///
///     g(r) = pairs with distance in the bin / (½ N (N − 1) p(bin))
///
/// p is the exact probability of the distance for two independent points of the domain open to the centres: the
/// periodic box, or the walled box without a mean radius at each side. So g = 1 for an ideal gas at every N and r in
/// both kinds of box, without corrections for edges. For a mixture between walls the mean radius is right to relative
/// order (spread of the radii / side)². For agents without a radius lengths are in mean spacings √(A/N), and centres
/// reach the walls.
/// On request also the hexatic correlation of ψ6, the bond orientation of bond_orientation_order():
///
///     g₆(r) = mean of Re ψ6(i)* ψ6(j) over the pairs in the bin
///
/// a constant at large r in a crystal, a power of r in a hexatic, exp(−r/ξ₆) in a liquid. Products are added as whole
/// numbers, in units of N² · 2⁻⁵⁹, 2e-8 for 10⁵ agents.
/// The result is the distribution "pair_correlation": distance (centre of the bin, length), pair_correlation, error
/// (from blocks of samples), and on request orientation_correlation and its error. The range is `range` mean
/// diameters, but at most half the shorter side of the domain. There is no result for fewer than two agents, and where
/// walls leave no area to centres. Cost: O(N · agents within the range), about 0.5 µs an agent at 5 diameters; sampled
/// on the StructureSchedule; 0.3 µs more with g₆. Source: L. S. Ornstein & F. Zernike (1914); normalisation by set
/// covariance: J. Ohser (1983), Mathematische Operationsforschung und Statistik 14, 63; g₆: D. R. Nelson & B. I.
/// Halperin (1979), doi:10.1103/PhysRevB.19.2457.
class PairCorrelation final : public Observable {
 public:
  PairCorrelation(std::uint64_t every, double range, std::uint64_t bins, bool has_orientation = false)
      : schedule_(every), range_(range), bins_(bins), has_orientation_(has_orientation) {}

  [[nodiscard]] Requirements requirements(Box const& /*box*/) const override { return {.columns = {X::name, Y::name}}; }
  [[nodiscard]] std::vector<ColumnInfo> columns() const override { return {}; }
  void begin(Snapshot const& start) override;
  void sample(Snapshot const& now, std::span<double> row, bool counts_for_average) override;
  [[nodiscard]] std::vector<NamedEstimate> results() const override { return {}; }
  [[nodiscard]] std::vector<Distribution> distributions() const override;
  void serialize(Archive& archive) override;

 private:
  /// Counts all pairs in bins. Returns Σ Re ψ6* ψ6 over the pairs of each bin, each pair once for each of its agents.
  std::vector<double> count_with_orientation(Snapshot const& now, double range);

  [[nodiscard]] std::size_t bin_of(Vector separation) const;

  StructureSchedule schedule_;
  double range_;  ///< range in mean diameters
  std::uint64_t bins_;
  bool has_orientation_;               ///< whether g₆ is measured
  double bin_width_ = 0.0;             ///< 0 where g(r) is undefined
  std::vector<std::uint64_t> counts_;  ///< counts in each bin, two for a pair: one for each of its agents
  std::vector<BlockAverage> correlation_;
  std::vector<BlockAverage> orientation_;  ///< averages of g₆, a sample weighted by its pairs; empty unless measured
};

}  // namespace gridlock
