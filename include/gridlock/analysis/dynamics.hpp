#pragma once

/// \file
/// Displacements of agents in a trajectory, for each lag, over all time origins; also relative to their neighbours.
///
/// ```cpp
/// std::vector<double> const positions{0.0, 0.0, 0.1, 0.0, 0.2, 0.0};  // one agent in three frames
/// std::vector<double> const times{0.0, 1.0, 2.0};
/// Dynamics const dynamics = find_dynamics({.positions = positions.data(), .frames = 3, .agents = 1, .times = times}, {});
/// double const msd = dynamics.kinds[0].squared_displacement[1].value;  // 0.04 after the lag 2
/// ```

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "gridlock/core/error.hpp"
#include "gridlock/grid/neighbour_lists.hpp"
#include "gridlock/observe/estimate.hpp"

namespace gridlock {

/// Positions of the same agents in many frames, without jumps at the edges of a periodic box.
struct TrajectoryInMemory {
  double const* positions = nullptr;  ///< x of agent i in frame f is positions[2 (f · agents + i)], y the next number
  std::size_t frames = 0;
  std::size_t agents = 0;
  std::span<double const> times;              ///< time of each frame, ascending
  std::span<std::uint32_t const> kinds = {};  ///< one for each agent, 0, 1, 2 … without gaps; empty: one kind
};

/// The quantities that are measured besides displacements.
struct DynamicsSettings {
  double wave_number = 0.0;     ///< q of F_s(q, t), in 1 / length; 0: no F_s
  double overlap_length = 0.0;  ///< a of the overlap; 0: no overlap
  std::size_t max_lags = 0;     ///< largest number of lags, evenly in their logarithm; 0: all
  bool keeps_drift = true;      ///< false: positions relative to the mean position in each frame
  std::uint64_t threads = 1;    ///< 0: one for each core
  /// Returns the neighbours of all agents in a frame, for displacements relative to them; empty: displacements alone.
  std::function<NeighbourLists(std::size_t frame)> neighbours = {};
};

/// The quantities of one kind of agents: one estimate for each lag; empty for quantities that are not measured.
struct DynamicsOfKind {
  std::vector<Estimate> squared_displacement;
  std::vector<Estimate> non_gaussian;
  std::vector<Estimate> scattering;
  std::vector<Estimate> overlap;
  std::vector<Estimate> susceptibility;  ///< where the overlap is measured, as in Dynamics
};

struct Dynamics {
  std::vector<double> lag;                         ///< time lags, ascending, above 0
  std::vector<std::uint64_t> origins;              ///< number of pairs of frames with each lag
  std::vector<std::uint64_t> independent_origins;  ///< number of these pairs whose intervals do not overlap
  std::vector<DynamicsOfKind> kinds;
  std::vector<Estimate> susceptibility;  ///< χ₄ of all kinds together
};

/// Returns means over agents and time origins for every lag between two frames, for each kind of agents.
///
///     squared_displacement = ⟨Δr²⟩                     Δr = r(t₀ + t) − r(t₀)
///     non_gaussian         = ⟨Δr⁴⟩ / (2 ⟨Δr²⟩²) − 1    0 for Gaussian displacements in two dimensions
///     scattering           = ⟨J₀(q |Δr|)⟩              F_s(q, t), averaged over all directions of q
///     overlap              = ⟨Q⟩                       Q = share of agents with |Δr| ≤ a
///     susceptibility χ₄    = N var(Q)                  over time origins; N agents of the kind, or of all kinds
///
/// With `neighbours`, displacements are relative to the mean displacement of the n_i neighbours that agent i has at the
/// origin, which takes out motion that neighbours share, such as the long waves of two dimensions:
///
///     Δr_i = r_i(t₀ + t) − r_i(t₀) − (1/n_i) Σ_j (r_j(t₀ + t) − r_j(t₀))
///
/// An agent without neighbours keeps its displacement. `neighbours` is called once for each origin:
///
/// ```cpp
/// std::vector<double> const positions{1.0, 1.0, 2.0, 1.0, 1.5, 1.0, 2.5, 1.0};  // two agents in two frames
/// std::vector<double> const times{0.0, 1.0};
/// DynamicsSettings settings{.overlap_length = 0.3};
/// settings.neighbours = [&](std::size_t frame) {
///   double const* const xy = positions.data() + 4 * frame;
///   return find_neighbour_lists(Box(9.0, 9.0, Edge::periodic), 1.5, {.x = xy, .y = xy + 1, .count = 2, .stride = 2});
/// };
/// Dynamics const found =
///     find_dynamics({.positions = positions.data(), .frames = 2, .agents = 2, .times = times}, settings);
/// double const msd = found.kinds[0].squared_displacement[0].value;  // 0: they have moved together
/// ```
///
/// Frames may be at any times: lags that differ by less than a thousandth of the shortest time between frames count as
/// one lag. A mean takes all pairs of frames of a lag. Its error comes from time origins whose intervals do not
/// overlap, in blocks if they are many. The error is absent for one such origin, and somewhat too large, since
/// overlapping intervals add information. It misses changes slower than the trajectory. χ₄ compares all pairs of
/// origins whose intervals do not overlap, ½ N ⟨(Q_a − Q_b)²⟩, and is NaN without one; a run at constant energy or
/// composition has a smaller χ₄ than one in which they fluctuate. The result does not depend on the number of threads.
/// Errors: Error for fewer than two frames, times that do not ascend, positions that are not finite, kinds with gaps,
/// more than 8192 frames that are not at equal time intervals, and neighbours that are not agents.
/// Cost: pairs of frames · agents · 0.5 ns with AVX-512, 1.1 ns without; with F_s 2 ns and 4.3 ns (AMD Zen 4); relative
/// to six neighbours 10 ns more, and the search. Memory: 1 MiB besides the trajectory, 8 bytes a pair of frames unless
/// they are at equal time intervals, and with the overlap 4 bytes a pair of frames and kind.
/// Source: A. Rahman (1964), doi:10.1103/PhysRev.136.A405 (⟨Δr²⟩, α₂); W. Kob & H. C. Andersen (1995),
/// doi:10.1103/PhysRevE.52.4134 (F_s of supercooled mixtures); N. Lačević et al. (2003), doi:10.1063/1.1605094
/// (overlap, χ₄); L. Berthier et al. (2007), doi:10.1063/1.2721554 (χ₄ and ensembles); S. Mazoyer, F. Ebert, G. Maret &
/// P. Keim (2009), doi:10.1209/0295-5075/88/66004, and S. Vivek, C. P. Kelleher, P. M. Chaikin & E. R. Weeks (2017),
/// doi:10.1073/pnas.1607226113 (relative to neighbours).
Dynamics find_dynamics(TrajectoryInMemory const& trajectory, DynamicsSettings const& settings);

}  // namespace gridlock
