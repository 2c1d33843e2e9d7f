#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "drawing/canvas.hpp"
#include "gridlock/core/disks.hpp"
#include "gridlock/core/field.hpp"

namespace gridlock {

/// The quantity that determines the colour of a disk.
enum class Colouring {
  radius,         ///< the radius: one colour for each distinct radius
  neighbourhood,  ///< the grid cell of the centre, with different colours for adjacent cells
  values,         ///< a number for each disk, such as its displacement, on a colour bar
  directions,     ///< an angle for each disk, in radians, on a circle of colours
  kinds,          ///< a whole number below max_kinds for each disk, one colour for each number
};

inline constexpr std::size_t max_kinds = 8;  ///< number of distinct colours for kinds

struct LineSegment {
  Vector from;
  Vector to;
};

/// Settings of a picture.
struct PictureSettings {
  std::uint32_t width = 720;  ///< in pixels; text and lines grow with it
  Colouring colouring = Colouring::radius;
  std::uint64_t columns = 0;           ///< columns of the grid, drawn if its cells have at least 4 pixels; 0: none
  std::uint64_t rows = 0;              ///< rows of the grid; 0: none
  std::span<double const> values;      ///< values, directions, kinds: one for each row of state.agents; disks without a
                                       ///< finite value are grey
  std::span<Vector const> headings;    ///< one for each row, shown as a dot near the rim; empty: none
  std::span<LineSegment const> walls;  ///< inside the box
  Field const* field = nullptr;        ///< drawn beneath the disks, from white to green; nullptr: none
  double field_min = 0.0;              ///< value that is white
  double field_max = 1.0;              ///< value that is green
  std::optional<double> min;  ///< lower end of the colour bar; default: the smallest value, or 0 if none is negative
  std::optional<double> max;  ///< upper end of the bar, or last listed kind; default: the largest value
  std::string bar_label;      ///< label of the colour bar
  std::vector<std::string> kind_names;  ///< names of kinds 0, 1, 2 …; the rest is listed by number
  std::string title;                    ///< one line of plain text above the box; empty: none
};

/// Draws the box with the walls inside it, and all disks. In a periodic box a disk at an edge appears on both sides.
/// Walls are thick lines, periodic edges dashed lines. The height follows from the shape of the box.
///
/// Disks with positions that are not finite are left out, so that a broken state can be drawn too.
/// Errors: Error for a width outside 16 … 16,384 pixels, or if the numbers of values and disks differ.
void draw_picture(State const& state, PictureSettings const& settings, Canvas& canvas);

/// Pixels by rows from the top, each a 32-bit number 0x00RRGGBB in the byte order of the machine.
struct PicturePixels {
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  std::string bytes;
};

/// Draws a picture into pixels. Errors: RunFailure also for lack of memory. Cost: about 50 ms and 1 to 3 µs a disk.
PicturePixels picture_pixels(State const& state, PictureSettings const& settings);

}  // namespace gridlock
