#include "simulation/frame_schedule.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <sstream>
#include <utility>

#include "core/saturating.hpp"
#include "core/sorted.hpp"
#include "gridlock/core/error.hpp"
#include "simulation/decades.hpp"

namespace gridlock {

namespace {

/// Above 2⁵³ some whole numbers are not doubles.
constexpr double max_steps = 9007199254740992.0;

std::uint64_t whole_steps(double steps) {
  if (steps >= 0.0 && steps <= max_steps && steps == std::floor(steps)) return static_cast<std::uint64_t>(steps);
  throw Error({.what = fmt::format("{} is not a number of steps", steps),
               .hint = "use whole numbers, 0 or above",
               .key = "trajectory.steps"});
}

std::uint64_t steps_until(double time, double time_step) {
  // Rounding must not shift a time that is a multiple of the time step to the next step.
  double const steps = std::ceil(time / time_step * (1.0 - 1e-12));
  if (time >= 0.0 && steps <= max_steps) return static_cast<std::uint64_t>(steps);
  throw Error({.what = fmt::format("{} is not a time that a run with steps of {} reaches", time, time_step),
               .hint = "use times after the start of the run, 0 or above",
               .key = "trajectory.times"});
}

}  // namespace

void describe(TrajectorySettings& settings, SettingVisitor& visitor) {
  visitor.visit({.key = "every",
                 .unit = "steps",
                 .documentation = "Steps between frames of trajectory.h5; 0 for none, and no file where no frame is "
                                  "asked for."},
                settings.every);
  visitor.visit(
      {.key = "per_decade",
       .documentation = "Frames for each factor of ten in the number of steps, evenly in its logarithm; 0 for "
                        "none.",
       .max = 1000},
      settings.per_decade);
  visitor.visit(
      {.key = "origin_every",
       .unit = "steps",
       .documentation = "Steps after which the frames of per_decade begin anew, so that there are many origins of "
                        "displacements; 0 for one origin, the start."},
      settings.origin_every);
  visitor.visit({.key = "steps", .documentation = "Further frames, at these steps after the start of the run."},
                settings.steps);
  visitor.visit({.key = "times",
                 .unit = "time",
                 .documentation = "Further frames, at the first steps that reach these times after the start of the "
                                  "run."},
                settings.times);
  visitor.visit({.key = "columns",
                 .documentation = "What a frame holds besides the ids: names of columns between spaces, such as \"x y "
                                  "radius\", or \"all\"."},
                settings.columns);
  visitor.visit(
      {.key = "compression", .documentation = "From 0, none, over 1, the fastest, to 9, the smallest file.", .max = 9},
      settings.compression);
  visitor.visit({.key = "author", .documentation = "Whose trajectory it is, as the file says."}, settings.author);
}

std::vector<std::size_t> chosen_columns(std::vector<std::string_view> const& names, std::string const& columns) {
  std::vector<std::string> wanted;
  std::istringstream words(columns);
  for (std::string word; words >> word;) wanted.push_back(word);
  bool const is_all = columns == "all";
  for (std::string const& name : wanted) {
    if (is_all || std::ranges::count(names, name) > 0) continue;
    throw Error({.what = fmt::format("there is no column \"{}\"", name),
                 .hint = fmt::format("the columns are {}", fmt::join(names, ", ")),
                 .key = "trajectory.columns"});
  }
  std::vector<std::size_t> places;
  for (std::size_t place = 0; place < names.size(); ++place) {
    if (is_all || std::ranges::count(wanted, names[place]) > 0) places.push_back(place);
  }
  return places;
}

std::unique_ptr<FrameSource> with_columns(FrameSource const& frame, std::string const& columns) {
  std::vector<std::string_view> names;
  for (FrameColumn const& column : frame.columns()) names.emplace_back(column.name);
  return with_columns(frame, chosen_columns(names, columns));
}

FrameSchedule::FrameSchedule(TrajectorySettings const& settings, double time_step)
    : every_(settings.every), origin_every_(settings.origin_every) {
  if (origin_every_ > 0 && settings.per_decade == 0) {
    throw Error(
        {.what = fmt::format("there are origins every {} steps, but no frames that count from them", origin_every_),
         .hint = "set trajectory.per_decade too, for example to 10; trajectory.every is for frames even in time",
         .key = "trajectory.origin_every"});
  }
  steps_.push_back(0);
  for (double const steps : settings.steps) steps_.push_back(whole_steps(steps));
  for (double const time : settings.times) steps_.push_back(steps_until(time, time_step));
  if (settings.per_decade > 0) {
    if (origin_every_ > 0) after_origin_.push_back(0);
    double const most = origin_every_ > 0 ? static_cast<double>(origin_every_) : max_steps;
    double const share = 1.0 / static_cast<double>(settings.per_decade);
    for (double k = 0.0;; ++k) {
      double const steps = rounded_power_of_ten(k * share);
      if (!(steps < most)) break;
      (origin_every_ > 0 ? after_origin_ : steps_).push_back(static_cast<std::uint64_t>(steps));
    }
  }
  sort_and_drop_repeats(steps_);
  sort_and_drop_repeats(after_origin_);
}

bool FrameSchedule::is_due(std::uint64_t steps) const {
  if (every_ > 0 && steps % every_ == 0) return true;
  if (!after_origin_.empty() && std::ranges::binary_search(after_origin_, steps % origin_every_)) return true;
  return std::ranges::binary_search(steps_, steps);
}

std::uint64_t FrameSchedule::next_after(std::uint64_t steps) const {
  auto const named = std::ranges::upper_bound(steps_, steps);
  std::uint64_t next = named == steps_.end() ? never_reached : *named;
  if (every_ > 0) next = std::min(next, next_multiple(every_, steps));
  if (!after_origin_.empty()) {
    auto const after = std::ranges::upper_bound(after_origin_, steps % origin_every_);
    next = std::min(next, after == after_origin_.end() ? next_multiple(origin_every_, steps)
                                                       : steps - steps % origin_every_ + *after);
  }
  return next;
}

}  // namespace gridlock
