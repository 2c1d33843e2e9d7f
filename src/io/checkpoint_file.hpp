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

/// The bytes of a checkpoint file; what they mean is checkpoint.cpp's.
namespace gridlock::checkpoint {

/// XXH3 of 128 bits, the low word first.
using Checksum = std::array<std::uint64_t, 2>;

/// Version of a file that has all that it names.
constexpr std::uint32_t whole_version = 4;
/// Version of a file whose rows are in other files.
constexpr std::uint32_t version_of_parts = 6;

/// The kind of numbers in a list: the first byte of its value.
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

/// Members by name, to be written in the order of their names.
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
  /// Calls take(text) for the pieces of the file, one after the other.
  void write(std::uint32_t version, std::function<void(std::string_view)> const& take) const;

 private:
  void for_each_piece(std::function<void(std::string_view)> const& take) const;

  std::map<std::string, std::string> values_;  ///< in CBOR
};

/// Bytes that are read piece by piece.
struct Bytes {
  std::string name;  ///< in errors
  std::uint64_t size = 0;
  std::function<void(std::uint64_t offset, std::span<char> into)> read;  ///< requires that there are so many
};
/// Errors: Error for what is no regular file, or cannot be read.
Bytes bytes_of_file(std::filesystem::path const& path);
/// The text must outlive them.
Bytes bytes_of_text(std::string_view text, std::string name);

/// A file of members, of which nothing but their names and places is in memory.
class File {
 public:
  enum class Kind { truth, number, text, list };
  struct Place {
    Kind kind = Kind::number;
    std::uint64_t number = 0;  ///< or truth
    std::uint64_t offset = 0;  ///< of the first byte of a text or list
    std::uint64_t length = 0;  ///< in bytes
  };

  /// Errors: Error naming the file where it is no checkpoint, has another version, or is damaged anywhere.
  explicit File(Bytes bytes);

  [[nodiscard]] std::string const& name() const { return bytes_.name; }
  [[nodiscard]] std::uint32_t version() const { return version_; }
  [[nodiscard]] Checksum const& checksum() const { return checksum_; }

  /// The member of that name and kind. Errors: Error where there is none.
  [[nodiscard]] Place const& at(std::string const& member, Kind kind) const;
  [[nodiscard]] std::string text(Place const& place) const;
  /// The first byte of a list, 0 where it has none.
  [[nodiscard]] char letter(Place const& list) const;
  /// The numbers of a list. Errors: Error where they are of another kind.
  template <class Number>
  [[nodiscard]] std::uint64_t count(Place const& list) const {
    require_kind(list, letter_of<Number>(), sizeof(Number));
    return (list.length - 1) / sizeof(Number);
  }
  /// The numbers after the first byte of a list, whatever that says. Errors: Error where they are of another width.
  template <class Number>
  [[nodiscard]] std::vector<Number> rest_of(Place const& list) const {
    require_width(list, sizeof(Number));
    std::vector<Number> numbers((list.length - 1) / sizeof(Number));
    read(list, 0, std::span(numbers));
    return numbers;
  }
  /// Fills `values` with the numbers of a list from `first` on. Requires that it has so many.
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
