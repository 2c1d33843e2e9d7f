#include "io/xyz_lines.hpp"

#include <algorithm>
#include <utility>

#include "gridlock/core/error.hpp"
#include "io/text.hpp"

namespace gridlock::xyz {

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
  if (at_ >= text_.size()) return false;
  std::size_t const end = std::min(text_.find('\n', at_), text_.size());
  line_ = text_.substr(at_, end - at_);
  at_ = end + 1;
  ++number_;
  return true;
}

void Lines::go_back_to(int number) {
  at_ = 0;
  number_ = 0;
  while (number_ < number && next()) {
  }
}

void Lines::go_behind_the_last() {
  ++number_;
  line_ = {};
}

void Lines::refuse(std::string what, std::string hint, int column) const {
  throw Error(Problem{.what = std::move(what),
                      .hint = hint.empty() ? "correct the line, or write the file again" : std::move(hint),
                      .file = file_,
                      .line = number_,
                      .column = column,
                      .source_line = shown_line(line_)});
}

}  // namespace gridlock::xyz
