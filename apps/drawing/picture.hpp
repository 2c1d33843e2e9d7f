#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "drawing/canvas.hpp"
#include "gridlock/core/disks.hpp"

namespace gridlock {

/// The meaning of the colour of a disk.
enum class Colouring {
  radius,         ///< the kind of disk: one colour for each radius
  neighbourhood,  ///< the grid cell of its centre, so that disks of adjacent cells differ
  values,         ///< a number given for each disk, such as its displacement, on a colour bar
  directions,     ///< an angle given for each disk, in radians, on a circle of colours
  kinds,          ///< a whole number below max_kinds given for each disk, one colour for each
};

inline constexpr std::size_t max_kinds = 8;  ///< that colours can tell apart

/// How a state is drawn.
struct PictureSettings {
  std::uint32_t width = 720;  ///< pixels; text and lines grow with it
  Colouring colouring = Colouring::radius;
  std::uint64_t columns = 0;       ///< of the grid drawn over the disks, if its cells are 4 pixels wide; 0: none
  std::uint64_t rows = 0;          ///< 0: none
  std::span<double const> values;  ///< values, directions, kinds: one for each row of state.agents; disks without a
                                   ///< finite value are grey
  std::optional<double> min;  ///< where the colour bar begins; left out: the smallest value, or 0 if none is negative
  std::optional<double> max;  ///< where it ends, or the last of the kinds listed; left out: the largest value
  std::string bar_label;      ///< beside the colour bar
  std::vector<std::string> kind_names;  ///< of the kinds 0, 1, 2 …; one without a name is listed by its number
  std::string title;                    ///< one line of plain text above the box; empty: none
};

/// Draws the box and all its disks; in a periodic box a disk cut by the edge shows on both sides. Walls are a thick
/// line, periodic edges a dashed one. The height follows from the shape of the box.
///
/// Disks whose position is not finite are left out, so that a broken state can still be looked at.
/// Errors: Error for a width outside 16 … 16,384 pixels, or where values and disks differ in number.
void draw_picture(State const& state, PictureSettings const& settings, Canvas& canvas);

/// Pixels row by row from the top, each a 32-bit number 0x00RRGGBB in the byte order of the machine.
struct PicturePixels {
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  std::string bytes;
};

/// The same picture as pixels. Errors: RunFailure for lack of memory too. Cost: about 50 ms and 1 to 3 µs a disk.
PicturePixels picture_pixels(State const& state, PictureSettings const& settings);

}  // namespace gridlock
