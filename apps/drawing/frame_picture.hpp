#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "drawing/frame_values.hpp"
#include "drawing/picture.hpp"
#include "gridlock/core/frame.hpp"

namespace gridlock {

/// Draws frames of one run, of disks or of any other agents. Agents without a radius get a round mark, in every frame
/// of the size that suits the first one.
class FramePainter {
 public:
  /// `colour` is displacement (from the first frame), psi6, speed, direction (of the velocity or heading, in radians),
  /// neighbourhood (the grid cell), radius, or a column; empty: usual_colour().
  /// Errors: Error, naming the colours there are, for one that the agents do not have; Error for agents without
  /// positions.
  FramePainter(Frame first, std::string const& colour);

  [[nodiscard]] std::string const& colour() const { return colour_; }
  /// The names of the numbers 0, 1, 2 … of the colour's column, where it holds kinds.
  void name_kinds(std::vector<std::string> names) { kind_names_ = std::move(names); }

  /// Whether colours stand for numbers.
  [[nodiscard]] bool has_bar() const { return colour_ != "radius" && colour_ != "neighbourhood"; }
  /// Lets the bar reach over the numbers of this frame, which has the columns of the first one, too.
  void widen_bar(Frame const& frame);
  /// Errors: those of draw_picture().
  void draw(Frame const& frame, std::uint32_t width, std::string const& title, Canvas& canvas) const;
  /// The same as pixels.
  [[nodiscard]] PicturePixels pixels(Frame const& frame, std::uint32_t width, std::string const& title) const;

 private:
  /// Whether the numbers are kinds: whole ones that colours can tell apart.
  [[nodiscard]] bool are_kinds() const;
  /// Calls visit(state, settings) with the frame as a picture needs it.
  template <class Visit>
  auto with_picture(Frame const& frame, std::uint32_t width, std::string const& title, Visit visit) const;

  Frame first_;
  std::string colour_;
  std::vector<std::string> kind_names_;
  double mark_;  ///< the radius of agents that have none
  double least_ = 0.0;
  double most_ = 0.0;
};

}  // namespace gridlock
