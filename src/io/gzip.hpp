#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace gridlock {

/// Fills the beginning of a span with what comes next, and returns how many bytes have come: 0 at the end.
using ReadBytes = std::function<std::size_t(std::span<char> into)>;

/// Whether bytes begin as a file of gzip does.
inline bool is_gzip(std::string_view bytes) { return bytes.starts_with("\x1f\x8b"); }

/// Unpacks what gzip packed, of one part or of several one after the other, piece by piece.
class GzipReader {
 public:
  explicit GzipReader(ReadBytes packed);
  ~GzipReader();
  GzipReader(GzipReader&&) noexcept;
  GzipReader& operator=(GzipReader&&) noexcept;

  /// Fills the beginning of `into`, and returns how many bytes have come: 0 at the end; nothing where the packed bytes
  /// are damaged or cut off, or become so much longer that they are a trap. Errors: std::bad_alloc.
  std::optional<std::size_t> read(std::span<char> into);

 private:
  class Stream;

  std::unique_ptr<Stream> stream_;
};

}  // namespace gridlock
