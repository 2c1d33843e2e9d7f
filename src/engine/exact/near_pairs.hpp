#pragma once

#include <cstddef>
#include <vector>

#include "engine/exact/prediction.hpp"
#include "gridlock/core/target.hpp"

namespace gridlock::exact {

/// Pairs of disks, each of which is looked at once for both its disks.
struct Pairs {
  /// Pairs that a kernel gets at once, which stay in the first cache.
  static constexpr std::size_t at_once = 512;
  /// Entries behind the last pair that a kernel may read and write.
  static constexpr std::size_t slack = 8;

  std::size_t count = 0;
  std::vector<Index> one;
  std::vector<Index> other;
  std::vector<double> times;  ///< of contact

  void make_room_for(std::size_t more) {
    if (count + more + slack <= one.size()) return;
    one.resize(2 * (count + more + slack));
    other.resize(one.size());
    times.resize(one.size());
  }
  /// Adds the pair where `is_pair`, without a branch. Contract: there is room.
  void add(Index i, Index j, bool is_pair) {
    one[count] = i;
    other[count] = j;
    count += is_pair ? 1 : 0;
  }
};

/// Kernels that look at each pair of two near disks once, from cells without lists. All give the same pairs, in the
/// same order, and the same bits.
struct NearPairs {
  /// Adds the pairs of disk `first`, and of those after it while there are fewer than Pairs::at_once, with the disks
  /// behind them: those later in the cell, and those in the four cells to the right and above. Returns the
  /// next disk. Contract: first < end.
  Index (*add)(PredictionInput const& prediction_input, Index first, Index end, Pairs& pairs);
  /// Writes the time at which each pair touches, or `never`, with the bits of the predictions of both disks.
  /// Contract: time 0, no disk has been hit or grows, and the nearest image of a disk is the only one to be met.
  void (*find_times)(PredictionInput const& prediction_input, Pairs& pairs);
};

/// Returns the kernels for the instructions of this target, which the processor must have, and for these cells.
NearPairs near_pairs_for(Target target, PredictionInput const& prediction_input);

}  // namespace gridlock::exact
