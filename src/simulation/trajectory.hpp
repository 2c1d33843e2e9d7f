#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "gridlock/core/frame_source.hpp"
#include "gridlock/simulation/detail/trajectory_settings.hpp"
#include "gridlock/simulation/run.hpp"
#include "io/frame_format.hpp"
#include "simulation/frame_schedule.hpp"

namespace gridlock {

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
    /// Names that the model gives the numbers 0, 1, 2 … of a column; empty where they have none.
    std::function<std::vector<std::string>(std::string_view column)> value_names;
  };

  /// Begins the file at the first frame, or continues one that is there. Its name says in which format: one of those
  /// that runs can write.
  TrajectoryWriter(TrajectorySettings const& settings, double time_step, Origin origin);

  /// Opens the file of a run that was restored. Errors: Error where it is missing, damaged, or lacks a frame that was
  /// due up to the step `written_until` after the start: going on would leave it out without a word.
  void restore(Simulation const& simulation, std::uint64_t first_step, std::uint64_t written_until);

  [[nodiscard]] bool is_due(std::uint64_t steps) const override { return schedule_.is_due(steps); }
  [[nodiscard]] std::uint64_t next_after(std::uint64_t steps) const override { return schedule_.next_after(steps); }
  /// Errors: RunFailure where the file cannot be written or holds another run.
  void write(Simulation const& simulation, std::span<double const> sample) override;
  void serialize(Archive&) override {}

 private:
  void restore(FrameSource const& frame, std::uint64_t first_step, std::uint64_t written_until);
  void open(Simulation const& simulation, FrameSource const& frame);
  void write(Simulation const& simulation, FrameSource const& frame, std::uint64_t state_hash,
             std::span<double const> sample);

  TrajectorySettings settings_;
  FrameSchedule schedule_;
  Origin origin_;
  FrameFormat const& format_;
  std::unique_ptr<FrameWriter> writer_;
};

}  // namespace gridlock
