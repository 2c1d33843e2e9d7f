#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>

#include "gridlock/core/box.hpp"
#include "gridlock/observe/observable.hpp"
#include "gridlock/observe/rows_by_id.hpp"

namespace gridlock {

/// How far the disks have come from where they stood at begin().
///
///     mean_displacement         = (1/N) Σ_i |u_i| / √A                    fraction of the side √A of the box
///     mean_squared_displacement = (1/N) Σ_i u_i²                          length²
///     u_i = r_i − r_i(begin) + (n_x W, n_y H)
///
/// (n_x, n_y) counts the periodic edges crossed since begin(), so a disk that goes once around a periodic box has moved
/// by its whole side. The drift of the centre of mass is not taken out. Only disks alive since begin() enter.
///
/// Results are the values of the last sample, whether it counts for averages or not: both grow with time and have no
/// average. Their standard error comes from 16 blocks of disks with neighbouring Ids, which neighbours share on a
/// lattice start; it is the uncertainty of this one trajectory from the scatter between regions, and too small where
/// the whole system moves together. Errors over seeds are safer.
/// Cost: one pass over the disks, one square root each. Memory: 32 bytes a disk.
/// Source: the mean displacement is J.-X. Shen's measure of jamming, Agent based simulations and optimization with
/// uniform grid applied to colloidal jamming transitions; the mean square is A. Einstein's (1905),
/// doi:10.1002/andp.19053220806.
class Displacement final : public Observable {
 public:
  static constexpr std::size_t disk_blocks = 16;

  [[nodiscard]] std::vector<ColumnInfo> columns() const override;
  void begin(Moment const& start) override;
  void sample(Moment const& now, std::span<double> row, bool counts_for_average) override;
  [[nodiscard]] std::vector<NamedEstimate> results() const override;
  void carry(Archive& archive) override;

 private:
  struct Site {
    double x;
    double y;
    std::int32_t image_x;
    std::int32_t image_y;
  };

  RowsById rows_;
  std::vector<Site> sites_;
  std::array<Block, disk_blocks> length_{};          ///< Σ |u| of the last sample, in units of the side
  std::array<Block, disk_blocks> squared_length_{};  ///< Σ u² of the last sample
};

}  // namespace gridlock
