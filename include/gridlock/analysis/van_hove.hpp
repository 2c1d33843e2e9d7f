#pragma once

/// \file
/// The van Hove functions of a trajectory: how far agents have moved after a time, and where the other agents are then.
///
/// ```cpp
/// std::vector<double> const positions{0.2, 0.5, 0.5, 0.5, 0.5, 0.5, 0.2, 0.5};  // two agents change places
/// std::vector<double> const times{0.0, 1.0};
/// Box const box(1.0, 1.0, Edge::periodic);
/// VanHove const found = find_van_hove({.positions = positions.data(), .frames = 2, .agents = 2, .times = times},
///                                     {.lags = {1.0}, .range = 0.5, .bins = 10, .box = box});
/// double const distinct = found.lags[0].distinct[0].value;  // others have come to where agents were
/// ```

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "gridlock/analysis/dynamics.hpp"
#include "gridlock/core/box.hpp"

namespace gridlock {

struct VanHoveSettings {
  std::vector<double> lags;     ///< for each the lag of the trajectory that is nearest; 0: each frame with itself
  double range = 0.0;           ///< largest distance
  std::size_t bins = 200;       ///< number of bins of equal width
  std::optional<Box> box = {};  ///< the periodic box of all frames; nothing: no distinct part
  std::size_t max_origins = 0;  ///< largest number of origins of a lag, evenly spread; 0: all
  std::uint64_t threads = 1;    ///< 0: one for each core
};

/// The functions after one lag.
struct VanHoveAtLag {
  double lag = 0.0;
  std::uint64_t origins = 0;              ///< number of pairs of frames
  std::uint64_t independent_origins = 0;  ///< number of these pairs whose intervals do not overlap
  std::vector<Estimate> self;             ///< G_s of kind a, in 1 / length², in bin k is at a · bins + k
  std::vector<Estimate> distinct;         ///< G_d of kinds a and b in bin k is at ((a · kinds) + b) · bins + k
};

struct VanHove {
  std::size_t kinds = 1;
  std::vector<double> distance;  ///< the middle of each bin
  std::vector<VanHoveAtLag> lags;
};

/// Returns the van Hove functions after some lags, as means over time origins.
///
///     G_s(r, t)  = agents with |r_i(t₀ + t) − r_i(t₀)| in the bin / (N_a · area of the ring)
///     G_d(r, t)  = pairs i ≠ j with |r_j(t₀ + t) − r_i(t₀)| in the bin / (all such pairs · area of the ring / area of
///                  the box)
///
/// for i of kind a and j of kind b. The self part integrates to 1: ∫ G_s 2πr dr = 1; for independent walkers it is
/// exp(−r²/4Dt)/4πDt. The distinct part is relative to the density of others: it is g_ab(r) at t = 0, and 1 where
/// agents no longer know of each other. Errors are those of find_dynamics(): from origins whose intervals do not
/// overlap.
/// Errors: those of find_dynamics(); Error for a range that is not positive, no bins or too many, lags below 0 or
/// beyond the last frame, and with a box those of find_pair_correlations(). The result does not depend on the number of
/// threads.
/// Cost: the self part 9 ns an origin and agent; the distinct part twice that of find_pair_correlations() an origin.
/// Source: L. van Hove (1954), doi:10.1103/PhysRev.95.249.
VanHove find_van_hove(TrajectoryInMemory const& trajectory, VanHoveSettings const& settings);

}  // namespace gridlock
