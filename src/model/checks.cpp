#include "gridlock/model/detail/checks.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <bit>
#include <cstdint>
#include <string>

#include "gridlock/core/error.hpp"
#include "gridlock/model/move_apart.hpp"

namespace gridlock {

namespace {

std::string in_words(Vector p) { return fmt::format("({}, {})", p.x, p.y); }

std::string in_words(std::optional<Id> agent) { return agent ? fmt::format("agent {}", *agent) : "the model"; }

}  // namespace

std::size_t find_outside(Box const& box, std::span<double const> x, std::span<double const> y) {
  // As bits, numbers from 0 on are in their order, and numbers below 0, infinity and nan are larger than any side. So
  // two comparisons of bits are enough for nearly all points; only −0 needs a comparison of numbers.
  auto const width = std::bit_cast<std::uint64_t>(box.width());
  auto const height = std::bit_cast<std::uint64_t>(box.height());
  auto const is_row_inside = [&](std::size_t row) {
    bool const has_small_bits =
        std::bit_cast<std::uint64_t>(x[row]) <= width && std::bit_cast<std::uint64_t>(y[row]) <= height;
    return has_small_bits || is_inside(box, {x[row], y[row]});
  };
  std::size_t row = 0;
  while (row < x.size() && is_row_inside(row)) ++row;
  return row;
}

std::string in_words(double number) { return fmt::format("{:.10g}", number); }

void require_displacement(Box const& box, double longest, std::string const& key) {
  constexpr double rounding = 1.0 + 1e-9;  // unit vectors are a little longer than 1
  double const shorter = std::min(box.width(), box.height());
  if (longest * rounding < shorter) return;
  throw Error(
      {.what = fmt::format("agents that move by {} in a step would cross the whole box, whose shorter side is {}",
                           longest, shorter),
       .hint = fmt::format("displacements have to stay below {}", shorter),
       .key = key});
}

void throw_outside(std::uint64_t step, Id agent, Vector p, Box const& box) {
  throw RunFailure(
      fmt::format("step {}: agent {} is put at {}, outside the box of {} × {}\n  hint: this is a mistake of the model: "
                  "moves go around "
                  "the edges and turn back at walls, but a position that is set needs a point in the box",
                  step, agent, in_words(p), box.width(), box.height()));
}

void throw_birth_outside(std::uint64_t step, std::optional<Id> parent, Vector p, Box const& box) {
  throw RunFailure(
      fmt::format("step {}: {} puts a newborn agent at {}, outside the box of {} × {}\n  hint: this is a "
                  "mistake of the model: the columns x and y of a birth need a point in the box",
                  step, in_words(parent), in_words(p), box.width(), box.height()));
}

void throw_long_displacement(std::uint64_t step, Id agent, Vector displacement, Box const& box) {
  throw RunFailure(
      fmt::format("step {}: agent {} moves by {} in a box of {} × {}\n  hint: this is a mistake of the model: "
                  "a displacement has to be finite and shorter than the sides of the box",
                  step, agent, in_words(displacement), box.width(), box.height()));
}

void throw_far_move(std::uint64_t step, Id agent, Vector from, Vector to) {
  throw RunFailure(fmt::format(
      "step {}: agent {} moves from {} to {}, farther than the cells next to its own\n  hint: this is a mistake of the "
      "model: in a tiled model agents move no farther than the cutoff, except those that is_local() says are not local",
      step, agent, in_words(from), in_words(to)));
}

void throw_far_search(FarSearch const& search) {
  bool const is_elsewhere = search.agent && !(search.point == search.position);
  throw RunFailure(
      fmt::format("step {}: {} searches within {} of {}{}, but the model declares a cutoff of {}\n  hint: this "
                  "is a mistake of "
                  "the model: let cutoff() return the largest distance at which an agent searches for others",
                  search.step, in_words(search.agent), search.cutoff, in_words(search.point),
                  is_elsewhere ? fmt::format(" from {}", in_words(search.position)) : "", search.declared));
}

void throw_unknown_event(std::uint64_t step, std::optional<Id> agent, std::size_t event,
                         std::span<std::string_view const> declared) {
  throw RunFailure(fmt::format(
      "step {}: {} counts event {}, but the model declares {}\n  hint: this is a mistake of the model: name every "
      "event in its array `events`; count() takes the place in it, from 0",
      step, in_words(agent), event,
      declared.empty() ? "no events" : fmt::format("{} events: {}", declared.size(), fmt::join(declared, ", "))));
}

void throw_not_alive(std::uint64_t step, Id agent) {
  throw RunFailure(fmt::format(
      "step {}: there is no agent {}\n  hint: this is a mistake of the model: the agent is dead, or never was; "
      "contains() tells",
      step, agent));
}

void require_good_step(std::uint64_t step, double cutoff, double time_step) {
  if (cutoff > 0.0 && time_step > 0.0 && std::isfinite(cutoff) && std::isfinite(time_step)) return;
  throw RunFailure(
      fmt::format("step {}: the model has a cutoff of {} and a time step of {}\n  hint: this is a mistake of the "
                  "model: cutoff() and time_step() have to return finite numbers above 0",
                  step, cutoff, time_step));
}

namespace detail {

void require_short_part(std::uint64_t step, Id agent, Vector part, double radius) {
  if (squared_length(part) < radius * radius) return;
  throw RunFailure(
      fmt::format("step {}: agent {} of radius {} moves by {} in one part and could jump over another\n  hint: a part "
                  "has to be shorter than the radius: use more and shorter parts",
                  step, agent, in_words(radius), in_words(part)));
}

void require_radius(std::uint64_t step, Id agent, double radius, double cutoff) {
  if (2.0 * radius <= cutoff) return;
  throw RunFailure(
      fmt::format("step {}: agent {} has a radius of {}, but the model declares a cutoff of {}\n  hint: this is a "
                  "mistake of the model: let cutoff() return at least twice the largest radius",
                  step, agent, in_words(radius), in_words(cutoff)));
}

}  // namespace detail

}  // namespace gridlock
