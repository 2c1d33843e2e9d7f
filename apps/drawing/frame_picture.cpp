#include "drawing/frame_picture.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "drawing/picture.hpp"
#include "gridlock/core/error.hpp"

namespace gridlock {

namespace {

/// Errors: Error if the frame has no positions or the agents cannot be coloured this way.
void require_drawable(Frame const& frame, std::string const& colour) {
  if (frame.find("x") == nullptr || frame.find("y") == nullptr) {
    throw Error(Problem{.what = "the agents have no positions to draw them at",
                        .hint = "a trajectory keeps the columns of trajectory.columns; draw it with x and y there"});
  }
  std::vector<std::string> const colours = colours_of(frame);
  if (std::ranges::find(colours, colour) != colours.end()) return;
  throw Error(Problem{.what = fmt::format("the agents have no column \"{}\"", colour),
                      .hint = fmt::format("these agents can be coloured by {}", fmt::join(colours, ", ")),
                      .key = "--colour"});
}

/// Returns the name of a colour in British spelling.
std::string spelt(std::string const& colour) { return colour == "neighborhood" ? "neighbourhood" : colour; }

}  // namespace

FramePainter::FramePainter(Frame first, std::string const& colour)
    : first_(std::move(first)),
      colour_(colour.empty() ? usual_colour(first_) : spelt(colour)),
      mark_(mark_for(first_)) {
  require_drawable(first_, colour_);
  if (colour_ == "psi6") most_ = 1.0;
  if (colour_ == "direction") {
    least_ = -std::numbers::pi;
    most_ = std::numbers::pi;
  }
}

Field const* FramePainter::field_of(Frame const& frame) {
  auto const found = std::ranges::find_if(frame.fields, [](Field const& field) { return field.size() > 1; });
  return found == frame.fields.end() ? nullptr : &*found;
}

void FramePainter::widen_bar(Frame const& frame) {
  if (Field const* const field = field_of(frame)) {
    auto const [min, max] = std::ranges::minmax(field->values());
    field_min_ = std::min(field_min_, min);
    field_max_ = std::max(field_max_, max);
  }
  if (!has_bar() || colour_ == "psi6" || colour_ == "direction") return;
  for (double const value : colour_values(first_, frame, colour_)) {
    if (!std::isfinite(value)) continue;
    least_ = std::min(least_, value);
    most_ = std::max(most_, value);
  }
}

bool FramePainter::are_kinds() const {
  FrameColumn const* const column = first_.find(colour_);
  return column != nullptr && std::holds_alternative<std::vector<std::uint32_t>>(column->values) &&
         most_ < static_cast<double>(max_kinds);
}

template <class Visit>
auto FramePainter::with_picture(Frame const& frame, std::uint32_t width, std::string const& title, Visit visit) const {
  State const state = disks_of(frame, mark_);
  PictureSettings picture{.width = width, .title = title};
  std::vector<Vector> headings;
  if (frame.find("radius") != nullptr && frame.find("heading_x") != nullptr) headings = headings_of(frame);
  picture.headings = headings;
  picture.walls = walls_;
  if (Field const* const field = field_of(frame)) {
    picture.field = field;
    picture.field_min = field_min_;
    picture.field_max = field_max_;
  }
  std::vector<double> values;
  if (has_bar()) {
    values = colour_values(first_, frame, colour_);
    picture.colouring = colour_ == "direction" ? Colouring::directions
                        : are_kinds()          ? Colouring::kinds
                                               : Colouring::values;
    picture.kind_names = kind_names_;
    picture.values = values;
    picture.min = least_;
    picture.max = most_;
    picture.bar_label = colour_ == "psi6" ? "|ψ6|" : colour_;
  } else if (colour_ == "neighbourhood") {
    double const side = 2.0 * radius_range(state.agents).largest;
    auto const cells = [side](double length) { return static_cast<std::uint64_t>(std::max(1.0, length / side)); };
    picture.colouring = Colouring::neighbourhood;
    picture.columns = cells(state.box.width());
    picture.rows = cells(state.box.height());
  }
  return visit(state, picture);
}

void FramePainter::draw(Frame const& frame, std::uint32_t width, std::string const& title, Canvas& canvas) const {
  with_picture(frame, width, title,
               [&](State const& state, PictureSettings const& settings) { draw_picture(state, settings, canvas); });
}

PicturePixels FramePainter::pixels(Frame const& frame, std::uint32_t width, std::string const& title) const {
  return with_picture(frame, width, title, picture_pixels);
}

}  // namespace gridlock
