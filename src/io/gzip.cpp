#include "io/gzip.hpp"

#include <libdeflate.h>

#include <algorithm>
#include <memory>
#include <new>

namespace gridlock {

bool is_gzip(std::string_view bytes) { return bytes.starts_with("\x1f\x8b"); }

std::optional<std::string> unpacked_gzip(std::string_view bytes, std::size_t longest) {
  std::unique_ptr<libdeflate_decompressor, decltype(&libdeflate_free_decompressor)> const decompressor(
      libdeflate_alloc_decompressor(), &libdeflate_free_decompressor);
  if (!decompressor) throw std::bad_alloc();
  std::string text;
  std::size_t length = 0;
  text.resize(std::min(longest, 4 * bytes.size()));
  while (!bytes.empty()) {
    std::size_t taken = 0;
    std::size_t given = 0;
    libdeflate_result const result = libdeflate_gzip_decompress_ex(
        decompressor.get(), bytes.data(), bytes.size(), text.data() + length, text.size() - length, &taken, &given);
    if (result == LIBDEFLATE_INSUFFICIENT_SPACE && text.size() < longest) {
      text.resize(std::min(longest, 2 * text.size()));
      continue;
    }
    if (result != LIBDEFLATE_SUCCESS) return std::nullopt;
    bytes.remove_prefix(taken);
    length += given;
  }
  text.resize(length);
  return text;
}

}  // namespace gridlock
