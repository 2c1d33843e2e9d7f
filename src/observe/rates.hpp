#pragma once

#include "gridlock/core/disks.hpp"
#include "gridlock/observe/observable.hpp"

namespace gridlock {

/// Rates of pair collisions and wall hits, from differences of the counters between samples.
///
/// collision_rate  Γ = 2 C / (N t)         per disk and time: each of the C pair collisions counts for both disks
///     mean_free_time    = 1/Γ                 time
///     wall_hit_rate     = H / (N t)           per disk and time; walled boxes only
///     halted_fraction   = B / T               fraction of the T moves that ended at a wall or at another disk
///
/// Averages are ratios of sums: all collisions over all time that counts. Undefined are the mean free time without
/// collisions and the halted fraction without moves. Collisions are those that the engine carried out; under the
/// paper's rule with contact = "always" they include pairs that move apart.
/// An engine that moves disks from event to event halts none: its column halted_fraction is empty.
/// Cost: O(1).
/// Source: S. Chapman & T. G. Cowling, The Mathematical Theory of Non-uniform Gases (1970), chapter 5: in equilibrium
/// Γ = 2 σ ρ g(σ) √(πkT/m) for equal disks of diameter σ and density ρ.
class Rates final : public AveragingObservable {
 public:
  /// `has_turns` tells whether disks take turns that can be halted; without turns there is no halted_fraction.
  explicit Rates(bool has_turns = true) : has_turns_(has_turns) {}

  [[nodiscard]] Requirements requirements(Box const& /*box*/) const override {
    return {.columns = {}, .collisions = true};
  }
  void begin(Snapshot const& start) override;
  void sample(Snapshot const& now, std::span<double> row, bool counts_for_average) override;
  [[nodiscard]] std::vector<NamedEstimate> results() const override;
  void serialize(Archive& archive) override;

 private:
  Counters last_;
  double last_time_ = 0.0;
  bool has_turns_ = true;
  bool has_walls_ = false;
};

}  // namespace gridlock
