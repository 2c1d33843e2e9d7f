#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "engine/exact/moving_disk.hpp"

namespace gridlock::exact {

/// The disks that a disk can touch as long as all of them stay near their places: in a dense system half as many as the
/// block of cells has. Kernels read a whole register of indices at a time. A large disk among small ones has a long
/// list elsewhere.
struct alignas(64) Neighbours {
  static constexpr std::uint32_t most = 15;

  Index disks[most];    ///< and behind them `nobody`; the first is the place of the long list where there is one
  std::uint32_t count;  ///< more than `most` where there is a long list

  [[nodiscard]] bool has_all() const { return count <= most; }
  [[nodiscard]] Index long_list() const { return disks[0]; }
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
  void refer_to(Index long_list, Index nobody) {
    clear(nobody);
    disks[0] = long_list;
    count = most + 1;
  }
};
static_assert(sizeof(Neighbours) == 64);

/// The names of more neighbours than a short list has room for.
using LongList = std::vector<Index>;

/// Where a disk is taken to be: it leaves its place when it is further from it than the room of all, in x or y.
struct Place {
  double x;
  double y;
};

inline Place place_of(MovingDisk const& disk, double time) {
  return {disk.x + disk.velocity_x * time, disk.y + disk.velocity_y * time};
}

}  // namespace gridlock::exact
