#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

/// Reads and writes the bytes of checkpoint files; checkpoint.cpp gives the members their meaning.
namespace gridlock::checkpoint {

/// XXH3 of 128 bits, the low word first.
using Checksum = std::array<std::uint64_t, 2>;

/// Format version of a checkpoint in a single file.
constexpr std::uint32_t whole_version = 4;
/// Format version of a checkpoint or part whose rows are in several files.
constexpr std::uint32_t version_of_parts = 6;

/// Returns the letter of a type of numbers, the first byte of a list.
template <class Number>
constexpr char letter_of();
template <>
constexpr char letter_of<double>() {
  return 'd';
}
template <>
constexpr char letter_of<std::int32_t>() {
  return 'i';
}
template <>
constexpr char letter_of<std::uint32_t>() {
  return 'u';
}
template <>
constexpr char letter_of<std::uint64_t>() {
  return 'q';
}

[[noreturn]] void refuse(std::string const& name, std::string const& why, std::string hint);
inline constexpr char const* again_hint =
    "put back a copy of the file, or start the run again: --overwrite, in Python overwrite=True";

/// Collects members by name and writes them in alphabetical order.
class Members {
 public:
  void add(std::string const& name, bool value);
  void add(std::string const& name, std::uint64_t value);
  void add(std::string const& name, std::string const& value);
  template <class Number>
  void add_list(std::string const& name, std::vector<Number> const& values) {
    add_bytes(name, letter_of<Number>(), std::as_bytes(std::span(values)));
  }
  void add_bytes(std::string const& name, char letter, std::span<std::byte const> bytes);

  [[nodiscard]] Checksum checksum() const;
  /// Calls take(text) for each piece of the file, in order.
  void write(std::uint32_t version, std::function<void(std::string_view)> const& take) const;

 private:
  void for_each_piece(std::function<void(std::string_view)> const& take) const;

  std::map<std::string, std::string> values_;  ///< name and value, the value in CBOR
};

/// A source of bytes that is read piece by piece.
struct Bytes {
  std::string name;  ///< name of the file, for error messages
  std::uint64_t size = 0;
  std::function<void(std::uint64_t offset, std::span<char> into)> read;  ///< fills `into`; requires enough bytes
};
/// Opens a file as a source of bytes. Errors: Error if it is not a regular file, or unreadable.
Bytes bytes_of_file(std::filesystem::path const& path);
/// Uses a text as a source of bytes. The text must outlive the result.
Bytes bytes_of_text(std::string_view text, std::string name);

/// A checkpoint file of which only the names and positions of members are in memory.
class File {
 public:
  enum class Kind { truth, number, text, list };
  struct Place {
    Kind kind = Kind::number;
    std::uint64_t number = 0;  ///< value of a number or truth
    std::uint64_t offset = 0;  ///< position of the first byte of a text or list
    std::uint64_t length = 0;  ///< bytes of a text or list
  };

  /// Errors: Error naming the file if it is not a checkpoint, has another version, or is damaged anywhere.
  explicit File(Bytes bytes);

  [[nodiscard]] std::string const& name() const { return bytes_.name; }
  [[nodiscard]] std::uint32_t version() const { return version_; }
  [[nodiscard]] Checksum const& checksum() const { return checksum_; }

  [[nodiscard]] bool has(std::string const& member) const { return members_.contains(member); }
  /// Returns the member with this name and kind. Errors: Error if there is none.
  [[nodiscard]] Place const& at(std::string const& member, Kind kind) const;
  [[nodiscard]] std::string text(Place const& place) const;
  /// Returns the first byte of a list, its type; 0 if the list is empty.
  [[nodiscard]] char letter(Place const& list) const;
  /// Returns how many numbers a list has. Errors: Error if they are of another type.
  template <class Number>
  [[nodiscard]] std::uint64_t count(Place const& list) const {
    require_kind(list, letter_of<Number>(), sizeof(Number));
    return (list.length - 1) / sizeof(Number);
  }
  /// Returns the numbers after the first byte of a list, for any first byte. Errors: Error if the length does not fit.
  template <class Number>
  [[nodiscard]] std::vector<Number> rest_of(Place const& list) const {
    require_width(list, sizeof(Number));
    std::vector<Number> numbers((list.length - 1) / sizeof(Number));
    read(list, 0, std::span(numbers));
    return numbers;
  }
  /// Fills `values` with the numbers of a list from index `first` on. Requires first + values.size() ≤ count(list).
  template <class Number>
  void read(Place const& list, std::uint64_t first, std::span<Number> values) const {
    auto const into = std::as_writable_bytes(values);
    bytes_.read(list.offset + 1 + first * sizeof(Number), {reinterpret_cast<char*>(into.data()), into.size()});
  }

 private:
  void read_head();
  void require_checksum() const;
  bool find_members();
  void require_kind(Place const& list, char letter, std::size_t width) const;
  void require_width(Place const& list, std::size_t width) const;

  Bytes bytes_;
  std::uint32_t version_ = 0;
  Checksum checksum_{};
  std::map<std::string, Place> members_;
};

}  // namespace gridlock::checkpoint
