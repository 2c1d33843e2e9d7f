#pragma once

#include <cstdint>
#include <functional>

#include "gridlock/core/disks.hpp"
#include "gridlock/core/vector.hpp"
#include "gridlock/lattice/start.hpp"

namespace gridlock {

/// Rows first … end − 1 of a start, where several processes have some each.
struct RowRange {
  std::uint64_t first = 0;
  std::uint64_t end = 0;
};

/// How many disks the settings ask for.
std::uint64_t count_of(DisksSettings const& settings);

/// These rows of make_start(), which has them in the order of the Ids. Memory: equal disks on lattices and at uniform points those of
/// the rows alone; unequal ones 16 bytes for each disk of all, and a random start all sites, until it returns.
/// Errors: those of make_start().
State make_rows_of_start(Box const& box, DisksSettings const& settings, std::uint64_t seed, RowRange rows);

/// Σ m and Σ m v, added up row after row.
struct DriftSums {
  double mass = 0.0;
  Vector momentum;

  void add(Disks const& disks);
};

/// draw_velocities() of some rows. `add_all` adds up those of all, in their order; it is called where the drift is removed.
void draw_velocities_of_rows(State& state, VelocitySettings const& settings, std::uint64_t count_of_all,
                             std::function<void(DriftSums&)> const& add_all);

}  // namespace gridlock
