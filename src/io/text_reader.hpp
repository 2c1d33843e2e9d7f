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

/// Reads text piece by piece: from memory, a plain file, a file packed by gzip, or a trajectory in H5MD, which is
/// converted to extended XYZ.
class TextReader {
 public:
  /// Errors: Error if the file is unreadable, or if its first bytes show a format without text of agents.
  explicit TextReader(std::filesystem::path path);
  /// Reads a text in memory, which must outlive the reader. `name` is its name in error messages.
  TextReader(std::string_view text, std::string name);

  /// Returns the name of the text in error messages.
  [[nodiscard]] std::string const& name() const { return name_; }
  /// Returns an estimate of the size of the text in bytes.
  [[nodiscard]] std::uint64_t likely_size() const { return likely_size_; }

  /// Returns whether the file itself consists of these lines, so that errors may quote them.
  [[nodiscard]] bool is_of_text() const { return is_of_text_; }

  /// Returns the names of data that another program's trajectory has and the converted text omits.
  [[nodiscard]] std::vector<std::string> const& left_out() const { return left_out_; }

  /// Fills the beginning of `into`; returns the number of bytes, 0 at the end. Errors: Error if the file is unreadable
  /// or its gzip data are damaged.
  std::size_t read(std::span<char> into);
  /// Returns to the beginning; returns false if that is impossible, as with a pipe.
  bool begin_again();
  /// Reads the rest of a packed file up to its checksum. Errors: Error if the file is damaged.
  void require_undamaged();

 private:
  void open_file();

  std::string name_;
  std::filesystem::path path_;  ///< empty for a text in memory
  std::string_view text_;       ///< empty for a file
  bool can_begin_again_ = true;
  bool is_of_text_ = true;
  std::vector<std::string> left_out_;
  std::uint64_t likely_size_ = 0;
  ReadBytes bytes_;
  std::optional<GzipReader> packed_;
};

}  // namespace gridlock
