#include "gridlock/io/xyz.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "gridlock/core/error.hpp"
#include "io/file.hpp"
#include "io/gzip.hpp"
#include "io/text.hpp"
#include "io/xyz_header.hpp"
#include "io/xyz_lines.hpp"

namespace gridlock {

namespace xyz {

namespace {

/// One disk as its line gives it.
struct Row {
  Id id = 0;
  Vector position;
  Vector velocity;
  double radius = 0.0;
  double mass = 1.0;
  std::int32_t image_x = 0;
  std::int32_t image_y = 0;
  std::size_t number = 0;  ///< from 0, as it is in the file
  int line = 0;
};

/// The rows of a file as they stand in it.
struct Rows {
  std::vector<Row> disks;
  std::vector<double> others;  ///< row after row, those of Header::others
};

/// Reads the rows below the header.
class RowReader {
 public:
  RowReader(Lines& lines, Header const& header) : lines_(lines), header_(header) {}

  Rows read(std::uint64_t count) {
    Rows rows;
    // A row takes a digit and a space for every column: what the file cannot hold is not reserved.
    rows.disks.reserve(std::min<std::uint64_t>(count, lines_.bytes_left() / (2 * header_.roles.size()) + 1));
    std::vector<Word> words;
    for (std::uint64_t i = 0; i < count; ++i) {
      if (lines_.next()) {
        split(lines_.line(), words);
      } else {
        words.clear();
      }
      if (words.empty()) {
        lines_.refuse(fmt::format("the file ends after {} of {} disks", i, count),
                      "is the file cut off, or the first line wrong?");
      }
      if (words.size() != header_.roles.size()) {
        lines_.refuse(
            fmt::format("the line has {} columns, but the Properties name {}", words.size(), header_.roles.size()),
            "is the line cut off?", words.back().column);
      }
      rows.disks.push_back(row(words, i));
      for (auto const& [column, name] : header_.others) {
        rows.others.push_back(parse_number<double>(words[column].text).value_or(std::nan("")));
      }
    }
    return rows;
  }

 private:
  [[nodiscard]] Row row(std::vector<Word> const& words, std::uint64_t number) const {
    Row row{.id = number, .number = static_cast<std::size_t>(number), .line = lines_.number()};
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

  [[noreturn]] void refuse_word(Word const& word, Role role, std::string_view expected) const {
    lines_.refuse(fmt::format("the {} is {}, but must be {}", name_of(role), in_quotes(word.text), expected), "",
                  word.column);
  }

  [[nodiscard]] double real(Word const& word, Role role) const {
    auto const number = parse_number<double>(word.text);
    if (!number || !std::isfinite(*number)) refuse_word(word, role, "a finite number");
    return *number;
  }

  [[nodiscard]] double positive(Word const& word, Role role) const {
    double const number = real(word, role);
    if (!(number > 0.0)) refuse_word(word, role, "above 0");
    return number;
  }

  void refuse_height(Word const& word, Role role) const {
    if (real(word, role) == 0.0) return;
    lines_.refuse(fmt::format("the {} is {}, but disks live in the plane z = 0", name_of(role), word.text),
                  "only two-dimensional systems can be read", word.column);
  }

  [[nodiscard]] Id id(Word const& word) const {
    auto const number = parse_number<Id>(word.text);
    if (!number) refuse_word(word, Role::id, "a whole number, 0 or above");
    return *number;
  }

  [[nodiscard]] std::int32_t image(Word const& word, Role role) const {
    auto const number = parse_number<std::int32_t>(word.text);
    if (!number) refuse_word(word, role, "a whole number of 32 bits");
    return *number;
  }

  Lines& lines_;
  Header const& header_;
};

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

std::uint64_t slot_of(Id id) { return id & 0xFFFFFFFFU; }

[[noreturn]] void refuse_row(Lines& lines, Row const& row, std::string what, std::string hint) {
  lines.go_back_to(row.line);
  lines.refuse(std::move(what), std::move(hint));
}

/// The columns that disks do not have, in the order of the Ids.
std::vector<FrameColumn> others_of(Rows& rows, Header const& header) {
  std::ranges::stable_sort(rows.disks, {}, &Row::id);
  std::vector<FrameColumn> others;
  for (auto const& [column, name] : header.others) {
    std::vector<double> values;
    for (Row const& row : rows.disks) {
      values.push_back(rows.others[row.number * header.others.size() + others.size()]);
    }
    others.push_back({name, std::move(values)});
  }
  return others;
}

XyzFrame frame_of(Rows& rows, Header const& header, std::uint64_t count, Lines& lines) {
  XyzFrame frame{.state = {.box = header.box, .agents = {}, .clock = header.clock, .seed = header.seed},
                 .has_velocities = header.has(Role::velocity_x),
                 .has_radii = header.has(Role::radius),
                 .has_masses = header.has(Role::mass),
                 .has_images = header.has(Role::image_x)};
  Disks& disks = frame.state.agents;
  // A population keeps a place for every slot up to the largest: a damaged id must not ask for all the memory.
  std::uint64_t const most_slots = (std::uint64_t{1} << 22) + 64 * count;
  if (header.has(Role::id)) std::ranges::stable_sort(rows.disks, {}, [](Row const& row) { return slot_of(row.id); });
  disks.reserve(rows.disks.size());
  Row const* last = nullptr;
  for (Row const& row : rows.disks) {
    if (last != nullptr && slot_of(last->id) == slot_of(row.id)) {
      refuse_row(lines, row, fmt::format("the id {} is given twice, first on line {}", row.id, last->line),
                 "ids, and their last 32 bits, have to differ");
    }
    if (slot_of(row.id) >= most_slots) {
      refuse_row(lines, row, fmt::format("the id {} is out of proportion to {} disks", row.id, count),
                 fmt::format("use ids below {}, or leave the column out", most_slots));
    }
    bool const is_new = disks.add_as(row.id, row.position.x, row.position.y, row.velocity.x, row.velocity.y, row.radius,
                                     row.mass, row.image_x, row.image_y);
    if (!is_new) refuse_row(lines, row, fmt::format("the id {} is given twice", row.id), "");
    last = &row;
  }
  frame.others = others_of(rows, header);
  return frame;
}

}  // namespace

}  // namespace xyz

XyzFrame parse_xyz(std::string_view text, std::string const& name) {
  xyz::Lines lines(text, name);
  std::uint64_t const count = xyz::read_count(lines);
  xyz::Header const header = xyz::read_header(lines);
  xyz::Rows rows = xyz::RowReader(lines, header).read(count);
  xyz::refuse_more_lines(lines, count);
  return xyz::frame_of(rows, header, count, lines);
}

XyzFrame read_xyz(std::filesystem::path const& path) {
  std::string text = read_file(path);
  if (is_gzip(text)) {
    // Rows of numbers become five times as small at most; a file that asks for much more is a trap.
    constexpr std::size_t most_packed = 100;
    auto unpacked = unpacked_gzip(text, most_packed * text.size());
    if (!unpacked) {
      throw Error({.what = fmt::format("cannot unpack {}: it is damaged or cut off", path.string()),
                   .hint = "pack it again with gzip",
                   .file = path.string()});
    }
    text = std::move(*unpacked);
  }
  return parse_xyz(text, path.string());
}

}  // namespace gridlock
