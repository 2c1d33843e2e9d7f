#include "analysis/lags.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

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

std::vector<bool> independent_pairs(FramesOfLag const& frames, std::span<double const> times) {
  std::vector<bool> result(frames.size(), false);
  double free_from = -std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < frames.size(); ++k) {
    auto const [first, second] = frames[k];
    if (times[first] < free_from) continue;
    result[k] = true;
    free_from = times[second] - 1e-3 * frames.lag();
  }
  return result;
}

FramesOfLag frames_nearest(std::span<FramesOfLag const> lags, std::span<double const> times, double lag,
                           std::size_t max_origins) {
  if (!(lag >= 0.0) || !std::isfinite(lag)) {
    throw Error({.what = fmt::format("a lag is {}", lag), .hint = "use times, 0 or above"});
  }
  double const longest = times.empty() ? 0.0 : times.back() - times.front();
  if (lag > longest * (1.0 + 1e-9)) {
    throw Error({.what = fmt::format("a lag is {}, and the trajectory lasts {}", lag, longest),
                 .hint = "use lags up to the time between the first and the last frame"});
  }
  auto const away = [&](FramesOfLag const& frames) { return std::abs(frames.lag() - lag); };
  FramesOfLag found = lag == 0.0 ? FramesOfLag(0.0, 0, times.size()) : *std::ranges::min_element(lags, {}, away);
  if (max_origins == 0 || max_origins >= found.size()) return found;
  std::vector<FramesOfLag::Pair> chosen;
  for (std::size_t k = 0; k < max_origins; ++k) {
    auto const [first, second] = found[k * found.size() / max_origins];
    chosen.emplace_back(static_cast<std::uint32_t>(first), static_cast<std::uint32_t>(second));
  }
  return {found.lag(), std::move(chosen)};
}

Estimate mean_over_origins(std::span<double const> values, std::vector<bool> const& independent) {
  BlockAverage average;
  double sum = 0.0;
  for (std::size_t k = 0; k < values.size(); ++k) {
    sum += values[k];
    if (independent[k]) average.add(values[k]);
  }
  return {.value = sum / static_cast<double>(values.size()), .error = average.estimate()->error};
}

Estimate variance_over_origins(FramesOfLag const& frames, std::span<double const> times,
                               std::vector<bool> const& independent, std::vector<double> values) {
  double const mean = std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
  BlockAverage squares;
  for (std::size_t k = 0; k < values.size(); ++k) {
    values[k] -= mean;
    if (independent[k]) squares.add(values[k] * values[k]);
  }
  // The pairs of frames before `end` have ended when pair b begins; `first` and `second` are sums of their values.
  double first = 0.0, second = 0.0, sum = 0.0, count = 0.0;
  std::size_t end = 0;
  for (std::size_t b = 0; b < values.size(); ++b) {
    double const begins = times[frames[b].first] + 1e-3 * frames.lag();
    for (; end < b && times[frames[end].second] <= begins; ++end) {
      first += values[end];
      second += values[end] * values[end];
    }
    auto const before = static_cast<double>(end);
    sum += second - 2.0 * first * values[b] + before * values[b] * values[b];
    count += before;
  }
  if (count == 0.0) return {.value = std::numeric_limits<double>::quiet_NaN(), .error = std::nullopt};
  return {.value = 0.5 * sum / count, .error = squares.estimate()->error};
}

}  // namespace gridlock
