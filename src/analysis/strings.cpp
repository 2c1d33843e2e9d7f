#include "gridlock/analysis/strings.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "analysis/lags.hpp"
#include "analysis/trajectory.hpp"
#include "gridlock/grid/neighbour_lists.hpp"
#include "gridlock/observe/clusters.hpp"

namespace gridlock {

namespace {

/// Returns the agents that have moved farthest from one frame to another; of two that moved as far, the first.
Agents mobile_agents(TrajectoryInMemory const& trajectory, std::size_t first, std::size_t second, std::size_t count) {
  PointsInMemory const before = points_of(trajectory, first);
  PointsInMemory const after = points_of(trajectory, second);
  std::vector<double> squares(trajectory.agents);
  for (std::size_t i = 0; i < trajectory.agents; ++i) {
    squares[i] = squared_length({after.x[2 * i] - before.x[2 * i], after.y[2 * i] - before.y[2 * i]});
  }
  Agents order(trajectory.agents);
  std::iota(order.begin(), order.end(), 0U);
  auto const moved_farther = [&](std::uint32_t i, std::uint32_t j) {
    return squares[i] > squares[j] || (i < j && squares[i] == squares[j]);
  };
  std::ranges::nth_element(order, order.begin() + static_cast<std::ptrdiff_t>(count - 1), moved_farther);
  order.resize(count);
  return order;
}

/// Returns the number of agents of each string.
std::vector<std::uint64_t> lengths_of_strings(TrajectoryInMemory const& trajectory, StringSettings const& settings,
                                              std::size_t first, std::size_t second, std::size_t mobile) {
  // The points of both frames; a pair of one of the first frame and another of the second one joins two agents.
  std::vector<double> x, y;
  Agents const agents = mobile_agents(trajectory, first, second, mobile);
  for (std::size_t const frame : {first, second}) {
    PointsInMemory const points = points_of(trajectory, frame);
    for (std::size_t const i : agents) {
      x.push_back(points.x[points.stride * i]);
      y.push_back(points.y[points.stride * i]);
    }
  }
  PointsInMemory const both{.x = x.data(), .y = y.data(), .count = x.size()};
  PointPairs const pairs =
      settings.box ? find_pairs(*settings.box, settings.distance, both) : find_pairs(settings.distance, both);
  Agents i, j;
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    auto const [before, after] = std::minmax(pairs.first()[k], pairs.second()[k]);
    if (before >= mobile || after < mobile || after - mobile == before) continue;
    i.push_back(before);
    j.push_back(after - static_cast<std::uint32_t>(mobile));
  }
  return sizes_of_clusters(cluster_of_each(mobile, i, j));
}

StringsAtLag strings_at(TrajectoryInMemory const& trajectory, StringSettings const& settings, FramesOfLag const& frames,
                        std::size_t mobile) {
  std::vector<bool> const independent = independent_pairs(frames, trajectory.times);
  StringsAtLag result{.lag = frames.lag(),
                      .origins = frames.size(),
                      .independent_origins = static_cast<std::uint64_t>(std::ranges::count(independent, true))};
  std::vector<double> means, weighted;
  for (std::size_t k = 0; k < frames.size(); ++k) {
    auto const [first, second] = frames[k];
    double squares = 0.0;
    std::vector<std::uint64_t> const lengths = lengths_of_strings(trajectory, settings, first, second, mobile);
    for (std::uint64_t const length : lengths) {
      if (length > result.strings.size()) result.strings.resize(length, 0.0);
      result.strings[length - 1] += 1.0;
      squares += static_cast<double>(length) * static_cast<double>(length);
    }
    means.push_back(static_cast<double>(mobile) / static_cast<double>(lengths.size()));
    weighted.push_back(squares / static_cast<double>(mobile));
  }
  for (double& strings : result.strings) strings /= static_cast<double>(frames.size());
  result.mean_length = mean_over_origins(means, independent);
  result.weighted_length = mean_over_origins(weighted, independent);
  return result;
}

}  // namespace

Strings find_strings(TrajectoryInMemory const& trajectory, StringSettings const& settings) {
  require_trajectory(trajectory);
  if (!(settings.mobile_share > 0.0) || !(settings.mobile_share <= 1.0)) {
    throw Error({.what = fmt::format("the share of mobile agents is {}", settings.mobile_share),
                 .hint = "use a number above 0 and at most 1; 0.05 is usual"});
  }
  auto const wanted = std::llround(settings.mobile_share * static_cast<double>(trajectory.agents));
  std::size_t const mobile = std::max<std::size_t>(1, static_cast<std::size_t>(wanted));
  Strings result{.mobile_agents = mobile, .lags = {}};
  std::vector<FramesOfLag> const lags = lags_between(trajectory.times, 0);
  for (double const lag : settings.lags) {
    result.lags.push_back(
        strings_at(trajectory, settings, frames_nearest(lags, trajectory.times, lag, settings.max_origins), mobile));
  }
  return result;
}

}  // namespace gridlock
