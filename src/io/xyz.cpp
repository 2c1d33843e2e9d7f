#include "gridlock/io/xyz.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "gridlock/core/error.hpp"
#include "io/gzip.hpp"
#include "io/text.hpp"
#include "io/xyz_names.hpp"

namespace gridlock {

namespace {

/// What a column of the file means to us.
enum class Role { ignored, x, y, z, id, velocity_x, velocity_y, velocity_z, radius, mass, image_x, image_y, image_z };

std::string_view name_of(Role role) {
  constexpr std::array<std::string_view, 13> names{"",           "x position", "y position", "z position", "id",
                                                   "x velocity", "y velocity", "z velocity", "radius",     "mass",
                                                   "x image",    "y image",    "z image"};
  return names[static_cast<std::size_t>(role)];
}

/// A property we read, under the names programs give it.
struct Property {
  std::vector<std::string_view> names;
  std::vector<Role> roles;
  std::size_t fewest;  ///< columns it may have; at most one for each role
};

std::vector<Property> const& known_properties() {
  static std::vector<Property> const properties{
      {{"pos", "positions"}, {Role::x, Role::y, Role::z}, 2},
      {{"velo", "vel", "velocity", "velocities"}, {Role::velocity_x, Role::velocity_y, Role::velocity_z}, 2},
      {{"radius", "radii"}, {Role::radius}, 1},
      {{"masses", "mass"}, {Role::mass}, 1},
      {{"id"}, {Role::id}, 1},
      {{"image", "images"}, {Role::image_x, Role::image_y, Role::image_z}, 2},
  };
  return properties;
}

/// One word of a line and where it begins.
struct Word {
  std::string_view text;
  int column = 0;
};

bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\v' || c == '\f'; }

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

/// One disk as its line gives it.
struct Row {
  Id id = 0;
  Vector position;
  Vector velocity;
  double radius = 0.0;
  double mass = 1.0;
  std::int32_t image_x = 0;
  std::int32_t image_y = 0;
  std::size_t number = 0;  ///< from 0, as it stands in the file
  int line = 0;
};

std::uint64_t slot_of(Id id) { return id & 0xFFFFFFFFU; }

class XyzReader {
 public:
  XyzReader(std::string_view text, std::string name) : text_(text), file_(std::move(name)) {}

  XyzFrame read() {
    std::uint64_t const count = read_count();
    read_header();
    read_rows(count);
    refuse_more_lines(count);
    return frame(count);
  }

 private:
  struct Attribute {
    std::string key;
    std::string value;
    int column = 0;
  };

  bool next_line() {
    if (at_ >= text_.size()) return false;
    std::size_t const end = std::min(text_.find('\n', at_), text_.size());
    line_ = text_.substr(at_, end - at_);
    at_ = end + 1;
    ++line_number_;
    return true;
  }

  [[noreturn]] void refuse(std::string what, std::string hint, int column = 0) const {
    throw Error(Problem{.what = std::move(what),
                        .hint = hint.empty() ? "correct the line, or write the file again" : std::move(hint),
                        .file = file_,
                        .line = line_number_,
                        .column = column,
                        .source_line = shown_line(line_)});
  }

  std::uint64_t read_count() {
    if (!next_line()) refuse("the file is empty", "extended XYZ begins with the number of disks");
    std::vector<Word> words;
    split(line_, words);
    auto const count = words.size() == 1 ? parse_number<std::uint64_t>(words[0].text) : std::nullopt;
    if (!count) {
      refuse(fmt::format("the first line is {}, not the number of disks", in_quotes(line_)), "is this extended XYZ?",
             1);
    }
    return *count;
  }

  void read_header() {
    if (!next_line()) {
      ++line_number_;
      line_ = {};
      refuse("the file ends before the line of the box and the columns",
             "the second line needs Lattice=\"…\" and Properties=…");
    }
    for (Attribute const& attribute : attributes()) read_attribute(attribute);
    if (!has_lattice_) refuse("the second line gives no Lattice", "add Lattice=\"width 0 0 0 height 0 0 0 1\"");
    if (roles_.empty()) refuse("the second line gives no Properties", "add Properties=species:S:1:pos:R:3:radius:R:1");
    frame_.state.box = Box(width_, height_, edge_);
  }

