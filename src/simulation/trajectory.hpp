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

/// Writes the frames of a run to a file during the run.
///
/// A checkpoint contains no frames; the file itself lists its steps. A run that continues from an earlier step reaches
/// frames that exist already; these are kept, and their state hash must equal the run's.
class TrajectoryWriter final : public Writer {
 public:
  struct Origin {
    std::filesystem::path file;
    std::string configuration;
    std::string version;
    /// Returns the meanings of values 0, 1, 2 … of a column; none if they have no names.
    std::function<std::vector<std::string>(std::string_view column)> value_names;
  };

  /// The file is created at the first frame, or an existing one is continued. The extension of its name determines the
  /// format, one that runs can write.
  TrajectoryWriter(TrajectorySettings const& settings, double time_step, Origin origin);

  /// Opens the file of a restored run. Errors: Error if it is missing, damaged, or lacks a frame that was due at most
  /// `written_until` steps after the start, since continuing would leave a gap.
  void restore(Simulation const& simulation, std::uint64_t first_step, std::uint64_t written_until);

  [[nodiscard]] bool is_due(std::uint64_t steps) const override { return schedule_.is_due(steps); }
  [[nodiscard]] std::uint64_t next_after(std::uint64_t steps) const override { return schedule_.next_after(steps); }
  /// Errors: RunFailure if the file cannot be written or belongs to another run.
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
