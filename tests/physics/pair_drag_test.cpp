// Grains that lose energy in their contacts, against exact solutions of two disks.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include "gridlock/engine/engine.hpp"
#include "gridlock/lattice/start.hpp"
#include "observe/stress.hpp"

namespace gridlock {
namespace {

/// Two disks of σ = 1 and these masses on an oblique line through an edge of the box, at a distance and approaching
/// each other with a speed.
State two_disks(double mass, double other_mass, double distance, double speed) {
  State state{.box = Box(10.0, 10.0, Edge::periodic)};
  Vector const n{0.6, 0.8};
  Vector const middle{9.9, 5.0};
  for (int side : {-1, 1}) {
    double const m = side < 0 ? mass : other_mass;
    Vector const place = state.box.inside(middle + 0.5 * side * distance * n);
    Vector const v = -side * speed * (mass * other_mass / (mass + other_mass) / m) * n;
    state.agents.add(place.x, place.y, v.x, v.y, 0.5, m, 0, 0);
  }
  return state;
}

EngineSettings settings_of(double coefficient, double time_step, DragDirection direction = DragDirection::normal) {
  return {.kind = "soft",
          .time_step = time_step,
          .speed = 1.0,
          .threads = 1,
          .potential = {.kind = PairPotential::harmonic},
          .pair_drag = {.coefficient = coefficient, .direction = direction}};
}

double distance_of(State const& state) {
  return std::sqrt(squared_length(state.box.displacement(position(state.agents, 0), position(state.agents, 1))));
}

/// The oscillator of the reduced mass μ with the stiffness 1 and the drag k.
struct Oscillator {
  double reduced_mass;
  double drag;

  [[nodiscard]] double decay() const { return drag / (2.0 * reduced_mass); }
  [[nodiscard]] double damping() const { return drag / (2.0 * std::sqrt(reduced_mass)); }
  [[nodiscard]] double frequency() const { return std::sqrt(1.0 / reduced_mass - decay() * decay()); }
  /// The overlap after a time, from an overlap that grows with a speed.
  [[nodiscard]] double overlap(double start, double speed, double time) const {
    double const w = frequency();
    return std::exp(-decay() * time) *
           (start * std::cos(w * time) + (speed + decay() * start) / w * std::sin(w * time));
  }
};

TEST(PairDrag, OfTwoDisksInContactIsADampedOscillatorToTheSquareOfTheStep) {
  Oscillator const exact{.reduced_mass = 0.75, .drag = 0.3};
  double const time = 1.28;
  double const expected = exact.overlap(0.05, 0.1, time);
  ASSERT_GT(expected, 0.01);
  for (DragDirection const direction : {DragDirection::all, DragDirection::normal}) {
    std::vector<double> errors;
    for (double const step : {0.08, 0.04, 0.02}) {
      State state = two_disks(1.0, 3.0, 0.95, 0.1);
      Counters counters;
      make_engine(settings_of(exact.drag, step, direction), state)->advance(state, counters, {.time = time - 1e-9});
      ASSERT_NEAR(state.clock.time, time, 1e-9);
      errors.push_back(std::abs(1.0 - distance_of(state) - expected));
    }
    EXPECT_NEAR(errors[0] / errors[1], 4.0, 0.4);
    EXPECT_NEAR(errors[1] / errors[2], 4.0, 0.2);
    EXPECT_LT(errors[2], 2e-6);
  }
}

TEST(PairDrag, GivesTheRestitutionOfASpringWithADashpot) {
  // From contact to contact, r = σ: e = exp(−π ζ/√(1 − ζ²)).
  for (double const drag : {0.1, 0.4, 0.8}) {
    Oscillator const exact{.reduced_mass = 0.5, .drag = drag};
    double const zeta = exact.damping();
    State state = two_disks(1.0, 1.0, 1.01, 0.05);
    auto const engine = make_engine(settings_of(drag, 0.002), state);
    Counters counters;
    engine->advance(state, counters, {.time = 5.0});
    ASSERT_GT(distance_of(state), 1.0);
    Vector const difference = velocity(state.agents, 1) - velocity(state.agents, 0);
    double const restitution = std::sqrt(squared_length(difference)) / 0.05;
    EXPECT_NEAR(restitution, std::exp(-std::numbers::pi * zeta / std::sqrt(1.0 - zeta * zeta)), 1e-3) << drag;
  }
}

/// The mean shear stress of 100 grains in a steady flow, contacts and motion.
double stress_at(double rate) {
  DisksSettings disks{.count = 100, .packing_fraction = {}, .radius = 0.5, .start = StartKind::uniform};
  disks.species = {{.fraction = 0.5}, {.fraction = 0.5, .size_ratio = 1.4}};
  double const side = std::sqrt(50.0 * 0.25 * std::numbers::pi * 2.96 / 0.82);
  State state = make_start(Box(side, side, Edge::periodic), disks, 1);
  std::ranges::fill(state.agents.column<VelocityX>(), 0.0);
  std::ranges::fill(state.agents.column<VelocityY>(), 0.0);
  EngineSettings settings = settings_of(0.5, 0.1, DragDirection::all);
  settings.flow.shear_rate = rate;
  auto const engine = make_engine(settings, state);
  Counters counters;
  engine->advance(state, counters, {.time = 2.0 / rate});
  Stress stress({.potential = settings.potential, .pair_drag = settings.pair_drag, .flow = settings.flow});
  std::vector<double> row(6);
  stress.begin(Snapshot(state, counters));
  double sum = 0.0;
  constexpr int samples = 100;
  for (int k = 0; k < samples; ++k) {
    engine->advance(state, counters, {.time = state.clock.time + 4.0 / rate / samples});
    stress.sample(Snapshot(state, counters), row, false);
    sum += row[3] / samples;
  }
  return sum;
}

TEST(PairDrag, InAFlowHasAStressThatGrowsWithTheRate) {
  // Below jamming grains with a drag of their own, without one against the flow, have a viscosity at low rates.
  double const slow = stress_at(0.003);
  double const fast = stress_at(0.03);
  EXPECT_GT(slow, 0.0);
  EXPECT_GT(fast, 3.0 * slow);
  EXPECT_LT(fast, 30.0 * slow);
}

}  // namespace
}  // namespace gridlock