  /// The key=value pairs of the second line; a value may stand in quotes, brackets or braces.
  [[nodiscard]] std::vector<Attribute> attributes() const {
    std::vector<Attribute> found;
    for (std::size_t at = 0; at < line_.size();) {
      if (is_blank(line_[at])) {
        ++at;
        continue;
      }
      Attribute attribute{.key = "", .value = "T", .column = static_cast<int>(at) + 1};
      while (at < line_.size() && !is_blank(line_[at]) && line_[at] != '=') attribute.key += line_[at++];
      if (at < line_.size() && line_[at] == '=') {
        ++at;
        attribute.value = take_value(at);
      }
      found.push_back(std::move(attribute));
    }
    return found;
  }

  [[nodiscard]] std::string take_value(std::size_t& at) const {
    constexpr std::string_view opening = "\"'{[", closing = "\"'}]";
    std::size_t const kind = at < line_.size() ? opening.find(line_[at]) : std::string_view::npos;
    if (kind == std::string_view::npos) {
      std::size_t const begin = at;
      while (at < line_.size() && !is_blank(line_[at])) ++at;
      return std::string(line_.substr(begin, at - begin));
    }
    std::size_t const end = line_.find(closing[kind], at + 1);
    if (end == std::string_view::npos) {
      refuse(fmt::format("the {} in the second line does not end", line_[at]), "is the line cut off?",
             static_cast<int>(at) + 1);
    }
    std::string value(line_.substr(at + 1, end - at - 1));
    at = end + 1;
    return value;
  }

  void read_attribute(Attribute const& attribute) {
    std::string_view const value = attribute.value;
    if (attribute.key == "Lattice") {
      read_lattice(attribute);
    } else if (attribute.key == "pbc") {
      read_edge(attribute);
    } else if (attribute.key == "Properties") {
      read_properties(attribute);
    } else if (attribute.key == "Origin") {
      std::vector<Word> words;
      split(value, words);
      for (Word const& word : words) {
        if (parse_number<double>(word.text) == 0.0) continue;
        refuse(fmt::format("the box begins at {}, not at the origin", value),
               "shift all positions by minus this Origin", attribute.column);
      }
    } else if (attribute.key == "Time") {
      auto const time = parse_number<double>(value);
      if (!time || !std::isfinite(*time)) refuse_attribute(attribute, "a finite number");
      frame_.state.clock.time = *time;
    } else if (attribute.key == "step") {
      frame_.state.clock.step = whole_number(attribute);
    } else if (attribute.key == "seed") {
      frame_.state.seed = whole_number(attribute);
    }
  }

  [[noreturn]] void refuse_attribute(Attribute const& attribute, std::string_view expected) const {
    refuse(fmt::format("{} is {}, but must be {}", attribute.key, in_quotes(attribute.value), expected), "",
           attribute.column);
  }

  [[nodiscard]] std::uint64_t whole_number(Attribute const& attribute) const {
    auto const number = parse_number<std::uint64_t>(attribute.value);
    if (!number) refuse_attribute(attribute, "a whole number, 0 or above");
    return *number;
  }

  void read_lattice(Attribute const& attribute) {
    std::vector<Word> words;
    split(attribute.value, words);
    std::array<double, 9> lattice{};
    if (words.size() != lattice.size()) refuse_attribute(attribute, "nine numbers");
    for (std::size_t i = 0; i < lattice.size(); ++i) {
      auto const number = parse_number<double>(words[i].text);
      if (!number || !std::isfinite(*number)) refuse_attribute(attribute, "nine finite numbers");
      lattice[i] = *number;
    }
    for (std::size_t const i : {1, 2, 3, 5, 6, 7}) {
      if (lattice[i] == 0.0) continue;
      refuse(fmt::format("the Lattice {} is not orthogonal", in_quotes(attribute.value)),
             "only boxes with sides along x and y can be simulated: width 0 0 0 height 0 0 0 1", attribute.column);
    }
    width_ = lattice[0];
    height_ = lattice[4];
    if (!(width_ > 0.0 && height_ > 0.0)) {
      refuse(fmt::format("the box of {} × {} has no area", width_, height_), "both sides must be above 0",
             attribute.column);
    }
    has_lattice_ = true;
  }

