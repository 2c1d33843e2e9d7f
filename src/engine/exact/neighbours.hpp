#pragma once

#include <algorithm>
#include <cstdint>

#include "engine/exact/moving_disk.hpp"

namespace gridlock::exact {

/// The disks that a growing disk can touch as long as all of them stay near their places: close to jamming a handful, where
/// the block of cells has a dozen.
struct alignas(64) Neighbours {
  static constexpr std::uint32_t most = 15;

  Index disks[most];
  std::uint32_t count;  ///< more than `most` where there are too many for this list, and cells are to be asked

  [[nodiscard]] bool has_all() const { return count <= most; }
  [[nodiscard]] bool has(Index disk) const {
    for (std::uint32_t k = 0; k < std::min(count, most); ++k) {
      if (disks[k] == disk) return true;
    }
    return false;
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
