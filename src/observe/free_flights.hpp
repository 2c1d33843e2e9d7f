#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "gridlock/core/disks.hpp"
#include "gridlock/observe/observable.hpp"

namespace gridlock {

/// The free flights of disks between their collisions: how long they last, and how far they go.
///
///     mean_free_path = Σ |v| τ / flights          length, over all flights that end between two samples
///
/// In equilibrium it is ⟨|v|⟩/Γ, with the collision rate Γ; for equal disks 1/(2√2 ρ σ g(σ)). The distributions
/// "free_time_distribution" and "free_path_distribution" are histograms of τ and |v| τ over all flights that ended in
/// samples that count, in bins of an eighth of each power of two, per unit of time or length. Fast disks collide more
/// often, so that neither is exponential: at low density with the rate r(v) of disks of speed v it is
/// p(τ) = ⟨r² exp(−rτ)⟩/⟨r⟩. Flights before the first collision of a disk have no known start and are not counted;
/// walls reflect a flight and do not end it.
///
/// Contract: between collisions of two disks the speed of a disk stays. Errors: Error for fixed disks; of a bin, one
/// standard error as if flights were independent.
/// Cost: about 50 ns a collision. Memory: 8 bytes a disk.
/// Source: S. Chapman & T. G. Cowling, The Mathematical Theory of Non-uniform Gases (1970), chapter 5; P. Visco, F. van
/// Wijland, E. Trizac (2008), doi:10.1103/PhysRevE.77.041117, for the distributions.
class FreeFlights final : public AveragingObservable {
 public:
  [[nodiscard]] Requirements requirements(Box const& /*box*/) const override {
    return {.columns = {Mass::name}, .collisions = true, .reports = true};
  }
  void begin(Snapshot const& start) override;
  void collided(PairCollision const& collision) override;
  void sample(Snapshot const& now, std::span<double> row, bool counts_for_average) override;
  [[nodiscard]] std::vector<Distribution> distributions() const override;
  void serialize(Archive& archive) override;

 private:
  /// Counts of positive numbers in bins of an eighth of each power of two: a bin holds those with the same exponent and
  /// the same first three binary digits of the mantissa.
  struct Histogram {
    std::uint64_t first = 0;
    std::vector<std::uint64_t> counts;

    void add(double value);
    [[nodiscard]] double lower_edge(std::size_t bin) const;
  };
  void end_flight(std::size_t disk, double time, Vector velocity);
  [[nodiscard]] static Distribution distribution_of(Histogram const& histogram, std::string const& quantity,
                                                    std::string const& unit);

  std::vector<double> last_;  ///< time of the last collision of each disk that moves; NaN before its first
  double paths_ = 0.0;        ///< sum of the paths since the last sample
  std::uint64_t flights_ = 0;
  Histogram times_, lengths_;
};

}  // namespace gridlock
