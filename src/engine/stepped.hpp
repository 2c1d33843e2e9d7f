#pragma once

#include <cstddef>

#include "gridlock/engine/engine.hpp"
#include "gridlock/grid/cell_layout.hpp"

namespace gridlock {

/// The cells of the engine `stepped`: the k × k asked for, or the finest whose 3×3 block is enough for the start.
CellLayout stepped_layout(EngineSettings const& settings, State const& state);

/// The paper's rule, disk after disk in the order of their Ids, on the paper's linked lists: the readable reference
/// every faster version is measured against.
///
/// Errors: Error for settings out of their bounds, for no disks, for a state that validate() refuses, for a start in
/// which a sub-step could jump over a disk, and for a periodic box so small that the image a disk runs into need not be
/// the nearest one.
class SteppedEngine final : public Engine {
 public:
  SteppedEngine(EngineSettings const& settings, State const& state);

  void advance(State& state, Tally& tally, Horizon const& horizon) override;
  [[nodiscard]] double time_step() const override { return duration_; }

 private:
  /// Contract: a sub-step stays shorter than the contact distance to the smallest disk, or throws RunFailure.
  void require_short_substep(State const& state, std::size_t i, double squared_speed, double smallest_radius) const;

  EngineSettings settings_;
  double duration_;
  Box box_;  ///< the box layout_ was made for
  CellLayout layout_;
};

}  // namespace gridlock
