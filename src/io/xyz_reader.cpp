#include "io/xyz_reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "gridlock/core/error.hpp"
#include "io/text.hpp"

namespace gridlock::xyz {

namespace {

/// The head takes two lines, and each row one.
int line_of(std::uint64_t row) { return static_cast<int>(row) + 3; }

/// A population keeps a place for every slot up to the largest: a damaged Id must not ask for all the memory.
std::uint64_t most_slots(std::uint64_t count) { return (std::uint64_t{1} << 22) + 64 * count; }

std::uint64_t read_count(Lines& lines) {
  if (!lines.next()) lines.refuse("the file is empty", "extended XYZ begins with the number of disks");
  std::vector<Word> words;
  split(lines.line(), words);
  auto const count = words.size() == 1 ? parse_number<std::uint64_t>(words[0].text) : std::nullopt;
  if (!count) {
    lines.refuse(fmt::format("the first line is {}, not the number of disks", in_quotes(lines.line())),
                 "is this extended XYZ?", 1);
  }
  return *count;
}

void refuse_more_lines(Lines& lines, std::uint64_t count) {
  std::vector<Word> words;
  while (lines.next()) {
    split(lines.line(), words);
    if (words.empty()) continue;
    bool const is_count = words.size() == 1 && parse_number<std::uint64_t>(words[0].text);
    lines.refuse(fmt::format("the file continues after its {} disks", count),
                 is_count ? "it holds more than one frame: keep the one to start from" : "is the first line wrong?", 1);
  }
}

}  // namespace

std::optional<WrongId> find_wrong_id(std::vector<IdOfRow>& ids, std::uint64_t count) {
  std::ranges::sort(ids, {}, [](IdOfRow const& one) { return std::pair(slot_of(one.id), one.row); });
  for (std::size_t k = 0; k < ids.size(); ++k) {
    bool const is_twice = k > 0 && slot_of(ids[k - 1].id) == slot_of(ids[k].id);
    if (is_twice) return WrongId{.id = ids[k].id, .row = ids[k].row, .first_row = ids[k - 1].row};
    if (slot_of(ids[k].id) >= most_slots(count)) return WrongId{.id = ids[k].id, .row = ids[k].row, .first_row = {}};
  }
  return std::nullopt;
}

bool are_plain(Id first, Id last, std::uint64_t count) {
  return first == slot_of(first) && last == slot_of(last) && last < most_slots(count);
}

Reader::Reader(TextReader text) : lines_(std::move(text)) {
  undamaged([&] {
    count_ = read_count(lines_);
    header_ = read_header(lines_);
  });
}

/// Damage of a packed text makes any bytes of it, and errors that would mislead.
void Reader::undamaged(std::function<void()> const& read) {
  try {
    read();
  } catch (Error const&) {
    lines_.text().require_undamaged();
    throw;
  }
}

std::uint64_t Reader::likely_count() const {
  // A row takes a digit and a space for every column.
  return std::min<std::uint64_t>(count_, lines_.text().likely_size() / (2 * header_.roles.size()) + 1);
}

bool Reader::read(std::size_t most, Rows& rows) {
  std::uint64_t const end = next_row_ + std::min<std::uint64_t>(most, count_ - next_row_);
  bool const has_some = next_row_ < end;
  undamaged([&] {
    while (next_row_ < end) read_row(rows);
    if (!has_some) refuse_more_lines(lines_, count_);
  });
  return has_some;
}

void Reader::read_row(Rows& rows) {
  if (lines_.next()) {
    split(lines_.line(), words_);
  } else {
    words_.clear();
  }
  if (words_.empty()) {
    lines_.refuse(fmt::format("the file ends after {} of {} disks", next_row_, count_),
                  "is the file cut off, or the first line wrong?");
  }
  if (words_.size() != header_.roles.size()) {
    lines_.refuse(
        fmt::format("the line has {} columns, but the Properties name {}", words_.size(), header_.roles.size()),
        "is the line cut off?", words_.back().column);
  }
  rows.disks.push_back(row_of(words_));
  for (auto const& [column, name] : header_.others) {
    rows.others.push_back(parse_number<double>(words_[column].text).value_or(std::nan("")));
  }
  ++next_row_;
}

Row Reader::row_of(std::vector<Word> const& words) const {
  Row row{.id = next_row_, .number = next_row_};
  for (std::size_t c = 0; c < words.size(); ++c) {
    switch (header_.roles[c]) {
      case Role::ignored:
        break;
      case Role::x:
        row.position.x = real(words[c], Role::x);
        break;
      case Role::y:
        row.position.y = real(words[c], Role::y);
        break;
      case Role::z:
        refuse_height(words[c], Role::z);
        break;
      case Role::id:
        row.id = id(words[c]);
        break;
      case Role::velocity_x:
        row.velocity.x = real(words[c], Role::velocity_x);
        break;
      case Role::velocity_y:
        row.velocity.y = real(words[c], Role::velocity_y);
        break;
      case Role::velocity_z:
        refuse_height(words[c], Role::velocity_z);
        break;
      case Role::radius:
        row.radius = positive(words[c], Role::radius);
        break;
      case Role::mass:
        row.mass = positive(words[c], Role::mass);
        break;
      case Role::image_x:
        row.image_x = image(words[c], Role::image_x);
        break;
      case Role::image_y:
        row.image_y = image(words[c], Role::image_y);
        break;
      case Role::image_z:
        break;
    }
  }
  return row;
}

void Reader::refuse_word(Word const& word, Role role, std::string_view expected) const {
  lines_.refuse(fmt::format("the {} is {}, but must be {}", name_of(role), in_quotes(word.text), expected), "",
                word.column);
}

double Reader::real(Word const& word, Role role) const {
  auto const number = parse_number<double>(word.text);
  if (!number || !std::isfinite(*number)) refuse_word(word, role, "a finite number");
  return *number;
}

double Reader::positive(Word const& word, Role role) const {
  double const number = real(word, role);
  if (!(number > 0.0)) refuse_word(word, role, "above 0");
  return number;
}

void Reader::refuse_height(Word const& word, Role role) const {
  if (real(word, role) == 0.0) return;
  lines_.refuse(fmt::format("the {} is {}, but disks live in the plane z = 0", name_of(role), word.text),
                "only two-dimensional systems can be read", word.column);
}

Id Reader::id(Word const& word) const {
  auto const number = parse_number<Id>(word.text);
  if (!number) refuse_word(word, Role::id, "a whole number, 0 or above");
  return *number;
}

std::int32_t Reader::image(Word const& word, Role role) const {
  auto const number = parse_number<std::int32_t>(word.text);
  if (!number) refuse_word(word, role, "a whole number of 32 bits");
  return *number;
}

void Reader::refuse(WrongId const& wrong) {
  lines_.go_back_to(line_of(wrong.row));
  if (wrong.first_row) {
    lines_.refuse(fmt::format("the id {} is given twice, first on line {}", wrong.id, line_of(*wrong.first_row)),
                  "ids, and their last 32 bits, have to differ");
  }
  lines_.refuse(fmt::format("the id {} is out of proportion to {} disks", wrong.id, count_),
                fmt::format("use ids below {}, or leave the column out", most_slots(count_)));
}

}  // namespace gridlock::xyz
