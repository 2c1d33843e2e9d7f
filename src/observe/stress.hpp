#pragma once

#include <vector>

#include "core/pair_law.hpp"
#include "gridlock/observe/observable.hpp"

namespace gridlock {

/// Returns the columns stress_xx, stress_xy and stress_yy.
std::vector<ColumnInfo> stress_columns();

/// The energy and the stress of soft disks, from their places and velocities at a sample.
///
///     potential_energy = Σ_pairs V(r)                                      energy
///     total_energy     = potential_energy + ½ Σ_i m_i v_i²                 energy; disks with inertia only
///     stress_ab        = −(Σ_i m_i v_a v_b + Σ_pairs f_a r_b) / A          energy / area
///     pressure         = −(stress_xx + stress_yy) / 2                      energy / area
///     effective_swim_speed = 1 + ⟨F·n / (m γ)⟩ / v₀                        of self-propelled disks
///
/// f is the force on a disk, with the drag of pairs, and r the vector to it from its partner: repulsion makes the
/// pressure positive, and tension the stress. Disks without inertia have kT for m v_a² and 0 for m v_x v_y. In the swim
/// speed n is the heading of a disk and F the force of the others on it.
/// Cost: a search for all pairs nearer than the cutoff.
/// Source: D. Frenkel & B. Smit, Understanding Molecular Simulation (2002), chapter 4; for the swim speed
/// J. Stenhammar, D. Marenduzzo, R. J. Allen, M. E. Cates, Soft Matter 10, 1489 (2014), doi:10.1039/C3SM52813H.
class Stress final : public AveragingObservable {
 public:
  /// Contract: the traits have a potential.
  explicit Stress(DynamicsTraits const& dynamics);

  [[nodiscard]] Requirements requirements(Box const& /*box*/) const override {
    return {.columns = {X::name, Y::name, Radius::name, Mass::name, VelocityX::name, VelocityY::name}};
  }
  void begin(Snapshot const& start) override;
  void sample(Snapshot const& now, std::span<double> row, bool counts_for_average) override;

 private:
  struct PairSums {
    double energy;
    double stress_xx;
    double stress_xy;
    double stress_yy;
    double power;  ///< Σ F·v/m
  };
  [[nodiscard]] PairSums sum_over_pairs(Snapshot const& now) const;
  [[nodiscard]] bool has_inertia() const { return dynamics_.thermostat.kind != ThermostatKind::overdamped; }

  DynamicsTraits dynamics_;
  PairLaw law_;
};

}  // namespace gridlock
