#pragma once

#include <cstddef>
#include <span>

#include "gridlock/core/agents_view.hpp"
#include "gridlock/core/disks.hpp"

namespace gridlock {

/// Tells agents that move from disks that are fixed, whose mass is infinite. Agents without a mass all move.
class MobileAgents {
 public:
  explicit MobileAgents(AgentsView const& agents) {
    if (agents.has<Mass>()) masses_ = agents.column<Mass>();
  }
  [[nodiscard]] bool has(std::size_t row) const { return masses_.empty() || !is_fixed(masses_[row]); }

 private:
  std::span<double const> masses_;
};

}  // namespace gridlock
