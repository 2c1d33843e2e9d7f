#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "gridlock/core/disks.hpp"
#include "gridlock/core/random.hpp"
#include "gridlock/observe/observable.hpp"

/// States and runs written down by hand, for tests of observables.
namespace gridlock::hand_built {

inline State empty_state(Box const& box) { return {.box = box}; }

inline Id add_disk(State& state, Vector position, Vector velocity = {}, double radius = 0.01, double mass = 1.0) {
  return state.agents.add(position.x, position.y, velocity.x, velocity.y, radius, mass, 0, 0);
}

/// Disks at rest, uniform in the part of the box that centres can reach; they overlap as ideal gas points do.
inline State ideal_gas(Box const& box, std::size_t count, double radius, std::uint64_t seed) {
  State state = empty_state(box);
  double const margin = box.is_periodic() ? 0.0 : radius;
  for (std::size_t i = 0; i < count; ++i) {
    RandomStream random(seed, 0, i, Purpose::start_position);
    double const x = margin + (box.width() - 2.0 * margin) * random.uniform();
    double const y = margin + (box.height() - 2.0 * margin) * random.uniform();
    add_disk(state, {x, y}, {}, radius);
  }
  return state;
}

/// Normal velocity components of variance kT/m.
inline void draw_maxwell(State& state, double temperature, std::uint64_t seed) {
  for (std::size_t i = 0; i < state.agents.size(); ++i) {
    RandomStream random(seed, 0, state.agents.ids()[i], Purpose::start_velocity);
    double const width = std::sqrt(temperature / state.agents.column<Mass>()[i]);
    state.agents.column<VelocityX>()[i] = width * random.normal();
    state.agents.column<VelocityY>()[i] = width * random.normal();
  }
}

/// A periodic triangular lattice of spacing 1, `columns` sites in each of an even number of `rows`.
inline State triangular_lattice(int columns, int rows) {
  double const height = std::sqrt(0.75);
  State state = empty_state(Box(columns, rows * height, Edge::periodic));
  for (int row = 0; row < rows; ++row) {
    for (int n = 0; n < columns; ++n)
      add_disk(state, {n + (row % 2 == 0 ? 0.25 : 0.75), (row + 0.5) * height}, {}, 0.4);
  }
  return state;
}

/// A periodic square lattice of spacing 1.
inline State square_lattice(int sites_a_side) {
  State state = empty_state(Box(sites_a_side, sites_a_side, Edge::periodic));
  for (int row = 0; row < sites_a_side; ++row) {
    for (int n = 0; n < sites_a_side; ++n) add_disk(state, {n + 0.5, row + 0.5}, {}, 0.4);
  }
  return state;
}

/// The same disks under the same Ids, with the rows in reverse order.
inline State with_rows_reversed(State const& state) {
  State reversed{.box = state.box, .clock = state.clock, .seed = state.seed};
  Disks const& d = state.agents;
  for (std::size_t i = d.size(); i-- > 0;) {
    bool const is_added = reversed.agents.add_as(
        d.ids()[i], d.column<X>()[i], d.column<Y>()[i], d.column<VelocityX>()[i], d.column<VelocityY>()[i],
        d.column<Radius>()[i], d.column<Mass>()[i], d.column<ImageX>()[i], d.column<ImageY>()[i]);
    if (!is_added) return {};
  }
  return reversed;
}

/// Takes one sample and returns its row.
inline std::vector<double> sample(Observable& observable, State const& state, Counters const& counters = {},
                                  bool counts_for_average = true) {
  std::vector<double> row(observable.columns().size(), 0.0);
  observable.sample({state, counters}, row, counts_for_average);
  return row;
}

/// The cell of a row under a column's name.
inline double cell(Observable const& observable, std::vector<double> const& row, std::string const& name) {
  auto const columns = observable.columns();
  for (std::size_t c = 0; c < columns.size(); ++c) {
    if (columns[c].name == name) return row[c];
  }
  return no_value;
}

inline std::optional<Estimate> result(Observable const& observable, std::string const& name) {
  for (NamedEstimate const& named : observable.results()) {
    if (named.name == name) return named.estimate;
  }
  return std::nullopt;
}

}  // namespace gridlock::hand_built
