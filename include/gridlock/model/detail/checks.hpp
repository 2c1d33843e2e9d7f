#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "gridlock/core/box.hpp"
#include "gridlock/core/population.hpp"

namespace gridlock {

/// Returns whether a point lies in the box, its edges included; false for NaN.
inline bool is_inside(Box const& box, Vector p) {
  return p.x >= 0.0 && p.x <= box.width() && p.y >= 0.0 && p.y <= box.height();
}

/// Returns the first row whose point is outside the box; the number of rows if all points are inside.
std::size_t find_outside(Box const& box, std::span<double const> x, std::span<double const> y);

/// Returns whether each component of a displacement is shorter than the side of the box; false for NaN.
constexpr bool is_shorter_than_box(Box const& box, Vector displacement) {
  return std::abs(displacement.x) < box.width() && std::abs(displacement.y) < box.height();
}

inline bool is_finite(Vector p) { return std::isfinite(p.x) && std::isfinite(p.y); }

/// Refuses a `longest` displacement per step that is not shorter than the sides of the box. Errors: Error for the
/// setting `key`.
void require_displacement(Box const& box, double longest, std::string const& key);

/// Returns a number with ten digits for a message.
std::string in_words(double number);

// The functions below throw RunFailure with the step, the agent and the numbers, in every build. They are out of line,
// so that a check that passes costs only a comparison.

/// Throws RunFailure for an agent at, or moving to, a point outside the box.
[[noreturn, gnu::cold]] void throw_outside(std::uint64_t step, Id agent, Vector p, Box const& box);

/// Throws RunFailure for a newborn at a point outside the box; `parent` is empty in models without turns.
[[noreturn, gnu::cold]] void throw_birth_outside(std::uint64_t step, std::optional<Id> parent, Vector p,
                                                 Box const& box);

[[noreturn, gnu::cold]] void throw_long_displacement(std::uint64_t step, Id agent, Vector displacement, Box const& box);

/// Throws RunFailure for a local agent of a tiled model that moves to a cell not next to the cell where its turn began.
[[noreturn, gnu::cold]] void throw_far_move(std::uint64_t step, Id agent, Vector from, Vector to);

/// A search beyond the cutoff that the model declares.
struct FarSearch {
  std::uint64_t step = 0;
  std::optional<Id> agent;  ///< the agent whose turn it is; empty in models without turns
  Vector point;
  Vector position;  ///< position of the agent
  double cutoff = 0.0;
  double declared = 0.0;
};
[[noreturn, gnu::cold]] void throw_far_search(FarSearch const& search);

[[noreturn, gnu::cold]] void throw_unknown_event(std::uint64_t step, std::optional<Id> agent, std::size_t event,
                                                 std::span<std::string_view const> declared);

[[noreturn, gnu::cold]] void throw_not_alive(std::uint64_t step, Id agent);

/// Throws RunFailure if the cutoff or the time step is not a finite positive number.
void require_good_step(std::uint64_t step, double cutoff, double time_step);

}  // namespace gridlock
