#pragma once

#include "gridlock/core/disks.hpp"
#include "gridlock/observe/observable.hpp"

namespace gridlock {

/// The energy, which elastic dynamics conserves.
///
///     kinetic_energy       = ½ Σ_i m_i v_i²                            mass · length² / time²
///     kinetic_energy_drift = (K(t) − K(begin)) / K(begin)              pure number
///
/// kinetic_energy is averaged over samples; where the dynamics conserves it, its error is rounding. The result of the
/// drift is its last sample; as a fact of one trajectory it has no standard error. It is undefined for disks at rest at
/// begin().
/// Cost: one pass over the disks.
/// Source: D. Frenkel & B. Smit, Understanding Molecular Simulation (2002), chapter 4, recommends to check the drift
/// first.
class Energy final : public AveragingObservable {
 public:
  [[nodiscard]] Requirements requirements(Box const& /*box*/) const override {
    return {.columns = {VelocityX::name, VelocityY::name, Mass::name}};
  }
  void begin(Snapshot const& start) override;
  void sample(Snapshot const& now, std::span<double> row, bool counts_for_average) override;
  [[nodiscard]] std::vector<NamedEstimate> results() const override;
  void serialize(Archive& archive) override;

 private:
  [[nodiscard]] bool has_drift() const { return start_ > 0.0; }
  [[nodiscard]] double drift() const { return (last_ - start_) / start_; }

  double start_ = 0.0;
  double last_ = 0.0;
};

}  // namespace gridlock
