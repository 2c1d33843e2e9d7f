#include "observe/viscosity.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "core/temperature.hpp"
#include "gridlock/core/error.hpp"
#include "gridlock/engine/engine.hpp"
#include "gridlock/lattice/start.hpp"
#include "unit/observe/hand_built.hpp"

namespace gridlock {
namespace {

using hand_built::cell;
using hand_built::sample;

/// Disks of two sizes and masses, whose centre drifts.
State drifting_mixture() {
  State state =
      make_start(Box(7.0, 5.0, Edge::periodic),
                 {.count = 16,
                  .packing_fraction = 0.3,
                  .start = StartKind::random,
                  .species = {{.fraction = 0.5, .size_ratio = 1.0}, {.fraction = 0.5, .size_ratio = 1.4, .mass = 2.0}}},
                 3);
  hand_built::draw_maxwell(state, 1.0, 4);
  for (double& v : state.agents.column<VelocityX>()) v += 0.7;
  return state;
}

/// ∫ Σ m v_a v_b dt relative to the centre, and Σ J_a r_b, by following every disk from collision to collision.
class FollowedDisks {
 public:
  explicit FollowedDisks(State const& state) : time_(state.clock.time) {
    for (double const mass : state.agents.column<Mass>()) masses_.push_back(mass);
    for (std::size_t i = 0; i < masses_.size(); ++i) velocities_.push_back(velocity(state.agents, i));
  }
  void collide(PairCollision const& c) {
    fly(c.time);
    EXPECT_NEAR(squared_length(velocities_[c.i] - c.velocity_i), 0.0, 1e-24);
    EXPECT_NEAR(squared_length(velocities_[c.j] - c.velocity_j), 0.0, 1e-24);
    velocities_[c.i] = velocities_[c.i] - (1.0 / masses_[c.i]) * c.impulse;
    velocities_[c.j] = velocities_[c.j] + (1.0 / masses_[c.j]) * c.impulse;
    xx += c.impulse.x * c.separation.x;
    xy += c.impulse.x * c.separation.y;
    yy += c.impulse.y * c.separation.y;
    ++collisions;
  }
  void fly(double time) {
    Vector momentum{};
    double mass = 0.0;
    for (std::size_t i = 0; i < masses_.size(); ++i) {
      momentum = momentum + masses_[i] * velocities_[i];
      mass += masses_[i];
    }
    for (std::size_t i = 0; i < masses_.size(); ++i) {
      Vector const v = velocities_[i] - (1.0 / mass) * momentum;
      xx += (time - time_) * masses_[i] * v.x * v.x;
      xy += (time - time_) * masses_[i] * v.x * v.y;
      yy += (time - time_) * masses_[i] * v.y * v.y;
    }
    time_ = time;
  }
  double xx = 0.0;
  double xy = 0.0;
  double yy = 0.0;
  int collisions = 0;

