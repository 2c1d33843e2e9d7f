#pragma once

#include <string>
#include <vector>

#include "gridlock/engine/engine.hpp"

namespace gridlock::reference {

/// The names of the engines of hard disks that have dynamics.
inline std::vector<std::string> hard_engine_kinds() {
  std::vector<std::string> kinds;
  for (EngineRecord const& engine : engine_records()) {
    if (!engine.has_potential && !engine.is_monte_carlo) kinds.emplace_back(engine.name);
  }
  return kinds;
}

}  // namespace gridlock::reference
