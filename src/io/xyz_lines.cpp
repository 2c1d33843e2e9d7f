#include "io/xyz_lines.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <span>
#include <utility>

#include "gridlock/core/error.hpp"
#include "io/text.hpp"

namespace gridlock::xyz {

namespace {

/// Maximum length of a line in bytes; the second line with 1,000 named columns is shorter.
constexpr std::size_t longest_line = std::size_t{1} << 26;

}  // namespace

std::optional<double> real_number(std::string_view word) {
  if (auto const number = parse_number<double>(word)) return number;
  std::size_t const exponent = word.find_first_of("dD");
  if (exponent == std::string_view::npos) return std::nullopt;
  std::string text(word);
  text[exponent] = 'e';
  return parse_number<double>(text);
}

void split(std::string_view line, std::vector<Word>& words) {
  words.clear();
  for (std::size_t at = 0; at < line.size();) {
    if (is_blank(line[at])) {
      ++at;
      continue;
    }
    std::size_t const begin = at;
    while (at < line.size() && !is_blank(line[at])) ++at;
    words.push_back({line.substr(begin, at - begin), static_cast<int>(begin) + 1});
  }
}

bool Lines::next() {
  std::size_t end = window_.find('\n', next_);
  while (end == std::string::npos && !is_at_end_) {
    if (window_.size() - next_ > longest_line) refuse_endless_line();
    std::size_t const searched = window_.size() - begin_;
    if (read_more()) end = window_.find('\n', begin_ + searched);
  }
  if (next_ >= window_.size()) return false;
  end = std::min(end, window_.size());
  begin_ = next_;
  length_ = end - begin_;
  next_ = std::min(end + 1, window_.size());
  ++number_;
  skip_mark();
  return true;
}

/// Skips a byte order mark, which editors put before a file, and joined files therefore have between frames.
void Lines::skip_mark() {
  constexpr std::string_view mark = "\xEF\xBB\xBF";
  if (!line().starts_with(mark)) return;
  begin_ += mark.size();
  length_ -= mark.size();
}

std::uint64_t Lines::skip(std::uint64_t count) {
  std::uint64_t passed = 0;
  while (passed < count && next()) ++passed;
  return passed;
}

/// Reads more text into the window and discards the text before the current line. Returns false at the end of the text.
bool Lines::read_more() {
  constexpr std::size_t piece = std::size_t{1} << 18;
  window_.erase(0, begin_);
  next_ -= begin_;
  begin_ = 0;
  // Each piece doubles the window, so that a long line is moved only a few times.
  std::size_t const had = window_.size();
  window_.resize(had + std::max(piece, had));
  std::size_t const got = text_.read(std::span(window_).subspan(had));
  window_.resize(had + got);
  is_at_end_ = got == 0;
  return !is_at_end_;
}

/// Throws an Error about a line longer than longest_line. Contract: the window holds the beginning of that line.
void Lines::refuse_endless_line() {
  ++number_;
  begin_ = next_;
  length_ = 0;
  refuse(fmt::format("the line has more than {} bytes, and does not end", longest_line),
         "this is no text: name a file in extended XYZ");
}

bool Lines::begin_again() {
  window_.clear();
  begin_ = length_ = next_ = 0;
  is_at_end_ = !text_.begin_again();
  number_ = first_ - 1;
  return !is_at_end_;
}

void Lines::go_back_to(int number) {
  if (!begin_again()) number_ = number;
  while (number_ < number && next()) {
  }
}

void Lines::go_behind_the_last() {
  ++number_;
  begin_ = next_;
  length_ = 0;
}

void Lines::refuse(std::string what, std::string hint, int column) const {
  Problem problem{.what = std::move(what), .hint = std::move(hint), .file = text_.name()};
  if (problem.hint.empty()) {
    problem.hint = text_.is_of_text() ? "correct the line, or write the file again" : "write the file again";
  }
  if (text_.is_of_text()) {
    problem.line = number_;
    problem.column = column;
    problem.source_line = shown_line(line());
  }
  throw Error(std::move(problem));
}

}  // namespace gridlock::xyz
