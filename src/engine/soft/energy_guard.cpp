#include "engine/soft/energy_guard.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "gridlock/core/error.hpp"

namespace gridlock::soft {

void EnergyGuard::throw_change(std::uint64_t step, double change, double kinetic) const {
  // The error of velocity Verlet grows with the square of the step.
  double const shorter = std::sqrt(0.1 * max_error * kinetic / std::abs(change));
  throw RunFailure(
      fmt::format("step {}: the energy has changed by {:.3g} in up to {} steps without a thermostat, at a kinetic "
                  "energy of {:.3g}\n"
                  "  hint: use a shorter engine.time_step, such as {:.1g}",
                  step, change, steps_between_looks, kinetic, settings_.time_step * std::max(shorter, 0.01)));
}

}  // namespace gridlock::soft
