#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "gridlock/core/setting.hpp"

namespace gridlock {

/// The settings `[trajectory]`: the frames are those of all schedules together, and the start; none without a schedule.
struct TrajectorySettings {
  std::uint64_t every = 0;         ///< steps between frames; 0 for none
  std::uint64_t per_decade = 0;    ///< frames for each factor of ten in the number of steps; 0 for none
  std::uint64_t origin_every = 0;  ///< steps between the steps from which per_decade counts; 0: from the start alone
  std::vector<double> steps;       ///< whole numbers
  std::vector<double> times;
  std::string columns = "all";    ///< words between spaces
  std::uint64_t compression = 1;  ///< 0: none, 1: fastest … 9: smallest
  std::string author;

  [[nodiscard]] bool has_frames() const { return every > 0 || per_decade > 0 || !steps.empty() || !times.empty(); }
};
void describe(TrajectorySettings& settings, SettingVisitor& visitor);

}  // namespace gridlock
