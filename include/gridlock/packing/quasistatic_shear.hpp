#pragma once

/// \file
/// Quasi-static shear of soft disks: small steps of strain, and the nearest minimum of the energy after each.
///
/// ```cpp
/// Packing const start{.box = Box(1.0, 1.0, Edge::periodic), .x = {0.3, 0.45}, .y = {0.5, 0.5}, .radius = {0.1, 0.1}};
/// QuasistaticShear shear({.step = 0.01, .until_strain = 0.1}, start);
/// shear.advance();
/// double const stress = shear.minima().back().stress.xy;  // 0: the two have moved apart
/// ```

#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <vector>

#include "gridlock/core/archive.hpp"
#include "gridlock/packing/contact_network.hpp"
#include "gridlock/packing/minimizer.hpp"
#include "gridlock/packing/soft_disks.hpp"

namespace gridlock {

/// The deformation of a periodic box by a strain γ. Both have the shear stress σ = dE/dγ/A.
///
/// simple_shear: x ← x + γ y; the tilt of the box grows by γ.
/// pure_shear:   x ← x e^(γ/2), y ← y e^(−γ/2); the box keeps its area.
enum class Deformation { simple_shear, pure_shear };

/// The settings of a quasi-static shear.
struct QuasistaticShearSettings {
  MinimizerSettings minimizer = {};
  Deformation deformation = Deformation::simple_shear;
  double step = 1e-3;         ///< strain between two kept minima
  double until_strain = 0.1;  ///< strain at the end, below 0 for the other direction; the amplitude of cycles
  double until_stress = std::numeric_limits<double>::infinity();  ///< |σ| D²/ε at which it ends
  std::uint64_t cycles = 0;             ///< each from 0 to until_strain, to −until_strain and back to 0; 0: no cycles
  double accuracy = 1e-6;               ///< strain within which an event is found
  std::optional<double> min_drop = {};  ///< smallest drop of |σ| D²/ε that is an event; none: step/5
  static constexpr double max_steps = 1e6;
};

/// Throws Error for settings out of range.
void require_valid(QuasistaticShearSettings const& settings);

/// A minimum at one strain. Stresses are in ε/D², D the smallest diameter, and tension is positive.
struct ShearedMinimum {
  double strain = 0.0;
  double shear_stress = 0.0;  ///< dE/dγ/A for the deformation
  StressTensor stress;
  double energy = 0.0;  ///< of all disks, in ε
  std::uint64_t contacts = 0;
};

/// A drop of the stress at one strain: a rearrangement.
struct ShearEvent {
  double strain = 0.0;          ///< last strain before the drop
  double width = 0.0;           ///< distance to the first strain after it
  double stress_drop = 0.0;     ///< in ε/D²
  double energy_drop = 0.0;     ///< of all disks, in ε
  double moved_disks = 0.0;     ///< disks that moved by more than 0.01 D against the affine motion
  double participation = 0.0;   ///< (Σ u²)²/Σ u⁴ of these motions u of all disks
  double largest_motion = 0.0;  ///< in D
  double softest_mode = std::numeric_limits<double>::quiet_NaN();  ///< smallest eigenvalue before the drop, in ε/D²
  double mode_overlap = std::numeric_limits<double>::quiet_NaN();  ///< |u·e|/|u| with the unit vector e of that mode
};

/// The motion of a disk in an event.
struct EventMotion {
  std::uint32_t event = 0;  ///< number of the event, from 0
  std::uint32_t disk = 0;
  Vector place;   ///< before the event
  Vector motion;  ///< against the affine motion
};

/// The end of a cycle.
struct ShearCycle {
  double largest_motion = 0.0;  ///< between the ends of the cycle before and of this one, in D
  bool is_reversible = false;   ///< whether no disk has moved by more than 0.001 D
};

enum class ShearStatus { running, reached, unconverged };

/// Shears a packing in steps and finds the minimum after each.
///
/// Each step deforms box and centres and searches the minimum downhill from there. Where the stress has fallen by more
/// than `min_drop`, the step is halved until the drop lies within `accuracy`. The minima at whole steps are kept. Bits
/// depend on neither threads nor interruptions.
/// Errors: Error for a box that is not periodic, for settings out of range, and for a packing that the minimizer
/// refuses. Cost: about 0.1 s a step for 1,000 disks. Source: C. Maloney and A. Lemaître (2006),
/// doi:10.1103/PhysRevE.74.016118.
class QuasistaticShear {
 public:
  QuasistaticShear(QuasistaticShearSettings const& settings, Packing packing);

