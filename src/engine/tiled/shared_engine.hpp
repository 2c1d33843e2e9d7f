#pragma once

#include <cstdint>

#include "core/disks_overview.hpp"
#include "engine/tiled/steps.hpp"
#include "gridlock/core/detail/large_array.hpp"
#include "gridlock/engine/engine.hpp"
#include "gridlock/grid/cell_layout.hpp"

namespace gridlock {

/// The cells of the engine `tiled`.
CellLayout tiled_layout(EngineSettings const& settings, Box const& box, DisksOverview const& all);

/// The engine `tiled` for disks that several processes share. The state of each has some of all disks, in the order of
/// their Ids: after steps those that are in its tiles. All processes call each function together. The bits, counters
/// included, are those of one process.
class SharedTiledEngine final : public Engine {
 public:
  /// Contract: in the order of the Ids the disks of process 0 come first, then those of process 1.
  /// Errors: those of TiledEngine, in all processes.
  SharedTiledEngine(EngineSettings const& settings, State const& own);

  /// Clock and counters are those of all disks.
  void advance(State& own, Counters& counters, StopCondition const& stop_condition) override;
  [[nodiscard]] double time_step() const override { return duration_; }
  /// Looks at each disk of this process by itself, and at no overlaps.
  void require_valid(State const& own) const override;
  void take_restored(State& own) override;

 private:
  /// Numbers the rows, which are in the order that the constructor requires.
  void count_ids(State const& own);
  void require_all_valid(State const& own) const;
  void require_no_overlaps(State const& own) const;

  EngineSettings settings_;
  DisksOverview all_;
  double duration_;
  LargeArray<std::uint32_t> id_indices_;  ///< the place of each row in the order of the Ids of all
};

}  // namespace gridlock
