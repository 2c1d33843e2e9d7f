#include "io/xyz_header.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "io/text.hpp"
#include "io/xyz_names.hpp"

namespace gridlock::xyz {

namespace {

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

/// One key=value pair of the second line.
struct Attribute {
  std::string key;
  std::string value;
  int column = 0;
};

std::string take_value(Lines const& lines, std::size_t& at) {
  std::string_view const line = lines.line();
  constexpr std::string_view opening = "\"'{[", closing = "\"'}]";
  std::size_t const kind = at < line.size() ? opening.find(line[at]) : std::string_view::npos;
  if (kind == std::string_view::npos) {
    std::size_t const begin = at;
    while (at < line.size() && !is_blank(line[at])) ++at;
    return std::string(line.substr(begin, at - begin));
  }
  std::size_t const end = line.find(closing[kind], at + 1);
  if (end == std::string_view::npos) {
    lines.refuse(fmt::format("the {} in the second line does not end", line[at]), "is the line cut off?",
                 static_cast<int>(at) + 1);
  }
  std::string value(line.substr(at + 1, end - at - 1));
  at = end + 1;
  return value;
}

/// The key=value pairs of the second line; a value may stand in quotes, brackets or braces.
std::vector<Attribute> attributes_of(Lines const& lines) {
  std::string_view const line = lines.line();
  std::vector<Attribute> found;
  for (std::size_t at = 0; at < line.size();) {
    if (is_blank(line[at])) {
      ++at;
      continue;
    }
    Attribute attribute{.key = "", .value = "T", .column = static_cast<int>(at) + 1};
    while (at < line.size() && !is_blank(line[at]) && line[at] != '=') attribute.key += line[at++];
    if (at < line.size() && line[at] == '=') {
      ++at;
      attribute.value = take_value(lines, at);
    }
    found.push_back(std::move(attribute));
  }
  return found;
}

[[noreturn]] void refuse_attribute(Lines const& lines, Attribute const& attribute, std::string_view expected) {
  lines.refuse(fmt::format("{} is {}, but must be {}", attribute.key, in_quotes(attribute.value), expected), "",
               attribute.column);
}

std::uint64_t whole_number(Lines const& lines, Attribute const& attribute) {
  auto const number = parse_number<std::uint64_t>(attribute.value);
  if (!number) refuse_attribute(lines, attribute, "a whole number, 0 or above");
  return *number;
}

/// Reads the attribute Properties, the columns of the file.
class PropertiesReader {
 public:
  PropertiesReader(Lines const& lines, Attribute const& attribute, Header& header)
      : lines_(lines), attribute_(attribute), header_(header) {}

  void read() {
    std::vector<std::string_view> fields;
    std::string_view rest = attribute_.value;
    while (true) {
      std::size_t const colon = rest.find(':');
      fields.push_back(rest.substr(0, colon));
      if (colon == std::string_view::npos) break;
      rest.remove_prefix(colon + 1);
    }
    if (fields.size() % 3 != 0) refuse_attribute(lines_, attribute_, "name:type:columns, repeated");
    header_.roles.clear();
    header_.others.clear();
    for (std::size_t i = 0; i < fields.size(); i += 3) {
      auto const columns = parse_number<std::uint64_t>(fields[i + 2]);
      constexpr std::uint64_t most_columns = 1000;
      if (!columns || *columns == 0 || *columns > most_columns || header_.roles.size() > most_columns) {
        lines_.refuse(fmt::format("the property {} has {} columns, not a number from 1 to {}", in_quotes(fields[i]),
                                  in_quotes(fields[i + 2]), most_columns),
                      "Properties is name:type:columns, repeated", attribute_.column);
      }
      bool const is_number = fields[i + 1] == "R" || fields[i + 1] == "I";
      if (*columns == 1 && is_number) header_.others[header_.roles.size()] = std::string(fields[i]);
      add_property(fields[i], static_cast<std::size_t>(*columns));
    }
    if (!header_.has(Role::x)) {
      lines_.refuse("the file has no positions: no pos among the Properties", "add pos:R:3 and the columns",
                    attribute_.column);
    }
    std::erase_if(header_.others, [&](auto const& other) { return header_.roles[other.first] != Role::ignored; });
    for (auto& [column, name] : header_.others) name = xyz::column_name(name);
  }

 private:
  void add_property(std::string_view name, std::size_t columns) {
    for (Property const& property : known_properties()) {
      if (std::ranges::find(property.names, name) == property.names.end()) continue;
      if (columns < property.fewest || columns > property.roles.size()) {
        lines_.refuse(fmt::format("the property {} has {} columns, but must have {}", name, columns,
                                  property.fewest == property.roles.size()
                                      ? fmt::format("{}", property.fewest)
                                      : fmt::format("{} or {}", property.fewest, property.roles.size())),
                      "", attribute_.column);
      }
      if (header_.has(property.roles[0])) {
        lines_.refuse(fmt::format("the file gives every {} twice", name_of(property.roles[0])),
                      "take one of the columns out", attribute_.column);
      }
      for (std::size_t c = 0; c < columns; ++c) header_.roles.push_back(property.roles[c]);
      return;
    }
    header_.roles.insert(header_.roles.end(), columns, Role::ignored);
  }

