#include "simulation/trajectory.hpp"

#include <fmt/format.h>

#include <memory>
#include <utility>

#include "gridlock/core/error.hpp"
#include "simulation/settings_difference.hpp"

namespace gridlock {

TrajectoryWriter::TrajectoryWriter(TrajectorySettings const& settings, double time_step, Origin origin)
    : settings_(settings),
      schedule_(settings, time_step),
      origin_(std::move(origin)),
      format_(frame_format_of_run(origin_.file)) {}

void TrajectoryWriter::open(Simulation const& simulation, FrameSource const& frame) {
  std::error_code ignored;
  if (std::filesystem::exists(origin_.file, ignored)) {
    try {
      writer_ = format_.append(origin_.file, frame);
    } catch (Error const& error) {
      throw RunFailure(error.what());
    }
    return;
  }
  H5mdSettings header{.configuration = origin_.configuration,
                      .version = origin_.version,
                      .author = settings_.author,
                      .compression = settings_.compression,
                      .contacts = simulation.contacts()};
  for (ColumnInfo const& column : simulation.columns()) header.observables.push_back({column.name, column.unit});
  for (FrameColumn const& column : frame.columns()) {
    std::vector<std::string> names = origin_.value_names(column.name);
    if (!names.empty()) header.value_names.emplace(column.name, std::move(names));
  }
  writer_ = format_.create(origin_.file, header);
}

void TrajectoryWriter::restore(Simulation const& simulation, std::uint64_t first_step, std::uint64_t written_until) {
  simulation.give_frame([&](FrameSource const& frame) { restore(frame, first_step, written_until); });
}

void TrajectoryWriter::restore(FrameSource const& frame, std::uint64_t first_step, std::uint64_t written_until) {
  auto const refuse = [&](std::string const& what) {
    throw Error({.what = what,
                 .hint = "put the whole file back, or run config.resolved.toml again in another directory",
                 .file = origin_.file.string()});
  };
  std::error_code ignored;
  if (!std::filesystem::exists(origin_.file, ignored)) {
    refuse(
        fmt::format("{} is missing: the frames of the first {} steps are lost", origin_.file.string(), written_until));
  }
  try {
    // The settings are compared first, since opening the file for writing changes it.
    auto const difference =
        find_difference(setting_texts(format_.configuration_of(origin_.file), "trajectory.h5"),
                        setting_texts(origin_.configuration, "config.resolved.toml"), settings_of_length());
    if (difference) {
      throw Error({.what = fmt::format("{} is of another run: {}", origin_.file.string(),
                                       to_text(*difference, "the trajectory", "config.resolved.toml"))});
    }
    writer_ = format_.append(origin_.file, *with_columns(frame, settings_.columns));
  } catch (Error const& error) {
    refuse(error.problems().front().what);
  }
  auto const last = writer_->last_step();
  if (!last || *last < first_step) refuse(fmt::format("{} lacks the frames of this run", origin_.file.string()));
  std::uint64_t const next = schedule_.next_after(*last - first_step);
  if (next > written_until) return;
  refuse(fmt::format("{} lacks frames: the last is of step {}, and the run has written one of step {}",
                     origin_.file.string(), *last, first_step + next));
}

void TrajectoryWriter::write(Simulation const& simulation, std::span<double const> sample) {
  std::uint64_t const state_hash = simulation.state_hash();
  simulation.give_frame(
      [&](FrameSource const& all) { write(simulation, *with_columns(all, settings_.columns), state_hash, sample); });
}

void TrajectoryWriter::write(Simulation const& simulation, FrameSource const& frame, std::uint64_t state_hash,
                             std::span<double const> sample) {
  Clock const clock = frame.clock();
  if (!writer_) open(simulation, frame);
  if (auto const last = writer_->last_step(); last && *last >= clock.step) {
    if (writer_->state_hash_at(clock.step) == state_hash) return;
    throw RunFailure(fmt::format("{} holds another run: its frames do not have the state of step {}",
                                 origin_.file.string(), clock.step));
  }
  std::vector<double> observables(sample.begin(), sample.end());
  if (observables.empty()) observables.assign(simulation.columns().size(), no_value);
  writer_->write(frame, observables, state_hash);
}

}  // namespace gridlock
