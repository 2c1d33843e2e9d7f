#include "gridlock/engine/flow.hpp"

#include "core/magnitude.hpp"

namespace gridlock {

void describe(FlowSettings& settings, SettingVisitor& visitor) {
  visitor.visit({.key = "shear_rate",
                 .unit = "1 / time",
                 .documentation = "γ̇ of a steady flow γ̇ y along x, for the engine soft in a periodic box, whose tilt "
                                  "grows by γ̇ in a unit of time; 0 is no flow.",
                 .min = -max_magnitude,
                 .max = max_magnitude},
                settings.shear_rate);
}

}  // namespace gridlock
