#pragma once

#include <array>
#include <cstddef>
#include <span>

#include "gridlock/core/counters.hpp"
#include "gridlock/core/detail/exact_sum.hpp"
#include "gridlock/core/detail/message.hpp"

namespace gridlock {

/// The counters of all tiles in one step. Sums of floating-point numbers are kept exactly until all tiles are added, so
/// that the bits do not depend on the order of the tiles or on the process that computed them.
class CountersOfStep {
 public:
  void add(Counters const& of_tile);
  /// Add sums of floating-point numbers, one of each tile.
  void add_pair_virials(std::span<double const> of_tiles) { pair_virial_.add(of_tiles); }
  void add_inner_wall_impulses(std::span<double const> of_tiles) { inner_wall_impulse_.add(of_tiles); }
  void add_wall_impulses(std::size_t wall, std::span<double const> of_tiles) { wall_impulse_[wall].add(of_tiles); }
  /// Adds the counters of the tiles in `others`.
  void add(CountersOfStep const& others);

  /// Adds every count and sum to the counters of a run; each sum of the step is rounded once.
  void add_to(Counters& counters) const;

  void write(MessageWriter& message) const;
  static CountersOfStep read(MessageReader& message);

 private:
  Counters whole_numbers_;  ///< the counts of the step; its floating-point sums stay 0
  ExactSum pair_virial_;
  ExactSum inner_wall_impulse_;
  std::array<ExactSum, 4> wall_impulse_;
};

}  // namespace gridlock
