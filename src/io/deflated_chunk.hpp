#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace gridlock {

/// Numbers to be written into a chunk of HDF5.
struct ChunkSource {
  std::span<std::byte const> bytes;  ///< the numbers there are
  std::size_t width = 8;             ///< bytes of one number
  std::size_t capacity = 0;          ///< numbers the chunk holds; the rest is filled up
  std::uint64_t fill = 0;            ///< the bits of a number that is not there
  bool keeps_fill = false;           ///< whether a chunk of nothing but the fill value has to exist too
};

/// The bytes of a chunk as the filters "shuffle" and "deflate" of HDF5 leave them; only the numbers themselves for
/// level 0. Empty where every number has the bits of the fill value, and the chunk need not exist.
///
/// HDF5 would do the same in its H5Dwrite(), but one chunk at a time, under its global lock and with a slower deflate.
std::vector<std::byte> deflated_chunk(ChunkSource const& source, int level);

}  // namespace gridlock
