#pragma once

/// \file
/// Strings of mobile agents that follow one another, each into the place of the next.
///
/// ```cpp
/// std::vector<double> const positions{1.0, 1.0, 2.0, 1.0, 5.0, 5.0, 2.0, 1.0, 3.0, 1.0, 5.0, 5.0};
/// std::vector<double> const times{0.0, 1.0};  // agent 0 moves to where agent 1 was, agent 2 stays
/// Strings const found = find_strings({.positions = positions.data(), .frames = 2, .agents = 3, .times = times},
///                                    {.lags = {1.0}, .mobile_share = 0.6, .distance = 0.3});
/// double const length = found.lags[0].mean_length.value;  // 2
/// ```

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "gridlock/analysis/dynamics.hpp"
#include "gridlock/core/box.hpp"

namespace gridlock {

struct StringSettings {
  std::vector<double> lags;     ///< for each the lag of the trajectory that is nearest
  double mobile_share = 0.05;   ///< share of agents that are mobile: those that have moved farthest
  double distance = 0.0;        ///< δ within which one agent has taken the place of another, in length
  std::optional<Box> box = {};  ///< the box of all frames; nothing: the open plane
  std::size_t max_origins = 0;  ///< largest number of origins of a lag, evenly spread; 0: all
};

/// The strings after one lag.
struct StringsAtLag {
  double lag = 0.0;
  std::uint64_t origins = 0;              ///< number of pairs of frames
  std::uint64_t independent_origins = 0;  ///< number of these pairs whose intervals do not overlap
  Estimate mean_length;                   ///< ⟨n⟩, mobile agents a string; 1 if none follows another
  Estimate weighted_length;               ///< ⟨n²⟩/⟨n⟩, the length of the string of a mobile agent
  std::vector<double> strings;            ///< strings of n = 1, 2 … agents in an origin, as a mean
};

struct Strings {
  std::uint64_t mobile_agents = 0;  ///< number of mobile agents in each origin
  std::vector<StringsAtLag> lags;
};

/// Returns the lengths of strings after some lags, as means over time origins.
///
///     agents i and j are in one string if min(|r_i(t₀ + t) − r_j(t₀)|, |r_j(t₀ + t) − r_i(t₀)|) < δ
///
/// or if a chain of such pairs joins them; both are mobile: among the `mobile_share` of all agents with the largest
/// |r(t₀ + t) − r(t₀)|, at least one agent. A single mobile agent is a string of length 1. δ = 0.6 mean diameters in
/// the source. The errors are those of find_dynamics(): from origins whose intervals do not overlap.
/// Errors: those of find_dynamics(); Error for a share outside 0 … 1, a distance that is not positive or above half the
/// shorter side of a periodic box, and lags below 0 or beyond the last frame. Cost: 30 ns an origin and agent.
/// Source: C. Donati et al. (1998), doi:10.1103/PhysRevLett.80.2338.
Strings find_strings(TrajectoryInMemory const& trajectory, StringSettings const& settings);

}  // namespace gridlock
