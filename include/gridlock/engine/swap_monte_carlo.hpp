#pragma once

/// \file
/// Swap Monte Carlo: hard disks of many sizes brought to equilibrium where their own motion would take for ever.
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

/// More sweeps than any machine makes.
inline constexpr std::uint64_t max_sweeps = (std::uint64_t{1} << 40) - 1;

/// The settings of swap Monte Carlo.
struct SwapSettings {
  std::uint64_t sweeps = 100'000;  ///< of N trial moves each
  double swap_fraction = 0.2;      ///< share of the trial moves that swap radii
  /// The largest displacement along x and along y, in mean diameters; left out: adjusted.
  std::optional<double> step;
  /// Share of the sweeps, at their start, in which the step is adjusted until 40 % of the displacements are accepted.
  /// They count for no average.
  double adjusting = 0.1;
  std::uint64_t stage = 0;  ///< runs of one seed that differ in this number have random numbers of their own; below 2²⁴
};

/// How often trial moves were made and accepted since the step was fixed.
struct SwapCounts {
  std::uint64_t displacements = 0;
  std::uint64_t accepted_displacements = 0;
  std::uint64_t swaps = 0;  ///< of two disks of different radii
  std::uint64_t accepted_swaps = 0;
};

/// Correlation after `lag` sweeps, over all time origins.
struct SwapCorrelation {
  std::uint64_t lag = 0;
  std::uint64_t origins = 0;
  /// Q = ⟨share of disks with |Δr_i − ⟨Δr_j⟩| < 0.3 mean diameters⟩, j the neighbours of i at the origin: how many are
  /// still in the cage they were in. Relative to the neighbours, since in two dimensions whole regions drift without
  /// any rearrangement.
  double self_overlap = 1.0;
  /// C₆ = ⟨Re Σ ψ6_i(t) ψ6_i*(0)⟩/⟨Σ |ψ6_i(0)|²⟩, the bond orientations of disks with neighbours nearer than 1.5
  /// lattice spacings.
  double bond_orientation = 1.0;
};

/// The numbers by which a user judges whether equilibrium was reached.
struct SwapReport {
  std::uint64_t sweeps = 0;  ///< done, those of the adjusting too
  double step = 0.0;         ///< in mean diameters
  std::optional<double> displacement_acceptance;
  std::optional<double> swap_acceptance;  ///< absent where no two disks of different radii were tried
  /// In sweeps: where Q and C₆ fall to 1/e; absent where they have not.
  std::optional<double> overlap_relaxation_time;
  std::optional<double> bond_relaxation_time;
  /// Sweeps since the step was fixed over the longer of the two times; absent where one of them is.
  std::optional<double> relaxation_times;
  bool is_equilibrated = false;  ///< relaxation_times ≥ 10
  std::string warning;           ///< in plain words what is missing to that; empty where nothing is
};

/// Monte Carlo of hard disks in which disks also exchange their radii.
///
/// A trial move picks a disk at random. A displacement, uniform in a square of side 2·step, is accepted if the disk
/// overlaps nothing at its new place. A swap picks a second disk and exchanges the radii of the two (Ids, places,
/// velocities and masses stay) and is accepted if none overlaps then. Each trial is as likely as its reverse, so that
/// in the long run all arrangements of the disks and of their radii that do not overlap are equally likely. Once disks
/// are dense, a disk leaves its cage by becoming smaller: with the σ⁻³ distribution of sizes equilibrium is reached at
/// densities at which molecular dynamics stands still (Ninarello, Berthier, Coslovich 2017,
/// doi:10.1103/PhysRevX.7.021039; in two dimensions Berthier et al. 2019, doi:10.1038/s41467-019-09512-3).
///
/// The result is a pure function of the state, the settings and the seed: the same bits however the sweeps are divided
/// into calls, whatever the order of the rows, killed and resumed. Time does not pass: the clock of the state stays.
/// Errors: Error for settings out of their bounds, no disks, and a state that validate() refuses.
/// Cost: docs/notebook/jamming.md; 100 bytes a disk, and up to 20 MB for the correlations.
class SwapMonteCarlo {
 public:
  SwapMonteCarlo(SwapSettings const& settings, State const& state);
  ~SwapMonteCarlo();
  SwapMonteCarlo(SwapMonteCarlo&& other) noexcept;
  SwapMonteCarlo& operator=(SwapMonteCarlo&& other) noexcept;

  /// Goes on until all sweeps are done, and says so, or until should_continue(), asked after every sweep, says no.
  /// Contract: the state is the one of the constructor or of the last call, with the same disks.
  bool advance(State& state, std::function<bool()> const& should_continue = {});

  [[nodiscard]] std::uint64_t sweeps_done() const;
  [[nodiscard]] SwapCounts const& counts() const;
  /// For lags from one sweep on, those that have an origin.
  [[nodiscard]] std::vector<SwapCorrelation> correlations() const;
  [[nodiscard]] SwapReport report() const;

  /// Serializes what is kept between two calls of advance() besides the state, which has been serialized before.
  void serialize(Archive& archive, State const& state);

 private:
  struct Progress;
  std::unique_ptr<Progress> progress_;
};

}  // namespace gridlock
