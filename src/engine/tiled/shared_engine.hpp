#pragma once

#include <cstdint>

#include "core/disks_overview.hpp"
#include "engine/heading_columns.hpp"
#include "engine/tiled/steps.hpp"
#include "gridlock/core/detail/large_array.hpp"
#include "gridlock/engine/engine.hpp"
#include "gridlock/grid/cell_layout.hpp"

namespace gridlock {

/// Returns the cells of the engine `tiled`.
CellLayout tiled_layout(EngineSettings const& settings, Box const& box, DisksOverview const& all);

/// The engine `tiled` for disks that several processes share. The state of each process has some of the disks, in the
/// order of their Ids; after steps these are the disks in its tiles. All processes call each function together. Bits
/// and counters are those of one process.
class SharedTiledEngine final : public Engine {
 public:
  /// Contract: in the order of the Ids the disks of process 0 come first, then those of process 1.
  /// Errors: those of TiledEngine, in all processes.
  SharedTiledEngine(EngineSettings const& settings, State const& own);

  /// Advances as Engine::advance(). Clock and counters are those of all disks.
  void advance(State& own, Counters& counters, StopCondition const& stop_condition) override;
  [[nodiscard]] double time_step() const override { return duration_; }
  /// Checks each disk of this process, but not overlaps.
  void require_valid(State const& own) const override;
  void take_restored(State& own) override;
  void give_frame(FrameSource const& of_world, UseFrame const& use) const override {
    give_frame_with_headings(settings_.propulsion, of_world, use);
  }

 private:
  /// Numbers the rows by Id, in the order that the constructor requires.
  void count_ids(State const& own);
  void require_all_valid(State const& own) const;
  void require_no_overlaps(State const& own) const;

  EngineSettings settings_;
  DisksOverview all_;
  double duration_;
  LargeArray<std::uint32_t> id_indices_;  ///< index of each row in the order of the Ids of all processes
};

}  // namespace gridlock
