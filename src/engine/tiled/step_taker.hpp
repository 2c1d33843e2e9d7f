#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>

#include "engine/hot_disks.hpp"
#include "engine/tiled/steps.hpp"
#include "gridlock/core/counters.hpp"
#include "gridlock/core/disks.hpp"
#include "gridlock/engine/device.hpp"
#include "gridlock/grid/cell_layout.hpp"
#include "gridlock/grid/detail/tiling.hpp"

namespace gridlock::tiled {

/// Takes the steps of all disks of a state: on the cores of the processor, or on a graphics processor.
class StepTaker {
 public:
  StepTaker() = default;
  StepTaker(StepTaker const&) = delete;
  StepTaker& operator=(StepTaker const&) = delete;
  virtual ~StepTaker() = default;

  /// Takes a step, and adds its events to the counters.
  virtual void take_step(std::uint64_t step, Counters& counters) = 0;
  /// Returns the first disk, by tile, that could have jumped over another in the last step.
  [[nodiscard]] virtual std::optional<TooFast> too_fast() const = 0;
  virtual void write_back(State& state) = 0;
};

/// Returns the bytes that the device needs for disks in these cells.
std::size_t bytes_on_device(std::size_t disks, CellLayout const& layout, Tiling const& tiling);

/// Moves disks, in the order of memory, to the device; the room `device` defines it. `threads` are those of an emulated
/// device. Contract: the program has a device. Errors: Error if its memory is not large enough.
std::unique_ptr<StepTaker> steps_on_device(HotDisks const& disks, TurnRule const& rule, CellLayout const& layout,
                                           Tiling const& tiling, std::uint64_t threads);

}  // namespace gridlock::tiled
