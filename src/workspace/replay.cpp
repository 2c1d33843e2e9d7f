#include "workspace/replay.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <system_error>
#include <utility>
#include <variant>

#include "gridlock/core/error.hpp"
#include "gridlock/core/world.hpp"
#include "io/checkpoint.hpp"
#include "io/field_file.hpp"
#include "io/network_file.hpp"
#include "io/xyz_writer.hpp"
#include "workspace/result_differences.hpp"
#include "workspace/run_results.hpp"
#include "workspace/summary.hpp"

namespace gridlock {

namespace {

/// Returns whether the hash was recorded during the run, at a step of its clock.
bool is_of_step(HashLink const& link) { return link.of == "run" || link.of == "state"; }

/// Returns the first row in which the values of two columns differ in any bit; nothing if there is none.
std::optional<std::size_t> different_row(FrameValues const& one, FrameValues const& two) {
  return std::visit(
      [](auto const& a, auto const& b) -> std::optional<std::size_t> {
        auto const [at, other] =
            std::ranges::mismatch(a, b, [](auto left, auto right) { return word_of(left) == word_of(right); });
        if (at == a.end() && other == b.end()) return std::nullopt;
        return static_cast<std::size_t>(at - a.begin());
      },
      one, two);
}

std::string value_text(FrameValues const& values, std::size_t row) {
  return std::visit([&](auto const& numbers) { return fmt::format("{}", numbers[row]); }, values);
}

/// Returns the first difference of two frames with the same columns; empty if there is none.
std::string first_difference(Frame const& file, Frame const& replay) {
  if (file.ids != replay.ids) {
    auto const [at, other] = std::ranges::mismatch(file.ids, replay.ids);
    return fmt::format("{} agents, first another Id in row {}, where the replay has {} agents", file.size(),
                       at - file.ids.begin(), replay.size());
  }
  for (FrameColumn const& column : file.columns) {
    FrameColumn const* const same = replay.find(column.name);
    if (same == nullptr) return fmt::format("a column {}, which the replay has not", column.name);
    std::optional<std::size_t> const row = different_row(column.values, same->values);
    if (!row) continue;
    return fmt::format("{} = {} for agent {}, where the replay has {}", column.name, value_text(column.values, *row),
                       file.ids[*row], value_text(same->values, *row));
  }
  bool const has_same_box = file.box == replay.box && word_of(file.clock.time) == word_of(replay.clock.time);
  if (!has_same_box) return "another box or time than the replay";
  std::string difference = difference_of_fields(file.fields, replay.fields);
  return difference.empty() ? difference_of_networks(file.networks, replay.networks) : difference;
}

}  // namespace

Replay::Replay(std::filesystem::path const& directory, Setup const& setup, std::span<HashLink const> links,
               Verification& found)
    : directory_(directory),
      setup_(setup),
      simulation_(*setup.simulation),
      run_(simulation_, plan_of(setup)),
      schedule_(setup.configuration.trajectory, simulation_.time_step()),
      links_(links),
      found_(found) {
  run_.add(sample_);
  std::error_code ignored;
  std::filesystem::path const trajectory = directory / "trajectory.h5";
  if (std::filesystem::exists(trajectory, ignored)) trajectory_.emplace(trajectory);
}

bool Replay::differ(std::string difference) {
  found_.difference = std::move(difference);
  return false;
}

bool Replay::compare(HashLink const& link, std::uint64_t hash) {
  if (hash == link.hash) {
    ++found_.hashes;
    known_step_ = link.step;
    return true;
  }
  std::string const place =
      is_of_step(link) || link.of == "end"
          ? fmt::format("step {} agrees, and the next that is recorded, {}, differs", known_step_, link.step)
          : fmt::format("the first difference is in {}", link.of);
  return differ(fmt::format("{}: the state hash is {:016x}, and the run recorded {:016x}", place, hash, link.hash));
}

std::string Replay::difference_of_frame(std::size_t frame, std::uint64_t hash) const {
  try {
    H5mdFrame const recorded = trajectory_->frame(frame);
    Frame present;
    simulation_.give_frame(
        [&](FrameSource const& all) { present = with_columns(all, setup_.configuration.trajectory.columns)->whole(); });
    std::string difference = first_difference(recorded.frame, present);
    if (difference.empty()) difference = difference_of_observables(recorded.observables);
    if (!difference.empty() || recorded.state_hash == hash) return difference;
    return fmt::format("the state hash {:016x}, where the replay has {:016x}", recorded.state_hash, hash);
  } catch (Error const& error) {
    return fmt::format("damage: {}", error.problems().front().what);
  }
}

/// Compares the observables of a frame with the sample of its step. Those of another program are left out.
std::string Replay::difference_of_observables(std::vector<double> const& recorded) const {
  if (!sample_.values()) return "";
  std::vector<ColumnInfo> const columns = simulation_.columns();
  std::vector<H5mdObservable> const& names = trajectory_->settings().observables;
  for (std::size_t k = 0; k < columns.size(); ++k) {
    auto const place = std::ranges::find(names, columns[k].name, &H5mdObservable::name);
    if (place == names.end()) return fmt::format("no observable {}, which the replay has", columns[k].name);
    double const value = sample_.values()->empty() ? no_value : (*sample_.values())[k];
    double const in_file = recorded[static_cast<std::size_t>(place - names.begin())];
    if (is_same_number(in_file, value)) continue;
    return fmt::format("{} = {}, where the replay has {}", columns[k].name, in_file, value);
  }
  return "";
}

std::set<std::uint64_t> Replay::frames_between(std::uint64_t first, std::uint64_t last) const {
  std::set<std::uint64_t> steps;
  if (!trajectory_) return steps;
  for (Clock const& clock : trajectory_->clocks()) {
    if (clock.step >= first && clock.step <= last) steps.insert(clock.step);
  }
  std::uint64_t const start = links_.front().step;
  if (is_frame_due(first)) steps.insert(first);
  for (std::uint64_t due = schedule_.next_after(first - start); due <= last - start; due = schedule_.next_after(due)) {
    steps.insert(start + due);
  }
  return steps;
}

bool Replay::is_frame_due(std::uint64_t step) const {
  return setup_.configuration.trajectory.has_frames() && schedule_.is_due(step - links_.front().step);
}

bool Replay::compare_frame(std::uint64_t step, std::uint64_t hash) {
  std::span<Clock const> const clocks = trajectory_->clocks();
  auto const clock = std::ranges::find(clocks, step, &Clock::step);
  if (clock == clocks.end()) return differ(fmt::format("trajectory.h5 has no frame of step {}", step));
  if (!is_frame_due(step)) return differ(fmt::format("trajectory.h5 has a frame of step {}, where none is due", step));
  auto const frame = static_cast<std::size_t>(clock - clocks.begin());
  std::string const difference = difference_of_frame(frame, hash);
  if (!difference.empty())
    return differ(fmt::format("frame {} of trajectory.h5, of step {}, has {}", frame, step, difference));
  ++found_.frames;
  known_step_ = step;
  return true;
}

/// Carries on with the run to a step, with its samples. Errors: RunFailure where the run fails.
void Replay::advance_run_to(std::uint64_t step) {
  if (run_.advance_to(step) == RunStatus::failed) throw RunFailure(run_.record().failure);
}

/// Advances to a step with stops at all links and frames up to it.
bool Replay::advance_to(std::uint64_t step, std::function<void(double)> const& on_progress) {
  std::uint64_t const from = simulation_.clock().step;
  std::set<std::uint64_t> const frames = frames_between(from, step);
  std::set<std::uint64_t> stops{step};
  stops.insert(frames.begin(), frames.end());
  for (HashLink const& link : links_) {
    if (is_of_step(link) && link.step >= from && link.step <= step) stops.insert(link.step);
  }
  for (std::uint64_t const stop : stops) {
    advance_run_to(stop);
    std::uint64_t const hash = simulation_.state_hash();
    if (frames.contains(stop) && !compare_frame(stop, hash)) return false;
    for (HashLink const& link : links_) {
      if (is_of_step(link) && link.step == stop && !compare(link, hash)) return false;
    }
    if (on_progress && step > from) on_progress(static_cast<double>(stop - from) / static_cast<double>(step - from));
  }
  found_.steps += step - from;
  return true;
}

/// Carries out the protocol up to the last stage that the run has recorded, and compares the disks after each stage.
bool Replay::prepare() {
  std::vector<HashLink> stages;
  for (HashLink const& link : links_) {
    if (link.of.starts_with("stage ")) stages.push_back(link);
  }
  std::size_t compared = 0;
  bool is_same = true;
  auto const compare_stages = [&] {
    std::vector<std::uint64_t> const hashes = simulation_.preparation().state_hashes;
    for (; is_same && compared < std::min(hashes.size(), stages.size()); ++compared) {
      is_same = compare(stages[compared], hashes[compared]);
    }
    return is_same && compared < stages.size();
  };
  simulation_.prepare(compare_stages);
  compare_stages();
  return is_same;
}

bool Replay::advance_to_end(HashLink const& end) {
  advance_run_to(never_reached);
  return compare(end, simulation_.state_hash());
}

/// Compares the results of the whole run, as far as their files are there.
bool Replay::compare_results() {
  RunRecord const record = run_.record();
  auto const agrees = [&](std::string const& name,
                          std::function<std::string(std::filesystem::path const&)> const& find) {
    std::error_code ignored;
    std::filesystem::path const file = directory_ / name;
    if (!std::filesystem::exists(file, ignored)) return true;
    if (std::string difference = find(file); !difference.empty()) return differ(std::move(difference));
    ++found_.results;
    return true;
  };
  for (auto const& named : result_tables(record)) {
    if (!agrees(named.first, [&](auto const& file) { return difference_of_table(file, named.second); })) return false;
  }
  bool is_same = true;
  simulation_.give_frame([&](FrameSource const& frame) {
    std::string const summary = summary_text("", setup_.configuration, links_[1].hash, record, frame, {});
    is_same =
        agrees("final.xyz", [&](auto const& file) { return difference_of_text(file, xyz_text(frame)); }) &&
        agrees(final_fields_name,
               [&](auto const& file) {
                 std::string difference = difference_of_fields(read_fields(file), frame.fields());
                 return difference.empty() ? difference : fmt::format("{} has {}", final_fields_name, difference);
               }) &&
        agrees(final_networks_name,
               [&](auto const& file) {
                 std::string difference = difference_of_networks(read_networks(file), frame.networks());
                 return difference.empty() ? difference : fmt::format("{} has {}", final_networks_name, difference);
               }) &&
        agrees(summary_name, [&](auto const& file) { return difference_of_summary(file, summary); });
  });
  return is_same;
}

bool Replay::replay_all(std::function<void(double)> const& on_progress) {
  known_step_ = links_.front().step;
  if (!prepare()) return false;
  if (simulation_.is_prepared() && !advance_to(links_.back().step, on_progress)) return false;
  return links_.back().of != "end" || (advance_to_end(links_.back()) && compare_results());
}

bool Replay::restore(HashLink const& state) {
  std::filesystem::path const directory = directory_of_state(directory_, state.step);
  try {
    auto const restored = restore_checkpoint(directory, [&](Archive& archive) {
      serialize_inside(archive, "simulation", [&] { simulation_.serialize(archive); });
    });
    if (!restored) return differ(fmt::format("the kept state {} is missing", directory.string()));
    simulation_.take_restored();
    run_.continue_from_here();
    sample_.forget();  // a kept state has what observables remember, but not the sample of its step
  } catch (Error const& error) {
    return differ(fmt::format("the kept state of step {}: {}", state.step, error.problems().front().what));
  }
  std::uint64_t const hash = simulation_.state_hash();
  if (hash != state.hash) {
    return differ(fmt::format("the kept state of step {} has the hash {:016x}, and the run recorded {:016x}",
                              state.step, hash, state.hash));
  }
  ++found_.states;
  known_step_ = state.step;
  return true;
}

bool Replay::replay_window(HashLink const& state, std::uint64_t steps, std::function<void(double)> const& on_progress) {
  if (!restore(state)) return false;
  std::uint64_t target = state.step;
  for (HashLink const& link : links_) {
    bool const is_later = link.step > state.step && (is_of_step(link) || link.of == "end");
    if (is_later && (target == state.step || link.step - state.step <= steps)) target = link.step;
  }
  if (!advance_to(target, on_progress)) return false;
  bool const is_at_end = links_.back().of == "end" && links_.back().step == target;
  return !is_at_end || advance_to_end(links_.back());
}

}  // namespace gridlock
