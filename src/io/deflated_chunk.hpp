#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace gridlock {

/// Numbers that become one chunk of an HDF5 dataset.
struct ChunkSource {
  std::span<std::byte const> bytes;  ///< the numbers, without fill values
  std::size_t width = 8;             ///< size of one number in bytes
  std::size_t capacity = 0;          ///< numbers in the chunk; positions after `bytes` get the fill value
  std::uint64_t fill = 0;            ///< fill value: the bits of a missing number
  bool keeps_fill = false;           ///< whether a chunk with only fill values is written too
};

/// Returns the bytes of a chunk after HDF5's filters "shuffle" and "deflate"; unfiltered numbers for level 0. Returns
/// nothing if all numbers equal the fill value, since HDF5 needs no chunk for them.
///
/// H5Dwrite() of HDF5 does the same, but one chunk at a time, under a global lock and with a slower deflate.
std::vector<std::byte> deflated_chunk(ChunkSource const& source, int level);

}  // namespace gridlock
