#include "engine/exact/touch.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "engine/exact/moving_disk.hpp"

namespace gridlock::exact {

namespace {

/// Gaps smaller than this part of the distance at contact count as none.
constexpr double rounding_of_gap = 1e-10;
/// Steps after which a bracket cannot become smaller.
constexpr int max_steps = 200;

/// Returns the time at which a + b τ + c τ² falls through 0; `never` where it does not. `is_touching` says that a
/// differs from 0 by rounding only.
double fall_of_quadratic(double a, double b, double c, bool is_touching) {
  double const discriminant = b * b - 4.0 * a * c;
  if (is_touching && a <= 0.0) {
    if (b < 0.0 || (b == 0.0 && c < 0.0)) return 0.0;
    return c < 0.0 ? b / -c : never;
  }
  if (c < 0.0) {
    if (discriminant < 0.0) return never;
    double const root = std::sqrt(discriminant);
    return b > 0.0 ? (b + root) / (-2.0 * c) : 2.0 * a / (root - b);
  }
  if (b >= 0.0 || discriminant < 0.0) return never;
  return 2.0 * a / (std::sqrt(discriminant) - b);
}

/// A polynomial of the fourth degree at most, by its coefficients of τ⁰ … τ⁴.
struct Polynomial {
  std::array<double, 5> of;

