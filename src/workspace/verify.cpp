#include "gridlock/workspace/verify.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <system_error>
#include <utility>

#include "gridlock/core/error.hpp"
#include "gridlock/core/random.hpp"
#include "gridlock/core/target.hpp"
#include "gridlock/core/version.hpp"
#include "gridlock/io/h5md.hpp"
#include "gridlock/workspace/run_directory.hpp"
#include "io/checkpoint_file.hpp"
#include "io/file.hpp"
#include "simulation/settings_difference.hpp"
#include "workspace/continued_run.hpp"
#include "workspace/hash_chain.hpp"
#include "workspace/replay.hpp"
#include "workspace/summary.hpp"

namespace gridlock {

namespace {

namespace fs = std::filesystem;

std::string configuration_in(fs::path const& file) {
  checkpoint::File const saved(checkpoint::bytes_of_file(file));
  return saved.text(saved.at("configuration", checkpoint::File::Kind::text));
}

/// Returns what differs between the settings of the run, of which its other files have copies, and config.resolved.toml
/// now: "run.seed 1 → 2"; empty if no copy differs.
std::string changed_setting(fs::path const& directory, std::string const& now) {
  std::vector<std::function<std::string()>> copies;
  std::vector<fs::path> checkpoints{directory / "checkpoint.gridlock"};
  std::error_code error;
  for (fs::directory_iterator state(directory / states_name, error); !error && state != fs::directory_iterator();
       state.increment(error)) {
    checkpoints.push_back(state->path() / "checkpoint.gridlock");
  }
  for (fs::path const& file : checkpoints) {
    copies.emplace_back([file] { return configuration_in(file); });
  }
  copies.emplace_back([&] { return H5mdReader(directory / "trajectory.h5").settings().configuration; });
  for (auto const& copy : copies) {
    try {
      auto const difference =
          find_difference(setting_texts(copy(), "the run"), setting_texts(now, configuration_name), {});
      if (!difference) continue;
      auto const shown = [](std::string const& value) { return value.empty() ? "left out" : value; };
      return fmt::format("{} {} → {}", difference->key, shown(difference->here), shown(difference->there));
    } catch (Error const&) {
      // This copy is missing or damaged.
    }
  }
  return "";
}

/// Returns where the copy of the settings in the trajectory differs from those of the run; empty if they agree or there
/// is no trajectory. The copy has the length that the run had at first.
std::string difference_in_trajectory(fs::path const& directory, std::string const& settings) {
  fs::path const file = directory / "trajectory.h5";
  std::error_code ignored;
  if (!fs::exists(file, ignored)) return "";
  auto const difference = find_difference(setting_texts(H5mdReader(file).settings().configuration, file.string()),
                                          setting_texts(settings, configuration_name), settings_of_length());
  return difference ? "the settings differ: " + to_text(*difference, "trajectory.h5", configuration_name) : "";
}

Error changed_input(fs::path const& file, std::string const& what) {
  return Error({.what = fmt::format("{} was changed since the run{}{}", file.string(), what.empty() ? "" : ": ", what),
                .hint = "put back a copy of the file; a run of changed inputs is another run",
                .file = file.string()});
}

HashLink const& link_of(std::vector<HashLink> const& links, std::string_view of, fs::path const& directory) {
  auto const found = std::ranges::find(links, of, &HashLink::of);
  if (found != links.end()) return *found;
  fs::path const file = directory / hashes_name;
  throw Error({.what = fmt::format("{} is damaged: it has no line of \"{}\"", file.string(), of),
               .hint = "put back a copy of the file; without it the run cannot be verified",
               .file = file.string()});
}

/// Throws an Error for a directory whose run cannot be verified now.
void require_verifiable(fs::path const& directory) {
  require_run(directory);
  if (DirectoryLock::is_held(directory)) {
    throw Error({.what = fmt::format("a process works on the run in {}", directory.string()),
                 .hint = "verify it when the run has ended, or stop the run first"});
  }
  std::error_code ignored;
  if (fs::exists(directory / hashes_name, ignored)) return;
  throw Error(
      {.what = fmt::format("the run in {} has recorded no hashes: there is no {}", directory.string(), hashes_name),
       .hint = "a run records them at its first checkpoint and at its end; earlier versions recorded none"});
}

/// Returns the states that the run has kept and nobody has removed.
std::vector<HashLink> kept_states(std::vector<HashLink> const& links, fs::path const& directory) {
  std::vector<HashLink> states;
  std::ranges::copy_if(links, std::back_inserter(states), [&](HashLink const& link) {
    std::error_code ignored;
    return link.of == "state" && fs::exists(directory_of_state(directory, link.step), ignored);
  });
  return states;
}

/// Returns some of the states that a later hash follows, chosen at random, in the order of their steps.
std::vector<HashLink> chosen_states(std::vector<HashLink> const& links, fs::path const& directory,
                                    VerifyOptions const& options) {
  std::vector<HashLink> states = kept_states(links, directory);
  std::erase_if(states, [&](HashLink const& state) { return state.step >= links.back().step; });
  if (states.empty()) {
    throw Error({.what = fmt::format("the run in {} has kept no states, so only the whole run can be replayed",
                                     directory.string()),
                 .hint = "leave out --windows, in Python windows; checkpoint.keep_states = 100 keeps states of a run"});
  }
  RandomStream random(options.seed, 0, 0, purpose_of_turn(0));
  std::size_t const count = std::min<std::size_t>(options.windows, states.size());
  for (std::size_t k = 0; k < count; ++k) std::swap(states[k], states[k + random.below(states.size() - k)]);
  states.resize(count);
  std::ranges::sort(states, {}, &HashLink::step);
  return states;
}

/// Compares the end of the chain with the summary, which has the same hash.
void compare_summary(HashLink const& end, RunSummary const& summary, Verification& found) {
  if (summary.status != RunStatus::finished || (end.of == "end" && end.hash == summary.state_hash)) return;
  if (end.of != "end") {
    found.difference = fmt::format("{} ends with step {}, and {} says that the run has finished: lines are missing",
                                   hashes_name, end.step, summary_name);
    return;
  }
  found.difference = fmt::format("the state_hash in {} is {:016x}, and the last in {} is {:016x}", summary_name,
                                 summary.state_hash, hashes_name, end.hash);
}

void replay(Replay& again, std::vector<HashLink> const& links, Verification& found, VerifyOptions const& options) {
  if (options.windows == 0) {
    if (!again.replay_all(options.on_progress)) return;
    for (HashLink const& state : kept_states(links, found.directory)) {
      if (!again.restore(state)) return;
    }
    return;
  }
  std::vector<HashLink> const states = chosen_states(links, found.directory, options);
  for (HashLink const& state : states) {
    double const before = static_cast<double>(found.windows) / static_cast<double>(states.size());
    auto const show = [&](double fraction) {
      if (options.on_progress) options.on_progress(before + fraction / static_cast<double>(states.size()));
    };
    if (!again.replay_window(state, options.window_steps.value_or(0), show)) return;
    ++found.windows;
  }
}

}  // namespace

Verification verify_run(fs::path const& directory, VerifyOptions const& options) {
  require_verifiable(directory);
  Verification found{.directory = directory, .version = version(), .target = to_text(target())};
  if (std::string const line = find_changed_line(directory / hashes_name); !line.empty()) {
    found.difference = fmt::format("{} of {} was changed since the run", line, hashes_name);
    return found;
  }
  std::vector<HashLink> const links = read_hashes(directory / hashes_name);
  found.first_step = links.front().step;
  found.last_step = links.back().step;
  found.is_finished = links.back().of == "end";
  if (auto const summary = read_summary(directory)) {
    compare_summary(links.back(), *summary, found);
    found.recorded_version = summary->version;
    found.recorded_target = summary->target;
  }
  if (!found.difference.empty()) return found;
  fs::path const file = directory / configuration_name;
  std::string const settings = read_file(file);
  if (hash_of_settings(settings) != link_of(links, "settings", directory).hash) {
    throw changed_input(file, changed_setting(directory, settings));
  }
  found.difference = difference_in_trajectory(directory, settings);
  if (!found.difference.empty()) return found;
  Setup setup = set_up(SettingsFile::from_path(file), {.threads = options.threads});
  HashLink const& start = link_of(links, "start", directory);
  bool const has_same_start = setup.simulation->state_hash() == start.hash;
  if (!has_same_start && !setup.start_file.empty()) throw changed_input(setup.start_file, "");
  if (!has_same_start) {
    found.difference = fmt::format("the start of step {}: the state hash is {:016x}, and the run recorded {:016x}",
                                   start.step, setup.simulation->state_hash(), start.hash);
    return found;
  }
  ++found.hashes;
  Replay again(directory, setup, links, found);
  replay(again, links, found, options);
  return found;
}

std::string to_text(Verification const& found) {
  std::string const with =
      fmt::format("with {} by gridlock {}{}", found.target, found.version,
                  found.recorded_version.empty()
                      ? ""
                      : fmt::format("; recorded with {} by {}", found.recorded_target, found.recorded_version));
  std::string const directory = found.directory.string();
  if (!found.difference.empty()) return fmt::format("differs: {}: {} ({})", directory, found.difference, with);
  auto const count = [](std::size_t number, char const* noun) {
    return fmt::format("{} {}{}", number, noun, number == 1 ? "" : "s");
  };
  std::string agree = found.hashes == 1 ? "1 hash" : fmt::format("{} hashes", found.hashes);
  if (found.states > 0) agree += ", " + count(found.states, "kept state");
  if (found.frames > 0) agree += ", " + count(found.frames, "frame");
  if (found.results > 0) agree += ", " + count(found.results, "file") + " of results";
  std::string const steps = found.last_step > found.first_step
                                ? fmt::format("steps {} to {}", found.first_step, found.last_step)
                                : std::string("the start and the stages of its protocol");
  std::string const what =
      found.windows > 0
          ? fmt::format("{} with {} of its {} steps", count(found.windows, "window"), found.steps,
                        found.last_step - found.first_step)
          : fmt::format("{}{}", steps, found.is_finished ? "" : ", as far as the unfinished run is recorded");
  return fmt::format("verified: {}: {}: {} agree bit for bit, {}", directory, what, agree, with);
}

}  // namespace gridlock
