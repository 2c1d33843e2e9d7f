#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace gridlock {

/// Fills the beginning of a span with the next bytes; returns their number, 0 at the end.
using ReadBytes = std::function<std::size_t(std::span<char> into)>;

/// Returns whether bytes begin with the mark of gzip.
inline bool is_gzip(std::string_view bytes) { return bytes.starts_with("\x1f\x8b"); }

/// Unpacks a gzip file of one or several parts, piece by piece.
class GzipReader {
 public:
  explicit GzipReader(ReadBytes packed);
  ~GzipReader();
  GzipReader(GzipReader&&) noexcept;
  GzipReader& operator=(GzipReader&&) noexcept;

  /// Fills the beginning of `into`; returns the number of bytes, 0 at the end. Returns nothing if the packed bytes are
  /// damaged, cut off, or unpack to a suspiciously large size. Errors: std::bad_alloc.
  std::optional<std::size_t> read(std::span<char> into);

 private:
  class Stream;

  std::unique_ptr<Stream> stream_;
};

}  // namespace gridlock
