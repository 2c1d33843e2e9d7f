#pragma once

#include <cstddef>
#include <string>

#include "study/ensemble.hpp"
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

/// Where the curve of Figure 7 of an engine falls through 10 % at the end of the run, in words.
std::string crossing_text(Study const& study, PaperEngine const& engine, StartKind start);

/// Runs that came to a standstill.
struct Standstills {
  std::size_t arrested = 0;
  std::size_t runs = 0;
};
/// Of the runs of open_choices() with a time step, under a contact rule.
Standstills standstills_under(Study const& study, Contact contact);

}  // namespace gridlock
