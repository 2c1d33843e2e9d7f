#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>

#include "gridlock/core/archive.hpp"
#include "gridlock/core/disks.hpp"
#include "gridlock/protocol/protocol.hpp"
#include "gridlock/protocol/settings.hpp"

namespace gridlock {

/// Whether to go on, asked now and then.
using ShouldContinue = std::function<bool()>;

/// One stage of a protocol while it is carried out.
///
/// The state is the one of the start of the stage until advance() says that the stage has ended, unless advance() keeps
/// it up to date itself; restored, a stage is made for the state that was serialized.
class Stage {
 public:
  Stage() = default;
  Stage(Stage const&) = delete;
  Stage& operator=(Stage const&) = delete;
  virtual ~Stage() = default;

  /// Goes on until the stage has ended, or should_continue says no; returns whether it has ended.
  virtual bool advance(State& state, ShouldContinue const& should_continue) = 0;
  virtual void serialize(Archive& archive, State const& state) = 0;
  /// Iterations, events or trial moves done; tells a state that has changed from one that has not.
  [[nodiscard]] virtual std::uint64_t work() const = 0;
  /// The results, after the end.
  [[nodiscard]] virtual StageResult result(State const& state) const = 0;
};

/// The stage of that number, from 0. Errors: Error for a state that it cannot begin with.
std::unique_ptr<Stage> make_stage(ProtocolSettings const& protocol, std::size_t number, State const& state);

/// Writes positions and radii into the state the packing was made of, and counts the edges that disks have crossed.
void write_packing(Packing const& packing, State& state);

}  // namespace gridlock
