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

namespace gridlock {

/// How far the agents have come from where they were at begin(). Needs x and y, in a periodic box image_x and image_y
/// too.
///
///     mean_displacement         = (1/N) Σ_i |u_i| / √A                    fraction of the side √A of the box
///     mean_squared_displacement = (1/N) Σ_i u_i²                          length²
///     centre_displacement       = |(1/N) Σ_i u_i| / √A                    fraction of the side √A of the box
///     u_i = r_i − r_i(begin) + (n_x W, n_y H)
///
/// (n_x, n_y) counts the periodic edges crossed since begin(), so a disk that goes once around a periodic box has moved
/// by its whole side. Only agents alive since begin() enter.
///
/// The drift of the centre is not taken out of the first two. In a periodic box it is large under a rule that halts
/// disks (`stepped`, `tiled`): halting keeps the momentum, but not the motion of the centre, and which disks halt
/// depends on the order of the turns. It is no physics, and goes away with the time step: docs/explanation/paper.md,
/// "In a periodic box". What is left without it is about the centre: √(mean_squared_displacement/A −
/// centre_displacement²), of the side, is the root mean square. The centre is that of the places, every disk alike; of
/// mass where all masses are equal.
///
/// Results are the values of the last sample, whether it counts for averages or not: all grow with time and have no
/// average. The standard error of the first two comes from 16 blocks of agents with neighbouring Ids, which neighbours
/// share on a lattice start; it is the uncertainty of this one trajectory from the scatter between regions, and too
/// small where the whole system moves together. Errors over seeds are safer. That of the centre has none: there is but
/// one.
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
  struct Site {
    double x;
    double y;
    std::int32_t image_x;
    std::int32_t image_y;
  };

  Attached<Site> sites_;  ///< at begin()
  IdBlocks blocks_;
  std::array<Block, agent_blocks> length_{};          ///< Σ |u| of the last sample, in units of the side
  std::array<Block, agent_blocks> squared_length_{};  ///< Σ u² of the last sample
  Block centre_;                                      ///< |Σ u| of the last sample, in units of the side
};

}  // namespace gridlock
