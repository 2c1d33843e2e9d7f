#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "gridlock/core/disks.hpp"
#include "io/xyz_lines.hpp"

namespace gridlock::xyz {

/// What a column of the file means to us.
enum class Role { ignored, x, y, z, id, velocity_x, velocity_y, velocity_z, radius, mass, image_x, image_y, image_z };

std::string_view name_of(Role role);

/// What the second line of a file says.
struct Header {
  Box box;
  Clock clock;
  std::uint64_t seed = 0;
  std::vector<Role> roles;                    ///< of each column
  std::map<std::size_t, std::string> others;  ///< columns that disks do not have, one number each, by their place

  [[nodiscard]] bool has(Role role) const;
};

/// Reads the second line. Errors: Error where it does not say what a file of disks needs.
Header read_header(Lines& lines);

}  // namespace gridlock::xyz
