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
#include "gridlock/packing/contact_network.hpp"
#include "gridlock/packing/minimizer.hpp"
#include "gridlock/protocol/protocol.hpp"
#include "gridlock/protocol/settings.hpp"

namespace gridlock {

/// A function that returns whether work should continue; it is called now and then.
using ShouldContinue = std::function<bool()>;

/// A stage of a protocol while it runs.
///
/// The state stays that of the start of the stage until the stage ends, unless advance() updates it. After a restart
/// the stage is made for the state that was serialized.
class Stage {
 public:
  Stage() = default;
  Stage(Stage const&) = delete;
  Stage& operator=(Stage const&) = delete;
  virtual ~Stage() = default;

  /// Continues until the stage has ended or should_continue returns false. Returns whether it has ended.
  virtual bool advance(State& state, ShouldContinue const& should_continue) = 0;
  virtual void serialize(Archive& archive, State const& state) = 0;
  /// Number of iterations, events or trial moves done; it differs whenever the state has changed.
  [[nodiscard]] virtual std::uint64_t work() const = 0;
  /// Returns what shear has measured so far; nothing for another kind of stage.
  [[nodiscard]] virtual std::optional<ShearResult> shear_so_far() const { return std::nullopt; }
  /// Returns the results. Contract: the stage has ended.
  [[nodiscard]] virtual StageResult result(State const& state) const = 0;
};

/// The settings of one stage while they are checked.
struct StageCheck {
  StageSettings const& stage;
  std::optional<double> packing_fraction;  ///< packing fraction at the start of the stage, where it is known
  std::string place;                       ///< the stage's key, such as "protocol[2]"
  std::vector<Problem>& problems;

  /// Reports a problem of a setting; an empty name stands for the whole stage.
  void report(std::string_view setting, std::string what, std::string hint) const;
  /// Reports that the stage would never reach until_pressure.
  void report_pressure(std::string hint) const;
  /// Reports a stage that changes the packing fraction in one direction only and has its end in the other. The hint
  /// names the stage for the other direction, if there is one.
  void check_direction(bool leads_up, std::string_view opposite) const;
};

/// The record of a kind of stage. Only the kind's own file compares its name.
struct StageRecord {
  std::string_view name;                          ///< value of `stage` in [[protocol]]
  std::string_view documentation = {};            ///< description, where that of the setting `stage` is not enough
  std::vector<std::string_view> settings = {};    ///< settings in StageSettings that the kind accepts
  std::vector<std::string_view> ends = {};        ///< end conditions, of which one must be set
  std::string_view table_of_errors = "protocol";  ///< table to which its engine's errors assign the settings
  bool needs_no_overlaps = false;                 ///< whether the stage before must leave hard disks
  bool leaves_overlaps = false;                   ///< to be set by a stage that keeps overlaps, too
  bool has_soft_disks = false;                    ///< whether it needs the same edges along x and y
  bool needs_rectangle = false;                   ///< whether it knows no oblique boxes
  bool needs_images = false;                      ///< whether it needs a box that is periodic along x and y
  bool ends_near_jamming = false;                 ///< whether it brings hard disks near jamming
  bool may_end_without_pressure = false;          ///< whether the next stage may press the disks together
  /// Reports settings that contradict each other; null where none can.
  void (*check)(StageCheck const& check) = nullptr;
  /// Returns the packing fraction at the end; nothing where it depends on the disks. Null: it does not change.
  std::optional<double> (*packing_fraction_after)(StageSettings const& stage, std::optional<double> before) = nullptr;
  /// Errors: Error for a start on which the stage has no effect as the first stage.
  void (*require_start)(State const& start) = nullptr;
  /// Makes the stage with this number, counted from 0. Errors: Error for a state with which it cannot begin.
  std::unique_ptr<Stage> (*make)(ProtocolSettings const& protocol, std::size_t number, State const& state) = nullptr;
};

template <class Kind>
std::unique_ptr<Stage> make_stage(ProtocolSettings const& protocol, std::size_t number, State const& state) {
  return std::make_unique<Kind>(protocol, number, state);
}

/// Returns the packing fraction at which a stage ends; nothing if it ends at a pressure.
std::optional<double> packing_fraction_at_end(StageSettings const& stage, std::optional<double> before);

/// Writes the box, positions and radii into the state that the packing was made of, and counts the edges that disks
/// crossed.
void write_packing(Packing const& packing, State& state);

// For stages of soft disks.

MinimizerSettings minimizer_settings(ProtocolSettings const& protocol, StageSettings const& stage);
/// Adds the results that follow from the contacts at the end of a stage.
void add_end(ContactNetwork const& network, SoftSettings const& soft, StageResult& result);

// Each record is in the file of its stage.
StageRecord grow_stage();
StageRecord run_stage();
StageRecord quench_stage();
StageRecord compress_stage();
StageRecord decompress_stage();
StageRecord separate_stage();
StageRecord swap_stage();
StageRecord monte_carlo_stage();
StageRecord event_chain_stage();
StageRecord shear_stage();

/// Returns the records of all kinds, in the order of the documentation.
std::span<StageRecord const> stage_records();

/// Returns the record with this name. Errors: Error where there is none.
StageRecord const& stage_record(std::string_view kind);

}  // namespace gridlock
