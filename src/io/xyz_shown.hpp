#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "io/text_reader.hpp"

namespace gridlock::xyz {

/// A column of a frame as numbers; words are numbered from 0 in alphabetical order.
struct ShownColumn {
  std::string name;
  std::vector<double> values;
};

/// A frame of extended or plain XYZ in the plane, to be shown.
struct ShownFrame {
  std::optional<double> step;
  std::optional<double> time;
  std::optional<std::array<double, 2>> sides;  ///< sides of the box; none if the file has no box
  double shift = 0.0;                          ///< xy, 0 between walls
  std::array<bool, 2> is_periodic{};           ///< along x and along y
  std::vector<double> ids;
  std::vector<ShownColumn> columns;  ///< including x and y
  std::vector<std::string> notes;    ///< sentences about differences between file and picture
};

/// Reads the first frame of a text to be shown. The rules are those of Reader, but files without a box, boxes of any
/// height, and three-dimensional positions, whose z is omitted, are accepted too.
/// Positions are relative to the lower left corner, and folded through periodic edges. `first_line` is the number of
/// the first line. Errors: Error if the text is malformed.
ShownFrame read_shown(TextReader text, int first_line);

/// Reads step and time, without columns, from a text that may end after its second line.
ShownFrame read_shown_head(TextReader text, int first_line);

}  // namespace gridlock::xyz
