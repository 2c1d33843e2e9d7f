#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "study/study.hpp"

namespace gridlock {

/// What 100 steps of N disks on k × k neighbourhoods cost.
struct StepCost {
  std::uint64_t disks = 0;
  std::uint64_t k = 0;
  double packing_fraction = 0.0;
  double seconds = 0.0;      ///< CPU time of the process, median over repeats
  double spread = 0.0;       ///< largest less smallest repeat
  double checks = 0.0;       ///< distances checked, exactly
  double free_checks = 0.0;  ///< what they would be if no disk halted, with the disks where they are
  double halted_fraction = 0.0;
};

/// The sizes of neighbourhoods of Figure 5.
inline constexpr std::uint64_t timing_ks[] = {10, 15, 20};
inline constexpr std::uint64_t timing_steps = 100;
inline constexpr std::uint64_t substeps_of_a_turn = 5;

/// Whether the disks of Figure 5 are small enough for 3 × 3 neighbourhoods to hold all they can meet, for every k.
bool fits_neighbourhoods(PaperExtent const& extent);

/// Seconds the measurement takes, roughly; for the progress.
double seconds_to_measure(PaperExtent const& extent);

/// Measures every N and k of the extent, one after the other on this thread: anything else running in the process would
/// be in the CPU time. on_progress(fraction) is called several times a second; where it returns false, what has been
/// measured is kept among the partial results, and nothing is returned.
std::vector<StepCost> measure_step_costs(Study& study, std::function<bool(double)> const& on_progress);

Chapter figure_5(Study& study, std::vector<StepCost> const& costs);

}  // namespace gridlock
