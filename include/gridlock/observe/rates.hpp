#pragma once

#include "gridlock/observe/averaging_observable.hpp"

namespace gridlock {

/// How often disks meet each other and the walls, from differences of the tally between samples.
///
///     collision_rate  Γ = 2 C / (N t)         per disk and time: each of the C pair collisions is one for both partners
///     mean_free_time    = 1/Γ                 time
///     wall_hit_rate     = H / (N t)           per disk and time; walled boxes only
///     blocked_share     = B / T               share of the T turns that ended at a wall or at another disk
///
/// Averages are ratios of sums: all collisions over all time that counts. A mean free time without collisions and a
/// share of no turns are left out. Collisions are the scatterings the engine did; under the paper's rule with
/// contact = "always" that includes pairs that recede.
/// An engine that moves disks from event to event halts none: it has no blocked_share, and the column stays empty.
/// Cost: O(1).
/// Source: S. Chapman & T. G. Cowling, The Mathematical Theory of Non-uniform Gases (1970), chapter 5: in equilibrium
/// Γ = 2 σ ρ g(σ) √(πkT/m) for equal disks of diameter σ and density ρ.
class Rates final : public AveragingObservable {
 public:
  /// `has_turns`: whether disks take turns that can end halted; without, there is no blocked_share.
  explicit Rates(bool has_turns = true) : has_turns_(has_turns) {}

  void begin(Moment const& start) override;
  void sample(Moment const& now, std::span<double> row, bool counts_for_average) override;
  [[nodiscard]] std::vector<NamedEstimate> results() const override;
  void carry(Archive& archive) override;

 private:
  Tally last_;
  double last_time_ = 0.0;
  bool has_turns_ = true;
  bool has_walls_ = false;
};

}  // namespace gridlock
