#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "gridlock/core/disks.hpp"
#include "gridlock/observe/observable.hpp"

namespace gridlock {

/// The temperature of the motion along x and along y, of all mobile agents and of each kind.
///
///     between walls:  kT_x = Σ m v_x² / N
///     periodic:       kT_x = Σ m (v_x − V_x)² / (N − M/M_all)    V: velocity of the centre of mass of all agents
///
/// The sums are over all mobile agents, M = M_all, or over those of a kind, with N agents of mass M together. All are
/// equal on average in thermal equilibrium; the mean of the two directions is the temperature of the pressures.
/// Kinds are the different pairs of radius and mass at the start, in ascending order of the radius, then of the mass;
/// there are columns of kinds if there are at least 2 and at most `max_kinds` of them. Disks of infinite mass are
/// fixed, and not counted; where there are any, momentum is not conserved, and the first formula holds. Undefined for
/// one agent alone in a periodic box.
/// Cost: one pass over the agents, about 20 ns each. Memory: 4 bytes an agent if there are several kinds.
/// Source: D. Frenkel & B. Smit, Understanding Molecular Simulation (2002), chapter 4.
class TemperatureByKind final : public AveragingObservable {
 public:
  static constexpr std::size_t max_kinds = 8;

  [[nodiscard]] Requirements requirements(Box const& /*box*/) const override {
    return {.columns = {VelocityX::name, VelocityY::name, Mass::name}};
  }
  void begin(Snapshot const& start) override;
  void sample(Snapshot const& now, std::span<double> row, bool counts_for_average) override;

 private:
  bool has_fixed_ = false;           ///< whether there are fixed disks at the start
  std::size_t kinds_ = 0;            ///< 0 where there is one, or too many
  Attached<std::uint32_t> kind_of_;  ///< place of each agent's kind
};

}  // namespace gridlock
