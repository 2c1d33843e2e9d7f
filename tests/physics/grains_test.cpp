// Grains in the exact engine against exact statements and against an independent program. Units: σ = m = kT = 1.
//
// Haff's law with its prefactor and the numbers behind it, fixed disks as cages and as a Lorentz gas, and the weight of a
// gas on its floor. Numbers that are not derived were computed once by a short program that shares no code with this one.

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "gridlock/core/error.hpp"
#include "gridlock/engine/engine.hpp"
#include "gridlock/lattice/start.hpp"
#include "reference/mean_and_error.hpp"
#include "reference/random_scene.hpp"
#include "reference/unwrapped.hpp"

namespace gridlock {
namespace {

using reference::mean_of;
using reference::unwrapped;

constexpr double pi = std::numbers::pi;
constexpr double fixed_mass = std::numeric_limits<double>::infinity();

/// 256 disks at kT = 1 in a periodic square, as after many elastic collisions.
State equilibrium(double packing_fraction, std::uint64_t seed, std::size_t count = 256) {
  double const side = std::sqrt(static_cast<double>(count) * pi / 4.0 / packing_fraction);
  State state =
      make_start(Box(side, side, Edge::periodic), {.count = count, .packing_fraction = packing_fraction}, seed);
  draw_velocities(state, {.kind = VelocityKind::maxwell, .max = 2.0});
  Counters counters;
  make_engine({.kind = "exact", .threads = 1}, state)->advance(state, counters, {.pair_collisions = 20 * count});
  double const temperature = kinetic_energy(state.agents) / static_cast<double>(count - 1);
  for (double& v : state.agents.column<VelocityX>()) v /= std::sqrt(temperature);
  for (double& v : state.agents.column<VelocityY>()) v /= std::sqrt(temperature);
  state.clock = {};
  return state;
}

TEST(InelasticGas, CoolsByHaffsLawWithItsPrefactor) {
  // 1/t₀ = (1 − e²) ω₀/4 with the measured ω₀ = 0.5325 at φ = 0.1; after τ collisions a disk T = exp(−(1 − e²) τ/2),
  // both but for what the independent program found: T/T_Haff = 1.022(4) and 0.993(1) of the exponent.
  double const e = 0.95;
  double const losses = 1.0 - e * e;
  std::vector<double> over_haff;
  std::vector<double> exponent;
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    State state = equilibrium(0.1, seed);
    Counters counters;
    make_engine({.kind = "exact", .threads = 1, .collisions = {.restitution = e}}, state)
        ->advance(state, counters, {.pair_collisions = 100 * 256 / 2});
    double const temperature = kinetic_energy(state.agents) / 255.0;
    double const haff = 1.0 / std::pow(1.0 + losses * 0.5325 / 4.0 * state.clock.time, 2);
    over_haff.push_back(temperature / haff);
    exponent.push_back(std::log(temperature) / (-losses * 100.0 / 2.0));
  }
  EXPECT_NEAR(mean_of(over_haff).value, 1.022, 0.02);
  EXPECT_NEAR(mean_of(exponent).value, 0.993, 0.006);
}

TEST(InelasticCollapse, EndsARunUnlessContactsLast) {
  State state = equilibrium(0.5, 1);
  State with_contacts = state;
  StopCondition const many{.pair_collisions = 300 * 256 / 2};
  EngineSettings settings{.kind = "exact", .threads = 1, .collisions = {.restitution = 0.2}};
  Counters counters;
  std::string message;
  try {
    make_engine(settings, state)->advance(state, counters, {.time = 1e4});
  } catch (RunFailure const& failure) {
    message = failure.what();
  }
  EXPECT_NE(message.find("inelastic collapse"), std::string::npos) << message;
  settings.collisions.contact_time = 1e-4;
  Counters more;
  auto const engine = make_engine(settings, with_contacts);
  engine->advance(with_contacts, more, many);
  EXPECT_EQ(more.pair_collisions, many.pair_collisions);
  std::vector<Count> const counts = engine->counts(with_contacts, more);
  EXPECT_EQ(counts.back().name, "elastic_contacts");
  EXPECT_GT(counts.back().value, 0U);
}

/// One disk of diameter 1 and speed 1 in a cage of fixed disks around the middle of the box.
State caged(std::vector<Vector> const& cage) {
  State state{.box = Box(6.0, 5.0, Edge::wall)};
  state.agents.add(3.0, 2.5, 0.6, 0.8, 0.5, 1.0, 0, 0);
  for (Vector const p : cage) state.agents.add(3.0 + p.x, 2.5 + p.y, 0.0, 0.0, 0.5, fixed_mass, 0, 0);
  return state;
}

TEST(CagedDisk, HitsAsOftenAsTheAreaOfItsCentreSays) {
  // The rate is v P/(π A), with the length P of the border and the area A of the places of the centre.
  auto const square = [](double a) {
    return std::vector<Vector>{{a / 2, a / 2}, {-a / 2, a / 2}, {a / 2, -a / 2}, {-a / 2, -a / 2}};
  };
  auto const hexagon = [](double a) {
    std::vector<Vector> cage;
    for (int k = 0; k < 6; ++k) cage.push_back({a * std::cos(pi * k / 3.0), a * std::sin(pi * k / 3.0)});
    return cage;
  };
  struct Cage {
    std::vector<Vector> disks;
    double rate;
  };
  for (auto const& [disks, rate] : {Cage{square(1.6), 4.9900427045}, Cage{square(1.8), 2.5545803217},
                                    Cage{hexagon(1.2), 3.2294945516}, Cage{hexagon(1.5), 1.3435925113}}) {
    State state = caged(disks);
    auto const engine = make_engine({.kind = "exact", .threads = 1}, state);
    std::vector<double> rates;
    Counters counters;
    for (int block = 1; block <= 20; ++block) {
      std::uint64_t const before = counters.pair_collisions;
      engine->advance(state, counters, {.time = 5000.0 * block});
      rates.push_back(static_cast<double>(counters.pair_collisions - before) / 5000.0);
    }
    auto const [mean, error] = mean_of(rates);
    EXPECT_LT(error, 0.003 * rate);
    EXPECT_NEAR(mean, rate, 4.0 * error);
    EXPECT_NEAR(kinetic_energy(state.agents), 0.5, 1e-10);
  }
}

TEST(LorentzGas, CollidesAtTheExactRateAndDiffusesAsComputed) {
  // Fixed disks and points that are nearly points: radii 1 − r and r, on a triangular lattice of spacing 2 + w.
  constexpr double r = 1e-7;
  struct Gas {
    double w;
    double rate;
    double diffusion;
  };
  for (auto const& [w, rate, diffusion] : {Gas{0.1, 2.951684, 0.0991}, Gas{0.3, 1.389196, 0.2483}}) {
    double const a = 2.0 + w;
    State state{.box = Box(14.0 * a, 8.0 * a * std::sqrt(3.0), Edge::periodic), .seed = 1};
    for (int row = 0; row < 16; ++row) {
      for (int column = 0; column < 14; ++column) {
        state.agents.add((column + (row % 2 == 0 ? 0.25 : 0.75)) * a, (row + 0.5) * a * std::sqrt(0.75), 0.0, 0.0,
                         1.0 - r, fixed_mass, 0, 0);
      }
    }
    std::size_t const fixed = state.agents.size();
    for (std::uint64_t n = 0; state.agents.size() < fixed + 4000; ++n) {
      RandomStream random = state.start_random(n);
      Vector const p = state.anywhere(random);
      bool is_free = true;
      for (std::size_t i = 0; i < fixed; ++i) {
        is_free &= squared_length(state.box.displacement(p, position(state.agents, i))) > 1.0;
      }
      double const angle = 2.0 * pi * random.uniform();
      if (is_free) state.agents.add(p.x, p.y, std::cos(angle), std::sin(angle), r, 1.0, 0, 0);
    }
    std::vector<Vector> begin;
    for (std::size_t i = fixed; i < state.agents.size(); ++i) begin.push_back(unwrapped(state, i));
    Counters counters;
    auto const engine = make_engine({.kind = "exact", .time_step = 1e6, .threads = 1}, state);
    std::array<std::vector<double>, 2> squares;
    for (std::size_t half = 0; half < 2; ++half) {
      engine->advance(state, counters, {.time = half == 0 ? 150.0 : 300.0});
      for (std::size_t i = fixed; i < state.agents.size(); ++i) {
        squares[half].push_back(squared_length(unwrapped(state, i) - begin[i - fixed]));
      }
    }
    std::vector<double> slopes;
    for (std::size_t i = 0; i < begin.size(); ++i) slopes.push_back((squares[1][i] - squares[0][i]) / 600.0);
    double const measured = static_cast<double>(counters.pair_collisions) / (4000.0 * 300.0);
    EXPECT_NEAR(measured, rate, 0.003 * rate);
    EXPECT_NEAR(mean_of(slopes).value, diffusion, 4.0 * mean_of(slopes).error) << "w " << w;
    EXPECT_LT(mean_of(slopes).error, 0.03 * diffusion);
  }
}

TEST(BouncingDisk, KeepsItsPeriodAndItsEnergy) {
  double const g = 0.7;
  double const height = 2.0;
  State state{.box = Box(3.0, 9.0, Edge::wall)};
  state.agents.add(1.0, 0.5 + height, 0.0, 0.0, 0.5, 2.0, 0, 0);
  Counters counters;
  auto const engine = make_engine({.kind = "exact", .gravity = {.y = -g}}, state);
  double const period = 2.0 * std::sqrt(2.0 * height / g);
  for (std::uint64_t bounces = 1; bounces <= 1000; ++bounces) {
    engine->advance(state, counters, {.time = static_cast<double>(bounces) * period});
    ASSERT_EQ(counters.wall_hits[Counters::bottom], bounces);
    ASSERT_NEAR(state.agents.column<Y>()[0], 0.5 + height, 1e-9 * static_cast<double>(bounces));
  }
}

TEST(GrainOnAFloor, LosesHeightByTheSquareOfItsRestitutionUntilContactsLast) {
  State state{.box = Box(3.0, 9.0, Edge::wall)};
  state.agents.add(1.0, 2.5, 0.0, 0.0, 0.5, 1.0, 0, 0);
  EngineSettings const settings{
      .kind = "exact", .collisions = {.wall_restitution = 0.8, .contact_time = 1e-3}, .gravity = {.y = -1.0}};
  auto const engine = make_engine(settings, state);
  Counters counters;
  double velocity = std::sqrt(2.0 * 2.0);
  double time = velocity;
  for (int bounce = 1; bounce <= 20; ++bounce) {
    velocity *= 0.8;
    engine->advance(state, counters, {.time = time + velocity});  // the top of the path
    EXPECT_NEAR(state.agents.column<Y>()[0], 0.5 + 0.5 * velocity * velocity, 1e-10);
    time += 2.0 * velocity;
  }
  engine->advance(state, counters, {.time = 100.0});
  EXPECT_LT(state.agents.column<Y>()[0], 0.5 + 1e-3 * 1e-3);
  EXPECT_GE(state.agents.column<Y>()[0], 0.5);
  EXPECT_GT(engine->counts(state, counters).back().value, 10'000U) << "elastic contacts";
}

TEST(FallingGas, WeighsOnItsFloorAllButItsChangeOfMomentum) {
  reference::SceneSettings const scene{.width = 6.0, .height = 30.0, .count = 60, .packing_fraction = 0.2};
  State state = reference::random_scene(scene);
  auto const momentum_y = [&] { return momentum(state.agents).y; };
  double const mass = static_cast<double>(state.agents.size());
  double const before = momentum_y();
  Counters counters;
  make_engine({.kind = "exact", .audit_every = 101, .gravity = {.y = -0.4}}, state)
      ->advance(state, counters, {.time = 400.0});
  EXPECT_GT(counters.pair_collisions, 10'000U);
  double const lid = counters.wall_impulse[Counters::top];
  double const floor = counters.wall_impulse[Counters::bottom];
  EXPECT_NEAR((floor - lid) / (mass * 0.4 * 400.0 + momentum_y() - before), 1.0, 1e-10);
}

TEST(FallingGas, HasTheHeightAndTheFloorPressureOfAnIndependentProgram) {
  // 200 disks, a periodic channel of width 15 and height 50, g = 0.2, all velocities drawn every 3 units of time:
  // pressure of the floor 2.670(4), of the lid 0.00455(12), mean height 13.453(11).
  State state =
      make_start(Box(15.0, 50.0, Edge::periodic, Edge::wall),
                 {.count = 200, .radius = 0.5, .start = StartKind::square, .region = {0.0, 0.0, 15.0, 25.0}}, 3);
  ThermostatSettings const thermostat{.kind = ThermostatKind::brownian, .temperature = 1.0, .interval = 3.0};
  auto const engine = make_engine(
      {.kind = "exact", .time_step = 3.0, .threads = 1, .thermostat = thermostat, .gravity = {.y = -0.2}}, state);
  Counters counters;
  engine->advance(state, counters, {.time = 600.0});
  std::vector<double> floors;
  std::vector<double> heights;
  Counters const begin = counters;
  for (int block = 1; block <= 20; ++block) {
    double const before = counters.wall_impulse[Counters::bottom];
    double height = 0.0;
    for (int sample = 1; sample <= 60; ++sample) {
      engine->advance(state, counters, {.time = 600.0 + 300.0 * (block - 1) + 5.0 * sample});
      for (double const y : state.agents.column<Y>()) height += y / (200.0 * 60.0);
    }
    floors.push_back((counters.wall_impulse[Counters::bottom] - before) / (300.0 * 15.0));
    heights.push_back(height);
  }
  EXPECT_NEAR(mean_of(floors).value, 2.670, 4.0 * std::hypot(mean_of(floors).error, 0.004));
  EXPECT_NEAR(mean_of(heights).value, 13.453, 4.0 * std::hypot(mean_of(heights).error, 0.011));
  EXPECT_LT(mean_of(heights).error, 0.2);
  EXPECT_LT(mean_of(floors).error, 0.04);
  double const lid = (counters.wall_impulse[Counters::top] - begin.wall_impulse[Counters::top]) / (6000.0 * 15.0);
  EXPECT_NEAR(lid, 0.00455, 0.002);
}

TEST(WallsInsideTheBox, MakeASmallerBoxOfALargerOne) {
  reference::SceneSettings const scene{.width = 1.3, .height = 0.9, .count = 12, .packing_fraction = 0.2};
  for (Vector const gravity : {Vector{}, Vector{0.3, -1.0}}) {
    State small = reference::random_scene(scene);
    State large{.box = Box(3.0, 2.0, Edge::wall), .seed = small.seed};
    Vector const corner{0.9, 0.7};
    for (std::size_t i = 0; i < small.agents.size(); ++i) {
      Vector const p = corner + position(small.agents, i);
      Vector const v = velocity(small.agents, i);
      large.agents.add(p.x, p.y, v.x, v.y, small.agents.column<Radius>()[i], 1.0, 0, 0);
    }
    GravitySettings const falls{.x = gravity.x, .y = gravity.y};
    std::vector<WallSettings> const walls{{.from = {0.9, 0.7}, .to = {2.2, 0.7}},
                                          {.from = {2.2, 0.7}, .to = {2.2, 1.6}},
                                          {.from = {2.2, 1.6}, .to = {0.9, 1.6}},
                                          {.from = {0.9, 1.6}, .to = {0.9, 0.7}}};
    Counters of_small;
    Counters of_large;
    make_engine({.kind = "exact", .gravity = falls}, small)->advance(small, of_small, {.time = 0.8});
    make_engine({.kind = "exact", .gravity = falls, .walls = walls}, large)->advance(large, of_large, {.time = 0.8});
    EXPECT_EQ(of_large.inner_wall_hits, of_small.all_wall_hits());
    EXPECT_EQ(of_large.pair_collisions, of_small.pair_collisions);
    EXPECT_GT(of_small.pair_collisions, 10U);
    for (std::size_t i = 0; i < small.agents.size(); ++i) {
      Vector const d = position(large.agents, i) - position(small.agents, i) - corner;
      EXPECT_NEAR(d.x, 0.0, 1e-9);
      EXPECT_NEAR(d.y, 0.0, 1e-9);
    }
  }
}

TEST(WallsInsideTheBox, ScatterDisksAtTheirEndsAsPoints) {
  State state{.box = Box(4.0, 4.0, Edge::wall)};
  state.agents.add(0.6, 2.3, 1.0, 0.0, 0.5, 1.0, 0, 0);
  Counters counters;
  make_engine({.kind = "exact", .walls = {{.from = {2.0, 0.5}, .to = {2.0, 2.0}}}}, state)
      ->advance(state, counters, {.time = 1.5});
  // The centre passes 0.3 above the end and touches it 0.4 before: the normal is (−0.8, 0.6).
  EXPECT_EQ(counters.inner_wall_hits, 1U);
  EXPECT_NEAR(state.agents.column<VelocityX>()[0], 1.0 - 2.0 * 0.64, 1e-12);
  EXPECT_NEAR(state.agents.column<VelocityY>()[0], 2.0 * 0.48, 1e-12);
}

}  // namespace
}  // namespace gridlock
