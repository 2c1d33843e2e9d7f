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

/// The rectangle that a Lattice describes, and its shift xy.
struct Sides {
  double width = 0.0;
  double height = 0.0;
  double shift = 0.0;
  bool leans = false;  ///< out of the plane: the third vector is not along z, or another has a z component
};

/// The content of the second line in extended or plain XYZ.
struct Header {
  std::vector<Entry> entries;
  std::optional<Sides> sides;               ///< none if the file has no Lattice
  std::array<bool, 2> is_periodic{};        ///< along x and along y
  Vector origin;                            ///< the lower left corner of the box
  std::optional<Columns> columns;           ///< none if the file has no Properties, as in plain XYZ
  std::optional<double> time;               ///< none if missing or not a number
  std::optional<std::uint64_t> step;        ///< none if missing or not a whole number
  std::optional<std::uint64_t> seed;        ///< none if missing or not a whole number
  std::vector<std::string> unused_entries;  ///< Time, step and seed with unsuitable values: "step=-1"

  /// Returns the last entry with this key, which is the valid one; null if there is none.
  [[nodiscard]] Entry const* entry(std::string_view key) const;
};

/// Returns step and time, each 0 if the file does not have it.
inline Clock clock_of(Header const& header) {
  return {.step = header.step.value_or(0), .time = header.time.value_or(0.0)};
}

/// Moves a position into [0, side) by whole sides, as a periodic edge does. Returns the number of sides, 0 if the
/// position was inside.
double fold(double& place, double side);

/// Reads the second line. Errors: Error if it is malformed or the box is not a rectangle.
Header read_header(Lines& lines);

/// Returns the box of a file of disks. Errors: Error unless the line has a Lattice in the plane with equal kinds of
/// edges, and Properties with positions.
Box box_of_disks(Lines const& lines, Header const& header);

}  // namespace gridlock::xyz