 private:
  std::vector<double> masses_;
  std::vector<Vector> velocities_;
  double time_;
};

TEST(Viscosity, ItsStressesAndGrowthAreThoseOfDisksFollowedFromCollisionToCollision) {
  constexpr double interval = 0.4;
  constexpr std::size_t samples = 20;
  State state = drifting_mixture();
  Counters counters;
  Viscosity viscosity(3);
  viscosity.begin({state, counters});
  FollowedDisks followed(state);
  auto const engine = make_engine({.kind = "exact", .time_step = 1e6}, state);
  engine->report_collisions([&](PairCollision const& collision) {
    viscosity.collided(collision);
    followed.collide(collision);
  });
  double const scale = state.box.area() * interval;
  std::vector<double> shear{0.0}, unlike{0.0}, bulk{0.0};
  for (std::size_t k = 1; k <= samples; ++k) {
    engine->advance(state, counters, {.time = interval * static_cast<double>(k)});
    followed.fly(state.clock.time);
    auto const row = sample(viscosity, state, counters);
    double const xx = std::exchange(followed.xx, 0.0);
    double const xy = std::exchange(followed.xy, 0.0);
    double const yy = std::exchange(followed.yy, 0.0);
    EXPECT_NEAR(cell(viscosity, row, "stress_xx"), -xx / scale, 1e-12);
    EXPECT_NEAR(cell(viscosity, row, "stress_xy"), -xy / scale, 1e-12);
    EXPECT_NEAR(cell(viscosity, row, "stress_yy"), -yy / scale, 1e-12);
    shear.push_back(shear.back() + xy);
    unlike.push_back(unlike.back() + 0.5 * (xx - yy));
    bulk.push_back(bulk.back() + 0.5 * (xx + yy));
  }
  EXPECT_EQ(static_cast<std::uint64_t>(followed.collisions), counters.pair_collisions);
  EXPECT_GT(followed.collisions, 100);
  double const kt = *temperature(state);
  auto const growth = [&](std::vector<double> const& g, std::size_t lag) {
    double sum = 0.0;
    for (std::size_t k = 2 * lag; k < g.size(); ++k) sum += std::pow(g[k] - 2.0 * g[k - lag] + g[k - 2 * lag], 2);
    return sum / static_cast<double>(g.size() - 2 * lag) / (4.0 * state.box.area() * kt);
  };
  auto const correlation = [&](std::vector<double> const& g, std::size_t lag) {
    double sum = 0.0;
    for (std::size_t k = 2 * lag; k < g.size(); ++k) sum += (g[k] - g[k - 1]) * (g[k - lag] - g[k - lag - 1]);
    return sum / static_cast<double>(g.size() - 2 * lag) / (state.box.area() * kt * interval * interval);
  };
  auto const table = viscosity.distributions().at(0).columns_of_values;
  ASSERT_EQ(table[0].size(), 3U);
  for (std::size_t lag = 1; lag <= 3; ++lag) {
    EXPECT_NEAR(table[0][lag - 1], interval * static_cast<double>(lag), 1e-12);
    EXPECT_NEAR(table[1][lag - 1], 0.5 * (growth(shear, lag) + growth(unlike, lag)), 1e-12);
    EXPECT_NEAR(table[3][lag - 1], growth(bulk, lag), 1e-12);
    EXPECT_NEAR(table[5][lag - 1], 0.5 * (correlation(shear, lag) + correlation(unlike, lag)), 1e-12);
  }
}

TEST(Viscosity, OfStressesThatForgetEachOtherAtOnceIsTheirVarianceOverFourTimesTheAreaAndTemperature) {
  // Each interval of 0.5 has one impulse ±J along x and y at the distance 1, so that ΔG is ±J², and no two are alike.
  State state = hand_built::empty_state(Box(10.0, 10.0, Edge::periodic));
  hand_built::add_disk(state, {1.0, 1.0}, {1.0, 0.0});
  hand_built::add_disk(state, {3.0, 1.0}, {-1.0, 0.0});
  Viscosity viscosity(6);
  viscosity.begin({state, {}});
  for (std::uint64_t k = 1; k <= 20'000; ++k) {
    RandomStream random(1, 0, k, Purpose::start_velocity);
    double const strength = random.uniform() < 0.5 ? 3.0 : -3.0;
    // A moment without a change of the velocities: the motion of the two disks, of no shear along xy, stays.
    viscosity.collided({.time = state.clock.time,
                        .i = 0,
                        .j = 1,
                        .separation = {0.0, strength},
                        .velocity_i = {},
                        .velocity_j = {},
                        .mass_i = 1.0,
                        .mass_j = 1.0,
                        .impulse = {2.0, 0.0}});
    state.clock.time += 0.5;
    sample(viscosity, state);
  }
  // G_xy grows by half of ±6 as a symmetric tensor, (G_xx − G_yy)/2 evenly: η is a half of 9 / (2 · 0.5 · A kT).
  auto const eta = hand_built::result(viscosity, "shear_viscosity");
  ASSERT_TRUE(eta && eta->error);
  double const expected = 0.5 * 9.0 / (2.0 * 0.5 * 100.0 * 1.0);
  EXPECT_LT(*eta->error, 0.05 * expected);
  EXPECT_NEAR(eta->value, expected, 4.0 * *eta->error);
}

TEST(Viscosity, RefusesWallsAndFixedDisks) {
  State walled = hand_built::ideal_gas(Box(3.0, 2.0, Edge::wall), 4, 0.1, 1);
  State fixed = hand_built::ideal_gas(Box(3.0, 2.0, Edge::periodic), 4, 0.1, 1);
  fixed.agents.column<Mass>()[0] = std::numeric_limits<double>::infinity();
  EXPECT_THROW(Viscosity(4).begin({walled, {}}), Error);
  EXPECT_THROW(Viscosity(4).begin({fixed, {}}), Error);
}

}  // namespace
}  // namespace gridlock
