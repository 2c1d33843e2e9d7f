#include "study/partial_results.hpp"

#include <fmt/format.h>
#include <xxhash.h>

#include <exception>
#include <regex>
#include <system_error>
#include <utility>
#include <vector>

#include "gridlock/core/error.hpp"
#include "gridlock/workspace/run_directory.hpp"
#include "io/checkpoint.hpp"
#include "io/file.hpp"

namespace gridlock {

namespace {

/// A piece of the full study has less than a hundred kilobytes.
constexpr std::uint64_t largest_piece = std::uint64_t{1} << 28;

void serialize_piece(Archive& archive, std::string const& key, std::function<void(Archive&)> const& serialize) {
  for (auto const& [name, own] : {std::pair("version", std::string(version())), std::pair("key", key)}) {
    std::string recorded = own;
    archive.visit(name, recorded);
    archive.require(recorded == own, "it is the result of another piece, or of another version");
  }
  serialize_inside(archive, "result", [&] { serialize(archive); });
}

}  // namespace

std::filesystem::path PartialResults::file_of(std::string const& key) const {
  return directory_ / fmt::format("{:016x}.gridlock", XXH3_64bits(key.data(), key.size()));
}

bool PartialResults::restore(std::string const& key, std::function<void(Archive&)> const& serialize) const {
  std::filesystem::path const file = file_of(key);
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(file, ignored)) return false;
  try {
    from_checkpoint(read_file(file, largest_piece), file.string(),
                    [&](Archive& archive) { serialize_piece(archive, key, serialize); });
    return true;
  } catch (Error const&) {
    return false;
  }
}

void PartialResults::keep(std::string const& key, std::function<void(Archive&)> const& serialize) {
  std::string const bytes = to_checkpoint([&](Archive& archive) { serialize_piece(archive, key, serialize); });
  try {
    std::filesystem::create_directories(directory_);
    write_file(file_of(key), bytes);
  } catch (std::exception const& error) {
    std::scoped_lock const lock(mutex_);
    if (problem_.empty()) problem_ = error.what();
  }
}

std::string PartialResults::problem() const {
  std::scoped_lock const lock(mutex_);
  return problem_;
}

void PartialResults::remove_all() const {
  // What a killed process has left of a piece is hidden and ends with "part".
  static std::regex const piece(R"re(\.?[0-9a-f]{16}\.gridlock(\..*\.part)?)re");
  std::error_code ignored;
  std::vector<std::filesystem::path> files;
  for (auto const& entry : std::filesystem::directory_iterator(directory_, ignored)) {
    if (std::regex_match(entry.path().filename().string(), piece)) files.push_back(entry.path());
  }
  for (auto const& file : files) std::filesystem::remove(file, ignored);
  // Only an empty directory is removed.
  std::filesystem::remove(directory_, ignored);
}

}  // namespace gridlock
