#pragma once

#include "gridlock/core/disks.hpp"
#include "gridlock/observe/observable.hpp"

namespace gridlock {

/// The pressure, from the impulses of pair collisions and wall hits between samples.
///
///     virial_pressure        = (N kT + W / 2t) / A                  mass / time² (force per length)
///     compressibility_factor = Z = 1 + W / (2 N kT t)               pure number
///     wall_pressure_left …   = I_left / (t H)                       mass / time²; walled boxes only
///     wall_pressure          = Σ_walls I / (2 t (W_box + H_box))    mean over the length of the four walls
///
/// W = Σ (r_i − r_j)·Δp_i is the virial of all pair collisions during t (σ m |v_n| for two equal disks in contact), I
/// the impulse on a wall, and kT the temperature() at the end of the interval, which dynamics that conserve energy do
/// not change. Z is undefined at rest, and all values that need kT for one disk in a periodic box.
///
/// Between walls the pair virial divided by the full area is less than the bulk pressure, by a layer at the walls. On a
/// long trajectory of equal disks in a square box of side L, wall_pressure · L (L − 2R) = K + W / 2t.
/// Averages are ratios of sums over all time that counts.
/// Cost: one pass over the disks for kT.
/// Source: M. Engel et al. (2013), doi:10.1103/PhysRevE.87.042134; J. J. Erpenbeck & W. W. Wood (1977), in Statistical
/// Mechanics B, ed. B. J. Berne.
class Pressure final : public AveragingObservable {
 public:
  [[nodiscard]] Requirements requirements(Box const& /*box*/) const override {
    return {.columns = {VelocityX::name, VelocityY::name, Mass::name}, .collisions = true};
  }
  void begin(Snapshot const& start) override;
  void sample(Snapshot const& now, std::span<double> row, bool counts_for_average) override;
  void serialize(Archive& archive) override;

 private:
  Counters last_;
  double last_time_ = 0.0;
  bool has_walls_ = false;
};

}  // namespace gridlock