  [[nodiscard]] double at(double t) const { return (((of[4] * t + of[3]) * t + of[2]) * t + of[1]) * t + of[0]; }
  [[nodiscard]] Polynomial derivative() const { return {{of[1], 2.0 * of[2], 3.0 * of[3], 4.0 * of[4], 0.0}}; }
};

/// Returns the zero of a monotonic function between two points of different signs, by halving and by Newton's steps.
double zero_between(Polynomial const& f, double positive, double negative) {
  Polynomial const slope = f.derivative();
  double middle = 0.5 * (positive + negative);
  for (int step = 0; step < max_steps; ++step) {
    double const value = f.at(middle);
    if (value == 0.0) return middle;
    (value > 0.0 ? positive : negative) = middle;
    double next = middle - value / slope.at(middle);
    bool const is_inside = next > std::min(positive, negative) && next < std::max(positive, negative);
    if (!is_inside || step % 4 == 3) next = 0.5 * (positive + negative);
    if (next == middle || next == positive || next == negative) return positive;
    middle = next;
  }
  return positive;
}

/// Returns a point from `from` on, in steps that double, at which f is no longer negative, or with a step to the left
/// no longer positive. Contract: f grows without limit to the right, and falls without limit to the left.
double point_beyond(Polynomial const& f, double from, double step) {
  double point = from + step;
  while (step > 0.0 ? f.at(point) < 0.0 : f.at(point) > 0.0) {
    step *= 2.0;
    point = from + step;
  }
  return point;
}

/// The points at which f begins to rise, falls again, and rises for good; all three are one where it falls once.
struct Turns {
  double first_low;
  double high;
  double last_low;
};

/// Finds where the slope of f changes its sign. Contract: the coefficient of τ⁴ is positive.
Turns turns_of(Polynomial const& f, double scale) {
  Polynomial const slope = f.derivative();
  // The slope itself turns where 2 c₂ + 6 c₃ τ + 12 c₄ τ² = 0.
  double const half_b = 3.0 * f.of[3];
  double const discriminant = half_b * half_b - 24.0 * f.of[2] * f.of[4];
  auto const lowest_zero = [&](double from) { return zero_between(slope, from, point_beyond(slope, from, -scale)); };
  auto const highest_zero = [&](double from) { return zero_between(slope, point_beyond(slope, from, scale), from); };
  if (!(discriminant > 0.0)) {
    double const middle = -half_b / (12.0 * f.of[4]);
    double const zero = slope.at(middle) > 0.0 ? lowest_zero(middle) : highest_zero(middle);
    return {zero, zero, zero};
  }
  double const root = std::sqrt(discriminant);
  double const first = (-half_b - root) / (12.0 * f.of[4]);
  double const second = (-half_b + root) / (12.0 * f.of[4]);
  bool const is_first_above = slope.at(first) > 0.0;
  bool const is_second_below = slope.at(second) < 0.0;
  if (!is_first_above) {
    double const zero = highest_zero(second);
    return {zero, zero, zero};
  }
  double const low = lowest_zero(first);
  if (!is_second_below) return {low, low, low};
  return {low, zero_between(slope, first, second), highest_zero(second)};
}

/// Returns the first time from 0 on at which f falls through 0.
double fall_of_quartic(Polynomial f, double scale, bool is_touching) {
  if (is_touching && f.of[0] <= 0.0) {
    if (f.of[1] < 0.0 || (f.of[1] == 0.0 && f.of[2] < 0.0)) return 0.0;
    f.of[0] = 0.0;
  }
  Turns const turns = turns_of(f, scale);
  if (f.of[0] > 0.0 && turns.first_low > 0.0 && f.at(turns.first_low) <= 0.0) {
    return zero_between(f, 0.0, turns.first_low);
  }
  double const high = std::max(turns.high, 0.0);
  if (turns.last_low > high && f.at(high) > 0.0 && f.at(turns.last_low) <= 0.0) {
    return zero_between(f, high, turns.last_low);
  }
  return never;
}

/// Returns the time at which the centre comes within `contact` of a point.
double time_to_point(Vector point, double contact, Path const& path) {
  Vector const d = path.position - point;
  Vector const v = path.velocity;
  Vector const g = path.acceleration;
  double const squared_contact = contact * contact;
  double const c = squared_length(d) - squared_contact;
  double const b = dot(d, v);
  bool const is_touching = c <= rounding_of_gap * squared_contact;
  if (g.x == 0.0 && g.y == 0.0) {
    if (!(b < 0.0)) return never;
    if (c <= 0.0) return 0.0;
    double const across = d.x * v.y - d.y * v.x;
    double const discriminant = squared_length(v) * squared_contact - across * across;
    return discriminant >= 0.0 ? c / (std::sqrt(discriminant) - b) : never;
  }
  Polynomial const f{{c, 2.0 * b, squared_length(v) + dot(d, g), dot(v, g), 0.25 * squared_length(g)}};
  double const scale = contact / std::sqrt(squared_length(v) + std::sqrt(squared_length(g)) * contact);
  return fall_of_quartic(f, scale, is_touching);
}

/// Returns the time at which the disk touches one side of a line between two points; `side` is 1 on the left, −1 on the
/// right.
double time_to_side(Obstacle const& wall, double side, double contact, Path const& path) {
  Vector const along = wall.to - wall.from;
  double const length = std::sqrt(squared_length(along));
  Vector const normal{-side * along.y / length, side * along.x / length};
  double const gap = dot(normal, path.position - wall.from) - contact;
  double const speed = dot(normal, path.velocity);
  double const half_acceleration = 0.5 * dot(normal, path.acceleration);
  bool const is_touching = std::abs(gap) <= rounding_of_gap * contact;
  double const wait = fall_of_quadratic(gap, speed, half_acceleration, is_touching);
  if (!(wait >= 0.0 && wait < never)) return never;
  double const foot = dot(path.at(wait) - wall.from, along);
  return foot >= 0.0 && foot <= length * length ? wait : never;
}

}  // namespace

double time_to_touch(Obstacle const& obstacle, double radius, Path const& path) {
  double const contact = radius + obstacle.radius;
  double wait = time_to_point(obstacle.from, contact, path);
  if (obstacle.from == obstacle.to) return wait;
  wait = std::min(wait, time_to_point(obstacle.to, contact, path));
  for (double const side : {1.0, -1.0}) wait = std::min(wait, time_to_side(obstacle, side, contact, path));
  return wait;
}

}  // namespace gridlock::exact
