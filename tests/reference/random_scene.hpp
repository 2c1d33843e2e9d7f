#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <optional>
#include <ostream>
#include <string_view>
#include <vector>

#include "gridlock/core/disks.hpp"
#include "gridlock/core/random.hpp"

namespace gridlock::reference {

/// A random set-up of hard disks, described by numbers alone so that a failure can be printed and repeated.
struct SceneSettings {
  Edge edge = Edge::wall;
  std::optional<Edge> edge_y = {};  ///< of y alone, where it is another
  double width = 1.25;              ///< An oblong box tells what takes x for y.
  double height = 0.8;
  std::uint64_t count = 20;
  double packing_fraction = 0.4;  ///< asked for; less where the disks would not fit on their sites
  double smallest_ratio = 1.0;    ///< radii are uniform in [smallest_ratio, 1] of the largest
  double heaviest_mass = 1.0;     ///< masses are uniform in [1, heaviest_mass]
  std::uint64_t seed = 1;
  double tilt = 0.0;

  [[nodiscard]] Box box() const { return Box(width, height, edge, edge_y.value_or(edge)).tilted(tilt); }

  friend std::ostream& operator<<(std::ostream& out, SceneSettings const& s) {
    return out << edges_in_words(s.box()) << " " << s.width << " × " << s.height << ", N = " << s.count
               << ", φ = " << s.packing_fraction << ", smallest ratio " << s.smallest_ratio << ", heaviest mass "
               << s.heaviest_mass << ", seed " << s.seed << ", tilt " << s.tilt;
  }
};

namespace detail {

/// Whether disk i could stand at p without overlap and inside the box.
inline bool is_free(State const& state, std::size_t i, Vector p) {
  auto const r = state.agents.column<Radius>();
  if (!state.box.is_periodic_x() && (p.x < r[i] || p.x > state.box.width() - r[i])) return false;
  if (!state.box.is_periodic_y() && (p.y < r[i] || p.y > state.box.height() - r[i])) return false;
  for (std::size_t j = 0; j < state.agents.size(); ++j) {
    if (j == i) continue;
    double const contact = r[i] + r[j];
    if (squared_length(state.box.displacement(p, position(state.agents, j))) < contact * contact) return false;
  }
  return true;
}

/// Random small moves that are undone where they overlap: takes the order out of a lattice.
inline void shake(State& state, RandomStream& random, double largest_move, int sweeps) {
  for (int sweep = 0; sweep < sweeps; ++sweep) {
    for (std::size_t i = 0; i < state.agents.size(); ++i) {
      int crossed_x = 0;
      int crossed_y = 0;
      Vector const p =
          state.box.wrap(position(state.agents, i) + largest_move * random.in_unit_disk(), crossed_x, crossed_y);
      if (!is_free(state, i, p)) continue;
      state.agents.column<X>()[i] = p.x;
      state.agents.column<Y>()[i] = p.y;
    }
  }
}

}  // namespace detail

/// Calls visit(edge of x, edge of y) for all four kinds of box.
template <class Visit>
void for_each_edges(Visit visit) {
  for (Edge const x : {Edge::wall, Edge::periodic}) {
    for (Edge const y : {Edge::wall, Edge::periodic}) visit(x, y);
  }
}

/// Disks on random sites of the smallest square-like lattice that holds them, shaken, with velocities uniform in the
/// unit disk. In a periodic box no disk is wider than a fifth of the shorter side, as the engines ask.
inline State random_scene(SceneSettings const& settings) {
  State state{.box = settings.box(), .seed = settings.seed};
  RandomStream random(settings.seed, 0, 0, Purpose::start_position);
  double const stretch = std::sqrt(settings.width / settings.height * static_cast<double>(settings.count));
  auto const columns = std::max<std::uint64_t>(1, static_cast<std::uint64_t>(std::ceil(stretch)));
  std::uint64_t const rows = (settings.count + columns - 1) / columns;
  double const step_x = settings.width / static_cast<double>(columns);
  double const step_y = settings.height / static_cast<double>(rows);

  std::vector<double> ratios;
  double squares = 0.0;
  for (std::uint64_t n = 0; n < settings.count; ++n) {
    ratios.push_back(settings.smallest_ratio + (1.0 - settings.smallest_ratio) * random.uniform());
    squares += ratios.back() * ratios.back();
  }
  double largest = std::sqrt(settings.packing_fraction * state.box.area() / (std::numbers::pi * squares));
  largest = std::min(largest, 0.4999 * std::min(step_x, step_y));
  largest = std::min(largest, 0.1 * state.box.shortest_period());

  std::vector<std::uint64_t> sites(columns * rows);
  for (std::uint64_t n = 0; n < sites.size(); ++n) sites[n] = n;
  for (std::uint64_t n = sites.size(); n > 1; --n) std::swap(sites[n - 1], sites[random.below(n)]);
  for (std::uint64_t n = 0; n < settings.count; ++n) {
    double const x = (static_cast<double>(sites[n] % columns) + 0.5) * step_x;
    double const y = (static_cast<double>(sites[n] / columns) + 0.5) * step_y;
    Vector const v = random.in_unit_disk();
    double const mass = 1.0 + (settings.heaviest_mass - 1.0) * random.uniform();
    state.agents.add(x, y, v.x, v.y, largest * ratios[n], mass, 0, 0);
  }
  detail::shake(state, random, 0.5 * std::min(step_x, step_y), 10);
  return state;
}

}  // namespace gridlock::reference
