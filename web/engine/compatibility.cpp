#include "compatibility.hpp"

#include <fast_float/fast_float.h>
#include <fmt/format.h>

#include "gridlock/core/error.hpp"
#include "io/gzip.hpp"
#include "io/h5md_text.hpp"

namespace std {  // NOLINT(cert-dcl58-cpp): see the header

from_chars_result from_chars(char const* first, char const* last, double& value) {
  auto const [end, error] = fast_float::from_chars(first, last, value);
  return {end, error};
}

/// Writes the shortest text that reads back as the same bits. fmt chooses the format, as its only caller number_text()
/// requires.
to_chars_result to_chars(char* first, char* last, double value, chars_format /*format*/) {
  auto const room = static_cast<size_t>(last - first);
  auto const [end, length] = fmt::format_to_n(first, room, "{}", value);
  if (length > room) return {last, errc::value_too_large};
  return {end, errc{}};
}

}  // namespace std

namespace gridlock {

// The page reads no compressed files, and zlib is not available as headers only.

class GzipReader::Stream {};

GzipReader::GzipReader(ReadBytes /*packed*/) {
  throw Error({.what = "compressed files cannot be read here", .hint = "unpack the file first"});
}
GzipReader::~GzipReader() = default;
GzipReader::GzipReader(GzipReader&&) noexcept = default;
GzipReader& GzipReader::operator=(GzipReader&&) noexcept = default;

std::optional<std::size_t> GzipReader::read(std::span<char> /*into*/) { return std::nullopt; }

// The page reads trajectories in H5MD by h5wasm.

TrajectoryText text_of_trajectory(std::filesystem::path const& path) {
  throw Error({.what = path.string() + " is a trajectory in H5MD, and extended XYZ is read here",
               .hint = "gridlock export FILE --to xyz makes extended XYZ of it"});
}

}  // namespace gridlock
