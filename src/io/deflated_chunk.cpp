#include "io/deflated_chunk.hpp"

#include <libdeflate.h>

#include <algorithm>
#include <cassert>
#include <cstring>
#include <memory>
#include <new>

namespace gridlock {

namespace {

using Compressor = std::unique_ptr<libdeflate_compressor, decltype(&libdeflate_free_compressor)>;

/// Returns a compressor for this thread and level. It is reused, since its tables take some hundred KiB.
libdeflate_compressor* compressor_of(int level) {
  thread_local Compressor compressor(nullptr, &libdeflate_free_compressor);
  thread_local int present_level = -1;
  if (present_level != level) {
    compressor.reset(libdeflate_alloc_compressor(level));
    if (!compressor) throw std::bad_alloc();
    present_level = level;
  }
  return compressor.get();
}

/// Returns the numbers of the chunk, filled up to its capacity, before any filter.
std::vector<std::byte> filled_up(ChunkSource const& source) {
  std::vector<std::byte> raw(source.capacity * source.width);
  std::ranges::copy(source.bytes, raw.begin());
  // Little-endian, as the file is: the low bytes of the fill value come first.
  for (std::size_t at = source.bytes.size(); at < raw.size(); at += source.width) {
    std::memcpy(raw.data() + at, &source.fill, source.width);
  }
  return raw;
}

bool is_all_fill(ChunkSource const& source) {
  for (std::size_t at = 0; at < source.bytes.size(); at += source.width) {
    if (std::memcmp(source.bytes.data() + at, &source.fill, source.width) != 0) return false;
  }
  return true;
}

/// Returns all first bytes of the numbers, then all second bytes, and so on. Similar bytes side by side deflate better.
std::vector<std::byte> shuffled(std::span<std::byte const> raw, std::size_t width) {
  std::vector<std::byte> result(raw.size());
  std::size_t const count = raw.size() / width;
  for (std::size_t byte = 0; byte < width; ++byte) {
    std::byte* const plane = result.data() + byte * count;
    for (std::size_t i = 0; i < count; ++i) plane[i] = raw[i * width + byte];
  }
  return result;
}

}  // namespace

std::vector<std::byte> deflated_chunk(ChunkSource const& source, int level) {
  assert(source.bytes.size() <= source.capacity * source.width);
  if (!source.keeps_fill && is_all_fill(source)) return {};
  std::vector<std::byte> raw = filled_up(source);
  if (level == 0) return raw;
  std::vector<std::byte> const planes = shuffled(raw, source.width);
  libdeflate_compressor* const compressor = compressor_of(level);
  std::vector<std::byte> deflated(libdeflate_zlib_compress_bound(compressor, planes.size()));
  deflated.resize(libdeflate_zlib_compress(compressor, planes.data(), planes.size(), deflated.data(), deflated.size()));
  return deflated;
}

}  // namespace gridlock
