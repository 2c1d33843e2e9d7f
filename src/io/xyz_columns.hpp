#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "io/xyz_comment.hpp"
#include "io/xyz_lines.hpp"

namespace gridlock::xyz {

/// The meaning of a column in the file.
enum class Role {
  ignored,
  x,
  y,
  z,
  id,
  velocity_x,
  velocity_y,
  velocity_z,
  momentum_x,
  momentum_y,
  momentum_z,
  radius,
  diameter,
  mass,
  image_x,
  image_y,
  image_z
};

std::string_view name_of(Role role);

/// A property of extended XYZ, with one column or several adjacent columns.
struct Property {
  std::string name;
  char type = 'R';  ///< R (real), I (integer), S (words) or L (T and F)
  std::size_t first = 0;
  std::size_t width = 1;
  bool is_used = false;  ///< whether its columns have roles other than `ignored`
};

/// The columns that the entry Properties describes.
struct Columns {
  std::vector<Property> properties;
  std::vector<Role> roles;                    ///< role of each column
  std::map<std::size_t, std::string> others;  ///< names of the columns without a role, by index
  bool has_momenta = false;                   ///< whether the file has momenta and no velocities

  [[nodiscard]] bool has(Role role) const;
  /// Returns whether the file has velocities, or momenta from which velocities follow.
  [[nodiscard]] bool has_velocities() const { return has(Role::velocity_x) || has(Role::momentum_x); }
  /// Returns whether the file has radii, or diameters from which radii follow.
  [[nodiscard]] bool has_radii() const { return has(Role::radius) || has(Role::diameter); }
  /// Returns the names of the properties that disks do not use, other than names of species.
  [[nodiscard]] std::vector<std::string> unused() const;
};

/// Reads the value of Properties. Errors: Error if it is malformed or describes a quantity twice.
Columns read_columns(Lines const& lines, Entry const& properties);

/// Returns the number in a column. Errors: Error if the word is not a finite number.
double finite_number(Lines const& lines, Word const& word, Role role);

/// Returns a number, 1 for true, 0 for false; NaN for other words.
double any_number(std::string_view word);

/// Returns whether a word is true: T, F, other spellings of the specification, or 1 and 0 of ASE; nothing otherwise.
std::optional<bool> truth(std::string_view word);

/// Throws an Error about a word in a column.
[[noreturn]] void refuse_word(Lines const& lines, Word const& word, Role role, std::string_view expected);

}  // namespace gridlock::xyz
