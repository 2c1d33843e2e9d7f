#include "gridlock/engine/propulsion.hpp"

#include <cmath>

#include "core/magnitude.hpp"

namespace gridlock {

void describe(PropulsionSettings& settings, SettingVisitor& visitor) {
  visitor.visit(
      {.key = "speed",
       .unit = "length / time",
       .documentation =
           "Speed v₀ at which each disk swims along its heading; 0: disks do not propel themselves. In the engine "
           "exact it needs thermostat.kind = \"brownian\".",
       .min = 0.0,
       .max = max_magnitude},
      settings.speed);
  visitor.visit({.key = "rotational_diffusion",
                 .unit = "radian² / time",
                 .documentation = "D_R: the angle of a heading has the variance 2 D_R t after a time t.",
                 .min = 0.0,
                 .max = max_magnitude},
                settings.rotational_diffusion);
}

double turn_width(PropulsionSettings const& settings, double duration) {
  return std::sqrt(2.0 * settings.rotational_diffusion * duration);
}

}  // namespace gridlock
