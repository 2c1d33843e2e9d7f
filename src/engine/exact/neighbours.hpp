#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "engine/exact/moving_disk.hpp"

namespace gridlock::exact {

/// The list of disks that a disk can touch as long as all disks stay near their places; in a dense system half as many
/// as the block of cells holds. Kernels read a whole register of indices at once. A large disk among small ones has a
/// long list elsewhere.
struct alignas(64) Neighbours {
  static constexpr std::uint32_t most = 15;

  Index disks[most];    ///< unused entries hold `nobody`; with a long list the first is its index
  std::uint32_t count;  ///< number of neighbours; more than `most` where there is a long list

  [[nodiscard]] bool has_all() const { return count <= most; }
  [[nodiscard]] Index long_list() const { return disks[0]; }
  [[nodiscard]] bool has(Index disk) const {
    // All entries are compared, so that compilers use vector instructions.
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

/// The list of neighbours that are too many for a short list.
using LongList = std::vector<Index>;

/// The reference position of a disk. The disk leaves its place when it is further from it than the room, in x or y.
struct Place {
  double x;
  double y;
};

inline Place place_of(MovingDisk const& disk, Vector gravity, double time) {
  auto const [x, y] = centre_at(disk, gravity, time);
  return {x, y};
}

}  // namespace gridlock::exact
