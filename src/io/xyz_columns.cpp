#include "io/xyz_columns.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstdint>
#include <utility>

#include "io/text.hpp"
#include "io/xyz_names.hpp"

namespace gridlock::xyz {

namespace {

/// A property that Gridlock reads, with the names that other programs use for it.
struct KnownProperty {
  std::vector<std::string_view> names;  ///< in lower case
  std::vector<Role> roles;
  std::size_t min_width;  ///< smallest number of columns; the largest is the number of roles
};

std::vector<KnownProperty> const& known_properties() {
  static std::vector<KnownProperty> const properties{
      {{"pos", "position", "positions", "coordinates"}, {Role::x, Role::y, Role::z}, 2},
      {{"velo", "vel", "velocity", "velocities"}, {Role::velocity_x, Role::velocity_y, Role::velocity_z}, 2},
      {{"radius", "radii"}, {Role::radius}, 1},
      {{"masses", "mass"}, {Role::mass}, 1},
      {{"id", "ids", "identifier", "particle_identifier"}, {Role::id}, 1},
      {{"image", "images", "pbc_image"}, {Role::image_x, Role::image_y, Role::image_z}, 2},
  };
  return properties;
}

/// Another property that is read only if the file has no column with the role `in_place_of`.
struct Substitute {
  std::vector<std::vector<std::string_view>> names;  ///< names of one property, or of one property per component
  std::vector<Role> roles;
  Role in_place_of;
  std::size_t min_width;
};

std::vector<Substitute> const& substitutes() {
  static std::vector<Substitute> const all{
      {{{"x"}, {"y"}, {"z"}}, {Role::x, Role::y, Role::z}, Role::x, 2},
      {{{"vx", "velocity_x"}, {"vy", "velocity_y"}, {"vz", "velocity_z"}},
       {Role::velocity_x, Role::velocity_y, Role::velocity_z},
       Role::velocity_x,
       2},
      {{{"ix", "image_x"}, {"iy", "image_y"}, {"iz", "image_z"}},
       {Role::image_x, Role::image_y, Role::image_z},
       Role::image_x,
       2},
      {{{"momenta", "momentum"}}, {Role::momentum_x, Role::momentum_y, Role::momentum_z}, Role::velocity_x, 2},
      {{{"diameter", "diameters"}}, {Role::diameter}, Role::radius, 1},
  };
  return all;
}

bool is_one_of(std::string_view name, std::vector<std::string_view> const& names) {
  return std::ranges::any_of(names, [&](std::string_view known) {
    return std::ranges::equal(name, known, {}, [](char c) { return std::tolower(static_cast<unsigned char>(c)); });
  });
}

class ColumnsReader {
 public:
  ColumnsReader(Lines const& lines, Entry const& entry) : lines_(lines), entry_(entry) {}

  Columns read() {
    std::vector<std::string_view> fields;
    for (std::string_view rest = entry_.value;;) {
      std::size_t const colon = rest.find(':');
      fields.push_back(rest.substr(0, colon));
      if (colon == std::string_view::npos) break;
      rest.remove_prefix(colon + 1);
    }
    if (fields.size() % 3 != 0) {
      refuse(fmt::format("Properties is {}, but must be name:type:columns, repeated", in_quotes(entry_.value)));
    }
    for (std::size_t i = 0; i < fields.size(); i += 3) add_property(fields[i], fields[i + 1], fields[i + 2]);
    for (Property& property : columns_.properties) give_roles(property);
    for (Substitute const& substitute : substitutes()) {
      if (!columns_.has(substitute.in_place_of)) give_roles(substitute);
    }
    for (Property const& property : columns_.properties) {
      if (property.is_used || property.width != 1 || property.type == 'S') continue;
      columns_.others[property.first] = column_name(property.name);
    }
    columns_.has_momenta = columns_.has(Role::momentum_x);
    return std::move(columns_);
  }

 private:
  [[noreturn]] void refuse(std::string what, std::string hint = "") const {
    lines_.refuse(std::move(what), std::move(hint), entry_.column);
  }

  void add_property(std::string_view name, std::string_view type, std::string_view width) {
    auto const columns = parse_number<std::uint64_t>(width);
    constexpr std::uint64_t max_columns = 1000;
    if (!columns || *columns == 0 || *columns > max_columns || columns_.roles.size() > max_columns) {
      refuse(fmt::format("the property {} has {} columns, not a number from 1 to {}", in_quotes(name), in_quotes(width),
                         max_columns),
             "Properties is name:type:columns, repeated");
    }
    if (type.size() != 1 || std::string_view("RISL").find(type) == std::string_view::npos) {
      refuse(fmt::format("the property {} has the type {}, not R, I, S or L", in_quotes(name), in_quotes(type)),
             "Properties is name:type:columns, repeated");
    }
    auto const count = static_cast<std::size_t>(*columns);
    columns_.properties.push_back(
        {.name = std::string(name), .type = type[0], .first = columns_.roles.size(), .width = count});
    columns_.roles.insert(columns_.roles.end(), count, Role::ignored);
  }

