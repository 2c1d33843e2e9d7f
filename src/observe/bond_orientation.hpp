#pragma once

#include <complex>
#include <optional>
#include <vector>

#include "gridlock/core/disks.hpp"
#include "gridlock/core/vector.hpp"
#include "gridlock/observe/observable.hpp"
#include "observe/structure_schedule.hpp"

namespace gridlock {

class LocalPoints;

/// The sixfold order of a state, from 0 to 1.
struct BondOrientationOrder {
  double global_order = 0.0;
  double local_order = 0.0;
};

/// How well the directions to nearest neighbours agree with one triangular lattice.
///
///     ψ6(j)  = (1/n_j) Σ_k exp(6 i θ_jk)        over the n_j neighbours k of agent j, θ_jk the direction from j to k
///     global = |(1/N) Σ_j ψ6(j)|                1: one crystal;  0: liquid, or many grains
///     local  = (1/N) Σ_j |ψ6(j)|                1: every agent sits in a regular hexagon
///
/// Neighbours are nearer than 1.5 a, where a = √(2/(√3 ρ)) is the spacing of the triangular lattice of density ρ = N/A:
/// midway between its first shell (a) and its second (1.73 a). In a periodic box the cutoff is at most half the shorter
/// side, which matters below about 11 agents. An agent without neighbours has ψ6 = 0. Both orders are 0 for the square
/// lattice, whose eight neighbours cancel. Returns nothing for no agents. Cost: O(N), about 0.2 µs an agent.
/// Source: D. R. Nelson & B. I. Halperin (1979), doi:10.1103/PhysRevB.19.2457. Bonds are added as whole numbers, so
/// that ψ6 does not depend on their order: a component of exp(6 i θ) is rounded to at most N·2⁻⁶¹, 1e-12 for a million
/// agents.
/// Contract: the agents have x and y.
std::optional<BondOrientationOrder> bond_orientation_order(Snapshot const& now);
inline std::optional<BondOrientationOrder> bond_orientation_order(State const& state) {
  return bond_orientation_order(Snapshot(state, Counters()));
}

/// Returns the largest distance of two neighbours, 1.5 a or half the shorter side.
double neighbour_distance(Box const& box, std::size_t agents);

/// Returns ψ6 of each owned point; `all` is the number of points of all processes. Contract: the cutoff of the points
/// is neighbour_distance().
std::vector<std::complex<double>> bond_orientations_of(LocalPoints const& points, std::size_t all);

/// Returns |ψ6(j)| of each agent, in the order of the rows. Contract: the agents have x and y.
std::vector<double> local_bond_orientation_orders(Box const& box, AgentsView const& agents);
inline std::vector<double> local_bond_orientation_orders(State const& state) {
  return local_bond_orientation_orders(state.box, state.agents);
}

/// Samples of bond_orientation_order() along a run: the columns global_bond_orientation_order and
/// local_bond_orientation_order, averaged over the samples that StructureSchedule selects; other cells are empty.
class BondOrientation final : public AveragingObservable {
 public:
  explicit BondOrientation(std::uint64_t every) : schedule_(every) {}

  [[nodiscard]] Requirements requirements(Box const& /*box*/) const override { return {.columns = {X::name, Y::name}}; }
  void begin(Snapshot const& start) override;
  void sample(Snapshot const& now, std::span<double> row, bool counts_for_average) override;
  void serialize(Archive& archive) override;

 private:
  StructureSchedule schedule_;
};

}  // namespace gridlock
