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

/// The time correlations of a run of swap Monte Carlo.
///
/// Time origins are sixteen, a sixteenth of the run apart. Between two of them the disks are compared with the last
/// origin after 1, 2, 3, 4, 6, 8, 12 … sweeps, at an origin with all earlier ones. So a relaxation time that fits ten
/// times into the run comes from many origins, and measuring takes a few hundred looks, however long the run. Of many
/// disks 4096 are watched.
class Relaxation {
 public:
  Relaxation() = default;
  /// For a run of so many sweeps of these disks.
  Relaxation(State const& state, std::uint64_t sweeps);

  /// Called at the start of the run, sweep 0, and after every sweep.
  void look_at(SwapTrials const& trials, std::uint64_t sweep);

  [[nodiscard]] std::vector<SwapCorrelation> correlations() const;

  /// After so many sweeps. Errors: Error where what is restored is not of such a run of so many disks.
  void serialize(Archive& archive, std::size_t disks, std::uint64_t sweep);

 private:
  /// The state that is remembered of one time.
  struct Origin {
    std::uint64_t sweep = 0;
    std::vector<std::uint32_t> first;  ///< neighbours of watched disk k: from first[k] to first[k + 1]
    std::vector<std::uint32_t> neighbours;
    std::vector<double> relative_x;  ///< of a watched disk to the mean of its neighbours
    std::vector<double> relative_y;
    std::vector<double> order_x;  ///< ψ6
    std::vector<double> order_y;
  };
  /// Sums over the origins that a lag has.
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
  [[nodiscard]] bool is_short_lag(std::uint64_t lag) const;
  static void serialize(Archive& archive, Origin& origin);
  void require_restored(Archive const& archive, std::uint64_t sweep) const;

  std::size_t disks_ = 0;
  std::size_t stride_ = 1;  ///< every disk whose number it divides is watched
  double neighbour_distance_ = 0.0;
  double squared_cage_ = 0.0;
  std::uint64_t spacing_ = 1;  ///< of the origins, in sweeps
  std::vector<Origin> origins_;
  std::vector<Sums> sums_;  ///< in the order of their lags
};

/// Where a correlation that is 1 at lag 0 falls to 1/e, between two lags by a straight line; nothing where it does not.
std::optional<double> relaxation_time(std::vector<SwapCorrelation> const& correlations,
                                      double SwapCorrelation::*quantity);

}  // namespace gridlock
