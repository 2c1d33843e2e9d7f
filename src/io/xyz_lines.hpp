#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "io/text_reader.hpp"

namespace gridlock::xyz {

/// One word of a line and where it begins.
struct Word {
  std::string_view text;
  int column = 0;  ///< from 1
};

inline bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\v' || c == '\f'; }

/// The number that a word denotes, also with the exponents of Fortran, 1d3 and 1D3; nothing where it is none.
std::optional<double> real_number(std::string_view word);

/// The words of a line, in the place of those of the line before.
void split(std::string_view line, std::vector<Word>& words);

/// The lines of a text, one at a time, without a byte order mark before them; errors name the present one. Memory: a
/// piece of the text, or a line where one is longer.
class Lines {
 public:
  /// `first` is the number of the first line, where the text is a part of a file.
  explicit Lines(TextReader text, int first = 1) : text_(std::move(text)), first_(first), number_(first - 1) {}

  /// Goes to the next line; at the end of the text it stays where it is and returns false.
  bool next();
  /// Passes over lines; how many there were.
  std::uint64_t skip(std::uint64_t count);
  /// Is before the first line again; false where the text cannot be read again, as with a pipe.
  bool begin_again();
  /// Goes to a line that has been read before. Where the text cannot be read again it has that number and nothing in
  /// it.
  void go_back_to(int number);
  /// Is behind the last line, which is where something is missing.
  void go_behind_the_last();

  [[nodiscard]] std::string_view line() const { return std::string_view(window_).substr(begin_, length_); }
  [[nodiscard]] int number() const { return number_; }
  [[nodiscard]] TextReader& text() { return text_; }
  [[nodiscard]] TextReader const& text() const { return text_; }

  /// Throws Error; an empty hint means the usual one.
  [[noreturn]] void refuse(std::string what, std::string hint, int column = 0) const;

 private:
  bool read_more();
  [[noreturn]] void refuse_endless_line();
  void skip_mark();

  TextReader text_;
  std::string window_;      ///< the present line and what has been read behind it
  std::size_t begin_ = 0;   ///< of the present line
  std::size_t length_ = 0;  ///< of the present line
  std::size_t next_ = 0;    ///< where the next one begins
  bool is_at_end_ = false;  ///< of the text
  int first_ = 1;
  int number_ = 0;
};

}  // namespace gridlock::xyz
