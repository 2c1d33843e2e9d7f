#include "gridlock/analysis/dynamics.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "analysis/bessel_table.hpp"
#include "analysis/displacement_sums.hpp"
#include "analysis/lags.hpp"
#include "analysis/relative_positions.hpp"
#include "analysis/trajectory.hpp"
#include "gridlock/core/detail/thread_pool.hpp"
#include "gridlock/core/vector.hpp"

namespace gridlock {

namespace {

/// The coordinates of some agents in all frames: x of all agents of a frame, then y.
struct AgentBlock {
  std::size_t agents = 0;
  std::vector<double> coordinates;

  [[nodiscard]] double const* x(std::size_t frame) const { return coordinates.data() + 2 * frame * agents; }
  [[nodiscard]] double const* y(std::size_t frame) const { return x(frame) + agents; }
};

/// Agents of one kind with their neighbours at an origin, and their positions relative to them.
struct CagesAtOrigin {
  Cages cages;
  std::vector<double> x = std::vector<double>(cages.size());
  std::vector<double> y = std::vector<double>(cages.size());
};

/// The pair of frames of a lag that comes next.
struct Cursor {
  std::size_t pair = 0;
  std::size_t independent = 0;  ///< number of independent pairs before it
};

/// The sums of one lag for one kind of agents.
struct LagSums {
  Lanes lanes;                      ///< sums over pairs of frames that are not independent
  double near_in_lanes = 0.0;       ///< sum over the lanes of agents that are near
  Sums sums;                        ///< sums over independent pairs, and scattering of all pairs
  std::vector<Sums> by_origin;      ///< sums of each independent pair
  std::vector<std::uint32_t> near;  ///< number of agents that are near, of each pair; empty without an overlap length

  [[nodiscard]] Sums total() const {
    Sums total = sums;
    total.add(lanes);
    return total;
  }
};

using SumsOfLags = std::vector<LagSums>;

class Walk {
 public:
  Walk(TrajectoryInMemory const& trajectory, DynamicsSettings const& settings)
      : trajectory_(trajectory), settings_(settings), lags_(lags_between(trajectory.times, settings.max_lags)) {
    for (FramesOfLag const& frames : lags_) independent_.push_back(independent_pairs(frames, trajectory.times));
    if (settings.wave_number > 0.0) bessel_.emplace();
    drift_.assign(trajectory.frames, Vector{});
    if (!settings.keeps_drift) find_drift();
  }

  [[nodiscard]] Dynamics run() const {
    Dynamics result;
    for (std::size_t l = 0; l < lags_.size(); ++l) {
      result.lag.push_back(lags_[l].lag());
      result.origins.push_back(lags_[l].size());
      result.independent_origins.push_back(static_cast<std::uint64_t>(std::ranges::count(independent_[l], true)));
    }
    std::vector<Agents> const kinds = agents_by_kind(trajectory_);
    std::vector<SumsOfLags> sums(kinds.size(), no_sums());
    ThreadPool pool(settings_.threads);
    if (settings_.neighbours) {
      add_relative_to_neighbours(kinds, pool, sums);
    } else {
      for (std::size_t kind = 0; kind < kinds.size(); ++kind) add_all(kinds[kind], pool, sums[kind]);
    }
    for (std::size_t kind = 0; kind < kinds.size(); ++kind) {
      result.kinds.push_back(curves(sums[kind], static_cast<double>(kinds[kind].size())));
    }
    if (settings_.overlap_length > 0.0) {
      result.susceptibility = susceptibilities(sums, static_cast<double>(trajectory_.agents));
    }
    return result;
  }

 private:
  void find_drift() {
    for (std::size_t f = 0; f < trajectory_.frames; ++f) {
      double const* const frame = frame_at(f);
      for (std::size_t i = 0; i < trajectory_.agents; ++i)
        drift_[f] = drift_[f] + Vector{frame[2 * i], frame[2 * i + 1]};
      drift_[f] = (1.0 / static_cast<double>(trajectory_.agents)) * drift_[f];
    }
  }

  [[nodiscard]] double const* frame_at(std::size_t f) const {
    return trajectory_.positions + 2 * f * trajectory_.agents;
  }

  [[nodiscard]] SumsOfLags no_sums() const {
    SumsOfLags result(lags_.size());
    for (std::size_t l = 0; l < lags_.size(); ++l) {
      result[l].by_origin.resize(static_cast<std::size_t>(std::ranges::count(independent_[l], true)));
      if (settings_.overlap_length > 0.0) result[l].near.resize(lags_[l].size());
    }
    return result;
  }