  Lines const& lines_;
  Attribute const& attribute_;
  Header& header_;
};

/// Reads the second line, attribute by attribute.
class HeaderReader {
 public:
  explicit HeaderReader(Lines const& lines) : lines_(lines) {}

  Header read() {
    for (Attribute const& attribute : attributes_of(lines_)) read_attribute(attribute);
    if (!has_lattice_) {
      lines_.refuse("the second line gives no Lattice", "add Lattice=\"width 0 0 0 height 0 0 0 1\"");
    }
    if (header_.roles.empty()) {
      lines_.refuse("the second line gives no Properties", "add Properties=species:S:1:pos:R:3:radius:R:1");
    }
    header_.box = Box(width_, height_, edge_);
    return std::move(header_);
  }

 private:
  void read_attribute(Attribute const& attribute) {
    std::string_view const value = attribute.value;
    if (attribute.key == "Lattice") {
      read_lattice(attribute);
    } else if (attribute.key == "pbc") {
      read_edge(attribute);
    } else if (attribute.key == "Properties") {
      PropertiesReader(lines_, attribute, header_).read();
    } else if (attribute.key == "Origin") {
      std::vector<Word> words;
      split(value, words);
      for (Word const& word : words) {
        if (parse_number<double>(word.text) == 0.0) continue;
        lines_.refuse(fmt::format("the box begins at {}, not at the origin", value),
                      "shift all positions by minus this Origin", attribute.column);
      }
    } else if (attribute.key == "Time") {
      auto const time = parse_number<double>(value);
      if (!time || !std::isfinite(*time)) refuse_attribute(lines_, attribute, "a finite number");
      header_.clock.time = *time;
    } else if (attribute.key == "step") {
      header_.clock.step = whole_number(lines_, attribute);
    } else if (attribute.key == "seed") {
      header_.seed = whole_number(lines_, attribute);
    }
  }

  void read_lattice(Attribute const& attribute) {
    std::vector<Word> words;
    split(attribute.value, words);
    std::array<double, 9> lattice{};
    if (words.size() != lattice.size()) refuse_attribute(lines_, attribute, "nine numbers");
    for (std::size_t i = 0; i < lattice.size(); ++i) {
      auto const number = parse_number<double>(words[i].text);
      if (!number || !std::isfinite(*number)) refuse_attribute(lines_, attribute, "nine finite numbers");
      lattice[i] = *number;
    }
    for (std::size_t const i : {1, 2, 3, 5, 6, 7}) {
      if (lattice[i] == 0.0) continue;
      lines_.refuse(fmt::format("the Lattice {} is not orthogonal", in_quotes(attribute.value)),
                    "only boxes with sides along x and y can be simulated: width 0 0 0 height 0 0 0 1",
                    attribute.column);
    }
    width_ = lattice[0];
    height_ = lattice[4];
    if (!(width_ > 0.0 && height_ > 0.0)) {
      lines_.refuse(fmt::format("the box of {} × {} has no area", width_, height_), "both sides must be above 0",
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
    if (words.size() != 3 || periodic.size() != 3) refuse_attribute(lines_, attribute, "\"T T F\" or \"F F F\"");
    if (periodic[0] != periodic[1]) {
      lines_.refuse(fmt::format("pbc {} is periodic on two sides only", in_quotes(attribute.value)),
                    "a box has either walls or periodic edges on all sides", attribute.column);
    }
    edge_ = periodic[0] ? Edge::periodic : Edge::wall;
  }

  Lines const& lines_;
  double width_ = 0.0;
  double height_ = 0.0;
  Edge edge_ = Edge::periodic;
  bool has_lattice_ = false;
  Header header_;
};

}  // namespace

std::string_view name_of(Role role) {
  constexpr std::array<std::string_view, 13> names{"",           "x position", "y position", "z position", "id",
                                                   "x velocity", "y velocity", "z velocity", "radius",     "mass",
                                                   "x image",    "y image",    "z image"};
  return names[static_cast<std::size_t>(role)];
}

bool Header::has(Role role) const { return std::ranges::find(roles, role) != roles.end(); }

Header read_header(Lines& lines) {
  if (!lines.next()) {
    lines.go_behind_the_last();
    lines.refuse("the file ends before the line of the box and the columns",
                 "the second line needs Lattice=\"…\" and Properties=…");
  }
  return HeaderReader(lines).read();
}

}  // namespace gridlock::xyz