  void read_edge(Attribute const& attribute) {
    std::vector<Word> words;
    split(attribute.value, words);
    auto const is = [](std::string_view word, std::string_view letter, std::string_view name, std::string_view number) {
      return word == letter || word == name || word == number;
    };
    std::vector<bool> periodic;
    for (Word const& word : words) {
      bool const yes = is(word.text, "T", "True", "1");
      if (!yes && !is(word.text, "F", "False", "0")) break;
      periodic.push_back(yes);
    }
    if (words.size() != 3 || periodic.size() != 3) refuse_attribute(attribute, "\"T T F\" or \"F F F\"");
    if (periodic[0] != periodic[1]) {
      refuse(fmt::format("pbc {} is periodic on two sides only", in_quotes(attribute.value)),
             "a box has either walls or periodic edges on all sides", attribute.column);
    }
    edge_ = periodic[0] ? Edge::periodic : Edge::wall;
  }

  void read_properties(Attribute const& attribute) {
    std::vector<std::string_view> fields;
    std::string_view rest = attribute.value;
    while (true) {
      std::size_t const colon = rest.find(':');
      fields.push_back(rest.substr(0, colon));
      if (colon == std::string_view::npos) break;
      rest.remove_prefix(colon + 1);
    }
    if (fields.size() % 3 != 0) refuse_attribute(attribute, "name:type:columns, repeated");
    roles_.clear();
    other_at_.clear();
    for (std::size_t i = 0; i < fields.size(); i += 3) {
      auto const columns = parse_number<std::uint64_t>(fields[i + 2]);
      constexpr std::uint64_t most_columns = 1000;
      if (!columns || *columns == 0 || *columns > most_columns || roles_.size() > most_columns) {
        refuse(fmt::format("the property {} has {} columns, not a number from 1 to {}", in_quotes(fields[i]),
                           in_quotes(fields[i + 2]), most_columns),
               "Properties is name:type:columns, repeated", attribute.column);
      }
      bool const is_number = fields[i + 1] == "R" || fields[i + 1] == "I";
      if (*columns == 1 && is_number) other_at_[roles_.size()] = std::string(fields[i]);
      add_property(attribute, fields[i], static_cast<std::size_t>(*columns));
    }
    if (!has(Role::x)) {
      refuse("the file has no positions: no pos among the Properties", "add pos:R:3 and the columns", attribute.column);
    }
    std::erase_if(other_at_, [&](auto const& other) { return roles_[other.first] != Role::ignored; });
    for (auto& [column, name] : other_at_) name = xyz::column_name(name);
    frame_.has_velocities = has(Role::velocity_x);
    frame_.has_radii = has(Role::radius);
    has_ids_ = has(Role::id);
  }

  void add_property(Attribute const& attribute, std::string_view name, std::size_t columns) {
    for (Property const& property : known_properties()) {
      if (std::ranges::find(property.names, name) == property.names.end()) continue;
      if (columns < property.fewest || columns > property.roles.size()) {
        refuse(fmt::format("the property {} has {} columns, but must have {}", name, columns,
                           property.fewest == property.roles.size()
                               ? fmt::format("{}", property.fewest)
                               : fmt::format("{} or {}", property.fewest, property.roles.size())),
               "", attribute.column);
      }
      if (has(property.roles[0])) {
        refuse(fmt::format("the file gives every {} twice", name_of(property.roles[0])), "take one of the columns out",
               attribute.column);
      }
      for (std::size_t c = 0; c < columns; ++c) roles_.push_back(property.roles[c]);
      return;
    }
    roles_.insert(roles_.end(), columns, Role::ignored);
  }

  [[nodiscard]] bool has(Role role) const { return std::ranges::find(roles_, role) != roles_.end(); }

