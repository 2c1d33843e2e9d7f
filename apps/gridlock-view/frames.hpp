#pragma once

#include <cstddef>
#include <filesystem>
#include <list>
#include <mutex>
#include <string>
#include <vector>

#include "gridlock/io/h5md.hpp"

namespace gridlock::view {

/// Frames of trajectories for the page, read by the library: also while a run writes them, each checked by its
/// checksum.
///
/// HDF5 serves one thread at a time, so all calls wait for one another. Errors: Error for what H5mdReader refuses.
class FrameStore {
 public:
  /// The contents of a trajectory, as JSON: agents, columns, observables, the number of frames, and from frame `first`
  /// on the step and time of each and the value of each observable.
  std::string describe(std::filesystem::path const& file, std::size_t first);

  /// Frame k as bytes: the length of the JSON that follows, 4 bytes; JSON with the clock, the box and where each column
  /// begins and of what type it is; the columns, little-endian, each at a multiple of 8 bytes behind the JSON. All
  /// columns where none is named; columns that it does not have are left out.
  /// Errors: Error for k out of range.
  std::string frame(std::filesystem::path const& file, std::size_t k, std::vector<std::string> const& columns);

 private:
  /// The mark that tells whether a file is still the one that was opened, at its length then.
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
  std::list<Open> open_;  ///< the last used first
};

}  // namespace gridlock::view
