#pragma once

/// \file
/// Hard disks that grow while they fly, until they are as dense or as hard pressed as asked for.
///
/// ```cpp
/// #include "gridlock/lattice/start.hpp"
///
/// State state = make_start(Box(1.0, 1.0, Edge::periodic), {.count = 100, .packing_fraction = 0.4}, 1);
/// draw_velocities(state, {});
/// Growth growth({.rate = 1e-2, .packing_fraction = 0.7}, state);
/// Counters counters;
/// growth.advance(state, counters);  // the radii in `state` now cover 0.7 of the box
/// ```

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>

#include "gridlock/core/archive.hpp"
#include "gridlock/core/disks.hpp"
#include "gridlock/engine/engine.hpp"

namespace gridlock {

namespace exact {
class Dynamics;
class LeftState;
}  // namespace exact

/// Rates of growth γ. A disk collides about 9/γ times until it is jammed: at the slowest rate, days for a hundred
/// disks. Above the fastest one disks grow faster than they fly.
inline constexpr double slowest_growth = 1e-9;
inline constexpr double fastest_growth = 1.0;

/// How disks grow and when they stop: at whichever of the two ends comes first, of which at least one is given.
struct GrowthSettings {
  /// γ = (dD/dt) / √(kT/m): D the diameter of the smallest disk, m the mass of the lightest of that size, kT that of
  /// the start.
  double rate = 1e-3;
  std::optional<double> packing_fraction;  ///< to end at, exactly
  std::optional<double> pressure;          ///< reduced pressure βP/ρ to reach, measured since the last rescaling
  /// Pair collisions divided by disks, after which the pressure is measured and the velocities are rescaled to kT of
  /// the start; two hits at walls count as one.
  double collisions_per_rescaling = 20.0;
  std::uint64_t audit_every = 0;  ///< pair collisions between two audits; 0 is never
};

/// Lubachevsky–Stillinger growth in the exact engine: between collisions every radius grows linearly, R_i(t) = R_i(0)
/// (1 + g t) with one g for all, so that the ratios of sizes stay.
///
/// With σ = R_i + R_j and a = dσ/dt a collision turns the velocity v along the line of centres into −v + 2a: growth
/// heats the disks, and every 20 collisions a disk their velocities are scaled back. The walls of the box do the same
/// with R. The reduced pressure is that of all collisions since the last rescaling,
///     p = 1 + Σ (σ|Δp| of pairs + R|Δp| of walls) / (2 N kT t),
/// which diverges like 2/(1 − φ/φ_J) where nothing can move any more. It says nothing more: fast growth ends at a high
/// pressure in states that are not jammed.
///
/// The trajectory depends on the disks alone, not on cells, rows or the places where advance() was interrupted.
/// Errors: Error naming the setting for ends that contradict each other or the state, for a start that the engine
/// `exact` refuses, for fewer than two disks or disks at rest, and for a periodic box too small for the disks grown.
/// RunFailure where no time passes, and where the density asked for is not reached before gaps are last digits.
/// Source: B. D. Lubachevsky & F. H. Stillinger, J. Stat. Phys. 60, 561 (1990).
/// Cost: O(1) per collision.
class Growth {
 public:
  Growth(GrowthSettings const& settings, State const& state);
  Growth(Growth const&) = delete;
  Growth& operator=(Growth const&) = delete;
  ~Growth();

  /// Grows the disks until an end is reached, and says so; or until `should_continue`, asked now and then and after
  /// each audit, says no. Radii, positions, velocities and the time in `state` belong together, also where it was
  /// interrupted; at an end the velocities are those of kT of the start.
  bool advance(State& state, Counters& counters, std::function<bool()> const& should_continue = {});

  /// Whether an end is reached: advance() does nothing more.
  [[nodiscard]] bool is_finished() const { return is_finished_; }
  /// βP/ρ between the last two rescalings; absent before the first one.
  [[nodiscard]] std::optional<double> reduced_pressure() const { return reduced_pressure_; }
  /// Pair collisions since the start.
  [[nodiscard]] std::uint64_t collisions() const { return collisions_; }
  /// How often the velocities were rescaled.
  [[nodiscard]] std::uint64_t rescalings() const { return rescalings_; }

  /// Restored into a Growth made of the same start and settings, after the state, it goes on with the same bits.
  void serialize(Archive& archive, State const& state);

 private:
  void start_from(State const& state);
  void leave_at_last_event(State& state);
  void measure_pressure(State const& state);
  void rescale(State& state);
  void require_gaps_of_some_digits(State const& state) const;
  void finish_at_density(State& state);
  void finish(State& state);

  GrowthSettings settings_;
  double temperature_ = 0.0;                   // kT of the start
  double diameter_rate_ = 0.0;                 // dD/dt of the smallest disk
  std::uint64_t hits_per_rescaling_ = 0;       // of all disks
  std::unique_ptr<exact::Dynamics> dynamics_;  // nullptr before the start and after the end
  std::unique_ptr<exact::LeftState> left_;
  double start_time_ = 0.0;
  double last_scale_ =
      0.0;  // of the radii at start_time_, at which they reach the packing fraction; infinite without one
  double measured_from_temperature_ = 0.0;
  std::uint64_t collisions_ = 0;
  std::uint64_t hits_at_rescaling_ = 0;  // when the next one is due
  std::uint64_t hits_at_renewal_ = 0;
  std::uint64_t rescalings_ = 0;
  std::optional<double> reduced_pressure_;
  bool is_finished_ = false;
};

}  // namespace gridlock
