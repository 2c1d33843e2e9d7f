#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "gridlock/core/frame.hpp"
#include "gridlock/io/h5md.hpp"
#include "gridlock/simulation/detail/trajectory_settings.hpp"
#include "gridlock/simulation/run.hpp"

namespace gridlock {

/// The frame with the columns asked for only, in its own order; the Ids always stay.
/// Errors: Error under trajectory.columns for a name that is no column.
Frame with_columns(Frame frame, std::string const& columns);

/// The steps after the start of a run at which frames are due; a function of the settings alone, so that a run that is
/// resumed has the frames of one that was never interrupted.
///
/// every n: 0, n, 2n …; p frames per decade: 0 and ⌊10^(k/p) + ½⌋ for k = 0, 1, 2 …, with origins every m steps those below m
/// after each multiple of m; a time t: the first step at or after.
class FrameSchedule {
 public:
  /// Errors: Error under trajectory.steps or trajectory.times for what is no step or time.
  FrameSchedule(TrajectorySettings const& settings, double time_step);

  [[nodiscard]] bool is_due(std::uint64_t steps) const;
  /// The next step after `steps`; `never_reached` where there is none.
  [[nodiscard]] std::uint64_t next_after(std::uint64_t steps) const;

 private:
  std::uint64_t every_;
  std::uint64_t origin_every_;
  std::vector<std::uint64_t> steps_;         ///< sorted, those of every_ left out
  std::vector<std::uint64_t> after_origin_;  ///< sorted, below origin_every_; none where the start is the only origin
};

/// Writes the frames of a run into a file while it runs.
///
/// Nothing of it is in a checkpoint: the file itself says which frames it holds. A run that continues from an earlier
/// step comes by frames that are there already; they stay, and their state hash must be the one of the run.
class TrajectoryWriter final : public Writer {
 public:
  struct Origin {
    std::filesystem::path file;
    std::string configuration;
    std::string version;
  };

  /// Begins the file at the first frame, or continues one that is there.
  TrajectoryWriter(TrajectorySettings const& settings, double time_step, Origin origin);

  /// Opens the file of a run that was restored. Errors: Error where it is missing, damaged, or lacks a frame that was due
  /// up to the step `written_until` after the start: going on would leave it out without a word.
  void restore(Simulation const& simulation, std::uint64_t first_step, std::uint64_t written_until);

  [[nodiscard]] bool is_due(std::uint64_t steps) const override { return schedule_.is_due(steps); }
  [[nodiscard]] std::uint64_t next_after(std::uint64_t steps) const override { return schedule_.next_after(steps); }
  /// Errors: RunFailure where the file cannot be written or holds another run.
  void write(Simulation const& simulation, std::span<double const> sample) override;
  void serialize(Archive&) override {}

 private:
  void open(Simulation const& simulation, Frame const& frame);

  TrajectorySettings settings_;
  FrameSchedule schedule_;
  Origin origin_;
  std::optional<H5mdWriter> writer_;
};

}  // namespace gridlock
