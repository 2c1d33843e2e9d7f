#include "gridlock/simulation/event.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <iterator>
#include <optional>
#include <set>

#include "gridlock/core/detail/time_step_rule.hpp"
#include "gridlock/packing/minimizer.hpp"

namespace gridlock {

namespace {

constexpr std::array<std::string_view, 44> kind_texts{"unused_setting",
                                                      "misleading_rule",
                                                      "note_of_model",
                                                      "frames_beyond_end",
                                                      "tilt_flipped",
                                                      "nothing_moves",
                                                      "thermostat",
                                                      "losing_energy",
                                                      "lasting_contacts",
                                                      "propulsion",
                                                      "fast_on_ranks",
                                                      "start_not_tried",
                                                      "stage_with_two_ends",
                                                      "other_potential",
                                                      "velocities_drawn",
                                                      "masses_assumed",
                                                      "columns_unused",
                                                      "entries_unused",
                                                      "disks_folded",
                                                      "begun",
                                                      "began_again",
                                                      "resumed",
                                                      "version_changed",
                                                      "threads_chosen",
                                                      "lengthened",
                                                      "equilibration_fitted",
                                                      "checkpoint_written",
                                                      "checkpoint_failed",
                                                      "checkpoint_damaged",
                                                      "stage_not_equilibrated",
                                                      "stage_without_minimum",
                                                      "stage_without_pressure",
                                                      "stage_fell_short",
                                                      "jamming_not_known",
                                                      "packing_not_jammed",
                                                      "packing_unstable",
                                                      "packing_gives_way",
                                                      "packing_too_dense",
                                                      "error_not_known",
                                                      "disks_in_cages",
                                                      "time_stands_still",
                                                      "audited",
                                                      "traffic_counted",
                                                      "ended"};

EventValue const* find(Event const& event, std::string_view name) {
  auto const found =
      std::ranges::find(event.values, name, [](auto const& value) { return std::string_view(value.first); });
  return found == event.values.end() ? nullptr : &found->second;
}

/// Returns a value of an event by its name; an empty value if it is missing or of another type.
template <class Value>
Value value_of(Event const& event, std::string_view name) {
  EventValue const* const value = find(event, name);
  Value const* const typed = value == nullptr ? nullptr : std::get_if<Value>(value);
  return typed == nullptr ? Value() : *typed;
}

/// Reads the values of an event to compose its text.
struct Values {
  Event const& event;
  [[nodiscard]] std::uint64_t count(std::string_view name) const { return value_of<std::uint64_t>(event, name); }
  [[nodiscard]] double number(std::string_view name) const { return value_of<double>(event, name); }
  [[nodiscard]] std::string word(std::string_view name) const { return value_of<std::string>(event, name); }
};

std::string text_of_start_file(Event const& event) {
  Values const of{event};
  switch (event.kind) {
    case EventKind::velocities_drawn:
      return fmt::format("the start file has no velocities: they are drawn anew, velocities.kind = \"{}\"",
                         of.word("velocities"));
    case EventKind::masses_assumed:
      return "the start file has momenta and no masses: velocities are those of masses of 1";
    case EventKind::columns_unused:
      return fmt::format("columns of the start file that are not used: {}", of.word("names"));
    case EventKind::entries_unused:
      return fmt::format(
          "the start file has {}, which is of another kind than here: the run begins at step {}, time {:.6g}",
          of.word("entries"), event.step, of.number("time"));
    default:
      return fmt::format(
          "{} disk{} of the start file {} outside its periodic box: moved in through its edges, and counted by image",
          of.count("disks"), of.count("disks") == 1 ? "" : "s", of.count("disks") == 1 ? "was" : "were");
  }
}

/// The longest path between two kicks, in diameters, for which the error of self-diffusion is linear in the path.
constexpr double max_brownian_flight = 0.25;

std::string text_of_thermostat(Values const& of) {
  std::string free_motion =
      fmt::format("{}: kT = {:.6g}, a free disk{} diffuses with D₀ = {:.6g}", of.word("kind"), of.number("temperature"),
                  of.count("are_unlike") == 0 ? "" : " of the mean mass", of.number("diffusion"));
  if (of.word("kind") != "brownian") return free_motion;
  double const flight = of.number("flight");
  std::string const draws =
      fmt::format("{}; {:.4g} draws of all velocities in σ²/D₀, between two of them a path of {:.3g} σ along each axis",
                  free_motion, of.number("draws"), flight);
  if (flight > max_brownian_flight) {
    return fmt::format(
        "{}: too long for Brownian motion between disks; an interval {:.2g} times as long makes it 0.1 σ", draws,
        0.1 / flight);
  }
  return fmt::format(
      "{}: self-diffusion at a packing fraction of 0.5 is about {:.2g} % too small, less where it is lower", draws,
      of.number("error_percent"));
}

/// The longest way of a disk between two turns of its heading, in diameters, that is short beside a diameter, and the
/// largest turn, in radians, that is small beside a right angle.
constexpr double max_way = 0.11;
constexpr double max_turn = 0.5;

std::string text_of_propulsion(Values const& of) {
  bool const turns = of.number("rotational_diffusion") > 0.0;
  std::string text = turns ? fmt::format("self-propelled disks: they forget their headings over v₀/D_R = {:.4g} σ",
                                         of.number("persistence"))
                           : "self-propelled disks whose headings never turn: means over time depend on the start";
  text += fmt::format("; in {} they go {:.3g} σ", of.word("duration"), of.number("way"));
  if (turns) text += fmt::format(" and turn by {:.3g} radians", of.number("turn"));
  if (of.number("way") > max_way) {
    text += ": too far for motion in continuous time; at 0.2 σ the effective swim speed is about 10 % too small";
  } else if (of.number("turn") > max_turn) {
    text += ": too much for a heading that turns smoothly; a shorter time makes it less";
  }
  return text;
}

std::string text_of_setup(Event const& event) {
  Values const of{event};
  switch (event.kind) {
    case EventKind::unused_setting:
      return fmt::format("{} has no effect with {}", event.key, of.word("choice"));
    case EventKind::misleading_rule: {
      TimeStepCaveats caveats{.centre_drifts = of.count("centre_drifts") != 0};
      if (find(event, "packing_fraction") != nullptr) caveats.too_dense = of.number("packing_fraction");
      return fmt::format("with engine.kind = \"{}\" {}, because of its time step; \"exact\" has none",
                         of.word("engine"), in_words(caveats));
    }
    case EventKind::note_of_model:
      return of.word("text");
    case EventKind::frames_beyond_end:
      return fmt::format("{} of {} in {} lie{} beyond the end of the run at {} {:.6g}: no frame there",
                         of.count("beyond"), of.count("asked_for"), event.key, of.count("beyond") == 1 ? "s" : "",
                         of.word("unit"), of.number("end"));
    case EventKind::tilt_flipped:
      return fmt::format("box.tilt = {:.6g} has the images of a box with the tilt {:.6g}, which is used",
                         of.number("given"), of.number("tilt"));
    case EventKind::nothing_moves:
      return event.key == "disks.file" ? "no disk of the start file has a velocity: nothing moves"
                                       : "velocities.max is 0: nothing moves";
    case EventKind::thermostat:
      return text_of_thermostat(of);
    case EventKind::losing_energy:
      return fmt::format(
          "collisions with a restitution of {:.6g} can come without end in a finite time, the inelastic collapse, "
          "which ends a run; collisions.contact_time, far shorter than the time between collisions, is a remedy",
          of.number("restitution"));
    case EventKind::lasting_contacts:
      return fmt::format(
          "about {:.0f} % of the collisions lose no energy, for a disk collides once in {:.3g} at the "
          "start; a shorter collisions.contact_time makes them fewer",
          of.number("percent"), of.number("mean_free_time"));
    case EventKind::propulsion:
      return text_of_propulsion(of);
    case EventKind::fast_on_ranks:
      return fmt::format(
          "some disks are {:.3g} times as fast as engine.speed = {:.6g}: on ranks such disks wait for one another, and "
          "a run of many can take hundreds of times as long; a larger engine.speed makes shorter steps",
          of.number("ratio"), of.number("speed"));
    case EventKind::stage_with_two_ends:
      return fmt::format("stage {} of the protocol, \"{}\", has two ends, {}: the one that it reaches first ends it",
                         of.count("stage"), of.word("name"), of.word("ends"));
    case EventKind::other_potential:
      return fmt::format(
          "the protocol presses disks with soft.potential = \"{}\", and the run moves them with "
          "potential.kind = \"{}\": forces change where it begins",
          of.word("protocol"), of.word("run"));
    default:
      return fmt::format(
          "the random start was not tried, since that takes about {:.0f} s; gridlock run will tell "
          "whether all find room",
          of.number("seconds"));
  }
}

std::string text_of_audits(Values const& of) {
  if (of.count("audits") == 0) return "no audit was due: there were fewer pair collisions than engine.audit_every";
  bool const looks_for_missed_events = of.count("audits_for_missed_events") == of.count("audits");
  return fmt::format("{} audits found no overlap{}", of.count("audits"),
                     looks_for_missed_events ? " and no missed event"
                                             : "; for missed events they look among few disks only, not here");
}

std::string text_of_checkpoint(Event const& event) {
  Values const of{event};
  if (event.kind == EventKind::checkpoint_written) return fmt::format("checkpoint at step {}", event.step);
  if (event.kind == EventKind::checkpoint_failed) {
    return fmt::format("no checkpoint at step {}: {}", event.step, of.word("why"));
  }
  return fmt::format("{}; going back to the previous one", of.word("why"));
}

/// Returns why a packing under pressure is not jammed.
std::string reason_of(Event const& event) {
  Values const of{event};
  if (find(event, "missing_contacts") != nullptr) {
    return of.count("backbone_disks") == 0
               ? std::string("no disk is held by three contacts")
               : fmt::format("its backbone of {} disks has {} contact{} fewer than it needs",
                             of.count("backbone_disks"), of.count("missing_contacts"),
                             of.count("missing_contacts") == 1 ? "" : "s");
  }
  if (find(event, "softest_mode") != nullptr)
    return fmt::format("the energy falls along its softest mode, of eigenvalue {:.3g}", of.number("softest_mode"));
  return fmt::format("a net force is {:.3g} of the mean contact force", of.number("residual"));
}

std::string text_of_stage(Event const& event) {
  Values const of{event};
  std::string const stage = fmt::format("stage {} of the protocol, \"{}\"", of.count("stage"), of.word("name"));
  switch (event.kind) {
    case EventKind::stage_not_equilibrated:
      if (find(event, "density_drift") != nullptr) {
        return fmt::format(
            "{}, is no equilibrium: from the first to the second half of the sweeps its mean packing fraction changes "
            "by {:.2g} standard deviations; use more sweeps",
            stage, of.number("density_drift"));
      }
      return find(event, "relaxation_times") == nullptr
                 ? stage + ", is no equilibrium: the disks have not forgotten where they began; use more sweeps"
                 : fmt::format("{}, is no equilibrium: its sweeps are {:.3g} relaxation times, and it takes 10", stage,
                               of.number("relaxation_times"));
    case EventKind::stage_without_minimum:
      return fmt::format("{}, ends where no minimum was found in {} iterations, at packing fraction {:.10g}", stage,
                         MinimizerSettings{}.iterations, of.number("packing_fraction"));
    case EventKind::stage_without_pressure:
      return fmt::format("{}, ends with disks that do not press on each other, at packing fraction {:.6g}", stage,
                         of.number("packing_fraction"));
    case EventKind::stage_fell_short:
      return fmt::format(
          "{}, ends short of its goal, at pressure {:.6g} and packing fraction {:.6g}: the start lies on the other "
          "side, or no "
          "minimum was found closer to it",
          stage, of.number("pressure"), of.number("packing_fraction"));
    case EventKind::jamming_not_known:
      return fmt::format(
          "{}, ends at a reduced pressure of {:.4g}, which does not tell whether the disks are jammed: a stage "
          "\"compress\" of soft disks after it does",
          stage, of.number("pressure"));
    case EventKind::packing_not_jammed:
      return fmt::format("the packing of {}, is not jammed: {}{}", stage, reason_of(event),
                         find(event, "jamming_packing_fraction") == nullptr
                             ? ""
                             : "; jamming_packing_fraction is only where its pressure vanishes");
    case EventKind::packing_gives_way:
      return fmt::format(
          "the packing of {}, is at an instability: its bulk modulus is {:.3g}; the moduli are left out of the "
          "results, "
          "and so of means over runs",
          stage, of.number("bulk_modulus"));
    case EventKind::packing_too_dense:
      return fmt::format(
          "the packing of {}, is far above jamming: the disks cover {:.4g} of the box, and overlap by {:.2g} of their "
          "distance at contact on the average; nothing there is like hard disks",
          stage, of.number("packing_fraction"), of.number("mean_overlap"));
    default:
      return fmt::format(
          "the packing of {}, is unstable against shear: its least shear modulus is {:.3g}, since the box keeps its "
          "shape; with box_shape = \"free\" packings are stable",
          stage, of.number("least_shear_modulus"));
  }
}

/// Returns the text of notes on runs of hard disks and on averages.
std::string text_of_run(Event const& event) {
  Values const of{event};
  switch (event.kind) {
    case EventKind::disks_in_cages:
      return fmt::format(
          "the disks have not left their cages: after {:.3g} collisions each, their mean squared displacement is "
          "{:.2g} "
          "of a squared diameter; a crystal stays so, but a fluid is no equilibrium yet: run it longer",
          of.number("collisions_per_disk"), of.number("squared_diameters"));
    case EventKind::time_stands_still:
      return fmt::format(
          "time hardly moves: in {} collisions {:.3g} of time has passed, and from one to the next a disk flies {:.2g} "
          "of "
          "its diameter; disks are wedged or jammed",
          of.count("collisions"), of.number("time"), of.number("flight"));
    default:
      break;
  }
  if (find(event, "samples") != nullptr) {
    bool const has_no_values = find(event, "no_values") != nullptr;
    return fmt::format("no {} is given for {}: averages keep {} samples, and it takes {} times observe.viscosity_lag",
                       has_no_values ? "value" : "error", of.word("names"), of.count("samples"),
                       has_no_values ? 2 : 10);
  }
  std::string const why =
      find(event, "differs_by") != nullptr
          ? fmt::format("the samples that averages leave out differ from those that they keep by {:.2g} errors",
                        of.number("differs_by"))
          : fmt::format("what changes slowest was seen about {:.0f} times in the samples, and it takes 10",
                        std::max(of.number("times_seen"), 1.0));
  return fmt::format("no error is given for {}: {}; make the run longer, or take several seeds", of.word("names"), why);
}

std::string text_of_end(Event const& event) {
  Values const of{event};
  std::string const failure = of.word("failure");
  return fmt::format("{} at step {} after {:.1f} s, state hash {}{}{}", of.word("status"), event.step,
                     of.number("seconds"), of.word("state_hash"), failure.empty() ? "" : ": ", failure);
}

}  // namespace

std::string_view to_text(EventKind kind) { return kind_texts[static_cast<std::size_t>(kind)]; }

std::string_view to_text(Severity severity) {
  switch (severity) {
    case Severity::info:
      return "info";
    case Severity::note:
      return "note";
    case Severity::warning:
      break;
  }
  return "warning";
}

std::string to_text(Event const& event) {
  Values const of{event};
  switch (event.kind) {
    case EventKind::begun:
      return fmt::format("gridlock {} begins: {}, {} {}, seed {}, start hash {}", of.word("version"), of.word("title"),
                         of.count("agents"), of.word("agents_name"), of.count("seed"), of.word("start_hash"));
    case EventKind::began_again:
      return "there is no checkpoint: the run begins again from its start";
    case EventKind::resumed:
      return fmt::format("gridlock {} continues from step {} of {}", of.word("version"), event.step, of.word("file"));
    case EventKind::version_changed:
      return fmt::format(
          "what is continued was saved by gridlock {}, and this is gridlock {}: the bits may differ from those of a "
          "run "
          "by one of them alone",
          of.word("former"), of.word("version"));
    case EventKind::threads_chosen:
      return fmt::format("on {}{} thread{}{}",
                         of.count("ranks") > 1 ? fmt::format("{} ranks, ", of.count("ranks")) : "", of.count("threads"),
                         of.count("threads") == 1 ? "" : "s", of.count("ranks") > 1 ? " each" : "");
    case EventKind::traffic_counted:
      return fmt::format("rank {} sent {} messages of {:.3g} MB in all, and waited {:.3g} s for others",
                         of.count("rank"), of.count("messages_sent"),
                         static_cast<double>(of.count("bytes_sent")) * 1e-6, of.number("seconds_waiting"));
    case EventKind::lengthened:
      return fmt::format("lengthened to {}", of.word("length"));
    case EventKind::equilibration_fitted:
      return fmt::format(
          "observe.equilibration is {:.4g} of the new length, so that averages leave out the samples that "
          "they have left out so far",
          of.number("equilibration"));
    case EventKind::checkpoint_written:
    case EventKind::checkpoint_failed:
    case EventKind::checkpoint_damaged:
      return text_of_checkpoint(event);
    case EventKind::stage_not_equilibrated:
    case EventKind::stage_without_minimum:
    case EventKind::stage_without_pressure:
    case EventKind::stage_fell_short:
    case EventKind::jamming_not_known:
    case EventKind::packing_not_jammed:
    case EventKind::packing_unstable:
    case EventKind::packing_gives_way:
    case EventKind::packing_too_dense:
      return text_of_stage(event);
    case EventKind::error_not_known:
    case EventKind::disks_in_cages:
    case EventKind::time_stands_still:
      return text_of_run(event);
    case EventKind::audited:
      return text_of_audits(of);
    case EventKind::ended:
      return text_of_end(event);
    case EventKind::velocities_drawn:
    case EventKind::masses_assumed:
    case EventKind::columns_unused:
    case EventKind::entries_unused:
    case EventKind::disks_folded:
      return text_of_start_file(event);
    default:
      return text_of_setup(event);
  }
}

namespace {

/// Returns the note on an event of one or more runs of a sweep; nothing for an unused setting of minor interest.
std::optional<std::string> text_of(std::vector<Event> const& alike, std::size_t runs) {
  Event const& first = alike.front();
  std::string const text = to_text(first);
  bool const has_one_text = std::ranges::all_of(alike, [&](Event const& event) { return to_text(event) == text; });
  bool const is_of_all = alike.size() == runs;
  if (first.kind != EventKind::unused_setting) {
    return is_of_all && has_one_text ? text : fmt::format("{} of {} runs: {}", alike.size(), runs, text);
  }
  if (!is_of_all || std::ranges::all_of(alike, &Event::is_default)) return std::nullopt;
  return has_one_text ? text : fmt::format("{} has no effect in any run", first.key);
}

}  // namespace

std::vector<std::string> texts_of(std::vector<std::vector<Event>> const& runs) {
  std::vector<std::string> texts;
  std::set<std::pair<EventKind, std::string>> told;
  for (std::vector<Event> const& run : runs) {
    for (Event const& candidate : run) {
      if (!told.emplace(candidate.kind, candidate.key).second) continue;
      std::vector<Event> alike;
      for (std::vector<Event> const& other : runs) {
        std::ranges::copy_if(other, std::back_inserter(alike), [&](Event const& event) {
          return event.kind == candidate.kind && event.key == candidate.key;
        });
      }
      if (auto text = text_of(alike, runs.size())) texts.push_back(*std::move(text));
    }
  }
  return texts;
}

}  // namespace gridlock
