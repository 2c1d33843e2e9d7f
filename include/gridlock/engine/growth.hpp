#pragma once

/// \file
/// Hard disks that grow while they move, until they reach a packing fraction or a pressure.
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

/// Bounds on the growth rate γ. A disk collides about 9/γ times until it is jammed: at the slowest rate, a run of a
/// hundred disks takes days. Above the fastest rate disks grow faster than they move.
inline constexpr double slowest_growth = 1e-9;
inline constexpr double fastest_growth = 1.0;

/// The growth rate, and the packing fraction or pressure at which growth ends. At least one end is given; the first
/// counts.
struct GrowthSettings {
  /// γ = (dD/dt) / √(kT/m): D the smallest diameter, m the smallest mass of a disk of this size, kT the temperature of
  /// the start.
  double rate = 1e-3;
  std::optional<double> packing_fraction;  ///< packing fraction at the end, exactly
  std::optional<double> pressure;          ///< reduced pressure βP/ρ at the end, measured since the last rescaling
  /// Pair collisions over disks between two rescalings, at which the pressure is measured and velocities are scaled to
  /// kT of the start; two hits at walls count as one collision.
  double collisions_per_rescaling = 20.0;
  std::uint64_t audit_every = 0;  ///< pair collisions between two audits; 0: never
};

/// Lubachevsky–Stillinger growth by the exact engine: between collisions every radius grows linearly, R_i(t) = R_i(0)
/// (1 + g t) with the same g, so that ratios of sizes do not change.
///
/// With σ = R_i + R_j and a = dσ/dt a collision changes the velocity v along the line of centres to −v + 2a; at walls,
/// R replaces σ. So growth heats the disks, and velocities are scaled back every 20 collisions a disk. The reduced
/// pressure follows from all collisions since the last rescaling,
///     p = 1 + Σ (σ|Δp| of pairs + R|Δp| of walls) / (2 N kT t),
/// and diverges like 2/(1 − φ/φ_J) as disks jam. A high pressure does not prove jamming: after fast growth states with
/// a high pressure are not jammed.
///
/// The trajectory depends on the disks alone, not on cells, rows or interruptions of advance(). Errors: Error with the
/// setting for ends that contradict each other or the state, for a start that the engine `exact` refuses, for fewer
/// than two disks or disks at rest, and for a periodic box too small for the grown disks. RunFailure if the time does
/// not advance, or if gaps become as small as rounding errors before the packing fraction is reached. Source: B. D.
/// Lubachevsky & F. H. Stillinger, J. Stat. Phys. 60, 561 (1990). Cost: O(1) per collision.
class Growth {
 public:
  Growth(GrowthSettings const& settings, State const& state);
  Growth(Growth const&) = delete;
  Growth& operator=(Growth const&) = delete;
  ~Growth();

  /// Grows the disks until an end is reached, or until should_continue() returns false; returns whether an end is
  /// reached. After an interruption too, radii, positions, velocities and the time in `state` belong to one moment. At
  /// an end velocities are scaled to kT of the start.
  bool advance(State& state, Counters& counters, std::function<bool()> const& should_continue = {});

  /// Returns whether an end is reached; advance() then does nothing.
  [[nodiscard]] bool is_finished() const { return is_finished_; }
  /// Returns βP/ρ between the last two rescalings; nothing before the first rescaling.
  [[nodiscard]] std::optional<double> reduced_pressure() const { return reduced_pressure_; }
  /// Returns the number of pair collisions since the start.
  [[nodiscard]] std::uint64_t collisions() const { return collisions_; }
  /// Returns the number of rescalings of the velocities.
  [[nodiscard]] std::uint64_t rescalings() const { return rescalings_; }

  /// Serializes the growth, after the state. Restored into a Growth of the same start and settings, it continues with
  /// the same bits.
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
  double temperature_ = 0.0;                   // temperature kT of the start
  double diameter_rate_ = 0.0;                 // dD/dt of the smallest diameter
  std::uint64_t hits_per_rescaling_ = 0;       // pair collisions of all disks
  std::unique_ptr<exact::Dynamics> dynamics_;  // nullptr before the first advance() and after the end
  std::unique_ptr<exact::LeftState> left_;
  double start_time_ = 0.0;
  double last_scale_ = 0.0;  // scale of the radii of start_time_ at the final packing fraction; infinite if none is set
  double measured_from_temperature_ = 0.0;
  std::uint64_t collisions_ = 0;
  std::uint64_t hits_at_rescaling_ = 0;  // collisions_ at the next rescaling
  std::uint64_t hits_at_renewal_ = 0;
  std::uint64_t rescalings_ = 0;
  std::optional<double> reduced_pressure_;
  bool is_finished_ = false;
};

}  // namespace gridlock
