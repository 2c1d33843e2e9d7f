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

/// A frame of any extended or plain XYZ, in the plane.
struct ShownFrame {
  std::optional<double> step;
  std::optional<double> time;
  std::optional<std::array<double, 2>> sides;  ///< of the box; none in a file without
  bool is_periodic = false;                    ///< along both sides
  std::vector<double> ids;
  std::vector<ShownColumn> columns;  ///< x and y among them
  std::vector<std::string> notes;    ///< sentences on what is shown otherwise than the file has it
};

/// Reads the frame a text begins with as it can be looked at, by the rules of Reader, but more than disks can be: also
/// without a box, also boxes of any height and periodic along one side only, and without what is out of the plane.
/// Positions count from the corner of the box, and come in through periodic edges. `first_line` is the number of the
/// first line.
/// Errors: Error where it is damaged.
ShownFrame read_shown(TextReader text, int first_line);

/// Step and time alone, and no columns: of a text that may end behind its second line.
ShownFrame read_shown_head(TextReader text, int first_line);

}  // namespace gridlock::xyz
