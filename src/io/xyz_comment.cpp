#include "io/xyz_comment.hpp"

#include <fmt/format.h>

#include <cstddef>
#include <utility>

namespace gridlock::xyz {

namespace {

char closing_of(char opening) {
  switch (opening) {
    case '"':
    case '\'':
      return opening;
    case '{':
      return '}';
    case '[':
      return ']';
    default:
      return '\0';
  }
}

/// Reads the entries of the second line from left to right.
class EntryReader {
 public:
  explicit EntryReader(Lines const& lines) : lines_(lines), line_(lines.line()) {}

  std::vector<Entry> read() {
    std::vector<Entry> entries;
    while (skip_blanks()) {
      Entry entry{.key = "", .value = "T", .column = static_cast<int>(at_) + 1};
      entry.key = take_word(true);
      for (bool is_first = true; skip_blanks() && line_[at_] == '='; is_first = false) {
        ++at_;
        std::string const value = skip_blanks() ? take_word(false) : "";
        // As in ASE, a second equals sign belongs to the value.
        entry.value = is_first ? value : entry.value + '=' + value;
      }
      entries.push_back(std::move(entry));
    }
    return entries;
  }

 private:
  /// Skips blanks; returns whether the line has more text.
  bool skip_blanks() {
    while (at_ < line_.size() && is_blank(line_[at_])) ++at_;
    return at_ < line_.size();
  }

  /// Reads a key, up to an equals sign, or a value. A word that begins with a quote or bracket ends with its partner.
  std::string take_word(bool is_key) {
    bool const is_enclosed = closing_of(line_[at_]) != '\0';
    if (is_enclosed) {
      if (auto enclosed = take_enclosed()) return *std::move(enclosed);
    }
    std::string word;
    while (at_ < line_.size() && !is_blank(line_[at_]) && !(is_key && line_[at_] == '=')) {
      char const letter = line_[at_];
      if (letter == '\\' && at_ + 1 < line_.size()) {
        word += unescaped(line_[at_ + 1]);
        at_ += 2;
        continue;
      }
      // A quote or bracket inside a word encloses its text, also blanks, so energy="…" inside a value is not an entry.
      bool const hides = !word.empty() && letter != '\'' && closing_of(letter) != '\0';
      if (hides) {
        if (auto enclosed = take_enclosed()) word += *enclosed;
        continue;
      }
      word += letter;
      ++at_;
    }
    return word;
  }

  static char unescaped(char letter) { return letter == 'n' ? '\n' : letter; }

  /// Reads a text in quotes, brackets or braces; returns nothing for an apostrophe without a partner.
  std::optional<std::string> take_enclosed() {
    char const opening = line_[at_];
    auto const end = opening == '"' || opening == '\'' ? end_of_quote(at_) : end_of_brackets(at_);
    if (!end && opening == '\'') return std::nullopt;
    if (!end) {
      lines_.refuse(fmt::format("the {} in the second line does not end", opening), "is the line cut off?",
                    static_cast<int>(at_) + 1);
    }
    std::string_view const inside = line_.substr(at_ + 1, *end - at_ - 1);
    at_ = *end + 1;
    if (opening == '[') return fmt::format("[{}]", inside);
    if (opening == '{') return std::string(inside);
    std::string text;
    for (std::size_t k = 0; k < inside.size(); ++k) {
      text += inside[k] == '\\' && k + 1 < inside.size() ? unescaped(inside[++k]) : inside[k];
    }
    return text;
  }

  /// Returns the index of the quote that closes the quote at `begin`.
  [[nodiscard]] std::optional<std::size_t> end_of_quote(std::size_t begin) const {
    for (std::size_t k = begin + 1; k < line_.size(); ++k) {
      if (line_[k] == '\\') {
        ++k;
      } else if (line_[k] == line_[begin]) {
        return k;
      }
    }
    return std::nullopt;
  }

  /// Returns the index of the closing bracket or brace. Those in quotes are skipped if all quotes are closed.
  [[nodiscard]] std::optional<std::size_t> end_of_brackets(std::size_t begin) const {
    auto const end = end_of_brackets(begin, true);
    return end ? end : end_of_brackets(begin, false);
  }

  [[nodiscard]] std::optional<std::size_t> end_of_brackets(std::size_t begin, bool skips_quotes) const {
    char const opening = line_[begin];
    char const closing = closing_of(opening);
    std::size_t depth = 0;
    for (std::size_t k = begin; k < line_.size(); ++k) {
      if (line_[k] == '\\') {
        ++k;
      } else if (line_[k] == '"' && skips_quotes) {
        auto const end = end_of_quote(k);
        if (!end) return std::nullopt;
        k = *end;
      } else if (line_[k] == opening) {
        ++depth;
      } else if (line_[k] == closing && --depth == 0) {
        return k;
      }
    }
    return std::nullopt;
  }

  Lines const& lines_;
  std::string_view line_;
  std::size_t at_ = 0;
};

}  // namespace

std::vector<Entry> entries_of(Lines const& lines) { return EntryReader(lines).read(); }

namespace {

/// Reads the elements of a vector or a matrix from left to right.
class ElementReader {
 public:
  explicit ElementReader(std::string_view value) : value_(value) {}

  std::optional<std::vector<std::string>> read() {
    while (at_ < value_.size()) {
      if (!take_next()) return std::nullopt;
    }
    if (depth_ != 0 || before_ == Before::comma || !is_even()) return std::nullopt;
    return std::move(elements_);
  }

 private:
  enum class Before { opening, element, comma };

  bool take_next() {
    char const letter = value_[at_];
    if (is_blank(letter) || letter == '\n') return skip(true);
    if (letter == ',') {
      bool const is_between = before_ == Before::element;
      before_ = Before::comma;
      return skip(is_between);
    }
    if (letter == '[') {
      begin_of_row_ = elements_.size();
      before_ = Before::opening;
      return skip(++depth_ <= max_depth);
    }
    if (letter != ']') return take_word();
    if (depth_ == max_depth) rows_.push_back(elements_.size() - begin_of_row_);
    bool const is_end = depth_ > 0 && before_ != Before::comma;
    if (depth_ > 0) --depth_;
    before_ = Before::element;
    return skip(is_end);
  }

  bool skip(bool is_in_place) {
    ++at_;
    return is_in_place;
  }

  bool take_word() {
    std::string_view word = value_.substr(at_);
    word = word.substr(0, word.find_first_of(" \t\r\v\f\n,[]"));
    at_ += word.size();
    if (word.size() > 1 && word.front() == word.back() && (word[0] == '"' || word[0] == '\'')) {
      word = word.substr(1, word.size() - 2);
    }
    elements_.emplace_back(word);
    before_ = Before::element;
    return true;
  }

  /// Returns whether all rows have the same length and contain all elements.
  [[nodiscard]] bool is_even() const {
    std::size_t in_rows = 0;
    for (std::size_t const row : rows_) {
      if (row != rows_[0]) return false;
      in_rows += row;
    }
    return rows_.empty() || in_rows == elements_.size();
  }

  static constexpr std::size_t max_depth = 2;
  std::string_view value_;
  std::size_t at_ = 0;
  std::size_t depth_ = 0;
  std::size_t begin_of_row_ = 0;
  Before before_ = Before::opening;
  std::vector<std::string> elements_;
  std::vector<std::size_t> rows_;  ///< number of elements in each row
};

}  // namespace

std::optional<std::vector<std::string>> elements_of(std::string_view value) { return ElementReader(value).read(); }

}  // namespace gridlock::xyz
