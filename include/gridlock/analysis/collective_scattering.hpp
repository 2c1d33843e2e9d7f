#pragma once

/// \file
/// The collective intermediate scattering function of a trajectory: how long waves of the density last.
///
/// ```cpp
/// std::vector<double> const positions{0.0, 0.0, 0.25, 0.0};  // one agent in two frames
/// std::vector<double> const times{0.0, 1.0};
/// CollectiveScattering const found =
///     find_collective_scattering(Box(1.0, 1.0, Edge::periodic),
///                                {.positions = positions.data(), .frames = 2, .agents = 1, .times = times},
///                                {.wave_number = 6.28, .width = 0.1});
/// double const f = found.of(0, 0)[1].value;  // 0.5 after the lag 1: cos(π/2) along x, and 1 along y
/// ```

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "gridlock/analysis/dynamics.hpp"
#include "gridlock/core/box.hpp"

namespace gridlock {

struct CollectiveScatteringSettings {
  double wave_number = 0.0;   ///< the middle q of the ring of wave vectors, in 1 / length
  double width = 0.0;         ///< the width of the ring, in 1 / length
  std::size_t max_lags = 0;   ///< largest number of lags besides 0, evenly in their logarithm; 0: all
  std::uint64_t threads = 1;  ///< 0: one for each core
};

/// The functions F_ab(q, t) of all kinds a and b, averaged over a ring of wave vectors of the box.
struct CollectiveScattering {
  double wave_number = 0.0;   ///< the mean length of the wave vectors
  std::uint64_t vectors = 0;  ///< number of wave vectors, counting q and −q once
  std::size_t kinds = 1;
  std::vector<double> lag;                         ///< time lags, ascending, from 0 on
  std::vector<std::uint64_t> origins;              ///< number of pairs of frames with each lag
  std::vector<std::uint64_t> independent_origins;  ///< number of these pairs whose intervals do not overlap
  std::vector<Estimate> scattering;                ///< F_ab = F_ba at lag l is at ((a · kinds) + b) · lags + l

  [[nodiscard]] std::span<Estimate const> of(std::size_t a, std::size_t b) const {
    return std::span(scattering).subspan((a * kinds + b) * lag.size(), lag.size());
  }
};

/// Returns the collective intermediate scattering function of a trajectory in a periodic box.
///
///     F_ab(q, t) = Re ⟨ρ_a(t₀ + t) ρ_b*(t₀)⟩ / √(N_a N_b),   ρ_a(t) = Σ exp(i q·r(t)) over the agents of kind a
///
/// over time origins and the wave vectors q of the box with | |q| − wave_number | ≤ width / 2. F_ab(q, 0) = S_ab(q).
/// For independent agents F_aa(q, t) = F_s(q, t) and F_ab = 0; where momentum is conserved, corrections are of order
/// 1/N. The errors are those of find_dynamics(): from origins whose intervals do not overlap.
/// Errors: those of find_dynamics(); Error for a box that is not periodic, a ring without wave vectors, and more than
/// 10⁸ waves of all frames and kinds. The result does not depend on the number of threads.
/// Cost: 2 ns a frame, agent, and wave vector or row or column of wave vectors; 1 ns a pair of frames, wave vector and
/// pair of kinds. Memory: 16 bytes a frame, wave vector and kind.
/// Source: J.-P. Hansen & I. R. McDonald, Theory of Simple Liquids (2013), chapter 7.
CollectiveScattering find_collective_scattering(Box const& box, TrajectoryInMemory const& trajectory,
                                                CollectiveScatteringSettings const& settings);

}  // namespace gridlock
