#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "gridlock/core/setting.hpp"

namespace gridlock {

/// The settings `[trajectory]`: a trajectory has the start and the frames of all these schedules; no schedule, no
/// frames.
struct TrajectorySettings {
  std::uint64_t every = 0;         ///< steps between frames; 0 for none
  std::uint64_t per_decade = 0;    ///< frames for each factor of ten in the number of steps; 0 for none
  std::uint64_t origin_every = 0;  ///< steps between the time origins from which per_decade counts; 0: only the start
  std::vector<double> steps;       ///< steps with a frame, whole numbers
  std::vector<double> times;
  std::string columns = "all";    ///< names of columns between spaces, or "all"
  std::uint64_t compression = 1;  ///< of the file, 0: none, 1: fastest … 9: smallest
  std::string author;

  [[nodiscard]] bool has_frames() const { return every > 0 || per_decade > 0 || !steps.empty() || !times.empty(); }
};
void describe(TrajectorySettings& settings, SettingVisitor& visitor);

}  // namespace gridlock
