#include "io/xyz_reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "gridlock/core/error.hpp"
#include "io/text.hpp"

namespace gridlock::xyz {

namespace {

/// Returns the limit of slots. A population has memory for all slots, so a damaged Id could exhaust the memory.
std::uint64_t max_slots(std::uint64_t count) { return (std::uint64_t{1} << 22) + 64 * count; }

bool is_empty(std::string_view line) { return std::ranges::all_of(line, is_blank); }

std::optional<std::uint64_t> count_in(std::string_view line) {
  std::vector<Word> words;
  split(line, words);
  return words.size() == 1 ? parse_number<std::uint64_t>(words[0].text) : std::nullopt;
}

/// Goes to the next line that is not empty; returns false if there is none.
bool find_line(Lines& lines) {
  while (lines.next()) {
    if (!is_empty(lines.line())) return true;
  }
  return false;
}

/// Returns the number of disks in the current line, the first of a frame.
std::uint64_t count_of_first_line(Lines const& lines) {
  auto const count = count_in(lines.line());
  if (count) return *count;
  bool const is_wide = lines.line().starts_with("\xFF\xFE") || lines.line().starts_with("\xFE\xFF");
  lines.refuse(fmt::format("the first line is {}, not the number of disks", in_quotes(lines.line())),
               is_wide ? "the file is in UTF-16: save it in UTF-8" : "is this extended XYZ?", 1);
}

/// Skips the frame that begins with the current line.
void pass_frame(Lines& lines, std::uint64_t frame) {
  auto const count = frame == 0 ? count_of_first_line(lines) : count_in(lines.line());
  if (!count) {
    lines.refuse(
        fmt::format("the line behind frame {} is {}, not the number of disks", frame - 1, in_quotes(lines.line())), "",
        1);
  }
  bool const has_head = lines.skip(1) == 1;
  std::uint64_t const rows = lines.skip(*count);
  if (!has_head || rows < *count) {
    lines.refuse(fmt::format("the file ends after {} of {} disks of frame {}", rows, *count, frame),
                 "is the file cut off?");
  }
}

}  // namespace

std::optional<WrongId> find_wrong_id(std::vector<IdOfRow>& ids, std::uint64_t count) {
  std::ranges::sort(ids, {}, [](IdOfRow const& one) { return std::pair(slot_of(one.id), one.row); });
  for (std::size_t k = 0; k < ids.size(); ++k) {
    bool const is_twice = k > 0 && slot_of(ids[k - 1].id) == slot_of(ids[k].id);
    if (is_twice) return WrongId{.id = ids[k].id, .row = ids[k].row, .first_row = ids[k - 1].row};
    if (slot_of(ids[k].id) >= max_slots(count)) return WrongId{.id = ids[k].id, .row = ids[k].row, .first_row = {}};
  }
  return std::nullopt;
}

bool are_plain(Id first, Id last, std::uint64_t count) {
  return first == slot_of(first) && last == slot_of(last) && last < max_slots(count);
}

std::uint64_t read_count(Lines& lines) {
  if (!find_line(lines)) lines.refuse("the file is empty", "extended XYZ begins with the number of disks");
  return count_of_first_line(lines);
}

std::uint64_t count_frames(Lines& lines) {
  std::uint64_t frames = 0;
  while (find_line(lines)) pass_frame(lines, frames++);
  return frames;
}

Reader::Reader(TextReader text, FrameChoice choice) : lines_(std::move(text)), choice_(std::move(choice)) {
  undamaged([&] {
    if (choice_.frame) go_to(*choice_.frame);
    count_ = choice_.frame ? count_of_first_line(lines_) : read_count(lines_);
    header_ = read_header(lines_);
    box_ = box_of_disks(lines_, header_);
    widths_ = box_.widths_in(header_.sides->shift);
    first_row_line_ = lines_.number() + 1;
  });
}

/// Goes to the first line of a frame, counted from the end if `frame` is negative.
void Reader::go_to(std::int64_t frame) {
  auto const refuse = [&](std::uint64_t frames) {
    lines_.begin_again();
    lines_.refuse(fmt::format("the file has {} frame{}, and no frame {}", frames, frames == 1 ? "" : "s", frame),
                  "frames count from 0, or from -1 for the last");
  };
  if (frame < 0) {
    std::uint64_t const frames = count_frames(lines_);
    auto const from_end = -static_cast<std::uint64_t>(frame);
    if (from_end > frames) refuse(frames);
    if (!lines_.begin_again()) {
      lines_.refuse("the file cannot be read twice, which a frame from the last takes",
                    fmt::format("name one from 0 to {}", frames - 1));
    }
    frame = static_cast<std::int64_t>(frames - from_end);
  }
  for (std::int64_t passed = 0;; ++passed) {
    if (!find_line(lines_)) refuse(static_cast<std::uint64_t>(passed));
    if (passed == frame) return;
    pass_frame(lines_, static_cast<std::uint64_t>(passed));
  }
}

/// Calls `read`. Damaged gzip data unpack to arbitrary text, so after an Error the checksum is tested first.
void Reader::undamaged(std::function<void()> const& read) {
  try {
    read();
  } catch (Error const&) {
    lines_.text().require_undamaged();
    throw;
  }
}

std::uint64_t Reader::likely_count() const {
  // A row has at least a digit and a space for each column.
  return std::min<std::uint64_t>(count_, lines_.text().likely_size() / (2 * columns().roles.size()) + 1);
}

std::vector<std::string> Reader::unused() const {
  std::vector<std::string> names = columns().unused();
  std::vector<std::string> const& left_out = lines_.text().left_out();
  names.insert(names.end(), left_out.begin(), left_out.end());
  return names;
}

bool Reader::read(std::size_t most, Rows& rows) {
  std::uint64_t const end = next_row_ + std::min<std::uint64_t>(most, count_ - next_row_);
  bool const has_some = next_row_ < end;
  undamaged([&] {
    while (next_row_ < end) read_row(rows);
    // Lines after a chosen frame are not read.
    if (!has_some && !choice_.frame) refuse_further_lines();
  });
  return has_some;
}

void Reader::refuse_further_lines() {
  if (!find_line(lines_)) return;
  int const line = lines_.number();
  std::string what = fmt::format("the file continues after its {} disks", count_);
  std::string hint = "is the first line wrong?";
  if (count_in(lines_.line())) {
    std::uint64_t frames = 1;
    do {
      pass_frame(lines_, frames++);
    } while (find_line(lines_));
    what += fmt::format(": it holds {} frames", frames);
    hint = fmt::format("choose one: {} from 0 to {}", choice_.setting, frames - 1);
  }
  lines_.go_back_to(line);
  lines_.refuse(std::move(what), std::move(hint), 1);
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
  if (words_.size() != columns().roles.size()) {
    lines_.refuse(
        fmt::format("the line has {} columns, but the Properties name {}", words_.size(), columns().roles.size()),
        "is the line cut off?", words_.back().column);
  }
  Row row = row_of(words_);
  put_inside(row);
  rows.disks.push_back(row);
  for (auto const& [column, name] : columns().others) rows.others.push_back(any_number(words_[column].text));
  ++next_row_;
}

/// Moves a position into the box: relative to the lower left corner, and through periodic edges, but not through walls.
void Reader::put_inside(Row& row) {
  if (header_.origin.x != 0.0) row.position.x -= header_.origin.x;
  if (header_.origin.y != 0.0) row.position.y -= header_.origin.y;
  if (!box_.has_images()) return;
  Vector const outside = row.position;
  if (box_.is_oblique()) row.image_x += static_cast<std::int32_t>(widths_ * row.image_y);
  if (box_.is_periodic_y()) {
    std::int32_t const before = row.image_y;
    row.image_y = folded(row.position.y, box_.height(), row.image_y);
    row.position.x -= (row.image_y - before) * box_.shift();
  }
  if (box_.is_periodic_x()) row.image_x = folded(row.position.x, box_.width(), row.image_x);
  if (!(outside.x == row.position.x && outside.y == row.position.y)) ++folded_;
}

/// Moves a position into [0, side) and returns its new image. Errors: Error if the image exceeds 32 bits.
std::int32_t Reader::folded(double& place, double side, std::int32_t image) const {
  double const before = place;
  double const moved = static_cast<double>(image) + fold(place, side);
  constexpr double max_image = std::numeric_limits<std::int32_t>::max();
  if (std::abs(moved) <= max_image) return static_cast<std::int32_t>(moved);
  lines_.refuse(fmt::format("the disk at {} is {:.3g} boxes outside", before, std::abs(moved)),
                "are positions and Lattice in one unit?");
}

Row Reader::row_of(std::vector<Word> const& words) const {
  Row row{.id = next_row_, .number = next_row_};
  for (std::size_t c = 0; c < words.size(); ++c) take(words[c], columns().roles[c], row);
  if (!columns().has_momenta) return row;
  Vector const momentum = row.velocity;
  row.velocity = {momentum.x / row.mass, momentum.y / row.mass};
  if (!std::isfinite(row.velocity.x) || !std::isfinite(row.velocity.y)) {
    lines_.refuse(
        fmt::format("the momentum {}, {} over the mass {} is no finite velocity", momentum.x, momentum.y, row.mass),
        "are they in one unit?");
  }
  return row;
}

/// Stores a word of the row. Momenta are stored as velocities until row_of() divides them by the mass.
void Reader::take(Word const& word, Role role, Row& row) const {
  switch (role) {
    case Role::ignored:
    case Role::image_z:
      break;
    case Role::x:
      row.position.x = finite_number(lines_, word, role);
      break;
    case Role::y:
      row.position.y = finite_number(lines_, word, role);
      break;
    case Role::z:
    case Role::velocity_z:
    case Role::momentum_z:
      refuse_height(word, role);
      break;
    case Role::id:
      row.id = id(word);
      break;
    case Role::velocity_x:
    case Role::momentum_x:
      row.velocity.x = finite_number(lines_, word, role);
      break;
    case Role::velocity_y:
    case Role::momentum_y:
      row.velocity.y = finite_number(lines_, word, role);
      break;
    case Role::radius:
      row.radius = positive(word, role);
      break;
    case Role::diameter:
      row.radius = 0.5 * positive(word, role);
      break;
    case Role::mass:
      // A fixed disk has an infinite mass.
      row.mass = word.text == "inf" ? std::numeric_limits<double>::infinity() : positive(word, role);
      break;
    case Role::image_x:
      row.image_x = image(word, role);
      break;
    case Role::image_y:
      row.image_y = image(word, role);
      break;
  }
}

double Reader::positive(Word const& word, Role role) const {
  double const number = finite_number(lines_, word, role);
  if (!(number > 0.0)) refuse_word(lines_, word, role, "above 0");
  return number;
}

void Reader::refuse_height(Word const& word, Role role) const {
  double const height = finite_number(lines_, word, role);
  if (height == 0.0) return;
  // Programs that rotate a system leave rounding errors of 0.
  bool const is_place = role == Role::z;
  if (is_place && std::abs(height) <= 1e-12 * std::max(box_.width(), box_.height())) return;
  lines_.refuse(fmt::format("the {} is {}, but disks live in the plane z = 0", name_of(role), word.text),
                "only two-dimensional systems can be read", word.column);
}

Id Reader::id(Word const& word) const {
  auto const number = parse_number<Id>(word.text);
  if (!number) refuse_word(lines_, word, Role::id, "a whole number, 0 or above");
  return *number;
}

std::int32_t Reader::image(Word const& word, Role role) const {
  auto const number = parse_number<std::int32_t>(word.text);
  if (!number) refuse_word(lines_, word, role, "a whole number of 32 bits");
  return *number;
}

void Reader::refuse(WrongId const& wrong) {
  lines_.go_back_to(line_of(wrong.row));
  if (wrong.first_row) {
    lines_.refuse(fmt::format("the id {} is given twice, first on line {}", wrong.id, line_of(*wrong.first_row)),
                  "ids, and their last 32 bits, have to differ");
  }
  lines_.refuse(fmt::format("the id {} is out of proportion to {} disks", wrong.id, count_),
                fmt::format("use ids below {}, or leave the column out", max_slots(count_)));
}

}  // namespace gridlock::xyz
