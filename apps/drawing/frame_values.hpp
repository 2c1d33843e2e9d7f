#pragma once

#include <string>
#include <vector>

#include "gridlock/core/disks.hpp"
#include "gridlock/core/frame.hpp"

namespace gridlock {

/// Returns the default colour of a frame: direction for agents with headings, displacement for disks with images, or
/// else the last column of whole numbers such as a species, the radius, the direction of motion, or a single colour.
std::string usual_colour(Frame const& frame);

/// Returns the possible colours of agents in a frame: displacement (from the first frame), psi6, neighbourhood (the
/// grid cell), radius, speed, direction (of the velocity or heading, in radians), and the columns.
std::vector<std::string> colours_of(Frame const& frame);

/// Returns the value that determines the colour of each agent; NaN if unknown. Contract: `colour` is one of
/// colours_of(frame), but not neighbourhood, and radius only if the frame has that column.
std::vector<double> colour_values(Frame const& first, Frame const& frame, std::string const& colour);

/// Returns the headings of agents that have them.
std::vector<Vector> headings_of(Frame const& frame);

/// Returns the radius for agents without one: a third of their mean spacing, within 0.15 % and 0.8 % of the box side.
double mark_for(Frame const& frame);

/// Returns the agents of a frame as disks in the same order, with new Ids; `mark` is the radius of agents without one.
State disks_of(Frame const& frame, double mark);

}  // namespace gridlock
