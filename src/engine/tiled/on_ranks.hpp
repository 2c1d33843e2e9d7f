#pragma once

#include "core/disks_overview.hpp"
#include "engine/tiled/steps.hpp"
#include "gridlock/engine/engine.hpp"
#include "gridlock/grid/cell_layout.hpp"
#include "gridlock/parallel/detail/row_division.hpp"

namespace gridlock {

/// The cells of the engine `tiled`.
CellLayout tiled_layout(EngineSettings const& settings, Box const& box, DisksOverview const& all);

/// The engine `tiled` on several ranks. The state of each has some of all disks: in the order of the Ids those of rank
/// 0 come first, then those of rank 1. All ranks call each function together. The bits, counters included, are those
/// of one process.
class TiledOnRanks final : public Engine {
 public:
  /// Errors: those of TiledEngine, on all ranks.
  TiledOnRanks(EngineSettings const& settings, State const& own);

  /// Clock and counters are those of all disks.
  void advance(State& own, Counters& counters, StopCondition const& stop_condition) override;
  [[nodiscard]] double time_step() const override { return duration_; }
  /// Looks at each disk of this rank by itself, and at no overlaps.
  void require_valid(State const& own) const override;
  bool take_restored(State& own) override;

 private:
  void require_all_valid(State const& own) const;
  void require_no_overlaps(State const& own) const;

  EngineSettings settings_;
  DisksOverview all_;
  RowDivision rows_;
  double duration_;
};

}  // namespace gridlock
