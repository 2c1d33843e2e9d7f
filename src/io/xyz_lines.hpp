#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "io/text_reader.hpp"

namespace gridlock::xyz {

/// A word of a line with its position.
struct Word {
  std::string_view text;
  int column = 0;  ///< column of the first letter, from 1
};

inline bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\v' || c == '\f'; }

/// Returns the number that a word denotes, also with Fortran's exponents, 1d3 and 1D3; nothing if it is not a number.
std::optional<double> real_number(std::string_view word);

/// Replaces `words` by the words of a line.
void split(std::string_view line, std::vector<Word>& words);

/// Reads the lines of a text one at a time, without byte order marks. Error messages name the current line. Memory: a
/// piece of the text, or one line if it is longer.
class Lines {
 public:
  /// `first` is the number of the first line if the text is a part of a file.
  explicit Lines(TextReader text, int first = 1) : text_(std::move(text)), first_(first), number_(first - 1) {}

  /// Goes to the next line; at the end of the text it returns false and stays at the last line.
  bool next();
  /// Skips lines; returns how many there were, at most `count`.
  std::uint64_t skip(std::uint64_t count);
  /// Returns to before the first line; false if the text cannot be read again, as with a pipe.
  bool begin_again();
  /// Returns to a line that was read before. If the text cannot be read again, the line has that number and no text.
  void go_back_to(int number);
  /// Goes behind the last line, to report there that lines are missing.
  void go_behind_the_last();

  [[nodiscard]] std::string_view line() const { return std::string_view(window_).substr(begin_, length_); }
  [[nodiscard]] int number() const { return number_; }
  [[nodiscard]] TextReader& text() { return text_; }
  [[nodiscard]] TextReader const& text() const { return text_; }

  /// Throws an Error about the current line; an empty hint is replaced by the usual hint.
  [[noreturn]] void refuse(std::string what, std::string hint, int column = 0) const;

 private:
  bool read_more();
  [[noreturn]] void refuse_endless_line();
  void skip_mark();

  TextReader text_;
  std::string window_;      ///< the current line and the text read after it
  std::size_t begin_ = 0;   ///< index of the current line in window_
  std::size_t length_ = 0;  ///< bytes of the current line
  std::size_t next_ = 0;    ///< index of the next line in window_
  bool is_at_end_ = false;  ///< whether the text has ended
  int first_ = 1;
  int number_ = 0;
};

}  // namespace gridlock::xyz
