#pragma once

#include <cstdint>
#include <vector>

#include "gridlock/core/disks.hpp"
#include "gridlock/observe/observable.hpp"
#include "observe/list_average.hpp"
#include "observe/structure_schedule.hpp"

namespace gridlock {

/// How many mobile agents are in each cell of a grid that divides the box: whether the density is the same everywhere.
///
///     local_density_mean           = ⟨n⟩ = N / cells                  agents in a cell
///     local_density_variance_ratio = (⟨n²⟩ − ⟨n⟩²) / ⟨n⟩              pure number
///
/// The averages are over the cells of one sample. The ratio is 1 − 1/cells for an ideal gas, S(0) < 1 for large cells
/// of a fluid, and above 2.5 where dense and dilute regions larger than a cell exist side by side. The cells are as
/// nearly squares of the given side as fit into the box a whole number of times, by default of 6.4 mean diameters; for
/// agents without a radius the side is in mean spacings √(A/N). At walls, cells have a border of one radius without
/// centres.
/// The distribution "local_density": number of agents in a cell, the share of cells that hold so many, its error from
/// blocks of samples, and that number times the mean area of a disk over the area of a cell. Two peaks of it are two
/// phases. Disks of infinite mass are fixed, and not counted. Measured in every `every`-th sample (StructureSchedule).
/// Cost: one pass over the agents, 2 ns each. Memory: 8 bytes a cell.
/// Source: variance and peaks as criteria of phase separation: J. Stenhammar, D. Marenduzzo, R. J. Allen & M. E. Cates
/// (2014), doi:10.1039/C3SM52813H.
class LocalDensity final : public AveragingObservable {
 public:
  static constexpr std::uint64_t max_cells = 10'000'000;

  LocalDensity(std::uint64_t every, double side) : schedule_(every), side_(side) {}

  [[nodiscard]] Requirements requirements(Box const& /*box*/) const override { return {.columns = {X::name, Y::name}}; }
  /// Errors: Error for more cells than max_cells.
  void begin(Snapshot const& start) override;
  void sample(Snapshot const& now, std::span<double> row, bool counts_for_average) override;
  [[nodiscard]] std::vector<Distribution> distributions() const override;
  void serialize(Archive& archive) override;

 private:
  StructureSchedule schedule_;
  double side_;  ///< side of a cell, in mean diameters
  std::uint64_t columns_ = 1;
  std::uint64_t rows_ = 1;
  double share_of_disk_ = 0.0;  ///< mean area of a disk over the area of a cell; 0 for agents without a radius
  ListAverage shares_;          ///< share of the cells with 0, 1, 2 … agents
};

}  // namespace gridlock
