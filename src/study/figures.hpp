#pragma once

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

}  // namespace gridlock
