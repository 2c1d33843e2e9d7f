#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "io/descriptor.hpp"

namespace gridlock {

/// Returns the open descriptor of this process that a path leads to, directly or by links: 1 for /dev/stdout; nothing
/// for other paths.
std::optional<int> descriptor_named(std::filesystem::path const& path);

/// The treatment of a link, device or directory at the path of a file to be written.
enum class AtName {
  /// Links stay and the file they lead to is written; a device, pipe or open descriptor is written directly.
  written_through,
  replaced,  ///< a link, device or pipe is replaced by the file
};

/// A file that appears under its name complete or not at all.
///
/// Text goes to a temporary file in the same directory; commit() syncs that to the disk and renames it. A crash or a
/// full disk never destroys the file that existed before. Without a commit() the temporary file is removed; if the
/// process is killed, it stays until remove_leftovers() removes it.
/// Errors: RunFailure with the reason of the operating system. Cost: one buffer of 256 KiB, whatever the file's size.
class AtomicFile {
 public:
  explicit AtomicFile(std::filesystem::path path, AtName at_name = AtName::written_through);
  ~AtomicFile();
  AtomicFile(AtomicFile const&) = delete;
  AtomicFile& operator=(AtomicFile const&) = delete;

  void append(std::string_view text);
  /// Returns the path of the bytes before commit(), so that another program can write them instead of append().
  [[nodiscard]] std::filesystem::path const& location() const { return temporary_.empty() ? target_ : temporary_; }
  /// Syncs the file to the disk and renames it; no append() may follow. An earlier file of that name is renamed to
  /// `previous`, if that is given.
  void commit(std::filesystem::path const& previous = {});

 private:
  void write_out(std::string_view text);
  void discard() noexcept;
  [[noreturn]] void fail(int error_number);

  std::filesystem::path path_;       ///< path as the user gave it
  std::filesystem::path target_;     ///< path_, or the target of its symbolic links where these are kept
  std::filesystem::path temporary_;  ///< empty if the target is written directly
  int descriptor_ = -1;
  std::string buffer_;
};

/// Writes a whole file at once, by an AtomicFile.
void write_file(std::filesystem::path const& path, std::string_view content);

/// Removes the temporary files that killed processes left in a directory, named `.NAME.PID-NUMBER.part`.
///
/// A process holds a lock on its temporary file until it ends, on any machine of a shared file system. A file that can
/// be locked thus belongs to no living process. The PID in the name is no proof, as processes on other machines and in
/// other containers have the same numbers.
void remove_leftovers(std::filesystem::path const& directory);

/// Throws if a path exists and is not a regular file, since reading a pipe may wait for its writer for ever. Errors:
/// Error naming the file.
void require_regular_file(std::filesystem::path const& path);

/// Returns the size of a file in bytes. Errors: Error if it is missing or larger than `largest` bytes.
std::uint64_t size_of_file(std::filesystem::path const& path, std::uint64_t largest);

/// Fills `into` with the bytes of a file from `offset` on. Errors: Error if the file is unreadable or too short.
void read_piece(std::filesystem::path const& path, std::uint64_t offset, std::span<char> into);

/// Reads a file or pipe from its beginning, piece by piece. A pipe cannot be read twice.
class FileReader {
 public:
  /// Errors: Error if the file is missing, a directory or unreadable.
  explicit FileReader(std::filesystem::path path);

  /// Fills the beginning of `into`; returns the number of bytes, 0 at the end. Errors: Error if reading fails.
  std::size_t read(std::span<char> into);

  [[nodiscard]] bool is_regular() const { return is_regular_; }
  /// Returns the size of the file in bytes when it was opened; 0 for a pipe.
  [[nodiscard]] std::uint64_t size() const { return size_; }

 private:
  std::filesystem::path path_;
  Descriptor file_;
  bool is_regular_ = false;
  std::uint64_t size_ = 0;
};

/// Returns the bytes of a file.
/// Errors: Error if the file is missing, a directory, unreadable or larger than `largest` bytes (2 GiB).
std::string read_file(std::filesystem::path const& path, std::uint64_t largest = std::uint64_t{1} << 31);

/// Creates a directory with its parents, checks that files can be created in it, and removes leftovers from it.
/// Errors: Error under the key "-o", with the reason of the operating system.
void make_output_directory(std::filesystem::path const& path);

}  // namespace gridlock
