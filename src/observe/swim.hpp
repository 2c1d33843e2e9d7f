#pragma once

#include "gridlock/observe/observable.hpp"

namespace gridlock {

/// The effective swim speed of self-propelled disks, from differences of the counters between samples.
///
///     effective_swim_speed = ⟨Δr·n⟩ / (v₀ Δt)   between two turns of the heading n, Δt apart
///
/// It is 1 for disks that never meet, and falls as disks are in each other's way. In `stepped` and `tiled` it is the
/// fraction of the sub-steps that were not halted; in `exact` Δr is the displacement of a flight between two kicks, and
/// the value appears with the first whole flight.
/// Averages are ratios of sums. Cost: O(1).
/// Source: J. Stenhammar, D. Marenduzzo, R. J. Allen, M. E. Cates, Soft Matter 10, 1489 (2014),
/// doi:10.1039/C3SM52813H, for disks whose headings turn all the time.
class SwimSpeed final : public AveragingObservable {
 public:
  [[nodiscard]] Requirements requirements(Box const& /*box*/) const override {
    return {.columns = {}, .collisions = true};
  }
  void begin(Snapshot const& start) override;
  void sample(Snapshot const& now, std::span<double> row, bool counts_for_average) override;
  void serialize(Archive& archive) override;

 private:
  double last_swum_ = 0.0;
  double last_if_free_ = 0.0;
};

}  // namespace gridlock
