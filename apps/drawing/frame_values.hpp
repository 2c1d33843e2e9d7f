#pragma once

#include <string>
#include <vector>

#include "gridlock/core/disks.hpp"
#include "gridlock/core/frame.hpp"

namespace gridlock {

/// The colour of a frame where none was asked for: displacement for disks that count the edges they cross, the last
/// column of whole numbers such as a species, the radius, the direction of motion, or one colour for all.
std::string usual_colour(Frame const& frame);

/// The quantities that agents of a frame can be coloured by: displacement (from the first frame), psi6, neighbourhood
/// (the grid cell), radius, speed, direction (of the velocity or heading, in radians), and the columns.
std::vector<std::string> colours_of(Frame const& frame);

/// The number behind the colour of each agent; nan where it is not known. Contract: the colour is one of
/// colours_of(frame), and no neighbourhood, which is a matter of cells; radius only where there is such a column.
std::vector<double> colour_values(Frame const& first, Frame const& frame, std::string const& colour);

/// The radius that agents without one are drawn with: a third of the distance to the next agent, but neither a dot that
/// nobody sees nor a blot.
double mark_for(Frame const& frame);

/// The agents of a frame as disks, row by row; their names are of no concern to a picture.
State disks_of(Frame const& frame, double mark);

}  // namespace gridlock
