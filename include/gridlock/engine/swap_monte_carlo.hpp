#pragma once

/// \file
/// Monte Carlo of hard disks at constant area or constant pressure; swaps of radii bring disks of many sizes to
/// equilibrium at densities at which their dynamics is too slow.
///
/// ```cpp
/// #include "gridlock/lattice/start.hpp"
///
/// DisksSettings const disks{.count = 400, .packing_fraction = 0.5, .sizes = SizeDistribution::inverse_cube,
///                           .start = StartKind::random};
/// State state = make_start(Box(1.0, 1.0, Edge::periodic), disks, 1);
/// SwapMonteCarlo swaps({.sweeps = 10'000}, state);
/// swaps.advance(state);
/// bool const is_equilibrium = swaps.report().is_equilibrated;
/// ```

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "gridlock/core/archive.hpp"
#include "gridlock/core/disks.hpp"

namespace gridlock {

/// A bound on sweeps, more than any machine can make.
inline constexpr std::uint64_t max_sweeps = (std::uint64_t{1} << 40) - 1;

/// The settings of swap Monte Carlo.
struct SwapSettings {
  std::uint64_t sweeps = 100'000;  ///< number of sweeps, of N trial moves each
  double swap_fraction = 0.2;      ///< share of the trial moves that swap radii
  /// The largest displacement along x and along y, in mean diameters; empty: adjusted to an acceptance of 40 %.
  std::optional<double> step;
  /// Share of the sweeps, at their start, in which the step is adjusted until 40 % of the displacements are accepted.
  /// Averages leave these sweeps out.
  double adjusting = 0.1;
  /// βP D̄², D̄ the mean diameter: all radii grow and shrink together, so that the area fluctuates about that of this
  /// pressure. Empty: the area is constant.
  std::optional<double> pressure;
  std::uint64_t stage = 0;  ///< stages of one run have different numbers, and so independent random numbers; below 2²⁴
};

/// Numbers of trial moves and of accepted ones since the step was fixed.
struct SwapCounts {
  std::uint64_t displacements = 0;
  std::uint64_t accepted_displacements = 0;
  std::uint64_t swaps = 0;  ///< trial swaps of two different radii
  std::uint64_t accepted_swaps = 0;
  std::uint64_t area_changes = 0;
  std::uint64_t accepted_area_changes = 0;
};

/// Correlations after `lag` sweeps, averaged over all time origins.
struct SwapCorrelation {
  std::uint64_t lag = 0;
  std::uint64_t origins = 0;
  /// Q = ⟨share of disks with |Δr_i − ⟨Δr_j⟩| < 0.3 mean diameters⟩, j the neighbours of i at the origin: the share of
  /// disks that are still in their cages. Relative to the neighbours, since in two dimensions whole regions drift
  /// without rearrangement.
  double self_overlap = 1.0;
  /// C₆ = ⟨Re Σ ψ6_i(t) ψ6_i*(0)⟩/⟨Σ |ψ6_i(0)|²⟩, ψ6 from neighbours nearer than 1.5 lattice spacings.
  double bond_orientation = 1.0;
};

/// The mean packing fraction of a stretch of sweeps at constant pressure.
struct SwapDensity {
  std::uint64_t sweep = 0;  ///< number of sweeps at its end
  double packing_fraction = 0.0;
  bool is_adjusting = false;  ///< whether the steps were still adjusted in it
};

/// Numbers that show whether the disks are in equilibrium.
struct SwapReport {
  std::uint64_t sweeps = 0;  ///< sweeps done, including those that adjust the step
  double step = 0.0;         ///< largest displacement, in mean diameters
  std::optional<double> displacement_acceptance;
  std::optional<double> swap_acceptance;  ///< absent if no swap of different radii was tried
  std::optional<double> area_acceptance;  ///< absent at constant area
  /// βP/ρ at the mean packing fraction of the sweeps that count; absent at constant area.
  std::optional<double> reduced_pressure;
  /// Lags at which Q and C₆ fall to 1/e, in sweeps; absent if they have not.
  std::optional<double> overlap_relaxation_time;
  std::optional<double> bond_relaxation_time;
  /// Sweeps since the step was fixed over the longer of the two relaxation times; absent if one of them is absent.
  std::optional<double> relaxation_times;
  /// Difference of the mean packing fractions of the second and the first half of the sweeps that count, over the
  /// standard deviation; absent at constant area. A trend makes it large, to 1.7.
  std::optional<double> density_drift;
  /// Whether relaxation_times ≥ 10 and |density_drift| < 0.5.
  bool is_equilibrated = false;
  std::string warning;  ///< the reason why is_equilibrated is false; else empty
};

/// Monte Carlo of hard disks in which disks also exchange their radii.
///
/// A trial move picks a disk at random. A displacement, uniform in a square of side 2·step, is accepted if the disk
/// overlaps nothing at its new position. A swap picks a second disk and exchanges their radii (Ids, positions,
/// velocities and masses stay); it is accepted if neither disk then overlaps. Each trial is as likely as its reverse,
/// so that in the long run all arrangements without overlaps are equally likely. At high density a disk can leave its
/// cage once it is smaller: with the σ⁻³ distribution of sizes swaps reach equilibrium at densities at which molecular
/// dynamics is arrested (Ninarello, Berthier, Coslovich 2017, doi:10.1103/PhysRevX.7.021039; in two dimensions Berthier
/// et al. 2019, doi:10.1038/s41467-019-09512-3).
///
/// The result depends on the state, the settings and the seed alone, not on the division of the sweeps into calls, the
/// order of the rows or a resumed checkpoint. The clock of the state does not change. Errors: Error for settings out of
/// their bounds, no disks, and a state that validate() refuses.
///
/// At constant pressure each sweep ends with a trial change of the area. The sides of the box stay, and all radii
/// change by one factor. With the area v = A/D̄² in units of the disks, v and positions relative to the box have the
/// weight
///
///     vᴺ exp(−βP D̄² v)   where no disks overlap, else 0
///
/// (W. W. Wood 1968, doi:10.1063/1.1667938, for hard disks). A trial is symmetric in ln v. The area changes by
/// about v/N at a time, so N sweeps are the shortest time in which it finds its mean.
/// Cost: docs/notebook/jamming.md; 100 bytes a disk, and up to 20 MB for the correlations.
class SwapMonteCarlo {
 public:
  SwapMonteCarlo(SwapSettings const& settings, State const& state);
  ~SwapMonteCarlo();
  SwapMonteCarlo(SwapMonteCarlo&& other) noexcept;
  SwapMonteCarlo& operator=(SwapMonteCarlo&& other) noexcept;

  /// Makes sweeps until all are done, or should_continue(), called after every sweep, returns false; returns whether
  /// all are done. Contract: `state` is that of the constructor or of the last call, with the same disks.
  bool advance(State& state, std::function<bool()> const& should_continue = {});

  [[nodiscard]] std::uint64_t sweeps_done() const;
  [[nodiscard]] SwapCounts const& counts() const;
  /// Returns the correlations at all lags, from one sweep on, that have a time origin.
  [[nodiscard]] std::vector<SwapCorrelation> correlations() const;
  /// Returns the packing fraction along the run in about 1000 stretches; empty at constant area.
  [[nodiscard]] std::vector<SwapDensity> densities() const;
  [[nodiscard]] SwapReport report() const;

  /// Serializes the data kept between two calls of advance(), after the state.
  void serialize(Archive& archive, State const& state);

 private:
  struct Progress;
  std::unique_ptr<Progress> progress_;
};

}  // namespace gridlock
