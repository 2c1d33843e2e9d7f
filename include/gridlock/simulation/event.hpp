#pragma once

/// \file
/// Notes on a set-up and events of a run, with typed values.
///
/// ```cpp
/// Event const event{.kind = EventKind::checkpoint_written, .severity = Severity::info, .step = 100};
/// std::string const words = to_text(event);  // "checkpoint at step 100"
/// ```

#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

namespace gridlock {

/// The severity of an event: `info` appears only in run.log, `note` and `warning` are shown to every user.
enum class Severity { info, note, warning };

/// The kinds of notes and events.
enum class EventKind {
  // Notes on a set-up that can be run.
  unused_setting,       ///< a setting was given that has no effect on the run
  misleading_rule,      ///< the engine uses time steps under conditions where its results mislead
  note_of_model,        ///< a note of a model on its start, in its own words
  frames_beyond_end,    ///< the trajectory settings name frames beyond the end of the run
  tilt_flipped,         ///< the box has the tilt nearest to 0 that has the same images as the one that was given
  nothing_moves,        ///< no disk has a velocity
  thermostat,           ///< the diffusion of a free disk by the thermostat, and its error
  losing_energy,        ///< collisions lose energy, and no contact lasts
  lasting_contacts,     ///< contacts last so long that many collisions lose no energy
  propulsion,           ///< how far self-propelled disks go, and the error of a step or an interval
  fast_on_ranks,        ///< disks are so fast that processes often wait for one another
  start_not_tried,      ///< the start would take long and was left out
  stage_with_two_ends,  ///< a stage has two ends; it stops at the first
  other_potential,      ///< the run moves soft disks with another potential than the protocol
  velocities_drawn,     ///< the start file has no velocities
  masses_assumed,       ///< the start file has momenta and no masses; masses are taken as 1
  columns_unused,       ///< columns of the start file are not used
  entries_unused,       ///< in line 2 of the start file, the time and step are in another format
  disks_folded,         ///< the start file has disks outside its periodic box; their images inside are used
  // Events of a run in a directory.
  begun,
  began_again,  ///< the run began from the start, since there is no checkpoint
  resumed,
  version_changed,  ///< another version of the program wrote the checkpoint
  threads_chosen,
  lengthened,
  equilibration_fitted,  ///< changed for a new length, so that averages leave out the same samples as before
  checkpoint_written,
  checkpoint_failed,       ///< a checkpoint could not be written; the run continues
  checkpoint_damaged,      ///< the newest checkpoint is damaged; the one before it is used
  stage_not_equilibrated,  ///< swap Monte Carlo was too short
  stage_without_minimum,   ///< a minimization of soft disks found no minimum
  stage_without_pressure,  ///< the pressure of soft disks is 0 at the end of the stage
  stage_fell_short,        ///< the pressure of soft disks is above 0, but the stage did not find a minimum or its end
  jamming_not_known,       ///< hard disks grew to a high pressure, which does not show whether they are jammed
  packing_not_jammed,      ///< the pressure of soft disks is above 0 at the end of the stage, but they are not jammed
  packing_unstable,        ///< the packing is unstable against a shear
  packing_gives_way,       ///< the packing gives way to compression, so that its moduli are no averages of a solid
  packing_too_dense,       ///< the packing fraction is far above jamming
  error_not_known,         ///< an average has no standard error: the series contradicts it, or is too short for it
  disks_in_cages,          ///< hard disks have collided many times and moved less than a diameter
  time_stands_still,       ///< hard disks collide so often that the time hardly advances
  audited,
  traffic_counted,  ///< messages and waiting time of one of several processes
  ended,
};

using EventValue = std::variant<std::uint64_t, double, std::string>;

/// A note on a set-up or an event of a run, as values; to_text() returns it as a sentence.
struct Event {
  EventKind kind = EventKind::unused_setting;
  Severity severity = Severity::note;
  std::uint64_t step = 0;  ///< step of the clock at which it happened
  std::string key = {};    ///< the setting that it concerns; may be empty
  std::vector<std::pair<std::string, EventValue>> values = {};
  bool is_default = false;  ///< for an unused setting: whether it has its default value
};

/// Return the name of a kind, such as "unused_setting", or of a severity, such as "note".
std::string_view to_text(EventKind kind);
std::string_view to_text(Severity severity);

/// Returns the text of an event, without its severity.
std::string to_text(Event const& event);

/// Returns texts on the events of several set-ups. An unused setting is mentioned only if no run uses it and one run
/// does not have its default, since a sweep over engines has settings that only some engines use. Each other event is
/// mentioned once, with the number of its runs.
std::vector<std::string> texts_of(std::vector<std::vector<Event>> const& runs);

}  // namespace gridlock
