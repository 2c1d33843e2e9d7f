#include "drawing/frame_values.hpp"

#include <algorithm>
#include <cmath>

#include "core/unwrapped.hpp"
#include "observe/bond_orientation.hpp"

namespace gridlock {

namespace {

/// Returns the values of an existing column.
std::vector<double> numbers_of(Frame const& frame, std::string const& name) {
  return std::visit([](auto const& values) { return std::vector<double>(values.begin(), values.end()); },
                    frame.find(name)->values);
}

std::vector<double> numbers_or(Frame const& frame, std::string const& name, double otherwise) {
  return frame.find(name) == nullptr ? std::vector<double>(frame.size(), otherwise) : numbers_of(frame, name);
}

/// Returns the prefix of the columns of motion: "heading" if agents have headings, otherwise "velocity".
std::string motion_of(Frame const& frame) { return frame.find("heading_x") == nullptr ? "velocity" : "heading"; }

/// Returns positions or images of the agents; components without a column are 0.
std::vector<Vector> vectors_of(Frame const& frame, std::string const& x_name, std::string const& y_name) {
  std::vector<double> const x = numbers_or(frame, x_name, 0.0), y = numbers_or(frame, y_name, 0.0);
  std::vector<Vector> vectors;
  for (std::size_t i = 0; i < frame.size(); ++i) vectors.push_back({x[i], y[i]});
  return vectors;
}

/// Returns the distance of each agent from its position in the first frame; NaN if it is not in that frame.
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

bool has_both(Frame const& frame, std::string const& name) {
  return frame.find(name + "_x") != nullptr && frame.find(name + "_y") != nullptr;
}

}  // namespace

State disks_of(Frame const& frame, double mark) {
  State state{.box = frame.box, .agents = {}, .clock = frame.clock, .seed = frame.seed};
  auto const x = numbers_of(frame, "x"), y = numbers_of(frame, "y"), radius = numbers_or(frame, "radius", mark);
  auto const vx = numbers_or(frame, "velocity_x", 0.0), vy = numbers_or(frame, "velocity_y", 0.0);
  for (std::size_t i = 0; i < frame.size(); ++i) state.agents.add(x[i], y[i], vx[i], vy[i], radius[i], 1.0, 0, 0);
  return state;
}

std::vector<Vector> headings_of(Frame const& frame) { return vectors_of(frame, "heading_x", "heading_y"); }

double mark_for(Frame const& frame) {
  double const spacing = std::sqrt(frame.box.area() / std::max(1.0, static_cast<double>(frame.size())));
  double const side = frame.box.side();
  return std::clamp(0.33 * spacing, 0.0015 * side, 0.008 * side);
}

std::string usual_colour(Frame const& frame) {
  if (frame.find("heading_x") != nullptr) return "direction";
  if (frame.find("radius") != nullptr && frame.find("image_x") != nullptr) return "displacement";
  for (auto column = frame.columns.rbegin(); column != frame.columns.rend(); ++column) {
    if (std::holds_alternative<std::vector<std::uint32_t>>(column->values)) return column->name;
  }
  bool const has_radius = frame.find("radius") != nullptr;
  return has_radius || frame.find(motion_of(frame) + "_x") == nullptr ? "radius" : "direction";
}

std::vector<std::string> colours_of(Frame const& frame) {
  std::vector<std::string> colours{"displacement", "psi6", "neighbourhood", "radius"};
  if (has_both(frame, "velocity")) colours.emplace_back("speed");
  if (has_both(frame, motion_of(frame))) colours.emplace_back("direction");
  for (FrameColumn const& column : frame.columns) {
    if (std::ranges::find(colours, column.name) == colours.end()) colours.push_back(column.name);
  }
  return colours;
}

std::vector<double> colour_values(Frame const& first, Frame const& frame, std::string const& colour) {
  if (colour == "displacement") return displacements(first, frame);
  if (colour == "psi6") return local_bond_orientation_orders(disks_of(frame, 0.0));
  if (colour != "speed" && colour != "direction") return numbers_of(frame, colour);
  std::string const motion = colour == "speed" ? "velocity" : motion_of(frame);
  std::vector<double> values = numbers_of(frame, motion + "_x");
  std::vector<double> const y = numbers_of(frame, motion + "_y");
  for (std::size_t i = 0; i < values.size(); ++i) {
    values[i] = colour == "speed" ? std::sqrt(values[i] * values[i] + y[i] * y[i]) : std::atan2(y[i], values[i]);
  }
  return values;
}

}  // namespace gridlock
