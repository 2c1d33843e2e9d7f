#pragma once

#include <cstdint>

#include "gridlock/observe/observable.hpp"
#include "observe/structure_schedule.hpp"

namespace gridlock {

/// The defects of a triangular crystal along a run, as shares of all agents, from find_defects():
///
///     defect_fraction              agents whose Voronoi cell has not six sides
///     disclination_fraction        of these, those that are alone, with five or seven sides
///     dislocation_fraction         … in pairs of a five and a seven
///     dislocation_pair_fraction    … in clusters of the charges +2 and −2, such as vacancies and interstitials
///     other_defect_fraction        … in all other clusters
///
/// All pure numbers; the first is the sum of the others. Fixed agents count, for they are part of the structure.
/// Measured in every `every`-th sample (StructureSchedule), in a periodic box. Points are put in the order of their
/// coordinates before, so that the result depends neither on the order of the rows nor on the number of processes.
/// Errors: Error for a box with walls, whose cells at the walls are no defects but have fewer sides.
/// Cost: 1.5 µs an agent, in each process of a run. Memory: 150 bytes an agent.
/// Source: D. R. Nelson & B. I. Halperin (1979), doi:10.1103/PhysRevB.19.2457.
class DefectFractions final : public AveragingObservable {
 public:
  explicit DefectFractions(std::uint64_t every) : schedule_(every) {}

  [[nodiscard]] Requirements requirements(Box const& /*box*/) const override { return {.columns = {X::name, Y::name}}; }
  void begin(Snapshot const& start) override;
  void sample(Snapshot const& now, std::span<double> row, bool counts_for_average) override;
  void serialize(Archive& archive) override;

 private:
  StructureSchedule schedule_;
};

}  // namespace gridlock
