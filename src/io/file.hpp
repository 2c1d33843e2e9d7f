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

/// The open descriptor of this process that a path names, itself or by links: 1 for /dev/stdout; nothing for other
/// paths.
std::optional<int> descriptor_named(std::filesystem::path const& path);

/// The treatment of a link, device or directory that has the name of a file to be written.
enum class AtName {
  written_through,  ///< a link stays, and the file it leads to is written; a device, a pipe or an open descriptor is written directly
  replaced,  ///< a link, device or pipe is replaced
};

/// A file that appears under its name complete or not at all.
///
/// Text goes to a temporary file beside it; commit() brings that to the disk and renames it. A crash or a full disk
/// never destroys the file that was there before. Without a commit() nothing is left behind, but where the process is
/// killed: then the temporary file stays until remove_leftovers() finds it.
/// Errors: RunFailure with the reason of the operating system. Cost: one buffer of 256 KiB, whatever the file's size.
class AtomicFile {
 public:
  explicit AtomicFile(std::filesystem::path path, AtName at_name = AtName::written_through);
  ~AtomicFile();
  AtomicFile(AtomicFile const&) = delete;
  AtomicFile& operator=(AtomicFile const&) = delete;

  void append(std::string_view text);
  /// Where the bytes lie until commit(), for another program to write there instead of append().
  [[nodiscard]] std::filesystem::path const& location() const { return temporary_.empty() ? target_ : temporary_; }
  /// Brings the file to its name, and the name to the disk; nothing may be appended after it. A file that had the name
  /// before is kept as `previous` where that is given.
  void commit(std::filesystem::path const& previous = {});

 private:
  void write_out(std::string_view text);
  void discard() noexcept;
  [[noreturn]] void fail(int error_number);

  std::filesystem::path path_;       ///< as the user knows it
  std::filesystem::path target_;     ///< path_, with symbolic links followed where a link stays a link
  std::filesystem::path temporary_;  ///< empty where the target is written directly
  int descriptor_ = -1;
  std::string buffer_;
};

/// Writes the whole file at once, as AtomicFile does.
void write_file(std::filesystem::path const& path, std::string_view content);

/// Removes the temporary files that AtomicFile of killed processes left in a directory: `.NAME.PID-NUMBER.part`.
///
/// A process holds a lock on its temporary file, and the lock goes with the process, on whatever machine of a shared
/// file system it runs. So a file that can be locked belongs to no living process; its number in the name proves
/// nothing, as processes of other machines and containers have the same numbers.
void remove_leftovers(std::filesystem::path const& directory);

/// Refuses a name of anything but a regular file; reading a pipe would wait for its writer for ever.
/// Errors: Error naming the file.
void require_regular_file(std::filesystem::path const& path);

/// The bytes that a file has. Errors: Error where there is none, or where it is larger than `largest` bytes.
std::uint64_t size_of_file(std::filesystem::path const& path, std::uint64_t largest);

/// Fills `into` with what a file holds from `offset` on. Errors: Error for a file that is unreadable or shorter.
void read_piece(std::filesystem::path const& path, std::uint64_t offset, std::span<char> into);

/// A file that is read from its beginning, piece by piece; also a pipe, which cannot be read twice.
class FileReader {
 public:
  /// Errors: Error for a file that is missing, a directory or unreadable.
  explicit FileReader(std::filesystem::path path);

  /// Fills the beginning of `into`, and returns how many bytes have come: 0 at the end. Errors: Error.
  std::size_t read(std::span<char> into);

  [[nodiscard]] bool is_regular() const { return is_regular_; }
  /// In bytes, before anything is read; 0 of a pipe.
  [[nodiscard]] std::uint64_t size() const { return size_; }

 private:
  std::filesystem::path path_;
  Descriptor file_;
  bool is_regular_ = false;
  std::uint64_t size_ = 0;
};

/// The bytes of a file.
/// Errors: Error for a file that is missing, a directory, unreadable or larger than `largest` bytes (2 GiB).
std::string read_file(std::filesystem::path const& path, std::uint64_t largest = std::uint64_t{1} << 31);

/// Creates a directory with its parents, makes sure that files can be created in it, and removes leftovers from it.
/// Errors: Error under the key "-o", with the reason of the operating system.
void make_output_directory(std::filesystem::path const& path);

}  // namespace gridlock
