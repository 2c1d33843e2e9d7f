#include "gridlock/engine/pair_drag.hpp"

#include <array>
#include <string_view>

#include "core/magnitude.hpp"

namespace gridlock {

void describe(PairDragSettings& settings, SettingVisitor& visitor) {
  static constexpr std::array<std::string_view, 2> directions{"all", "normal"};
  visitor.visit({.key = "coefficient",
                 .unit = "mass / time",
                 .documentation = "k of the drag −k (v_i − v_j) between disks of the engine soft that touch; it needs "
                                  "inertia and no temperature, and 0 is no drag.",
                 .min = 0.0,
                 .max = max_magnitude},
                settings.coefficient);
  visit_enum(visitor,
             {.key = "direction",
              .documentation = "Which part of the relative velocity a drag slows down: \"all\", or \"normal\" for "
                               "that along the line of centres alone."},
             directions, settings.direction);
}

}  // namespace gridlock
