// Disks in a channel, in a cage of fixed disks and in a Lorentz gas.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "dynamics/sections.hpp"
#include "gridlock/lattice/start.hpp"
#include "reference/unwrapped.hpp"

namespace gridlock::validation {
namespace {

using reference::mean_squared_displacement;
using reference::unwrapped;

/// Disks that cannot pass one another, in a channel of width 1 + h that is periodic along x.
struct SingleFile {
  double h;
  double length;      ///< L/N
  double force;       ///< βF along the channel in the limit of many disks (Kofka & Post 1993, doi:10.1063/1.464967)
  double ring_force;  ///< of 200 disks
  double ring_wall;   ///< force on one wall for each of 200 disks
};

/// With λ(F, h) the largest eigenvalue of e^(−F s)/F, s = √(1 − (y − y')²), y and y' in [0, h], a ring of N disks has
/// ln Z = ln L + N (ln λ + F L/N) − ½ ln κ + O(1/N), where L/N = −∂ ln λ/∂F gives F, and κ = ∂² ln λ/∂F². The forces of
/// the ring are ∂ ln Z/∂L and ∂ ln Z/∂h. They were computed once with 60 Gauss points.
constexpr std::array files{
    SingleFile{0.25, 1.1944993642, 5.0, 4.979254, 4.220268}, SingleFile{0.5, 1.9777257311, 1.0, 0.997537, 2.091179},
    SingleFile{0.5, 1.1735442348, 5.0, 4.980808, 2.542306},  SingleFile{0.5, 0.9939612132, 20.0, 19.988996, 6.672326},
    SingleFile{0.75, 1.9446020900, 1.0, 0.997632, 1.492323}, SingleFile{0.75, 1.1106587266, 5.0, 4.991413, 2.647137},
    SingleFile{0.8, 1.0842967390, 5.0, 4.995456, 2.896320}};

/// Returns the forces along the channel and on a wall for each disk.
Numbers forces_in_channel(SingleFile const& file, std::uint64_t seed) {
  constexpr double count = 200.0;
  constexpr double equilibration = 500.0;
  constexpr double duration = 2000.0;
  double const length = count * file.length;
  State state{.box = Box(length, 1.0 + file.h, Edge::periodic, Edge::wall), .seed = seed};
  for (double i = 0.0; i < count; ++i) {
    double const y = 0.5 + file.h * (std::fmod(i, 2.0) == 0.0 ? 0.001 : 0.999);
    state.agents.add((i + 0.5) * file.length, y, 0.0, 0.0, 0.5, 1.0, 0, 0);
  }
  draw_velocities(state, {.kind = VelocityKind::maxwell, .max = 2.0});
  // Momentum along the channel is conserved, that across it is not: K = (N − ½) kT.
  scale_velocities(state, std::sqrt((count - 0.5) / kinetic_energy(state.agents)));
  auto const engine = make_engine(exact(), state);
  Counters counters;
  engine->advance(state, counters, {.time = equilibration});
  Counters const before = counters;
  engine->advance(state, counters, {.time = equilibration + duration});
  double const on_wall = 0.5 * (force_on(Counters::bottom, counters, before, duration) +
                                force_on(Counters::top, counters, before, duration));
  // The virial of both directions is L F − N kT along the channel and h F_wall − N kT across it.
  double const virial = (counters.pair_virial - before.pair_virial) / duration;
  return {(virial + 2.0 * count - file.h * on_wall) / length, on_wall / count};
}

void single_files() {
  for (SingleFile const& file : files) {
    auto const found = means(24, [&](std::uint64_t seed) { return forces_in_channel(file, seed); });
    std::string const name = fmt::format("single file of 200: h {} force {}", file.h, file.force);
    within_errors("force along the " + name, found[0], {file.ring_force, 0.0});
    within_errors("force on a wall of the " + name, found[1], {file.ring_wall, 0.0});
  }
}

constexpr double fixed_mass = std::numeric_limits<double>::infinity();

/// One disk of speed 1 among fixed disks. Its places have the area A and a border of length P: it collides at the rate
/// P/(πA), and presses with kT/A, kT = ½, on the border.
struct Cage {
  std::string name;
  double corners;
  double radius;  ///< from the middle to a fixed disk
  double rate;
  double force;  ///< on each fixed disk, over kT
};

/// Returns the rate and the force.
Numbers hits_in_cage(Cage const& cage, std::uint64_t seed) {
  constexpr std::uint64_t hits = 400'000;
  Vector const middle{3.0, 2.5};
  State state{.box = Box(6.0, 5.0, Edge::wall)};
  state.agents.add(middle.x, middle.y, std::cos(seed), std::sin(seed), 0.5, 1.0, 0, 0);
  std::vector<Vector> corners;
  for (double k = 0.5; k < cage.corners; ++k) {
    double const angle = 2.0 * pi * k / cage.corners;
    corners.push_back({std::cos(angle), std::sin(angle)});
    Vector const place = middle + cage.radius * corners.back();
    state.agents.add(place.x, place.y, 0.0, 0.0, 0.5, fixed_mass, 0, 0);
  }
  auto const engine = make_engine(exact(), state);
  Counters counters;
  engine->advance(state, counters, {.pair_collisions = 1});
  double const start = state.clock.time;
  double outward = 0.0;  // momentum that the fixed disks have got, away from the middle
  for (std::uint64_t hit = 2; hit <= hits + 1; ++hit) {
    Vector const before = velocity(state.agents, 0);
    engine->advance(state, counters, {.pair_collisions = hit});
    Vector const change = before - velocity(state.agents, 0);
    Vector const place = position(state.agents, 0) - middle;
    auto const hit_one = std::ranges::max_element(corners, {}, [&](Vector corner) { return dot(corner, place); });
    outward += dot(change, *hit_one);
  }
  double const duration = state.clock.time - start;
  return {static_cast<double>(hits) / duration, outward / (cage.corners * duration * 0.5)};
}

void cages() {
  for (Cage const& cage : {Cage{"square 1.6", 4.0, 1.6 / std::numbers::sqrt2, 4.9900427045, 3.90603167},
                           Cage{"square 1.8", 4.0, 1.8 / std::numbers::sqrt2, 2.5545803217, 1.96918451},
                           Cage{"hexagon 1.2", 6.0, 1.2, 3.2294945516, 1.68691061},
                           Cage{"hexagon 1.5", 6.0, 1.5, 1.3435925113, 0.69122448}}) {
    auto const found = means(24, [&](std::uint64_t seed) { return hits_in_cage(cage, seed); });
    within_errors("rate in the cage " + cage.name, found[0], {cage.rate, 0.0});
    within_errors("force on each disk of the cage " + cage.name, found[1], {cage.force, 0.0});
  }
}

/// Points at speed 1 among fixed disks of radius 1 on a triangular lattice of spacing 2 + w. Returns the rate of
/// collisions of a point and the diffusion coefficient between the times 150 and 300.
Numbers lorentz_gas(double w, std::uint64_t seed) {
  constexpr std::size_t points = 2000;
  constexpr double point_radius = 1e-7;
  double const a = 2.0 + w;
  State state{.box = Box(14.0 * a, 8.0 * a * std::sqrt(3.0), Edge::periodic), .seed = seed};
  for (int row = 0; row < 16; ++row) {
    for (int column = 0; column < 14; ++column) {
      state.agents.add((column + (row % 2 == 0 ? 0.25 : 0.75)) * a, (row + 0.5) * a * std::sqrt(0.75), 0.0, 0.0,
                       1.0 - point_radius, fixed_mass, 0, 0);
    }
  }
  std::size_t const fixed = state.agents.size();
  for (std::uint64_t n = 0; state.agents.size() < fixed + points; ++n) {
    RandomStream random = state.start_random(n);
    Vector const p = state.anywhere(random);
    bool is_free = true;
    for (std::size_t i = 0; i < fixed; ++i) {
      is_free &= squared_length(state.box.displacement(p, position(state.agents, i))) > 1.0;
    }
    double const angle = 2.0 * pi * random.uniform();
    if (is_free) state.agents.add(p.x, p.y, std::cos(angle), std::sin(angle), point_radius, 1.0, 0, 0);
  }
  auto const engine = make_engine(exact(), state);
  Counters counters;
  std::vector<Vector> const start = unwrapped(state);
  engine->advance(state, counters, {.time = 150.0});
  double const early = mean_squared_displacement(start, unwrapped(state));
  engine->advance(state, counters, {.time = 300.0});
  double const late = mean_squared_displacement(start, unwrapped(state));
  // Fixed disks are in the mean, and do not move.
  double const share = static_cast<double>(points) / static_cast<double>(state.agents.size());
  return {static_cast<double>(counters.pair_collisions) / (points * 300.0), (late - early) / (4.0 * 150.0 * share)};
}

void lorentz_gases() {
  struct Gas {
    double w;
    double rate;
    double diffusion;
  };
  for (auto const& [w, rate, diffusion] :
       {Gas{0.1, 2.951684, 0.0991}, Gas{0.2, 1.904816, 0.1689}, Gas{0.3, 1.389196, 0.2483}}) {
    auto const found = means(36, [w = w](std::uint64_t seed) { return lorentz_gas(w, seed); });
    within_errors(fmt::format("rate in the Lorentz gas w {}", w), found[0], {rate, 0.0});
    within(fmt::format("D of the Lorentz gas w {}", w), found[1], diffusion, 0.03 * diffusion);
  }
}

}  // namespace

void channels() {
  single_files();
  cages();
  lorentz_gases();
}

}  // namespace gridlock::validation
