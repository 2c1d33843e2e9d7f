#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "gridlock/core/archive.hpp"
#include "gridlock/core/disks.hpp"
#include "gridlock/core/error.hpp"
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

/// The settings of one stage while they are checked.
struct StageCheck {
  StageSettings const& stage;
  std::optional<double> packing_fraction;  ///< the one at which the stage begins, where it is known
  std::string place;                       ///< "protocol[2]"
  std::vector<Problem>& problems;

  /// An empty setting stands for the stage as a whole.
  void report(std::string_view setting, std::string what, std::string hint) const;
  /// The stage would never reach until_pressure.
  void report_pressure(std::string hint) const;
  /// Reports a stage that can only go up, or down, and ends on the other side. The hint names the stage that goes the
  /// other way, where there is one.
  void check_direction(bool leads_up, std::string_view opposite) const;
};

/// The record of a kind of stage: nothing outside its own file compares its name.
struct StageRecord {
  std::string_view name;                          ///< `stage` of [[protocol]]
  std::string_view documentation = {};            ///< what it does, where the sentence on `stage` does not say it
  std::vector<std::string_view> settings = {};    ///< those of StageSettings that it takes
  std::vector<std::string_view> ends = {};        ///< the settings of which it needs one
  std::string_view table_of_errors = "protocol";  ///< where the errors of its engine place the settings
  bool needs_no_overlaps = false;                 ///< it begins with hard disks
  bool leaves_overlaps = false;
  bool ends_near_jamming = false;         ///< hard disks at a high pressure come to no jammed packing by it
  bool may_end_without_pressure = false;  ///< a stage that follows may be the one to press the disks together
  /// Reports settings that contradict each other, where there are such.
  void (*check)(StageCheck const& check) = nullptr;
  /// The packing fraction that the stage leaves, none where the disks decide. Null: the one with which it begins.
  std::optional<double> (*packing_fraction_after)(StageSettings const& stage, std::optional<double> before) = nullptr;
  /// Errors: Error for a start that leaves nothing to do where it is the first stage.
  void (*require_start)(State const& start) = nullptr;
  /// The stage of that number, from 0. Errors: Error for a state that it cannot begin with.
  std::unique_ptr<Stage> (*make)(ProtocolSettings const& protocol, std::size_t number, State const& state) = nullptr;
};

template <class Kind>
std::unique_ptr<Stage> make_stage(ProtocolSettings const& protocol, std::size_t number, State const& state) {
  return std::make_unique<Kind>(protocol, number, state);
}

/// The one at which a stage ends that may end at a pressure instead.
std::optional<double> packing_fraction_at_end(StageSettings const& stage, std::optional<double> before);

/// Writes positions and radii into the state the packing was made of, and counts the edges that disks have crossed.
void write_packing(Packing const& packing, State& state);

/// Those of all kinds, in the order of the documentation.
std::span<StageRecord const> stage_records();

/// The one of that name. Errors: Error where there is none.
StageRecord const& stage_record(std::string_view kind);

}  // namespace gridlock
