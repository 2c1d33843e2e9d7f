#include "gridlock/analysis/van_hove.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "analysis/lags.hpp"
#include "analysis/pair_histogram.hpp"
#include "analysis/trajectory.hpp"

namespace gridlock {

namespace {

constexpr std::size_t max_van_hove_bins = 1'000'000;

/// Means of numbers in bins over origins.
class BinnedMeans {
 public:
  explicit BinnedMeans(std::size_t bins) : sums_(bins, 0.0), origins_(bins) {}

  void add(std::vector<double> const& values, bool is_independent) {
    for (std::size_t k = 0; k < values.size(); ++k) {
      sums_[k] += values[k];
      if (is_independent) origins_[k].add(values[k]);
    }
    ++count_;
  }

  [[nodiscard]] std::vector<Estimate> estimates() const {
    std::vector<Estimate> result;
    for (std::size_t k = 0; k < sums_.size(); ++k) {
      result.push_back({.value = sums_[k] / static_cast<double>(count_), .error = origins_[k].estimate()->error});
    }
    return result;
  }

 private:
  std::vector<double> sums_;
  std::vector<BlockAverage> origins_;
  std::size_t count_ = 0;
};

/// The bins of distances, and the areas of their rings.
struct Rings {
  double range;
  std::size_t bins;

  [[nodiscard]] double width() const { return range / static_cast<double>(bins); }
  [[nodiscard]] double middle(std::size_t k) const { return (static_cast<double>(k) + 0.5) * width(); }
  [[nodiscard]] double area(std::size_t k) const { return 2.0 * std::numbers::pi * width() * middle(k); }
  /// Adds 1 to the bin of a vector, if it is in the range.
  void count(Vector d, double* counts) const {
    double const bin = std::sqrt(d.x * d.x + d.y * d.y) * (static_cast<double>(bins) / range);
    if (bin < static_cast<double>(bins)) counts[static_cast<std::size_t>(bin)] += 1.0;
  }
};

class VanHoveWalk {
 public:
  VanHoveWalk(TrajectoryInMemory const& trajectory, VanHoveSettings const& settings)
      : trajectory_(trajectory), settings_(settings), rings_{settings.range, settings.bins} {
    std::vector<Agents> const kinds = agents_by_kind(trajectory);
    for (Agents const& agents : kinds) sizes_.push_back(static_cast<double>(agents.size()));
    kinds_of_both_.resize(2 * trajectory.agents);
    for (std::size_t i = 0; i < trajectory.agents; ++i) {
      kinds_of_both_[i] = trajectory.kinds.empty() ? 0 : trajectory.kinds[i];
      kinds_of_both_[trajectory.agents + i] = kinds_of_both_[i] + static_cast<std::uint32_t>(kinds.size());
    }
  }

  [[nodiscard]] VanHoveAtLag at(FramesOfLag const& frames) const {
    std::vector<bool> const independent = independent_pairs(frames, trajectory_.times);
    std::size_t const kinds = sizes_.size();
    BinnedMeans self(kinds * rings_.bins);
    BinnedMeans distinct(settings_.box ? kinds * kinds * rings_.bins : 0);
    for (std::size_t k = 0; k < frames.size(); ++k) {
      auto const [first, second] = frames[k];
      self.add(self_part(first, second), independent[k]);
      if (settings_.box) distinct.add(distinct_part(first, second), independent[k]);
    }
    return {.lag = frames.lag(),
            .origins = frames.size(),
            .independent_origins = static_cast<std::uint64_t>(std::ranges::count(independent, true)),
            .self = self.estimates(),
            .distinct = distinct.estimates()};
  }

  [[nodiscard]] VanHove run() const {
    VanHove result{.kinds = sizes_.size()};
    for (std::size_t k = 0; k < rings_.bins; ++k) result.distance.push_back(rings_.middle(k));
    std::vector<FramesOfLag> const lags = lags_between(trajectory_.times, 0);
    for (double const lag : settings_.lags) {
      result.lags.push_back(at(frames_nearest(lags, trajectory_.times, lag, settings_.max_origins)));
    }
    return result;
  }

