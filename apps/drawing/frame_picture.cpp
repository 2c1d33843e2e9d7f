#include "drawing/frame_picture.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "core/unwrapped.hpp"
#include "drawing/picture.hpp"
#include "gridlock/core/error.hpp"
#include "observe/bond_orientation.hpp"

namespace gridlock {

namespace {

/// The values of a column that the frame has.
std::vector<double> numbers_of(Frame const& frame, std::string const& name) {
  return std::visit([](auto const& values) { return std::vector<double>(values.begin(), values.end()); },
                    frame.find(name)->values);
}

std::vector<double> numbers_or(Frame const& frame, std::string const& name, double otherwise) {
  return frame.find(name) == nullptr ? std::vector<double>(frame.size(), otherwise) : numbers_of(frame, name);
}

/// How the column of the motion along x begins: "velocity", or "heading" where agents only know where they go.
std::string motion_of(Frame const& frame) { return frame.find("heading_x") == nullptr ? "velocity" : "heading"; }

/// The agents of a frame as disks, row by row; their names are of no concern to a picture.
State disks_of(Frame const& frame, double mark) {
  State state{.box = frame.box, .agents = {}, .clock = frame.clock, .seed = frame.seed};
  auto const x = numbers_of(frame, "x"), y = numbers_of(frame, "y"), radius = numbers_or(frame, "radius", mark);
  auto const vx = numbers_or(frame, "velocity_x", 0.0), vy = numbers_or(frame, "velocity_y", 0.0);
  for (std::size_t i = 0; i < frame.size(); ++i) state.agents.add(x[i], y[i], vx[i], vy[i], radius[i], 1.0, 0, 0);
  return state;
}

/// The coordinates of the agents of a frame, or how often they have crossed edges: 0 where the frame does not say.
std::vector<Vector> vectors_of(Frame const& frame, std::string const& x_name, std::string const& y_name) {
  std::vector<double> const x = numbers_or(frame, x_name, 0.0), y = numbers_or(frame, y_name, 0.0);
  std::vector<Vector> vectors;
  for (std::size_t i = 0; i < frame.size(); ++i) vectors.push_back({x[i], y[i]});
  return vectors;
}

/// How far each agent has come since the first frame; nan for one that was not there.
std::vector<double> displacements(Frame const& first, Frame const& frame) {
  auto const then = vectors_of(first, "x", "y"), now = vectors_of(frame, "x", "y");
  auto const image_then = vectors_of(first, "image_x", "image_y"), image_now = vectors_of(frame, "image_x", "image_y");
  std::vector<double> result(frame.size(), std::nan(""));
  for (std::size_t i = 0; i < frame.size(); ++i) {
    auto const found = std::ranges::lower_bound(first.ids, frame.ids[i]);
    if (found == first.ids.end() || *found != frame.ids[i]) continue;
    auto const j = static_cast<std::size_t>(found - first.ids.begin());
    Vector const moved = unwrapped_displacement(frame.box, then[j], now[i], image_now[i] - image_then[j]);
    result[i] = std::sqrt(squared_length(moved));
  }
  return result;
}

/// A third of the distance to the next agent, but neither a dot that nobody sees nor a blot.
double mark_for(Frame const& frame) {
  double const spacing = std::sqrt(frame.box.area() / std::max(1.0, static_cast<double>(frame.size())));
  double const side = frame.box.side();
  return std::clamp(0.33 * spacing, 0.0015 * side, 0.008 * side);
}

bool has_both(Frame const& frame, std::string const& name) {
  return frame.find(name + "_x") != nullptr && frame.find(name + "_y") != nullptr;
}

/// What the agents of a frame can be coloured by.
std::vector<std::string> colours_of(Frame const& frame) {
  std::vector<std::string> colours{"displacement", "psi6", "neighbourhood", "radius"};
  if (has_both(frame, "velocity")) colours.emplace_back("speed");
  if (has_both(frame, motion_of(frame))) colours.emplace_back("direction");
  for (FrameColumn const& column : frame.columns) {
    if (std::ranges::find(colours, column.name) == colours.end()) colours.push_back(column.name);
  }
  return colours;
}

/// Errors: Error for a frame that cannot be drawn, or not in this colour.
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

/// The colour in the spelling of this program.
std::string spelt(std::string const& colour) { return colour == "neighborhood" ? "neighbourhood" : colour; }

}  // namespace

std::string usual_colour(Frame const& frame) {
  if (frame.find("radius") != nullptr && frame.find("image_x") != nullptr) return "displacement";
  for (auto column = frame.columns.rbegin(); column != frame.columns.rend(); ++column) {
    if (std::holds_alternative<std::vector<std::uint32_t>>(column->values)) return column->name;
  }
  bool const has_radius = frame.find("radius") != nullptr;
  return has_radius || frame.find(motion_of(frame) + "_x") == nullptr ? "radius" : "direction";
}

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

std::vector<double> FramePainter::values_of(Frame const& frame) const {
  if (colour_ == "displacement") return displacements(first_, frame);
  if (colour_ == "psi6") return local_bond_orientation_orders(disks_of(frame, mark_));
  if (colour_ != "speed" && colour_ != "direction") return numbers_of(frame, colour_);
  std::string const motion = colour_ == "speed" ? "velocity" : motion_of(frame);
  std::vector<double> values = numbers_of(frame, motion + "_x");
  std::vector<double> const y = numbers_of(frame, motion + "_y");
  for (std::size_t i = 0; i < values.size(); ++i) {
    values[i] = colour_ == "speed" ? std::sqrt(values[i] * values[i] + y[i] * y[i]) : std::atan2(y[i], values[i]);
  }
  return values;
}

void FramePainter::widen_bar(Frame const& frame) {
  if (!has_bar() || colour_ == "psi6" || colour_ == "direction") return;
  for (double const value : values_of(frame)) {
    if (!std::isfinite(value)) continue;
    least_ = std::min(least_, value);
    most_ = std::max(most_, value);
  }
}

bool FramePainter::are_kinds() const {
  FrameColumn const* const column = first_.find(colour_);
  return column != nullptr && std::holds_alternative<std::vector<std::uint32_t>>(column->values) &&
         most_ < static_cast<double>(most_kinds);
}

template <class Visit>
auto FramePainter::with_picture(Frame const& frame, std::uint32_t width, std::string const& title, Visit visit) const {
  State const state = disks_of(frame, mark_);
  PictureSettings picture{.width = width, .title = title};
  std::vector<double> values;
  if (has_bar()) {
    values = values_of(frame);
    picture.colouring = colour_ == "direction" ? Colouring::directions
                        : are_kinds()          ? Colouring::kinds
                                               : Colouring::values;
    picture.kind_names = kind_names_;
    picture.values = values;
    picture.least = least_;
    picture.most = most_;
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