  /// Number of agents of which all frames stay in the second cache while the pairs of frames are visited.
  [[nodiscard]] std::size_t block_size() const {
    std::size_t const fits = (std::size_t{1} << 20) / (2 * sizeof(double) * trajectory_.frames);
    return std::clamp<std::size_t>(fits / lane_count * lane_count, 2 * lane_count, 4096);
  }

  [[nodiscard]] AgentBlock block_of(std::span<std::uint32_t const> agents) const {
    AgentBlock block{.agents = agents.size(), .coordinates = {}};
    block.coordinates.resize(2 * agents.size() * trajectory_.frames);
    double* to = block.coordinates.data();
    for (std::size_t f = 0; f < trajectory_.frames; ++f, to += 2 * agents.size()) {
      double const* const frame = frame_at(f);
      for (std::size_t k = 0; k < agents.size(); ++k) {
        double const* const agent = frame + 2 * std::size_t{agents[k]};
        to[k] = agent[0] - drift_[f].x;
        to[k + agents.size()] = agent[1] - drift_[f].y;
      }
    }
    return block;
  }

  void add_all(Agents const& agents, ThreadPool& pool, SumsOfLags& sums) const {
    for (std::size_t begin = 0; begin < agents.size(); begin += block_size()) {
      std::size_t const count = std::min(block_size(), agents.size() - begin);
      AgentBlock const block = block_of(std::span(agents).subspan(begin, count));
      pool.for_each(lags_.size(), [&](std::size_t l) {
        for (Cursor at; at.pair < lags_[l].size(); advance(at, l)) {
          auto const [first, second] = lags_[l][at.pair];
          add({block.x(first), block.y(first), block.x(second), block.y(second), block.agents}, l, at, sums[l]);
        }
      });
    }
  }

  void advance(Cursor& at, std::size_t lag) const {
    if (independent_[lag][at.pair]) ++at.independent;
    ++at.pair;
  }

  /// Adds a block of agents in one pair of frames.
  void add(Displacements const& moved, std::size_t lag, Cursor at, LagSums& sums) const {
    double const squared_overlap = settings_.overlap_length * settings_.overlap_length;
    double const scattering = bessel_ ? scattering_of(moved) : 0.0;
    sums.sums.scattering += scattering;
    double near = 0.0;
    if (independent_[lag][at.pair]) {
      Lanes lanes;
      kernels_.add(moved, squared_overlap, lanes);
      sums.sums.add(lanes);
      sums.by_origin[at.independent].add(lanes);
      sums.by_origin[at.independent].scattering += scattering;
      near = lanes.all_near();
    } else {
      kernels_.add(moved, squared_overlap, sums.lanes);
      // The lanes hold whole numbers, so that the difference is exact.
      if (!sums.near.empty()) near = sums.lanes.all_near() - std::exchange(sums.near_in_lanes, sums.lanes.all_near());
    }
    if (!sums.near.empty()) sums.near[at.pair] += static_cast<std::uint32_t>(near);
  }

  [[nodiscard]] double scattering_of(Displacements const& moved) const {
    Eight sums{};
    kernels_.add_scattering(moved, settings_.wave_number * settings_.wave_number, *bessel_, sums);
    double sum = 0.0;
    for (std::size_t l = 0; l < lane_count; ++l) sum += sums[l];
    return sum;
  }

  /// Adds displacements relative to those of neighbours, origin by origin: an origin has its neighbours for all lags.
  void add_relative_to_neighbours(std::vector<Agents> const& kinds, ThreadPool& pool,
                                  std::vector<SumsOfLags>& sums) const {
    std::vector<Cursor> next(lags_.size());
    for (std::size_t origin = 0; origin + 1 < trajectory_.frames; ++origin) {
      std::vector<std::size_t> here;  // the lags that have a pair with this origin
      for (std::size_t l = 0; l < lags_.size(); ++l) {
        if (next[l].pair < lags_[l].size() && lags_[l][next[l].pair].first == origin) here.push_back(l);
      }
      if (here.empty()) continue;
      NeighbourLists const neighbours = settings_.neighbours(origin);
      require_lists(neighbours, trajectory_.agents, origin);
      for (std::size_t kind = 0; kind < kinds.size(); ++kind) {
        CagesAtOrigin from{.cages = Cages(neighbours, kinds[kind])};
        from.cages.find_relative_positions(frame_at(origin), 0, from.cages.size(), drift_[origin], from.x.data(),
                                           from.y.data());
        pool.for_each(here.size(),
                      [&](std::size_t k) { add_relative(from, here[k], next[here[k]], sums[kind][here[k]]); });
      }
      for (std::size_t const l : here) advance(next[l], l);
    }
  }

