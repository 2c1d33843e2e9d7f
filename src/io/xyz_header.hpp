#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "gridlock/core/disks.hpp"
#include "io/xyz_columns.hpp"
#include "io/xyz_comment.hpp"
#include "io/xyz_lines.hpp"

namespace gridlock::xyz {

/// The rectangle of a Lattice.
struct Sides {
  double width = 0.0;
  double height = 0.0;
  bool leans = false;  ///< out of the plane: the third vector is not along z, or another has a z
};

/// The content of the second line of a file of extended or plain XYZ.
struct Header {
  std::vector<Entry> entries;
  std::optional<Sides> sides;               ///< none without a Lattice
  std::array<bool, 2> is_periodic{};        ///< along x and y
  Vector origin;                            ///< the lower left corner of the box
  std::optional<Columns> columns;           ///< none without Properties, as in plain XYZ
  std::optional<double> time;               ///< none where it is left out, or is no number
  std::optional<std::uint64_t> step;        ///< likewise
  std::optional<std::uint64_t> seed;        ///< likewise
  std::vector<std::string> unused_entries;  ///< Time, step and seed that are of another kind than ours: "step=-1"

  /// The last entry of that name, which is the one that counts; none where there is none.
  [[nodiscard]] Entry const* entry(std::string_view key) const;
};

/// Step and time, 0 where the file does not have them.
inline Clock clock_of(Header const& header) {
  return {.step = header.step.value_or(0), .time = header.time.value_or(0.0)};
}

/// Puts a place between 0 and `side`, as a periodic edge does. Returns how many sides it was away; 0 where it was
/// inside.
double fold(double& place, double side);

/// Reads the second line. Errors: Error where it is damaged, or the box is no rectangle.
Header read_header(Lines& lines);

/// The box of a file of disks. Errors: Error where the line does not say what disks need: a Lattice in the plane with
/// all edges alike, and Properties with positions.
Box box_of_disks(Lines const& lines, Header const& header);

}  // namespace gridlock::xyz
