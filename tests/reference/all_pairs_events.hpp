#pragma once

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
class AllPairsEvents {
 public:
  explicit AllPairsEvents(State const& start) : state(start) {}

  State state;
  std::array<std::uint64_t, 4> wall_hits{};
  std::uint64_t pair_collisions = 0;

  /// Handles events up to and including the next collision of two disks; returns their rows.
  std::pair<std::size_t, std::size_t> collide_next() {
    for (;;) {
      Event const event = first_event();
      double const wait = std::min(event.wait, longest_flight());
      move(wait);
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
      if (!state.box.is_periodic()) consider_walls(first, i);
    }
    return first;
  }

  void consider_pair(Event& first, std::size_t i, std::size_t j) const {
    int const images = state.box.is_periodic() ? 1 : 0;
    Vector const w = velocity(state.agents, j) - velocity(state.agents, i);
    double const a = squared_length(w);
    double const contact = state.agents.column<Radius>()[i] + state.agents.column<Radius>()[j];
    for (int n = -images; n <= images; ++n) {
      for (int m = -images; m <= images; ++m) {
        Vector const image{n * state.box.width(), m * state.box.height()};
        Vector const d = position(state.agents, j) + image - position(state.agents, i);
        double const b = dot(d, w);
        double const c = squared_length(d) - contact * contact;
        if (b >= 0.0 || b * b < a * c) continue;
        double const wait = std::max(0.0, (-b - std::sqrt(b * b - a * c)) / a);
        if (wait < first.wait) first = {wait, i, j, image, -1};
      }
    }
  }

  void consider_walls(Event& first, std::size_t i) const {
    Vector const p = position(state.agents, i);
    Vector const v = velocity(state.agents, i);
    double const r = state.agents.column<Radius>()[i];
    auto const consider = [&](double gap, double speed, int wall) {
      if (speed > 0.0 && std::max(0.0, gap / speed) < first.wait) first = {std::max(0.0, gap / speed), i, i, {}, wall};
    };
    consider(p.x - r, -v.x, 0);
    consider(state.box.width() - r - p.x, v.x, 1);
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
    component[event.i] = -component[event.i];
    ++wall_hits[static_cast<std::size_t>(event.wall)];
  }

  void collide(Event const& event) {
    auto const mass = state.agents.column<Mass>();
    Vector const d = state.box.displacement(position(state.agents, event.i), position(state.agents, event.j));
    double const distance = std::sqrt(squared_length(d));
    Vector const normal = (1.0 / distance) * d;
    double const speed = dot(velocity(state.agents, event.j) - velocity(state.agents, event.i), normal);
    double const reduced_mass = mass[event.i] * mass[event.j] / (mass[event.i] + mass[event.j]);
    kick(event.i, (2.0 * reduced_mass * speed / mass[event.i]) * normal);
    kick(event.j, (-2.0 * reduced_mass * speed / mass[event.j]) * normal);
  }

  void kick(std::size_t i, Vector change) {
    state.agents.column<VelocityX>()[i] += change.x;
    state.agents.column<VelocityY>()[i] += change.y;
  }
};

}  // namespace gridlock::reference
