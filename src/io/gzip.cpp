#include "io/gzip.hpp"

#include <zlib.h>

#include <array>
#include <limits>
#include <new>
#include <utility>

namespace gridlock {

namespace {

/// Largest ratio of unpacked to packed bytes. Rows of numbers reach about 5; a hostile file may exhaust the memory.
constexpr std::uint64_t max_packed = 100;
/// Unpacked bytes for which any ratio is allowed, since headers pack better than rows.
constexpr std::uint64_t always_allowed = std::uint64_t{1} << 20;

/// Value added to the window size of zlib, which makes zlib read and check the headers and checksums of gzip.
constexpr int gzip_only = 16;

}  // namespace

class GzipReader::Stream {
 public:
  explicit Stream(ReadBytes packed) : packed_(std::move(packed)) {
    if (inflateInit2(&zlib_, gzip_only + MAX_WBITS) != Z_OK) throw std::bad_alloc();
  }
  ~Stream() { inflateEnd(&zlib_); }
  Stream(Stream const&) = delete;
  Stream& operator=(Stream const&) = delete;

  std::optional<std::size_t> read(std::span<char> into) {
    constexpr std::size_t max_at_once = std::numeric_limits<uInt>::max();
    std::size_t const room = std::min(into.size(), max_at_once);
    zlib_.next_out = reinterpret_cast<Bytef*>(into.data());
    zlib_.avail_out = static_cast<uInt>(room);
    while (zlib_.avail_out == room) {
      if (zlib_.avail_in == 0 && !fetch()) return is_between_parts_ ? std::optional<std::size_t>(0) : std::nullopt;
      if (!unpack()) return std::nullopt;
    }
    given_ += room - zlib_.avail_out;
    if (given_ > always_allowed && given_ / max_packed > taken_ - zlib_.avail_in) return std::nullopt;
    return room - zlib_.avail_out;
  }

 private:
  /// Fetches packed bytes; returns false at their end.
  bool fetch() {
    std::size_t const got = packed_(buffer_);
    zlib_.next_in = reinterpret_cast<Bytef*>(buffer_.data());
    zlib_.avail_in = static_cast<uInt>(got);
    taken_ += got;
    return got > 0;
  }

  /// Unpacks bytes of the buffer; returns false if they are damaged.
  bool unpack() {
    is_between_parts_ = false;
    int const result = inflate(&zlib_, Z_NO_FLUSH);
    if (result == Z_MEM_ERROR) throw std::bad_alloc();
    if (result != Z_STREAM_END) return result == Z_OK;
    is_between_parts_ = true;
    return inflateReset(&zlib_) == Z_OK;
  }

  ReadBytes packed_;
  z_stream zlib_{};
  std::array<char, std::size_t{1} << 16> buffer_{};
  bool is_between_parts_ = false;
  std::uint64_t taken_ = 0;
  std::uint64_t given_ = 0;
};

GzipReader::GzipReader(ReadBytes packed) : stream_(std::make_unique<Stream>(std::move(packed))) {}
GzipReader::~GzipReader() = default;
GzipReader::GzipReader(GzipReader&&) noexcept = default;
GzipReader& GzipReader::operator=(GzipReader&&) noexcept = default;

std::optional<std::size_t> GzipReader::read(std::span<char> into) { return stream_->read(into); }

}  // namespace gridlock
