#pragma once

#include "core/overlap_law.hpp"
#include "gridlock/packing/soft_disks.hpp"

namespace gridlock {

/// The potential of soft disks at rest, in units of ε.
class Law : public OverlapLaw {
 public:
  explicit Law(Potential potential) : OverlapLaw(potential == Potential::harmonic) {}
};

}  // namespace gridlock
