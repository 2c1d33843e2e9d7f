#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "io/gzip.hpp"

namespace gridlock {

/// A text that is read piece by piece: of a file as it is, of one that gzip packed, of a trajectory in H5MD as extended
/// XYZ, or one that is in memory.
class TextReader {
 public:
  /// Errors: Error where the file cannot be read, and where its first bytes are those of a format that is no text of
  /// agents.
  explicit TextReader(std::filesystem::path path);
  /// The text must outlive it. `name` names it in errors.
  TextReader(std::string_view text, std::string name);

  /// The name of the text in errors.
  [[nodiscard]] std::string const& name() const { return name_; }
  /// How many bytes it has in about, as far as that is known beforehand.
  [[nodiscard]] std::uint64_t likely_size() const { return likely_size_; }

  /// Whether the file itself has the lines, so that errors may quote them.
  [[nodiscard]] bool is_of_text() const { return is_of_text_; }

  /// Names of what a trajectory of another program has besides, and its text has not.
  [[nodiscard]] std::vector<std::string> const& left_out() const { return left_out_; }

  /// Fills the beginning of `into`, and returns how many bytes have come: 0 at the end. Errors: Error where the file
  /// cannot be read, or where what gzip packed is damaged.
  std::size_t read(std::span<char> into);
  /// Begins again; false where that cannot be, as with a pipe.
  bool begin_again();
  /// Reads what is left where it is packed: the checksum comes last. Errors: Error where it is damaged.
  void require_undamaged();

 private:
  void open_file();

  std::string name_;
  std::filesystem::path path_;  ///< empty where it is in memory
  std::string_view text_;       ///< where it is in memory
  bool can_begin_again_ = true;
  bool is_of_text_ = true;
  std::vector<std::string> left_out_;
  std::uint64_t likely_size_ = 0;
  ReadBytes bytes_;
  std::optional<GzipReader> packed_;
};

}  // namespace gridlock
