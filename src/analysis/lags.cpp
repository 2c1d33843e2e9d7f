#include "analysis/lags.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "gridlock/core/error.hpp"

namespace gridlock {

namespace {

/// Largest number of frames at uneven times; with more, the pairs of frames would take more than 256 MiB.
constexpr std::size_t max_uneven_frames = 8192;

/// Returns the shortest time between frames. Errors: as lags_between().
double shortest_gap(std::span<double const> times) {
  if (times.size() < 2) {
    throw Error(
        {.what = fmt::format("a trajectory of {} frames has no lag", times.size()), .hint = "use at least two frames"});
  }
  double shortest = std::numeric_limits<double>::infinity();
  for (std::size_t f = 1; f < times.size(); ++f) {
    double const gap = times[f] - times[f - 1];
    if (!(gap > 0.0) || !std::isfinite(gap)) {
      throw Error({.what = fmt::format("frame {} is at time {} and the one before at {}", f, times[f], times[f - 1]),
                   .hint = "times must be finite and ascend"});
    }
    shortest = std::min(shortest, gap);
  }
  return shortest;
}

bool are_even(std::span<double const> times, double tolerance) {
  double const gap = (times.back() - times.front()) / static_cast<double>(times.size() - 1);
  for (std::size_t f = 0; f < times.size(); ++f) {
    if (std::abs(times[f] - times.front() - static_cast<double>(f) * gap) > tolerance) return false;
  }
  return true;
}

/// Returns the indices of the lags, which ascend, that are nearest to values evenly spaced in the logarithm.
std::vector<std::size_t> chosen_lags(std::vector<double> const& lags, std::size_t most) {
  std::vector<std::size_t> chosen;
  double const ratio = lags.back() / lags.front();
  for (std::size_t k = 0; k < most; ++k) {
    double const share = most == 1 ? 0.0 : static_cast<double>(k) / static_cast<double>(most - 1);
    double const wanted = lags.front() * std::pow(ratio, share);
    auto const after = static_cast<std::size_t>(std::ranges::lower_bound(lags, wanted) - lags.begin());
    std::size_t nearest = std::min(after, lags.size() - 1);
    if (nearest > 0 && wanted - lags[nearest - 1] < lags[nearest] - wanted) --nearest;
    if (chosen.empty() || nearest > chosen.back()) chosen.push_back(nearest);
  }
  return chosen;
}

std::vector<std::size_t> chosen_or_all(std::vector<double> const& lags, std::size_t most) {
  if (most > 0 && most < lags.size()) return chosen_lags(lags, most);
  std::vector<std::size_t> all(lags.size());
  for (std::size_t k = 0; k < lags.size(); ++k) all[k] = k;
  return all;
}

std::vector<FramesOfLag> even_lags(std::span<double const> times, std::size_t most) {
  double const gap = (times.back() - times.front()) / static_cast<double>(times.size() - 1);
  std::vector<double> lags;
  for (std::size_t offset = 1; offset < times.size(); ++offset) lags.push_back(static_cast<double>(offset) * gap);
  std::vector<FramesOfLag> result;
  for (std::size_t const k : chosen_or_all(lags, most)) result.emplace_back(lags[k], k + 1, times.size());
  return result;
}

std::vector<FramesOfLag> uneven_lags(std::span<double const> times, std::size_t most, double tolerance) {
  if (times.size() > max_uneven_frames) {
    throw Error({.what = fmt::format("{} frames are not even in time", times.size()),
                 .hint = fmt::format("use at most {} such frames, or frames that are even", max_uneven_frames)});
  }
  auto const lag_of = [&](FramesOfLag::Pair const& pair) { return times[pair.second] - times[pair.first]; };
  std::vector<FramesOfLag::Pair> pairs;
  pairs.reserve(times.size() * (times.size() - 1) / 2);
  for (std::uint32_t i = 0; i < times.size(); ++i) {
    for (std::uint32_t j = i + 1; j < times.size(); ++j) pairs.emplace_back(i, j);
  }
  std::ranges::sort(pairs, {}, lag_of);
  std::vector<std::size_t> begin{0};
  std::vector<double> lags{lag_of(pairs.front())};
  for (std::size_t k = 1; k < pairs.size(); ++k) {
    if (lag_of(pairs[k]) - lags.back() <= tolerance) continue;
    begin.push_back(k);
    lags.push_back(lag_of(pairs[k]));
  }
  begin.push_back(pairs.size());
  std::vector<FramesOfLag> result;
  for (std::size_t const k : chosen_or_all(lags, most)) {
    std::vector<FramesOfLag::Pair> of_lag(pairs.begin() + static_cast<std::ptrdiff_t>(begin[k]),
                                          pairs.begin() + static_cast<std::ptrdiff_t>(begin[k + 1]));
    std::ranges::sort(of_lag);
    result.emplace_back(lags[k], std::move(of_lag));
  }
  return result;
}

}  // namespace

std::vector<FramesOfLag> lags_between(std::span<double const> times, std::size_t most) {
  double const tolerance = 1e-3 * shortest_gap(times);
  return are_even(times, tolerance) ? even_lags(times, most) : uneven_lags(times, most, tolerance);
}

}  // namespace gridlock
