#pragma once

/// \file
/// Notes on a set-up and the milestones of a run, as typed values.
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

/// How much an event matters: `info` to those who read run.log, `note` and `warning` to everybody.
enum class Severity { info, note, warning };

/// The subject of an event.
enum class EventKind {
  // A set-up that can be run all the same.
  unused_setting,       ///< a setting was given on which nothing of the run depends
  misleading_rule,      ///< the engine has a time step where that is known to mislead
  note_of_model,        ///< what a model says of its start, in its own words
  frames_beyond_end,    ///< frames are asked for that lie beyond the end of the run
  nothing_moves,        ///< no disk has a velocity
  fast_on_ranks,        ///< several processes share disks so fast that those of one wait for those of others
  start_not_tried,      ///< the start takes long and was left out
  stage_with_two_ends,  ///< the first one that it reaches ends it
  velocities_drawn,     ///< the start file has none
  masses_assumed,       ///< the start file has momenta and no masses, which are 1
  columns_unused,       ///< of the start file
  entries_unused,       ///< of the second line of the start file: time and step of another kind than ours
  disks_folded,         ///< the start file has disks outside its periodic box, which come in through its edges
  // A run in a directory.
  begun,
  began_again,  ///< from the start, since there is no checkpoint
  resumed,
  version_changed,  ///< another version saved what is continued
  threads_chosen,
  lengthened,
  equilibration_fitted,  ///< to a new length, so that averages leave out what they have left out so far
  checkpoint_written,
  checkpoint_failed,       ///< it could not be written, and the run continues
  checkpoint_damaged,      ///< the newest one; the one before is used
  stage_not_equilibrated,  ///< swap Monte Carlo was too short
  stage_without_minimum,   ///< a minimization of soft disks gave up
  stage_without_pressure,  ///< soft disks do not press on each other where the stage ends
  stage_fell_short,        ///< soft disks press, but a minimum or the end of the stage was not found
  jamming_not_known,       ///< hard disks grew to a high pressure, which is no sign of jamming
  packing_not_jammed,      ///< soft disks press where the stage ends, and are not jammed
  packing_unstable,        ///< the packing gives way to a shear
  packing_gives_way,       ///< the packing gives way to compression, so that its moduli are no averages of a solid
  packing_too_dense,       ///< far above jamming
  error_not_known,         ///< of averages: the series contradicts it, and it is left out
  disks_in_cages,          ///< hard disks have collided many times and moved less than a diameter
  time_stands_still,       ///< hard disks collide and hardly fly
  audited,
  traffic_counted,  ///< the messages of one of several processes, and its time of waiting
  ended,
};

using EventValue = std::variant<std::uint64_t, double, std::string>;

/// Something worth telling of a set-up or a run, in values; to_text() says it in words.
struct Event {
  EventKind kind = EventKind::unused_setting;
  Severity severity = Severity::note;
  std::uint64_t step = 0;  ///< of the clock, when it happened
  std::string key = {};    ///< the setting to look at, where there is one
  std::vector<std::pair<std::string, EventValue>> values = {};
  bool is_default = false;  ///< an unused setting with the value it has anyway, as in a resolved configuration
};

/// The name of a kind, "unused_setting"; and of a severity, "note".
std::string_view to_text(EventKind kind);
std::string_view to_text(Severity severity);

/// An event in words, without its severity.
std::string to_text(Event const& event);

/// What to tell of the events of several set-ups. Unused settings are told of where they are unused in every run and
/// one run gives another value than the default: a sweep over engines sets what only some of them need. Of other events
/// it is told in how many runs they hold.
std::vector<std::string> texts_of(std::vector<std::vector<Event>> const& runs);

}  // namespace gridlock
