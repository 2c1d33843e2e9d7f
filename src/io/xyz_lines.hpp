#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace gridlock::xyz {

/// One word of a line and where it begins.
struct Word {
  std::string_view text;
  int column = 0;  ///< from 1
};

inline bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\v' || c == '\f'; }

/// The words of a line, in the place of those of the line before.
void split(std::string_view line, std::vector<Word>& words);

/// The lines of a file, one at a time; errors name the present one.
class Lines {
 public:
  Lines(std::string_view text, std::string file) : text_(text), file_(std::move(file)) {}

  /// Goes to the next line; at the end of the file it stays where it is and returns false.
  bool next();
  /// Goes to a line that has been read before.
  void go_back_to(int number);
  /// Is behind the last line, which is where something is missing.
  void go_behind_the_last();

  [[nodiscard]] std::string_view line() const { return line_; }
  [[nodiscard]] int number() const { return number_; }
  [[nodiscard]] std::size_t bytes_left() const { return at_ < text_.size() ? text_.size() - at_ : 0; }

  /// Throws Error; an empty hint means the usual one.
  [[noreturn]] void refuse(std::string what, std::string hint, int column = 0) const;

 private:
  std::string_view text_;
  std::string file_;
  std::size_t at_ = 0;
  int number_ = 0;
  std::string_view line_;
};

}  // namespace gridlock::xyz
