#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>

#include "gridlock/core/box.hpp"
#include "gridlock/core/disks.hpp"
#include "gridlock/observe/detail/id_index.hpp"
#include "gridlock/observe/observable.hpp"
#include "observe/id_blocks.hpp"
#include "observe/sites.hpp"

namespace gridlock {

/// The displacements of the agents since begin(). Needs x and y, in a periodic box also image_x and image_y.
///
///     mean_displacement         = (1/N) Σ_i |u_i| / √A                    fraction of the side √A of the box
///     mean_squared_displacement = (1/N) Σ_i u_i²                          length²
///     centre_displacement       = |(1/N) Σ_i u_i| / √A                    fraction of the side √A of the box
///     u_i = r_i − r_i(begin) + (n_x W, n_y H)
///
/// (n_x, n_y) is the number of periodic edges crossed since begin(): a disk that goes once around a periodic box has
/// moved by its whole side. Only agents alive since begin() are counted.
///
/// The first two include the drift of the centre. In a periodic box the drift is large under a rule that halts disks
/// (`stepped`, `tiled`): halting keeps the momentum, but not the motion of the centre, and which disks halt depends on
/// the order of the turns. This drift is not physical and vanishes with the time step: docs/explanation/paper.md, "In a
/// periodic box". Without it the root mean square is √(mean_squared_displacement/A − centre_displacement²), in sides.
/// The centre is the mean position, every disk alike; it is the centre of mass where all masses are equal.
///
/// Results are the values of the last sample, whether or not it counts for averages: all grow with time, so averages
/// have no meaning. The standard error of the first two comes from 16 blocks of agents with neighbouring Ids, which are
/// neighbours in space after a lattice start. It is the uncertainty of this one trajectory from the scatter between
/// regions, and too small where the whole system moves together; errors over seeds are safer. The centre has no error,
/// because there is only one.
/// Cost: one pass over the agents, one square root each. Memory: 32 bytes an agent.
/// Source: the mean displacement is J.-X. Shen's measure of jamming, Agent based simulations and optimization with
/// uniform grid applied to colloidal jamming transitions; the mean square is A. Einstein's (1905),
/// doi:10.1002/andp.19053220806.
class Displacement final : public Observable {
 public:
  static constexpr std::size_t agent_blocks = IdBlocks::count;

  [[nodiscard]] Requirements requirements(Box const& box) const override;
  [[nodiscard]] std::vector<ColumnInfo> columns() const override;
  void begin(Snapshot const& start) override;
  void sample(Snapshot const& now, std::span<double> row, bool counts_for_average) override;
  [[nodiscard]] std::vector<NamedEstimate> results() const override;
  void serialize(Archive& archive) override;

 private:
  Attached<Site> sites_;  ///< position of each agent at begin()
  IdBlocks blocks_;
  std::array<Block, agent_blocks> length_{};          ///< Σ |u| of the last sample, in units of the side
  std::array<Block, agent_blocks> squared_length_{};  ///< Σ u² of the last sample
  Block centre_;                                      ///< |Σ u| of the last sample, in units of the side
};

}  // namespace gridlock
