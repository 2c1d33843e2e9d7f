#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "drawing/frame_values.hpp"
#include "drawing/picture.hpp"
#include "gridlock/core/frame.hpp"

namespace gridlock {

/// Draws frames of a trajectory of disks or other agents, with the first field of more than one cell beneath them.
/// Agents without a radius get a round mark, whose size follows from the first frame.
class FramePainter {
 public:
  /// `colour` is displacement (from the first frame), psi6, speed, direction (of the velocity or heading, in radians),
  /// neighbourhood (the grid cell), radius, or a column; empty: usual_colour(). Errors: Error if the agents have no
  /// positions, or not this colour; it lists the possible colours.
  FramePainter(Frame first, std::string const& colour);

  [[nodiscard]] std::string const& colour() const { return colour_; }
  /// Sets the names of the values 0, 1, 2 … of the colour's column, for columns of kinds.
  void name_kinds(std::vector<std::string> names) { kind_names_ = std::move(names); }

  /// Draws these walls inside the box, which no frame has.
  void show_walls(std::vector<LineSegment> walls) { walls_ = std::move(walls); }

  /// Returns whether colours represent numbers, which need a colour bar.
  [[nodiscard]] bool has_bar() const { return colour_ != "radius" && colour_ != "neighbourhood"; }
  /// Returns whether widen_bar() must see all frames before the first is drawn.
  [[nodiscard]] bool needs_ranges() const { return has_bar() || field_of(first_) != nullptr; }
  /// Extends the ranges of the colour bar and of the field to the values of a frame with the columns of the first one.
  void widen_bar(Frame const& frame);
  /// Draws a frame. Errors: those of draw_picture().
  void draw(Frame const& frame, std::uint32_t width, std::string const& title, Canvas& canvas) const;
  /// Draws a frame and returns the pixels.
  [[nodiscard]] PicturePixels pixels(Frame const& frame, std::uint32_t width, std::string const& title) const;

 private:
  /// Returns the field to be drawn, if any.
  [[nodiscard]] static Field const* field_of(Frame const& frame);
  /// Returns whether the values are kinds: whole numbers, few enough for distinct colours.
  [[nodiscard]] bool are_kinds() const;
  /// Calls visit(state, settings) with the frame as a state of disks and with the settings of its picture.
  template <class Visit>
  auto with_picture(Frame const& frame, std::uint32_t width, std::string const& title, Visit visit) const;

  Frame first_;
  std::string colour_;
  std::vector<std::string> kind_names_;
  std::vector<LineSegment> walls_;
  double mark_;  ///< radius of the mark for agents without a radius
  double least_ = 0.0;
  double most_ = 0.0;
  double field_min_ = 0.0;
  double field_max_ = 0.0;
};

}  // namespace gridlock
