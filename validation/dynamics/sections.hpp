#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <numbers>
#include <string_view>
#include <vector>

#include "gridlock/engine/engine.hpp"
#include "reference/mean_and_error.hpp"

namespace gridlock::validation {

using reference::Estimate;

constexpr double pi = std::numbers::pi;

// Each section prints its rows of the table.
void diffusion();
void swimmers();
void cooling();
void falling();
void channels();
void shear();
void flow();
void soft();
void viscosity();

/// Prints a row that agrees if the difference is at most four errors.
void within_errors(std::string_view check, Estimate measured, Estimate expected);
/// The same for a number without an error from a few runs, which scatter as the runs here: `runs` gave `measured`.
void within_scatter(std::string_view check, Estimate measured, std::uint64_t runs, double expected,
                    std::uint64_t expected_runs);
/// Prints a row that agrees if the difference is at most the tolerance.
void within(std::string_view check, Estimate measured, double expected, double tolerance);
/// Returns whether all rows so far agree.
bool all_agree();

/// The numbers of one run.
using Numbers = std::vector<double>;
/// Returns the mean of each number over runs with the seeds 1 … count. The runs are shared among all cores.
std::vector<Estimate> means(std::uint64_t count, std::function<Numbers(std::uint64_t seed)> const& run);

/// Returns the settings of `exact` on one thread, in steps so long that they cost nothing.
EngineSettings exact();
/// Disks of kT = 1 in a periodic square, after 40 elastic collisions a disk.
State fluid(std::size_t count, double packing_fraction, std::uint64_t seed);
void scale_velocities(State& state, double factor);

/// Returns the mean force on a wall since the counters were `before`.
double force_on(Counters::Wall wall, Counters const& counters, Counters const& before, double duration);

}  // namespace gridlock::validation
