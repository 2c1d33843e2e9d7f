#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "gridlock/core/disks.hpp"

namespace gridlock::reference {

/// Hard disks from event to event with nothing clever: before every event all pairs, all their images and all walls are
/// looked at, and all disks are moved. Shares no line with the engine `exact`, not even the form of the quadratic.
/// Where they grow, every radius is R · (1 + growth · t).
class AllPairsEvents {
 public:
  explicit AllPairsEvents(State const& start, double growth = 0.0) : state(start), growth_(growth) {}

  State state;  ///< with the radii of the start
  double time = 0.0;
  std::array<std::uint64_t, 4> wall_hits{};
  std::array<double, 4> wall_impulse{};
  double wall_virial = 0.0;
  double pair_virial = 0.0;
  std::uint64_t pair_collisions = 0;

  [[nodiscard]] double radius(std::size_t i) const { return state.agents.column<Radius>()[i] * (1.0 + growth_ * time); }

  /// Handles events up to and including the next collision of two disks; returns their rows.
  std::pair<std::size_t, std::size_t> collide_next() {
    for (;;) {
      Event const event = first_event();
      double const wait = std::min(event.wait, longest_flight());
      move(wait);
      time += wait;
      state.clock.time += wait;
      if (event.wait > wait) continue;
      if (event.wall < 0) {
        collide(event);
        ++pair_collisions;
        return {event.i, event.j};
      }
      reflect(event);
    }
  }

 private:
  struct Event {
    double wait = std::numeric_limits<double>::infinity();
    std::size_t i = 0;
    std::size_t j = 0;
    Vector image;
    int wall = -1;
  };

  /// Half a side for the fastest disk: longer flights would need more images than the nearest ring.
  [[nodiscard]] double longest_flight() const {
    return 0.5 * std::min(state.box.width(), state.box.height()) / largest_speed(state.agents);
  }

  Event first_event() const {
    Event first;
    for (std::size_t i = 0; i < state.agents.size(); ++i) {
      for (std::size_t j = i + 1; j < state.agents.size(); ++j) consider_pair(first, i, j);
      consider_walls(first, i);
    }
    return first;
  }

  void consider_pair(Event& first, std::size_t i, std::size_t j) const {
    int const images_x = state.box.is_oblique() ? 2 : state.box.is_periodic_x() ? 1 : 0;
    int const images_y = state.box.is_periodic_y() ? 1 : 0;
    Vector const w = velocity(state.agents, j) - velocity(state.agents, i);
    double const contact = radius(i) + radius(j);
    double const widening = rate_of(i) + rate_of(j);
    for (int n = -images_x; n <= images_x; ++n) {
      for (int m = -images_y; m <= images_y; ++m) {
        Vector const image{n * state.box.width() + m * state.box.shift(), m * state.box.height()};
        Vector const d = position(state.agents, j) + image - position(state.agents, i);
        double const a = squared_length(w) - widening * widening;
        double const b = dot(d, w) - widening * contact;
        double const c = squared_length(d) - contact * contact;
        double const wait = first_contact(a, b, c);
        if (wait < first.wait) first = {wait, i, j, image, -1};
      }
    }
  }

  /// The first time at which c + 2 b t + a t² falls to zero; what overlaps by rounding and comes closer touches now.
  static double first_contact(double a, double b, double c) {
    constexpr double rounding = 1e-9;
    constexpr double never = std::numeric_limits<double>::infinity();
    if (a == 0.0) return b < 0.0 ? std::max(0.0, c / (-2.0 * b)) : never;
    if (b * b < a * c) return never;
    double const root = (-b - std::sqrt(b * b - a * c)) / a;  // the one of the two at which it falls
    return root > -rounding && !(a > 0.0 && b >= 0.0) ? std::max(0.0, root) : never;
  }

  [[nodiscard]] double rate_of(std::size_t i) const { return state.agents.column<Radius>()[i] * growth_; }

  void consider_walls(Event& first, std::size_t i) const {
    Vector const p = position(state.agents, i);
    Vector const v = velocity(state.agents, i);
    double const r = radius(i);
    auto const consider = [&](double gap, double outwards, int wall) {
      double const speed = outwards + rate_of(i);
      if (speed > 0.0 && std::max(0.0, gap / speed) < first.wait) first = {std::max(0.0, gap / speed), i, i, {}, wall};
    };
    if (!state.box.is_periodic_x()) {
      consider(p.x - r, -v.x, 0);
      consider(state.box.width() - r - p.x, v.x, 1);
    }
    if (state.box.is_periodic_y()) return;
    consider(p.y - r, -v.y, 2);
    consider(state.box.height() - r - p.y, v.y, 3);
  }

  void move(double time) {
    for (std::size_t i = 0; i < state.agents.size(); ++i) {
      int crossed_x = 0;
      int crossed_y = 0;
      Vector const p =
          state.box.wrap(position(state.agents, i) + time * velocity(state.agents, i), crossed_x, crossed_y);
      state.agents.column<X>()[i] = p.x;
      state.agents.column<Y>()[i] = p.y;
      state.agents.column<ImageX>()[i] += crossed_x;
      state.agents.column<ImageY>()[i] += crossed_y;
    }
  }

  void reflect(Event const& event) {
    auto const component = event.wall < 2 ? state.agents.column<VelocityX>() : state.agents.column<VelocityY>();
    double const away_from_wall = event.wall % 2 == 0 ? 1.0 : -1.0;
    double const before = component[event.i];
    component[event.i] = -before + 2.0 * away_from_wall * rate_of(event.i);
    auto const wall = static_cast<std::size_t>(event.wall);
    double const impulse = state.agents.column<Mass>()[event.i] * std::abs(component[event.i] - before);
    ++wall_hits[wall];
    wall_impulse[wall] += impulse;
    wall_virial += impulse * radius(event.i);
  }

  void collide(Event const& event) {
    auto const mass = state.agents.column<Mass>();
    Vector const d = state.box.displacement(position(state.agents, event.i), position(state.agents, event.j));
    double const distance = std::sqrt(squared_length(d));
    Vector const normal = (1.0 / distance) * d;
    double const speed = dot(velocity(state.agents, event.j) - velocity(state.agents, event.i), normal) -
                         (rate_of(event.i) + rate_of(event.j));
    double const reduced_mass = mass[event.i] * mass[event.j] / (mass[event.i] + mass[event.j]);
    kick(event.i, (2.0 * reduced_mass * speed / mass[event.i]) * normal);
    kick(event.j, (-2.0 * reduced_mass * speed / mass[event.j]) * normal);
    pair_virial -= 2.0 * reduced_mass * speed * distance;
  }

  void kick(std::size_t i, Vector change) {
    state.agents.column<VelocityX>()[i] += change.x;
    state.agents.column<VelocityY>()[i] += change.y;
  }

  double growth_;
};

/// The largest difference of a position or a velocity.
inline double difference(State const& a, State const& b) {
  double largest = 0.0;
  for (std::size_t i = 0; i < a.agents.size(); ++i) {
    Vector const d = a.box.displacement(position(a.agents, i), position(b.agents, i));
    Vector const w = velocity(b.agents, i) - velocity(a.agents, i);
    largest = std::max(largest, std::sqrt(std::max(squared_length(d), squared_length(w))));
  }
  return largest;
}

}  // namespace gridlock::reference
