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

/// Whether a point lies in the box, its edges included; false for coordinates that are not numbers.
inline bool is_inside(Box const& box, Vector p) {
  return p.x >= 0.0 && p.x <= box.width() && p.y >= 0.0 && p.y <= box.height();
}

/// The first row whose point is_inside() refuses; the number of rows if there is none.
std::size_t find_outside(Box const& box, std::span<double const> x, std::span<double const> y);

/// Whether a displacement is shorter than both sides of the box; false for one that is not a number.
inline bool is_shorter_than_box(Box const& box, Vector displacement) {
  return std::abs(displacement.x) < box.width() && std::abs(displacement.y) < box.height();
}

inline bool is_finite(Vector p) { return std::isfinite(p.x) && std::isfinite(p.y); }

/// Refuses settings with which agents would move by a side of the box or more in a step. Errors: Error, blaming `key`.
void require_displacement(Box const& box, double longest, std::string const& key);

/// A number of a setting for a message: ten digits, however large it is.
std::string in_words(double number);

// What a model does wrong ends its run in every build: each throws RunFailure with the step, the agent and the numbers.
// Out of line, so that the checks themselves cost a comparison.

/// An agent at, or moving to, a point outside the box.
[[noreturn, gnu::cold]] void throw_outside(std::uint64_t step, Id agent, Vector p, Box const& box);

/// A newborn at a point outside the box, of that parent where agents take turns.
[[noreturn, gnu::cold]] void throw_birth_outside(std::uint64_t step, std::optional<Id> parent, Vector p,
                                                 Box const& box);

/// A displacement that is not finite, or as long as a side of the box.
[[noreturn, gnu::cold]] void throw_long_displacement(std::uint64_t step, Id agent, Vector displacement, Box const& box);

/// A move of a local agent of a tiled model, from one point to another, to a cell that is not next to the one where its
/// turn began.
[[noreturn, gnu::cold]] void throw_far_move(std::uint64_t step, Id agent, Vector from, Vector to);

/// A search that does not lie within the cutoff that the model declares.
struct FarSearch {
  std::uint64_t step = 0;
  std::optional<Id> agent;  ///< whose turn it is, where agents take turns
  Vector point;
  Vector position;  ///< of that agent
  double cutoff = 0.0;
  double declared = 0.0;
};
[[noreturn, gnu::cold]] void throw_far_search(FarSearch const& search);

/// An event that the model does not declare.
[[noreturn, gnu::cold]] void throw_unknown_event(std::uint64_t step, std::optional<Id> agent, std::size_t event,
                                                 std::span<std::string_view const> declared);

/// The Id of an agent that is dead or never was.
[[noreturn, gnu::cold]] void throw_not_alive(std::uint64_t step, Id agent);

/// Throws where a cutoff or a time step is not a finite positive number.
void require_good_step(std::uint64_t step, double cutoff, double time_step);

}  // namespace gridlock
