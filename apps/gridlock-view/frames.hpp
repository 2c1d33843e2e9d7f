#pragma once

#include <cstddef>
#include <filesystem>
#include <list>
#include <mutex>
#include <string>
#include <vector>

#include "gridlock/io/h5md.hpp"

namespace gridlock::view {

/// Reads frames of trajectories for the page, also while a run writes them. Each frame is verified by its checksum.
///
/// Calls wait for each other, since HDF5 serves one thread at a time. Errors: Error for files that H5mdReader refuses.
class FrameStore {
 public:
  /// Returns a description of a trajectory in JSON: agents, columns, observables, the number of frames, and from frame
  /// `first` on the step, time and observables of each frame.
  std::string describe(std::filesystem::path const& file, std::size_t first);

  /// Returns frame k as bytes: the length of the JSON, 4 bytes; JSON with clock, box, and offset and type of each
  /// column; the columns, little-endian, each at a multiple of 8 bytes after the JSON. An empty `columns` requests all
  /// columns; unknown names are ignored. Errors: Error if k is out of range.
  std::string frame(std::filesystem::path const& file, std::size_t k, std::vector<std::string> const& columns);

 private:
  /// The identity and length of a file when it was opened, to detect a changed file.
  struct Version {
    std::uint64_t device = 0, inode = 0, bytes = 0;
    std::int64_t seconds = 0, nanoseconds = 0;
    friend bool operator==(Version const&, Version const&) = default;
  };
  struct Open {
    std::filesystem::path file;
    Version version;
    H5mdReader reader;
  };

  H5mdReader const& reader(std::filesystem::path const& file);
  static Version version_of(std::filesystem::path const& file);

  std::mutex mutex_;
  std::list<Open> open_;  ///< most recently used first
};

}  // namespace gridlock::view
