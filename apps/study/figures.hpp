#pragma once

#include <cstddef>
#include <string>

#include "study/replica_set.hpp"
#include "study/study.hpp"

namespace gridlock {

/// Each plan_ notes the simulations its chapter needs; the chapter is written when they are done, and leaves out what
/// did not finish.

Chapter figure_4(Study& study);

void plan_figure_6(Study& study);
Chapter figure_6(Study& study);

void plan_figure_7(Study& study);
Chapter figure_7(Study& study);

void plan_open_choices(Study& study);
Chapter open_choices(Study& study);

/// Whether it matters in which order the disks take their turns: `stepped` beside `tiled`.
void plan_turn_order(Study& study);
Chapter turn_order(Study& study);

/// Which part of Figures 6 and 7 is physics and which the time step: the paper's rule beside the dynamics without one.
Chapter physics_or_step(Study& study);

}  // namespace gridlock