  void read_rows(std::uint64_t count) {
    // A row takes a digit and a space for every column: what the file cannot hold is not reserved.
    std::size_t const left = at_ < text_.size() ? text_.size() - at_ : 0;
    rows_.reserve(std::min<std::uint64_t>(count, left / (2 * roles_.size()) + 1));
    std::vector<Word> words;
    for (std::uint64_t i = 0; i < count; ++i) {
      if (next_line()) {
        split(line_, words);
      } else {
        words.clear();
      }
      if (words.empty()) {
        refuse(fmt::format("the file ends after {} of {} disks", i, count),
               "is the file cut off, or the first line wrong?");
      }
      if (words.size() != roles_.size()) {
        refuse(fmt::format("the line has {} columns, but the Properties name {}", words.size(), roles_.size()),
               "is the line cut off?", words.back().column);
      }
      rows_.push_back(row(words, i));
      for (auto const& [column, name] : other_at_) {
        others_.push_back(parse_number<double>(words[column].text).value_or(std::nan("")));
      }
    }
  }

  [[nodiscard]] Row row(std::vector<Word> const& words, std::uint64_t number) const {
    Row row{.id = number, .number = static_cast<std::size_t>(number), .line = line_number_};
    for (std::size_t c = 0; c < words.size(); ++c) {
      switch (roles_[c]) {
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
    refuse(fmt::format("the {} is {}, but must be {}", name_of(role), in_quotes(word.text), expected), "", word.column);
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
    refuse(fmt::format("the {} is {}, but disks live in the plane z = 0", name_of(role), word.text),
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

  void refuse_more_lines(std::uint64_t count) {
    std::vector<Word> words;
    while (next_line()) {
      split(line_, words);
      if (words.empty()) continue;
      bool const is_count = words.size() == 1 && parse_number<std::uint64_t>(words[0].text);
      refuse(fmt::format("the file continues after its {} disks", count),
             is_count ? "it holds more than one frame: keep the one to start from" : "is the first line wrong?", 1);
    }
  }

  XyzFrame frame(std::uint64_t count) {
    // A population keeps a place for every slot up to the largest: a damaged id must not ask for all the memory.
    std::uint64_t const most_slots = (std::uint64_t{1} << 22) + 64 * count;
    if (has_ids_) std::ranges::stable_sort(rows_, {}, [](Row const& row) { return slot_of(row.id); });
    frame_.state.agents.reserve(rows_.size());
    Row const* last = nullptr;
    for (Row const& row : rows_) {
      if (last != nullptr && slot_of(last->id) == slot_of(row.id)) {
        refuse_row(row, fmt::format("the id {} is given twice, first on line {}", row.id, last->line),
                   "ids, and their last 32 bits, have to differ");
      }
      if (slot_of(row.id) >= most_slots) {
        refuse_row(row, fmt::format("the id {} is out of proportion to {} disks", row.id, count),
                   fmt::format("use ids below {}, or leave the column out", most_slots));
      }
      bool const is_new = frame_.state.agents.add_as(row.id, row.position.x, row.position.y, row.velocity.x,
                                                     row.velocity.y, row.radius, row.mass, row.image_x, row.image_y);
      if (!is_new) refuse_row(row, fmt::format("the id {} is given twice", row.id), "");
      last = &row;
    }
    add_others();
    return std::move(frame_);
  }

  void add_others() {
    std::ranges::stable_sort(rows_, {}, &Row::id);
    std::size_t place = 0;
    for (auto const& [column, name] : other_at_) {
      std::vector<double> values;
      for (Row const& row : rows_) values.push_back(others_[row.number * other_at_.size() + place]);
      frame_.others.push_back({name, std::move(values)});
      ++place;
    }
  }

  [[noreturn]] void refuse_row(Row const& row, std::string what, std::string hint) {
    at_ = 0;
    line_number_ = 0;
    while (line_number_ < row.line && next_line()) {
    }
    refuse(std::move(what), std::move(hint));
  }

  std::string_view text_;
  std::string file_;
  std::size_t at_ = 0;
  int line_number_ = 0;
  std::string_view line_;

  double width_ = 0.0;
  double height_ = 0.0;
  Edge edge_ = Edge::periodic;
  bool has_lattice_ = false;
  bool has_ids_ = false;
  std::vector<Role> roles_;
  std::map<std::size_t, std::string> other_at_;  ///< columns that disks do not have, one number each, by their place
  std::vector<double> others_;                   ///< row after row, those of other_at_
  std::vector<Row> rows_;
  XyzFrame frame_;
};

}  // namespace

XyzFrame parse_xyz(std::string_view text, std::string const& name) { return XyzReader(text, name).read(); }

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