  void give_roles(Property& property) {
    for (KnownProperty const& known : known_properties()) {
      if (!is_one_of(property.name, known.names)) continue;
      if (columns_.has(known.roles[0])) {
        refuse(fmt::format("the file gives every {} twice", name_of(known.roles[0])), "take one of the columns out");
      }
      give(property, known.roles, known.min_width);
      return;
    }
  }

  /// Gives roles to the columns of a substitute; an incomplete one, such as x without y, stays unused.
  void give_roles(Substitute const& substitute) {
    std::vector<Property*> found;
    for (std::vector<std::string_view> const& names : substitute.names) {
      auto const property = std::ranges::find_if(
          columns_.properties, [&](Property const& one) { return !one.is_used && is_one_of(one.name, names); });
      if (property != columns_.properties.end()) found.push_back(&*property);
    }
    if (substitute.names.size() == 1) {
      if (!found.empty()) give(*found[0], substitute.roles, substitute.min_width);
      return;
    }
    bool const is_whole = found.size() >= substitute.min_width && is_one_of(found[0]->name, substitute.names[0]) &&
                          is_one_of(found[1]->name, substitute.names[1]);
    if (!is_whole) return;
    for (std::size_t k = 0; k < found.size(); ++k) give(*found[k], {substitute.roles[k]}, 1);
  }

  void give(Property& property, std::vector<Role> const& roles, std::size_t min_width) {
    if (property.width < min_width || property.width > roles.size()) {
      refuse(fmt::format(
          "the property {} has {} columns, but must have {}", property.name, property.width,
          min_width == roles.size() ? fmt::format("{}", min_width) : fmt::format("{} or {}", min_width, roles.size())));
    }
    if (property.type == 'S' || property.type == 'L') {
      refuse(
          fmt::format("the property {} has the type {}, but must have numbers, R or I", property.name, property.type));
    }
    for (std::size_t c = 0; c < property.width; ++c) columns_.roles[property.first + c] = roles[c];
    property.is_used = true;
  }

  Lines const& lines_;
  Entry const& entry_;
  Columns columns_;
};

}  // namespace

std::string_view name_of(Role role) {
  constexpr std::array<std::string_view, 17> names{"",           "x position", "y position", "z position", "id",
                                                   "x velocity", "y velocity", "z velocity", "x momentum", "y momentum",
                                                   "z momentum", "radius",     "diameter",   "mass",       "x image",
                                                   "y image",    "z image"};
  return names[static_cast<std::size_t>(role)];
}

bool Columns::has(Role role) const { return std::ranges::find(roles, role) != roles.end(); }

std::vector<std::string> Columns::unused() const {
  std::vector<std::string> names;
  for (Property const& property : properties) {
    bool const is_kind = is_one_of(property.name, {"species", "type", "element", "symbol", "symbols"}) ||
                         property.name == "Z";  // "Z" is the atomic number
    if (!property.is_used && !is_kind) names.push_back(property.name);
  }
  return names;
}

Columns read_columns(Lines const& lines, Entry const& properties) { return ColumnsReader(lines, properties).read(); }

double finite_number(Lines const& lines, Word const& word, Role role) {
  auto const number = real_number(word.text);
  if (!number || !std::isfinite(*number)) refuse_word(lines, word, role, "a finite number");
  return *number;
}

double any_number(std::string_view word) {
  if (auto const number = real_number(word)) return *number;
  if (auto const is_true = truth(word)) return *is_true ? 1.0 : 0.0;
  return std::nan("");
}

std::optional<bool> truth(std::string_view word) {
  constexpr std::array<std::string_view, 5> yes{"T", "true", "True", "TRUE", "1"},
      no{"F", "false", "False", "FALSE", "0"};
  if (std::ranges::find(yes, word) != yes.end()) return true;
  if (std::ranges::find(no, word) != no.end()) return false;
  return std::nullopt;
}

void refuse_word(Lines const& lines, Word const& word, Role role, std::string_view expected) {
  lines.refuse(fmt::format("the {} is {}, but must be {}", name_of(role), in_quotes(word.text), expected), "",
               word.column);
}

}  // namespace gridlock::xyz
