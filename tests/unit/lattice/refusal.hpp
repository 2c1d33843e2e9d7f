#pragma once

#include <gtest/gtest.h>

#include "gridlock/core/error.hpp"
#include "gridlock/lattice/start.hpp"

namespace gridlock {

/// Why these disks find no start in a unit box; nothing and a failure where they do.
inline Problem refusal_of(DisksSettings const& disks, Edge edge = Edge::periodic) {
  try {
    static_cast<void>(make_start(Box(1.0, 1.0, edge), disks, 1));
  } catch (Error const& error) {
    return error.problems().front();
  }
  ADD_FAILURE() << "the start was found";
  return {};
}

}  // namespace gridlock
