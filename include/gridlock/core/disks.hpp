#pragma once

/// \file
/// Hard disks as agents, and their world, the State.
///
/// ```cpp
/// Disks disks;
/// Id const id = disks.add(0.5, 0.5, 1.0, 0.0, 0.1, 1.0, 0, 0);  // x, y, vx, vy, radius, mass, images
/// Vector const v = velocity(disks, disks.index_of(id));
/// double const energy = kinetic_energy(disks);  // 0.5
/// ```

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>

#include "gridlock/core/agents_view.hpp"
#include "gridlock/core/population.hpp"
#include "gridlock/core/vector.hpp"
#include "gridlock/core/world.hpp"

namespace gridlock {

struct X {
  using type = double;
  static constexpr char const* name = "x";
};
struct Y {
  using type = double;
  static constexpr char const* name = "y";
};
struct VelocityX {
  using type = double;
  static constexpr char const* name = "velocity_x";
};
struct VelocityY {
  using type = double;
  static constexpr char const* name = "velocity_y";
};
struct Radius {
  using type = double;
  static constexpr char const* name = "radius";
};
/// Infinite for a disk that is fixed.
struct Mass {
  using type = double;
  static constexpr char const* name = "mass";
};
/// Times that the disk left the periodic box through the right edge minus those through the left; 0 in a box with
/// walls.
struct ImageX {
  using type = std::int32_t;
  static constexpr char const* name = "image_x";
};
/// Times that the disk left the periodic box through the top edge minus those through the bottom; 0 in a box with
/// walls.
struct ImageY {
  using type = std::int32_t;
  static constexpr char const* name = "image_y";
};

/// Hard disks: centre, velocity, radius, mass, and the periodic image to which the centre has moved.
using Disks = Population<X, Y, VelocityX, VelocityY, Radius, Mass, ImageX, ImageY>;

inline Vector position(Disks const& disks, std::size_t i) { return {disks.column<X>()[i], disks.column<Y>()[i]}; }
inline Vector velocity(Disks const& disks, std::size_t i) {
  return {disks.column<VelocityX>()[i], disks.column<VelocityY>()[i]};
}

/// Returns whether a disk of this mass never moves: the mass is infinite, and the velocity 0.
constexpr bool is_fixed(double mass) { return mass == std::numeric_limits<double>::infinity(); }
inline bool is_fixed(Disks const& disks, std::size_t i) { return is_fixed(disks.column<Mass>()[i]); }

/// Return the number of disks that are fixed.
std::size_t count_of_fixed(Disks const& disks);
std::size_t count_of_fixed(std::span<double const> masses);

/// The smallest and the largest radius; 0 for no disks.
struct RadiusRange {
  double smallest = 0.0;
  double largest = 0.0;
};
RadiusRange radius_range(Disks const& disks);

/// Returns the sum of the two largest radii: the largest distance at which disks touch. One disk: its radius; no disks:
/// 0.
double largest_contact_distance(std::span<double const> radii);

/// Returns the largest speed of a disk; 0 for no disks.
double largest_speed(Disks const& disks);

/// Returns ½ Σ m v² of the disks that move, in (mass unit)·(length unit / time unit)². Contract: the agents have a mass
/// and a velocity.
double kinetic_energy(AgentsView const& agents);

/// Returns Σ m v of the disks that move. Contract: the agents have a mass and a velocity.
Vector momentum(AgentsView const& agents);

/// Returns Σ π R², the area that the agents cover. Contract: the agents have a radius.
double covered_area(AgentsView const& agents);

/// Hard disks, the model of the disk engines.
struct HardDisks {
  using Agents = Disks;
};

/// The complete physical state of hard disks: two equal states stay equal under the same engine settings.
///
/// ```cpp
/// State state{.box = Box(1.0, 1.0, Edge::wall), .seed = 7};
/// state.agents.add(0.5, 0.5, 1.0, 0.0, 0.1, 1.0, 0, 0);  // x, y, vx, vy, radius, mass, images
/// std::uint64_t const identity = hash(state);
/// ```
using State = World<HardDisks>;

/// Returns covered_area() over the area of the box.
inline double packing_fraction_of(State const& state) { return covered_area(state.agents) / state.box.area(); }

}  // namespace gridlock
