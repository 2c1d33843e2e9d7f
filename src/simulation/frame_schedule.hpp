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

/// Returns the indices of the requested columns in ascending order. Errors: Error under trajectory.columns for a name
/// that is not a column.
std::vector<std::size_t> chosen_columns(std::vector<std::string_view> const& names, std::string const& columns);

/// Returns a frame with Ids and the requested columns, in the frame's order. Errors: those of chosen_columns().
std::unique_ptr<FrameSource> with_columns(FrameSource const& frame, std::string const& columns);

/// The steps after the start of a run at which frames are due. They depend only on the settings, so that a resumed run
/// has the same frames as an uninterrupted one.
///
/// `every` n: 0, n, 2n …; p frames per decade: 0 and ⌊10^(k/p) + ½⌋ for k = 0, 1, 2 …, with origins every m steps those
/// below m after each multiple of m; a time t: the first step at or after t.
class FrameSchedule {
 public:
  /// Errors: Error under trajectory.steps or trajectory.times for an invalid step or time.
  FrameSchedule(TrajectorySettings const& settings, double time_step);

  [[nodiscard]] bool is_due(std::uint64_t steps) const;
  /// Returns the first due step after `steps`; `never_reached` if there is none.
  [[nodiscard]] std::uint64_t next_after(std::uint64_t steps) const;

 private:
  std::uint64_t every_;
  std::uint64_t origin_every_;
  std::vector<std::uint64_t> steps_;         ///< sorted, without multiples of every_
  std::vector<std::uint64_t> after_origin_;  ///< sorted, below origin_every_; empty if the start is the only origin
};

}  // namespace gridlock