  /// Adds the agents of one kind in one pair of frames, in blocks that stay in the first cache.
  void add_relative(CagesAtOrigin const& from, std::size_t lag, Cursor at, LagSums& sums) const {
    constexpr std::size_t most = 512;
    std::array<double, most> x, y;
    std::size_t const second = lags_[lag][at.pair].second;
    for (std::size_t begin = 0; begin < from.cages.size(); begin += most) {
      std::size_t const count = std::min(most, from.cages.size() - begin);
      from.cages.find_relative_positions(frame_at(second), begin, count, drift_[second], x.data(), y.data());
      add({from.x.data() + begin, from.y.data() + begin, x.data(), y.data(), count}, lag, at, sums);
    }
  }

  /// Returns the mean with its standard error from the values of the independent pairs.
  template <class Value>
  static Estimate estimate(double mean, std::vector<Sums> const& by_origin, Value value) {
    BlockAverage average;
    for (Sums const& origin : by_origin) average.add(value(origin));
    auto const scatter = average.estimate();
    return {.value = mean, .error = scatter ? scatter->error : std::nullopt};
  }

  [[nodiscard]] DynamicsOfKind curves(SumsOfLags const& lags, double agents) const {
    DynamicsOfKind result;
    for (std::size_t l = 0; l < lags_.size(); ++l) {
      Sums const total = lags[l].total();
      double const pairs = agents * static_cast<double>(lags_[l].size());
      double const second = total.squares / pairs;
      double const fourth = total.fourths / pairs;
      auto const mean = [&](double sum, double Sums::*member) {
        return estimate(sum / pairs, lags[l].by_origin, [&](Sums const& origin) { return origin.*member / agents; });
      };
      result.squared_displacement.push_back(mean(total.squares, &Sums::squares));
      // The ratio changes with its two means to first order. Without any motion the ratio is undefined.
      bool const is_defined = second > 0.0;
      result.non_gaussian.push_back(
          estimate(is_defined ? fourth / (2.0 * second * second) - 1.0 : std::numeric_limits<double>::quiet_NaN(),
                   is_defined ? lags[l].by_origin : std::vector<Sums>{}, [&](Sums const& origin) {
                     return (origin.fourths / agents - fourth) / (2.0 * second * second) -
                            fourth / (second * second * second) * (origin.squares / agents - second);
                   }));
      if (bessel_) result.scattering.push_back(mean(total.scattering, &Sums::scattering));
      if (settings_.overlap_length > 0.0) result.overlap.push_back(mean(total.near, &Sums::near));
    }
    if (settings_.overlap_length > 0.0) result.susceptibility = susceptibilities({&lags, 1}, agents);
    return result;
  }

  /// Returns χ₄ of the agents of some kinds together, for each lag.
  [[nodiscard]] std::vector<Estimate> susceptibilities(std::span<SumsOfLags const> kinds, double agents) const {
    std::vector<Estimate> result;
    for (std::size_t l = 0; l < lags_.size(); ++l) {
      std::vector<double> near(lags_[l].size());
      for (SumsOfLags const& lags : kinds) {
        for (std::size_t k = 0; k < near.size(); ++k) near[k] += lags[l].near[k];
      }
      Estimate variance = variance_over_origins(lags_[l], trajectory_.times, independent_[l], std::move(near));
      // The variance of Q is that of the number of agents over N².
      variance.value /= agents;
      if (variance.error) *variance.error /= agents;
      result.push_back(variance);
    }
    return result;
  }

  TrajectoryInMemory const& trajectory_;
  DynamicsSettings const& settings_;
  std::vector<FramesOfLag> lags_;
  std::vector<std::vector<bool>> independent_;
  std::optional<BesselTable> bessel_;
  std::vector<Vector> drift_;
  DisplacementKernels kernels_ = fastest_displacement_kernels();
};

void require_lengths(DynamicsSettings const& settings) {
  auto const require = [](char const* name, double value) {
    if (value >= 0.0 && std::isfinite(value)) return;
    throw Error(
        {.what = fmt::format("the {} is {}", name, value), .hint = "use a positive number, or 0 to leave it out"});
  };
  require("wave number", settings.wave_number);
  require("overlap length", settings.overlap_length);
}

}  // namespace

Dynamics find_dynamics(TrajectoryInMemory const& trajectory, DynamicsSettings const& settings) {
  require_lengths(settings);
  require_trajectory(trajectory);
  return Walk(trajectory, settings).run();
}

}  // namespace gridlock
