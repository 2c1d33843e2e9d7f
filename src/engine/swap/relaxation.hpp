#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "engine/swap/trials.hpp"
#include "gridlock/core/archive.hpp"
#include "gridlock/engine/swap_monte_carlo.hpp"

namespace gridlock {

/// Number of relaxation times that a run needs to reach equilibrium.
inline constexpr double enough_relaxation_times = 10.0;

/// Relaxation times in sweeps, those that a run has not reached left out.
struct RelaxationTimes {
  std::optional<double> overlap;
  std::optional<double> bond;
  std::optional<double> in_run;  ///< sweeps of the run over the longer of the two
  bool is_enough = false;        ///< whether in_run ≥ 10
};

/// Time correlations of a run of Monte Carlo.
///
/// There are sixteen time origins, a sixteenth of the run apart. Between origins the disks are compared with the last
/// origin after 1, 2, 3, 4, 6, 8, 12 … sweeps, at an origin with all earlier origins. So a relaxation time of a tenth
/// of the run is averaged over many origins, at the cost of a few hundred comparisons for a run of any length. At most
/// 4096 disks are compared.
class Relaxation {
 public:
  Relaxation() = default;
  /// Prepares for a run of `sweeps` sweeps of these disks.
  Relaxation(State const& state, std::uint64_t sweeps);

  /// Returns whether look_at() compares anything after this sweep.
  [[nodiscard]] bool is_due(std::uint64_t sweep) const;
  /// Compares the disks with the time origins. Call it at the start of the run (sweep 0) and after every sweep that is
  /// due; after others it does nothing.
  void look_at(SwapTrials const& trials, std::uint64_t sweep);

  [[nodiscard]] std::vector<SwapCorrelation> correlations() const;
  /// Returns the times at which the correlations fall to 1/e, in a run of so many sweeps.
  [[nodiscard]] RelaxationTimes times(std::uint64_t sweeps) const;

  /// Serializes the state after `sweep` sweeps. Errors: Error where the archive is of another run or number of disks.
  void serialize(Archive& archive, std::size_t disks, std::uint64_t sweep);

 private:
  /// The state at a time origin.
  struct Origin {
    std::uint64_t sweep = 0;
    std::vector<std::uint32_t> first;  ///< neighbours of watched disk k: from first[k] to first[k + 1]
    std::vector<std::uint32_t> neighbours;
    std::vector<double> relative_x;  ///< x of each watched disk relative to the mean of its neighbours
    std::vector<double> relative_y;
    std::vector<double> order_x;  ///< real part of ψ6
    std::vector<double> order_y;
  };
  /// Sums for one lag over its origins.
  struct Sums {
    std::uint64_t lag = 0;
    std::uint64_t origins = 0;
    double near = 0.0;
    double bond = 0.0;
    double bond_at_origin = 0.0;
  };

  [[nodiscard]] std::size_t watched() const { return (disks_ + stride_ - 1) / stride_; }
  [[nodiscard]] Origin look(SwapTrials const& trials, std::uint64_t sweep) const;
  void compare(Origin const& origin, Origin const& now, SwapTrials const& trials);
  static void serialize(Archive& archive, Origin& origin);
  void require_restored(Archive const& archive, std::uint64_t sweep) const;

  std::size_t disks_ = 0;
  std::size_t stride_ = 1;  ///< every stride_-th disk is watched
  double neighbour_distance_ = 0.0;
  double squared_cage_ = 0.0;
  std::uint64_t spacing_ = 1;  ///< sweeps from one origin to the next
  std::vector<Origin> origins_;
  std::vector<Sums> sums_;  ///< sums in the order of lags
};

/// Returns the lag at which a correlation that is 1 at lag 0 falls to 1/e, interpolated linearly, if it does.
std::optional<double> relaxation_time(std::vector<SwapCorrelation> const& correlations,
                                      double SwapCorrelation::*quantity);

}  // namespace gridlock
