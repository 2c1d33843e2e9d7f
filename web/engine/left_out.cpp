// Readers that a build of the engines alone leaves out, as zlib and HDF5 are not available as headers only. The page
// reads no compressed files, and trajectories in H5MD by h5wasm.

#include "gridlock/core/error.hpp"
#include "io/gzip.hpp"
#include "io/h5md_text.hpp"

namespace gridlock {

class GzipReader::Stream {};

GzipReader::GzipReader(ReadBytes /*packed*/) {
  throw Error({.what = "compressed files cannot be read here", .hint = "unpack the file first"});
}
GzipReader::~GzipReader() = default;
GzipReader::GzipReader(GzipReader&&) noexcept = default;
GzipReader& GzipReader::operator=(GzipReader&&) noexcept = default;

std::optional<std::size_t> GzipReader::read(std::span<char> /*into*/) { return std::nullopt; }

TrajectoryText text_of_trajectory(std::filesystem::path const& path) {
  throw Error({.what = path.string() + " is a trajectory in H5MD, and extended XYZ is read here",
               .hint = "gridlock export FILE --to xyz makes extended XYZ of it"});
}

}  // namespace gridlock
