#pragma once

#include <filesystem>
#include <functional>
#include <mutex>
#include <string>
#include <utility>

#include "gridlock/core/archive.hpp"

namespace gridlock {

/// Finished pieces of a study that is not finished, one file each in a directory of their own, so that a study that is
/// stopped or killed continues without doing them again.
///
/// A piece is found by its key, which says everything that its result depends on; the file holds the key and the version of
/// the library as well, and a file that is damaged or of another version counts as none. Every file is written whole or
/// not at all. May be used from several threads at a time, for different keys.
class PartialResults {
 public:
  explicit PartialResults(std::filesystem::path directory) : directory_(std::move(directory)) {}

  /// Restores the result of a piece; false where there is none, and what `serialize` visits is then only partly restored.
  [[nodiscard]] bool restore(std::string const& key, std::function<void(Archive&)> const& serialize) const;

  /// Keeps the result of a piece. Where it cannot be written the study continues, and problem() says why.
  void keep(std::string const& key, std::function<void(Archive&)> const& serialize);

  /// Why a piece could not be kept; empty where all were.
  [[nodiscard]] std::string problem() const;

  /// Removes all pieces, and the directory where nothing else is in it.
  void remove_all() const;

 private:
  [[nodiscard]] std::filesystem::path file_of(std::string const& key) const;

  std::filesystem::path directory_;
  mutable std::mutex mutex_;
  std::string problem_;
};

}  // namespace gridlock
