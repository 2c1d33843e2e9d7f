#pragma once

#include <cstdint>

#include "gridlock/core/archive.hpp"
#include "gridlock/core/box.hpp"
#include "gridlock/core/disks.hpp"

namespace gridlock {

/// Where a run stands: whole steps taken and physical time passed.
struct Clock {
  std::uint64_t step = 0;
  double time = 0.0;

  friend bool operator==(Clock const&, Clock const&) = default;
};

/// All of the physics and nothing else: two equal states have equal futures under the same engine settings.
struct State {
  Box box;
  Disks disks;
  Clock clock;
  std::uint64_t seed = 0;
};

/// The bitwise identity of a state: equal for equal bits of box, clock, seed and every column of every disk.
///
/// XXH3 of each disk's row under its Id, summed modulo 2⁶⁴, so that the order of the rows does not matter.
/// Cost: one pass over the disks.
std::uint64_t hash(State const& state);

/// Carries every bit of a state. Errors: Error where what is restored is none.
void carry(Archive& archive, Clock& clock);
void carry(Archive& archive, Box& box);
void carry(Archive& archive, State& state);

}  // namespace gridlock