  /// Continues until the end or until should_continue() returns false. Returns whether the end is reached.
  bool advance(std::function<bool()> const& should_continue = {});

  [[nodiscard]] ShearStatus status() const { return status_; }
  /// Returns the minima at whole steps, from strain 0.
  [[nodiscard]] std::vector<ShearedMinimum> const& minima() const { return minima_; }
  [[nodiscard]] std::vector<ShearEvent> const& events() const { return events_; }
  [[nodiscard]] std::vector<EventMotion> const& motions() const { return motions_; }
  [[nodiscard]] std::vector<ShearCycle> const& cycles() const { return cycles_; }
  /// Returns the disks at the last minimum, all inside the box.
  [[nodiscard]] Packing const& packing() const { return kept_; }
  /// Return the edges that each disk has crossed since the start, as its images count them.
  [[nodiscard]] std::vector<std::int32_t> crossed_x() const;
  [[nodiscard]] std::vector<std::int32_t> const& crossed_y() const { return crossed_y_; }
  /// Returns the widths by which the box has been shifted back: an image that was m edges above is now m times as many
  /// edges farther to the right.
  [[nodiscard]] std::int32_t widths_shifted_back() const;
  [[nodiscard]] Minimizer const& minimizer() const { return minimizer_; }

  void serialize(Archive& archive);

 private:
  [[nodiscard]] double strain_at(std::uint64_t whole_steps) const;
  [[nodiscard]] double strain_of(double share) const;
  [[nodiscard]] Box box_at(double strain) const;
  [[nodiscard]] Packing deformed(double strain) const;
  [[nodiscard]] ShearedMinimum measured(double strain) const;
  void take_minimum();
  void accept(ShearedMinimum const& minimum);
  void add_event(ShearedMinimum const& minimum);
  void end_step();
  void end_cycle();
  [[nodiscard]] double next_share() const;
  void try_share(double share);

  QuasistaticShearSettings settings_;
  Box first_box_;
  double diameter_;
  std::uint64_t steps_per_amplitude_;
  std::uint64_t all_steps_;
  Packing kept_;  ///< the last minimum
  ShearedMinimum minimum_;
  std::vector<std::int32_t> crossed_x_, crossed_y_;  ///< as if the box were never shifted back
  std::uint64_t whole_steps_ = 0;
  double kept_share_ = 0.0;   ///< share of the present step at which kept_ is
  double tried_share_ = 0.0;  ///< that of the minimum that is searched
  double drop_share_ = none;  ///< least share behind a drop, if one is known
  bool has_minimum_ = false;
  ShearStatus status_ = ShearStatus::running;
  std::vector<ShearedMinimum> minima_;
  std::vector<ShearEvent> events_;
  std::vector<EventMotion> motions_;
  std::vector<ShearCycle> cycles_;
  std::vector<double> x_of_cycle_, y_of_cycle_;  ///< centres at the end of the last cycle, without jumps at edges
  Minimizer minimizer_;

  static constexpr double none = 2.0;
};

// Serialize every bit, as columns.
void serialize(Archive& archive, std::vector<ShearedMinimum>& minima);
void serialize(Archive& archive, std::vector<ShearEvent>& events);
void serialize(Archive& archive, std::vector<EventMotion>& motions);
void serialize(Archive& archive, std::vector<ShearCycle>& cycles);

}  // namespace gridlock
