#pragma once

#include <cmath>
#include <cstdint>

#include "engine/soft/system.hpp"

namespace gridlock::soft {

/// Looks every thousand steps whether the energy stays the same where it should: without a thermostat, a flow and
/// a drag.
class EnergyGuard {
 public:
  /// Errors of the energy above this share of the kinetic energy fail.
  static constexpr double max_error = 0.05;
  static constexpr std::uint64_t steps_between_looks = 1000;

  EnergyGuard(EngineSettings const& settings, System const& system) : settings_(settings) {
    if (is_on()) energy_ = energy_of(system);
  }

  /// Errors: RunFailure if the energy has changed since the last look.
  void look(std::uint64_t step, System const& system) {
    if (!is_on() || step % steps_between_looks != 0) return;
    double const before = energy_;
    energy_ = energy_of(system);
    double const error = std::abs(energy_ - before);
    double const kinetic = system.kinetic_energy();
    // Disks at rest have errors of rounding alone.
    if (error <= max_error * kinetic + 1e-9 * std::abs(before)) return;
    throw_change(step, energy_ - before, kinetic);
  }

 private:
  [[nodiscard]] bool is_on() const {
    return settings_.thermostat.kind == ThermostatKind::none && !settings_.flow.exists() &&
           !settings_.pair_drag.exists();
  }
  static double energy_of(System const& system) { return system.kinetic_energy() + system.potential_energy(); }
  [[noreturn]] void throw_change(std::uint64_t step, double change, double kinetic) const;

  EngineSettings const& settings_;
  double energy_ = 0.0;
};

}  // namespace gridlock::soft
