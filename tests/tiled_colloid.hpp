#pragma once

#include <algorithm>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "examples/colloid.hpp"
#include "gridlock/core/detail/time_step_rule.hpp"
#include "gridlock/grid/detail/packed_layout.hpp"

namespace gridlock {

/// The paper's rule tile by tile, in the cells of the engine `tiled`: model and engine have the same bits, and each
/// proves the other.
struct TiledColloid : ColloidRule<TiledColloid> {
  static constexpr Schedule schedule = Schedule::tiled;
  static constexpr std::string_view name = "colloid_tiled";

  /// Room for disks of twice the speed that the step length refers to.
  [[nodiscard]] CellLayout cells(AgentSums<TiledColloid> const& all) const {
    RadiusRange const radii = radii_of(all);
    double const displacement_at_speed = step_length * 2.0 * radii.smallest;
    return packed_layout(all.box(), radii, all.size(), 2.0 * displacement_at_speed);
  }
  /// The few disks that are faster still wait for the end of the step.
  [[nodiscard]] bool is_local(Turn<TiledColloid> const& self, double room) const {
    double const rounding = static_cast<double>(substeps) * std::numeric_limits<double>::epsilon() *
                            std::max(self.box().width(), self.box().height());
    double const displacement = room * (1.0 - 1e-9) - largest_contact(self) - rounding;
    return displacement > 0.0 &&
           squared_length(velocity(self)) * self.time_step() * self.time_step() <= displacement * displacement;
  }

  [[nodiscard]] std::vector<std::string> notes(AgentSums<TiledColloid> const& all) const {
    std::string const reasons = in_words(time_step_caveats(all.box(), area_of(all)));
    if (reasons.empty()) return {};
    return {"with model.kind = \"" + std::string(TiledColloid::name) + "\" " + reasons +
            ", because of its time step; engine.kind = \"exact\" has none"};
  }
};

}  // namespace gridlock
