#pragma once

#include <algorithm>
#include <cstdint>

#include "engine/exact/moving_disk.hpp"

namespace gridlock::exact {

/// The disks that a disk can touch as long as all of them stay near their places: in a dense system half as many as the block of
/// cells has. Kernels read whole registers of names.
struct alignas(64) Neighbours {
  static constexpr std::uint32_t most = 15;

  Index disks[most];    ///< and behind them `nobody`
  std::uint32_t count;  ///< more than `most` where there are too many for this list, and cells are to be asked

  [[nodiscard]] bool has_all() const { return count <= most; }
  [[nodiscard]] bool has(Index disk) const {
    // All are looked at, many at once.
    bool is_found = false;
    for (Index const other : disks) is_found |= other == disk;
    return is_found;
  }
  void clear(Index nobody) {
    std::fill_n(disks, most, nobody);
    count = 0;
  }
  void add(Index disk) {
    if (count < most) disks[count] = disk;
    if (count <= most) ++count;
  }
};
static_assert(sizeof(Neighbours) == 64);

/// Where a disk is taken to be: it leaves its place when it is further from it than the room of all, in x or y.
struct Place {
  double x;
  double y;
};

}  // namespace gridlock::exact