 private:
  [[nodiscard]] Vector position(std::size_t frame, std::size_t agent) const {
    double const* const xy = trajectory_.positions + 2 * (frame * trajectory_.agents + agent);
    return {xy[0], xy[1]};
  }

  [[nodiscard]] std::vector<double> self_part(std::size_t first, std::size_t second) const {
    std::vector<double> values(sizes_.size() * rings_.bins, 0.0);
    for (std::size_t i = 0; i < trajectory_.agents; ++i) {
      rings_.count(position(second, i) - position(first, i), values.data() + kinds_of_both_[i] * rings_.bins);
    }
    for (std::size_t k = 0; k < values.size(); ++k) values[k] /= sizes_[k / rings_.bins] * rings_.area(k % rings_.bins);
    return values;
  }

  /// Both frames are points of one search, those of the second frame of kinds of their own.
  [[nodiscard]] std::vector<double> distinct_part(std::size_t first, std::size_t second) const {
    std::size_t const agents = trajectory_.agents;
    std::vector<double> both(4 * agents);
    double const* const from = trajectory_.positions;
    std::copy_n(from + 2 * first * agents, 2 * agents, both.data());
    std::copy_n(from + 2 * second * agents, 2 * agents, both.data() + 2 * agents);
    PointsInMemory const points{.x = both.data(), .y = both.data() + 1, .count = 2 * agents, .stride = 2};
    PairSums const sums = sum_over_pairs(*settings_.box, points, PairBins::rings(rings_.range, rings_.bins),
                                         kinds_of_both_, {}, settings_.threads);
    std::vector<double> own(sizes_.size() * rings_.bins, 0.0);
    for (std::size_t i = 0; i < agents; ++i) {
      rings_.count(settings_.box->displacement(position(first, i), position(second, i)),
                   own.data() + kinds_of_both_[i] * rings_.bins);
    }
    std::vector<double> values;
    for (std::size_t a = 0; a < sizes_.size(); ++a) {
      for (std::size_t b = 0; b < sizes_.size(); ++b) {
        double const pairs = sizes_[a] * (sizes_[b] - (a == b ? 1.0 : 0.0));
        for (std::size_t k = 0; k < rings_.bins; ++k) {
          double const seen =
              static_cast<double>(sums.between(a, sizes_.size() + b, k)) - (a == b ? own[a * rings_.bins + k] : 0.0);
          values.push_back(seen / (pairs * rings_.area(k) / settings_.box->area()));
        }
      }
    }
    return values;
  }

  TrajectoryInMemory const& trajectory_;
  VanHoveSettings const& settings_;
  Rings rings_;
  std::vector<double> sizes_;  ///< number of agents of each kind
  std::vector<std::uint32_t> kinds_of_both_;
};

void require_van_hove(VanHoveSettings const& settings, std::size_t kinds) {
  if (!(settings.range > 0.0) || !std::isfinite(settings.range)) {
    throw Error({.what = fmt::format("the range is {}", settings.range), .hint = "use a positive number"});
  }
  if (settings.bins >= 1 && settings.bins <= max_van_hove_bins / (kinds * kinds)) return;
  throw Error(
      {.what = fmt::format("van Hove functions of {} kinds in {} bins", kinds, settings.bins),
       .hint = fmt::format("use at least one bin, and at most {} of all pairs of kinds together", max_van_hove_bins)});
}

}  // namespace

VanHove find_van_hove(TrajectoryInMemory const& trajectory, VanHoveSettings const& settings) {
  require_trajectory(trajectory);
  require_van_hove(settings, agents_by_kind(trajectory).size());
  return VanHoveWalk(trajectory, settings).run();
}

}  // namespace gridlock
