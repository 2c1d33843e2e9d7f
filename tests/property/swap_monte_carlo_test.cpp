// Swap Monte Carlo against the rule written down with a look at all disks for every trial move: the same bits.

#include "gridlock/engine/swap_monte_carlo.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "gridlock/core/random.hpp"
#include "gridlock/grid/validate.hpp"
#include "gridlock/lattice/start.hpp"
#include "reference/random_scene.hpp"

namespace gridlock {
namespace {

/// Whether disk i has room there with that radius, whatever disk `other` does.
bool has_room(State const& state, std::size_t i, Vector p, double radius, std::size_t other) {
  Box const& box = state.box;
  if (!box.is_periodic_x() && (p.x < radius || p.x > box.width() - radius)) return false;
  if (!box.is_periodic_y() && (p.y < radius || p.y > box.height() - radius)) return false;
  for (std::size_t j = 0; j < state.agents.size(); ++j) {
    if (j == i || j == other) continue;
    double const contact = radius + state.agents.column<Radius>()[j];
    if (squared_length(box.displacement(p, position(state.agents, j))) < contact * contact) return false;
  }
  return true;
}

/// A trial move: kind, disk and partner or displacement come from four numbers of the stream (sweep, trial).
void take_trial(State& state, std::uint64_t sweep, std::uint64_t trial, double swap_fraction, double step) {
  auto const count = static_cast<double>(state.agents.size());
  auto const radii = state.agents.column<Radius>();
  RandomStream random(state.seed, sweep, trial, Purpose::swap_trial);
  bool const is_swap = random.uniform() < swap_fraction;
  auto const i = static_cast<std::size_t>(random.uniform() * count);
  if (is_swap) {
    auto const j = static_cast<std::size_t>(random.uniform() * count);
    bool const is_allowed = has_room(state, i, position(state.agents, i), radii[j], j) &&
                            has_room(state, j, position(state.agents, j), radii[i], i);
    if (is_allowed) std::swap(radii[i], radii[j]);
    return;
  }
  double const x = step * (2.0 * random.uniform() - 1.0);
  double const y = step * (2.0 * random.uniform() - 1.0);
  int image_x = state.agents.column<ImageX>()[i];
  int image_y = state.agents.column<ImageY>()[i];
  Vector const p = state.box.wrap(position(state.agents, i) + Vector{x, y}, image_x, image_y);
  if (!has_room(state, i, p, radii[i], i)) return;
  state.agents.column<X>()[i] = p.x;
  state.agents.column<Y>()[i] = p.y;
  state.agents.column<ImageX>()[i] = image_x;
  state.agents.column<ImageY>()[i] = image_y;
}

/// A change of the area v = A/D̄² at the pressure βP D̄², after the trial moves of a sweep.
void change_area(State& state, double& area, double pressure, std::uint64_t sweep) {
  auto const count = static_cast<double>(state.agents.size());
  auto const radii = state.agents.column<Radius>();
  RandomStream random(state.seed, sweep, state.agents.size(), Purpose::swap_trial);
  double const eta = 0.01 * (2.0 * random.uniform() - 1.0);
  double const ratio = (1.0 + eta) / (1.0 - eta);
  double const weight = std::exp((count + 1.0) * std::log(ratio) - pressure * area * (ratio - 1.0));
  if (!(std::exp(-random.exponential()) < weight)) return;
  std::vector<double> const before(radii.begin(), radii.end());
  for (double& radius : radii) radius *= 1.0 / std::sqrt(ratio);
  bool is_allowed = true;
  for (std::size_t i = 0; i < radii.size(); ++i)
    is_allowed = is_allowed && has_room(state, i, position(state.agents, i), radii[i], i);
  if (is_allowed) {
    area *= ratio;
  } else {
    std::ranges::copy(before, radii.begin());
  }
}

/// Both ways; what they made of the start is expected to be the same.
void expect_bits_of_the_rule(State const& start, double swap_fraction, double step_in_diameters, std::uint64_t sweeps,
                             std::optional<double> pressure = {}) {
  double diameters = 0.0;
  for (double const r : start.agents.column<Radius>()) diameters += 2.0 * r;
  double const mean = diameters / static_cast<double>(start.agents.size());
  double const longest = 0.5 * std::min(start.box.width(), start.box.height());
  double area = start.box.area() / (mean * mean);
  State expected = start;
  for (std::uint64_t sweep = 0; sweep < sweeps; ++sweep) {
    for (std::uint64_t trial = 0; trial < start.agents.size(); ++trial) {
      take_trial(expected, sweep, trial, swap_fraction, std::min(longest, mean * step_in_diameters));
    }
    if (pressure) change_area(expected, area, *pressure, sweep);
  }
  State state = start;
  SwapMonteCarlo swaps(
      {.sweeps = sweeps, .swap_fraction = swap_fraction, .step = step_in_diameters, .pressure = pressure}, state);
  swaps.advance(state);
  EXPECT_EQ(hash(state), hash(expected));
  EXPECT_NO_THROW(validate(state));
}

TEST(SwapMonteCarlo, HasTheBitsOfTheRuleWithALookAtAllDisks) {
  for (std::uint64_t seed = 1; seed <= 300; ++seed) {
    RandomStream random(seed, 0, 0, Purpose::start_velocity);
    reference::SceneSettings scene{.edge = random.below(2) == 0 ? Edge::wall : Edge::periodic,
                                   .width = 0.5 + 2.0 * random.uniform(),
                                   .height = 0.5 + 2.0 * random.uniform(),
                                   .count = random.below(2) == 0 ? 1 + random.below(12) : 20 + random.below(100),
                                   .packing_fraction = 0.05 + 0.7 * random.uniform(),
                                   .smallest_ratio = random.below(3) == 0 ? 1.0 : 0.1 + 0.9 * random.uniform(),
                                   .seed = seed};
    double const swap_fraction = random.below(4) == 0 ? 0.0 : 0.9 * random.uniform();
    double const step = 0.02 + (random.below(3) == 0 ? 5.0 : 0.5) * random.uniform();
    if (random.below(2) == 0) scene.edge_y = random.below(2) == 0 ? Edge::wall : Edge::periodic;
    State const start = random_scene(scene);
    std::optional<double> pressure;
    if (random.below(2) == 0) pressure = 20.0 * random.uniform();
    expect_bits_of_the_rule(start, swap_fraction, step, 6, pressure);
    ASSERT_FALSE(HasFailure()) << scene << ", step " << step << ", swaps " << swap_fraction;
  }
}

TEST(SwapMonteCarlo, HasTheBitsOfTheRuleWhereManySmallDisksShareACell) {
  DisksSettings const disks{.count = 500,
                            .packing_fraction = 0.5,
                            .start = StartKind::random,
                            .species = {{.fraction = 0.95, .size_ratio = 0.2}, {.fraction = 0.05}}};
  for (Edge const edge : {Edge::wall, Edge::periodic}) {
    expect_bits_of_the_rule(make_start(Box(1.25, 0.8, edge), disks, 7), 0.1, 0.5, 20);
  }
}

// Boxes so narrow that the cells on the left and on the right are the same.
TEST(SwapMonteCarlo, HasTheBitsOfTheRuleInBoxesOfOneToThreeCells) {
  for (double const width : {0.45, 0.65, 0.9, 1.3, 1.7}) {
    State state{.box = Box(width, 0.5, Edge::periodic), .seed = 5};
    state.agents.add(0.1, 0.1, 0.0, 0.0, 0.14, 1.0, 0, 0);
    state.agents.add(0.3, 0.35, 0.0, 0.0, 0.12, 1.0, 0, 0);
    expect_bits_of_the_rule(state, 0.3, 0.5, 200);
  }
}

}  // namespace
}  // namespace gridlock
