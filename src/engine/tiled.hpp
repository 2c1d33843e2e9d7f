#pragma once

#include <memory>
#include <vector>

#include "engine/heading_columns.hpp"
#include "engine/tiled/step_taker.hpp"
#include "engine/tiled/steps.hpp"
#include "gridlock/core/detail/thread_pool.hpp"
#include "gridlock/engine/engine.hpp"
#include "gridlock/grid/cell_layout.hpp"
#include "gridlock/grid/detail/tiling.hpp"

namespace gridlock {

EngineRecord tiled_record();

/// The engine `tiled`: turns by the rule of the paper, as in `stepped`, in another order (ClassOrder): tile by tile, in
/// a tile class by class of cells, in a cell by Id. Any number of threads gives the same bits.
///
/// Disks too fast for the ring of cells around their tile take their turns one by one at the end of the step.
/// Errors: those of SteppedEngine.
/// Memory: about 230 bytes for each disk during advance(); up to 350 in a box of one or two rows of cells, because the
/// grid has two empty rows.
class TiledEngine final : public Engine {
 public:
  TiledEngine(EngineSettings const& settings, State const& state);

  void advance(State& state, Counters& counters, StopCondition const& stop_condition) override;
  [[nodiscard]] double time_step() const override { return duration_; }
  void give_frame(FrameSource const& of_world, UseFrame const& use) const override {
    give_frame_with_headings(settings_.propulsion, of_world, use);
  }
  void require_valid(State const& state) const override;

 private:
  void lay_out(State const& state);
  [[nodiscard]] tiled::TurnRule rule_of(State const& state) const;
  [[nodiscard]] std::unique_ptr<tiled::StepTaker> step_taker(State const& state);

  EngineSettings settings_;
  bool is_on_device_;
  double duration_;
  Box box_;  ///< the box that layout_ was made for
  CellLayout layout_;
  ThreadPool thread_pool_;
  Tiling tiling_;
  std::vector<Tiling::Round> rounds_;  ///< rounds for the present thread pool
};

}  // namespace gridlock
