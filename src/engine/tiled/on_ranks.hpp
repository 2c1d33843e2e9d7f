#pragma once

#include <cstdint>
#include <vector>

#include "core/disks_overview.hpp"
#include "engine/tiled/steps.hpp"
#include "gridlock/core/detail/message.hpp"
#include "gridlock/engine/engine.hpp"
#include "gridlock/grid/cell_layout.hpp"
#include "gridlock/parallel/communicator.hpp"
#include "gridlock/parallel/detail/row_division.hpp"
#include "gridlock/parallel/detail/tasks.hpp"

namespace gridlock {

/// The cells of the engine `tiled`.
CellLayout tiled_layout(EngineSettings const& settings, Box const& box, DisksOverview const& all);

/// The engine `tiled` on several ranks, of which this one leads; the others take part by tiled::take_part(). The state
/// of each rank has the rows that a division gives it, in the order of the Ids; between two calls of advance() nobody
/// has any others. The bits, counters included, are those of one process.
class TiledOnRanks final : public Engine {
 public:
  /// All rows are those of the leader. Errors: those of TiledEngine.
  TiledOnRanks(EngineSettings const& settings, State const& state);
  /// The disks of all ranks are these; the caller has checked them.
  TiledOnRanks(EngineSettings const& settings, Box const& box, DisksOverview const& all, RowDivision const& rows);

  /// `own` is the part of the leader; clock and counters are those of all.
  void advance(State& own, Counters& counters, StopCondition const& stop_condition) override;
  [[nodiscard]] double time_step() const override { return duration_; }
  void require_valid(State const& state) const override;

  /// Throws Error for disks that overlap, whoever has them. Contract: every row is sound by itself (RowProblems).
  void require_no_overlaps(State const& own) const;

 private:
  [[nodiscard]] tiled::TurnRule rule() const;

  EngineSettings settings_;
  Box box_;
  DisksOverview all_;
  RowDivision rows_;
  double duration_;
};

namespace tiled {

/// What every other rank does after TaskOfRanks::steps_of_disks: its part in TiledOnRanks::advance() and
/// require_no_overlaps().
void take_part(Communicator& ranks, MessageReader& message, State& own);

}  // namespace tiled

}  // namespace gridlock
