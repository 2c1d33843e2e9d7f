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

/// The meaning of a column of the file.
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

/// One property of the rows, of one column or of several side by side.
struct Property {
  std::string name;
  char type = 'R';  ///< R, I, S (words) or L (T and F)
  std::size_t first = 0;
  std::size_t width = 1;
  bool is_used = false;  ///< whether its columns have roles
};

/// The columns that Properties names.
struct Columns {
  std::vector<Property> properties;
  std::vector<Role> roles;                    ///< of each column
  std::map<std::size_t, std::string> others;  ///< columns that disks do not have, one number each, by their place
  bool has_momenta = false;                   ///< in place of velocities

  [[nodiscard]] bool has(Role role) const;
  /// Velocities, or momenta, which are divided by the masses.
  [[nodiscard]] bool has_velocities() const { return has(Role::velocity_x) || has(Role::momentum_x); }
  /// Radii, or diameters.
  [[nodiscard]] bool has_radii() const { return has(Role::radius) || has(Role::diameter); }
  /// The names of the columns that mean nothing to disks, besides what tells the kinds apart.
  [[nodiscard]] std::vector<std::string> unused() const;
};

/// Reads the value of Properties. Errors: Error where it is damaged, or gives something twice.
Columns read_columns(Lines const& lines, Entry const& properties);

/// The number in a column. Errors: Error where it is none, or not finite.
double finite_number(Lines const& lines, Word const& word, Role role);

/// A number, or 1 and 0 for what is true and false; nan where the word is neither.
double any_number(std::string_view word);

/// T, F and the other spellings of the specification, and 1 and 0, which ASE reads too; nothing for another word.
std::optional<bool> truth(std::string_view word);

/// Refuses what stands in a column.
[[noreturn]] void refuse_word(Lines const& lines, Word const& word, Role role, std::string_view expected);

}  // namespace gridlock::xyz
