#pragma once

#include <array>
#include <cstddef>

#include "gridlock/core/counters.hpp"
#include "gridlock/core/detail/exact_sum.hpp"
#include "gridlock/core/detail/message.hpp"

namespace gridlock {

/// The counters of the tiles in one step. Sums of floating-point numbers are exact until all tiles are in: so the tiles
/// may come in any order and from any process, and the bits are the same.
class CountersOfStep {
 public:
  void add(Counters const& of_tile);
  /// Adds the counters of other tiles.
  void add(CountersOfStep const& others);

  /// Adds all of it to the counters of a run, where each sum of the step is rounded once.
  void add_to(Counters& counters) const;

  void write(MessageWriter& message) const;
  static CountersOfStep read(MessageReader& message);

 private:
  Counters whole_numbers_;  ///< its sums are 0
  ExactSum pair_virial_;
  std::array<ExactSum, 4> wall_impulse_;
};

}  // namespace gridlock
