#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "gridlock/core/disks.hpp"

namespace gridlock {

/// What the colour of a disk says.
enum class Colouring {
  radius,         ///< the kind of disk: one colour for each radius
  neighbourhood,  ///< the grid cell of its centre, so that disks of adjacent cells differ
  speed,          ///< |v|, on a colour bar
  values,         ///< a number given for each disk, such as its displacement, on a colour bar
  directions,     ///< an angle given for each disk, in radians, on a circle of colours
  kinds,          ///< a whole number below most_kinds given for each disk, one colour for each
};

inline constexpr std::size_t most_kinds = 8;  ///< that colours can tell apart

/// How a state is drawn.
struct PictureSettings {
  std::uint32_t width = 720;  ///< pixels; text and lines grow with it
  std::uint32_t height = 0;   ///< pixels; 0: follows from the shape of the box
  Colouring colouring = Colouring::radius;
  std::uint64_t columns = 0;       ///< of the grid drawn over the disks, if its cells are 4 pixels wide; 0: none
  std::uint64_t rows = 0;          ///< 0: none
  std::span<double const> values;  ///< values, directions, kinds: one for each row of state.agents; disks without a
                                   ///< finite value are grey
  std::optional<double> least;  ///< where the colour bar begins; left out: the smallest value, or 0 if none is negative
  std::optional<double> most;   ///< where it ends, or the last of the kinds listed; left out: the largest value
  std::string bar_label;        ///< beside the colour bar; empty: "speed" for speeds
  std::vector<std::string> kind_names;  ///< of the kinds 0, 1, 2 …; one without a name is listed by its number
  std::string title;                    ///< one line of plain text above the box; empty: none
  bool shows_velocities = false;        ///< arrows, up to 2,000 disks; the root-mean-square speed is one diameter long
  std::size_t most_vector_disks = 50'000;  ///< above it an SVG holds the disks as one embedded image
};

/// How the disks came into a picture: as shapes of their own, or as an image of pixels.
enum class PictureKind { vector, raster };

/// Draws the box and all its disks into a .svg, .png or .pdf file; in a periodic box a disk cut by the edge shows on both
/// sides. Walls are a thick line, periodic edges a dashed one.
///
/// Returns `raster` for PNG, and for an SVG or PDF with more disks than settings.most_vector_disks, whose disks are one
/// embedded image so that no picture of a million disks grows beyond a few megabytes.
/// Disks whose position is not finite are left out, so that a broken state can still be looked at.
/// Errors: Error for another extension, for a width or height outside 16 … 16,384 pixels, or where values
/// and disks differ in number; RunFailure where the file cannot be written.
/// Cost: SVG about 60 bytes and 1 µs a disk; PNG about 50 ms and 1 to 3 µs a disk.
PictureKind draw_disks(State const& state, PictureSettings const& settings, std::filesystem::path const& file);

/// The same picture as the text of an SVG document.
std::string picture_svg(State const& state, PictureSettings const& settings);

/// The same picture as the bytes of a PDF file, one point for a pixel.
std::string picture_pdf(State const& state, PictureSettings const& settings);

/// The same picture as the bytes of a PNG file.
std::string picture_png(State const& state, PictureSettings const& settings);

/// Pixels row by row from the top, each a 32-bit number 0x00RRGGBB in the byte order of the machine.
struct PicturePixels {
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  std::string bytes;
};

/// The same picture as bare pixels.
PicturePixels picture_pixels(State const& state, PictureSettings const& settings);

}  // namespace gridlock
