#pragma once

#include <cstdint>
#include <vector>

#include "engine/swap/trials.hpp"
#include "gridlock/core/archive.hpp"
#include "gridlock/engine/swap_monte_carlo.hpp"

namespace gridlock {

/// The changes of the area at constant pressure, one after each sweep, and the packing fractions that they lead to.
class AreaChanges {
 public:
  /// Contract: the settings have a pressure.
  AreaChanges(SwapSettings const& settings, std::uint64_t adjusting_sweeps, State const& state);

  /// Tries to change the area once. `sweep` is the number of sweeps of this run before, `number` selects the random
  /// numbers. Returns the factor of the radii, 1 where the area stays.
  double take(SwapTrials& trials, std::uint64_t sweep, std::uint64_t number, SwapCounts& counts);

  [[nodiscard]] std::vector<SwapDensity> densities() const;
  /// Returns βP/ρ at a packing fraction.
  [[nodiscard]] double reduced_pressure(double packing_fraction) const;

  void serialize(Archive& archive, std::uint64_t sweeps_done);

 private:
  void adjust();
  void note(std::uint64_t sweeps_done);

  std::uint64_t seed_;
  std::uint64_t adjusting_sweeps_;
  std::uint64_t stretch_;               ///< sweeps over which one mean packing fraction is taken
  double pressure_;                     ///< βP D̄²
  double disks_;                        ///< N
  double packing_fraction_times_area_;  ///< φ v, a constant of the mixture
  double area_;                         ///< v = A/D̄²
  double largest_ = 0.01;               ///< largest |η| of a trial, which changes v by the factor (1 + η)/(1 − η)
  std::uint64_t adjusting_trials_ = 0;  ///< trials since the last adjustment
  std::uint64_t adjusting_accepted_ = 0;
  double sum_ = 0.0;  ///< sum of the packing fractions in the present stretch
  std::vector<double> packing_fractions_;
};

}  // namespace gridlock
