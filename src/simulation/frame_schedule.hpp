#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "gridlock/core/frame_source.hpp"
#include "gridlock/simulation/detail/trajectory_settings.hpp"

namespace gridlock {

/// The places of the columns asked for, in increasing order. Errors: Error under trajectory.columns for a name that is
/// no column.
std::vector<std::size_t> chosen_columns(std::vector<std::string_view> const& names, std::string const& columns);

/// The frame with the columns asked for only, in its own order; the Ids always stay. Errors: those of chosen_columns().
std::unique_ptr<FrameSource> with_columns(FrameSource const& frame, std::string const& columns);

/// The steps after the start of a run at which frames are due; a function of the settings alone, so that a run that is
/// resumed has the frames of one that was never interrupted.
///
/// every n: 0, n, 2n …; p frames per decade: 0 and ⌊10^(k/p) + ½⌋ for k = 0, 1, 2 …, with origins every m steps those
/// below m after each multiple of m; a time t: the first step at or after.
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

}  // namespace gridlock
