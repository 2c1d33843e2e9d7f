#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "gridlock/core/detail/thread_pool.hpp"

namespace gridlock {

/// Number of disks in a block, one piece of work of a sum. The rounding of sums depends on it.
inline constexpr std::size_t block_size = 256;

inline std::size_t blocks_of(std::size_t disks) { return (disks + block_size - 1) / block_size; }

/// Adds up part(first, end) of all blocks of disks in order: the same bits for any number of threads. A Sum is 0 when
/// value-initialized, and has an operator +=.
template <class Sum, class Part>
Sum sum_over_blocks(std::size_t disks, ThreadPool& pool, Part const& part) {
  auto const part_of = [&](std::size_t block) {
    return part(block * block_size, std::min((block + 1) * block_size, disks));
  };
  std::size_t const blocks = blocks_of(disks);
  Sum sum{};
  if (pool.size() == 1) {
    for (std::size_t block = 0; block < blocks; ++block) sum += part_of(block);
    return sum;
  }
  std::vector<Sum> parts(blocks);
  pool.for_each(blocks, [&](std::size_t block) { parts[block] = part_of(block); });
  for (Sum const& each : parts) sum += each;
  return sum;
}

}  // namespace gridlock
