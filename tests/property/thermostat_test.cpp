// Thermostats of the exact engine: kicks come when they are due, whatever else happens.

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <ostream>
#include <string>
#include <vector>

#include "gridlock/core/error.hpp"
#include "gridlock/core/random.hpp"
#include "gridlock/engine/engine.hpp"
#include "gridlock/grid/validate.hpp"
#include "reference/random_scene.hpp"
#include "reference/same_bits.hpp"

namespace gridlock {
namespace {

using reference::expect_same_bits_from_a_checkpoint;
using reference::expect_same_bits_however_cut;
using reference::expect_same_bits_of_shuffled_rows;
using reference::random_scene;
using reference::SceneSettings;

void fix(Disks& disks, std::size_t row) {
  disks.column<Mass>()[row] = std::numeric_limits<double>::infinity();
  disks.column<VelocityX>()[row] = 0.0;
  disks.column<VelocityY>()[row] = 0.0;
}

struct ThermostatCase {
  std::string name;
  ThermostatSettings thermostat;
  SceneSettings scene;
  PropulsionSettings propulsion = {};
  bool has_fixed = false;  ///< every fifth disk is fixed

  friend std::ostream& operator<<(std::ostream& out, ThermostatCase const& c) { return out << c.name; }
};

std::vector<ThermostatCase> cases() {
  SceneSettings const fluid{.width = 1.3, .count = 40, .packing_fraction = 0.5};
  SceneSettings const mixture{.edge = Edge::periodic,
                              .width = 1.6,
                              .height = 0.9,
                              .count = 40,
                              .packing_fraction = 0.5,
                              .smallest_ratio = 0.3,
                              .heaviest_mass = 9.0};
  SceneSettings const one{.edge = Edge::periodic, .width = 1.3, .count = 1, .packing_fraction = 0.05};
  auto const brownian = [](double interval) {
    return ThermostatSettings{.kind = ThermostatKind::brownian, .temperature = 0.7, .interval = interval};
  };
  ThermostatSettings const andersen{.kind = ThermostatKind::andersen, .temperature = 0.7, .rate = 15.0};
  return {{"brownian_often", brownian(0.003), fluid},
          {"brownian_seldom", brownian(0.9), fluid},
          {"brownian_mixture", brownian(0.01), mixture},
          {"brownian_one", brownian(0.05), one},
          {"active", brownian(0.02), fluid, {.speed = 2.0, .rotational_diffusion = 3.0}},
          {"active_mixture", brownian(0.01), mixture, {.speed = 2.0, .rotational_diffusion = 3.0}},
          {"active_fixed", brownian(0.02), fluid, {.speed = 2.0, .rotational_diffusion = 3.0}, true},
          {"brownian_fixed", brownian(0.02), fluid, {}, true},
          {"andersen_fixed", andersen, mixture, {}, true},
          {"andersen", andersen, fluid},
          {"andersen_mixture", andersen, mixture},
          {"andersen_one", andersen, one}};
}

class Thermostats : public testing::TestWithParam<ThermostatCase> {
 protected:
  static EngineSettings settings() {
    return {
        .kind = "exact", .audit_every = 7, .thermostat = GetParam().thermostat, .propulsion = GetParam().propulsion};
  }
  static State start(std::uint64_t seed) {
    SceneSettings scene = GetParam().scene;
    scene.seed = seed;
    State state = random_scene(scene);
    for (std::size_t i = 0; GetParam().has_fixed && i < state.agents.size(); i += 5) fix(state.agents, i);
    return state;
  }
};

INSTANTIATE_TEST_SUITE_P(Cases, Thermostats, testing::ValuesIn(cases()), [](auto const& c) { return c.param.name; });

TEST_P(Thermostats, KickAtTheSameTimesHoweverTheRunIsCut) {
  for (std::uint64_t const seed : {1U, 2U, 3U}) {
    State state = start(seed);
    double const energy = kinetic_energy(state.agents);
    expect_same_bits_however_cut(state, settings(), 60);
    EXPECT_NO_THROW(validate(state));
    EXPECT_NE(kinetic_energy(state.agents), energy);
  }
}

TEST_P(Thermostats, GoOnFromACheckpointWithTheSameBits) {
  expect_same_bits_from_a_checkpoint(start(5), settings(), 21, 50);
}

TEST_P(Thermostats, DependOnIdsAndNotOnRows) { expect_same_bits_of_shuffled_rows(start(6), settings(), 40); }

/// Disks on a lattice, enough of them for threads to share.
State crowd() {
  State state{.box = Box(110.0, 90.0, Edge::periodic), .seed = 3};
  for (std::uint64_t i = 0; i < 80 * 75; ++i) {
    state.agents.add((static_cast<double>(i % 80) + 0.5) * 110.0 / 80.0, (static_cast<double>(i / 80) + 0.5) * 1.2, 0.0,
                     0.0, 0.5, 1.0, 0, 0);
  }
  return state;
}

TEST(ThermostatOfManyDisks, HasTheBitsOfOneThreadOnAnyNumber) {
  for (double const interval : {0.05, 0.7, 30.0}) {
    ThermostatSettings const thermostat{.kind = ThermostatKind::brownian, .temperature = 1.0, .interval = interval};
    std::vector<std::uint64_t> hashes;
    for (std::uint64_t const threads : {1U, 2U, 3U}) {
      State state = crowd();
      Counters counters;
      make_engine({.kind = "exact", .audit_every = 20011, .threads = threads, .thermostat = thermostat}, state)
          ->advance(state, counters, {.time = 10.0});
      EXPECT_GT(counters.pair_collisions, state.agents.size());
      hashes.push_back(hash(state));
    }
    EXPECT_EQ(hashes[1], hashes[0]) << "interval " << interval;
    EXPECT_EQ(hashes[2], hashes[0]) << "interval " << interval;
  }
}

TEST(BrownianDisk, WithoutCollisionsIsARandomFlight) {
  double const interval = 0.03;
  double const temperature = 0.7;
  State state{.box = Box(3.0, 2.0, Edge::periodic), .seed = 9};
  state.agents.add(1.0, 1.0, 0.0, 0.0, 0.1, 2.5, 0, 0);
  Counters counters;
  ThermostatSettings const thermostat{
      .kind = ThermostatKind::brownian, .temperature = temperature, .interval = interval};
  auto const engine = make_engine({.kind = "exact", .thermostat = thermostat}, state);
  Vector place{1.0, 1.0};
  for (std::uint64_t kick = 0; kick < 500; ++kick) {
    RandomStream random(state.seed, kick, 0, Purpose::thermostat);
    double const width = std::sqrt(temperature / 2.5);
    Vector const v{width * random.normal(), width * random.normal()};
    double const end = static_cast<double>(kick + 1) * interval;
    engine->advance(state, counters, {.time = std::nextafter(end, 0.0)});
    EXPECT_EQ(velocity(state.agents, 0), v) << "kick " << kick;
    place = place + interval * v;
    Vector const unfolded{state.agents.column<X>()[0] + 3.0 * state.agents.column<ImageX>()[0],
                          state.agents.column<Y>()[0] + 2.0 * state.agents.column<ImageY>()[0]};
    EXPECT_NEAR(unfolded.x, place.x, 1e-12 * static_cast<double>(kick + 1));
    EXPECT_NEAR(unfolded.y, place.y, 1e-12 * static_cast<double>(kick + 1));
  }
}

TEST(KickedDisk, MovesBesideFixedDisksAsItWouldAlone) {
  // Far from the fixed disks, whose Ids are lower and higher, it meets none of them.
  for (ThermostatKind const kind : {ThermostatKind::brownian, ThermostatKind::andersen}) {
    bool const is_brownian = kind == ThermostatKind::brownian;
    EngineSettings const settings{.kind = "exact",
                                  .thermostat = {.kind = kind, .temperature = 0.01, .rate = 20.0, .interval = 0.05},
                                  .propulsion = {.speed = is_brownian ? 0.1 : 0.0, .rotational_diffusion = 2.0}};
    State alone{.box = Box(9.0, 7.0, Edge::periodic), .seed = 9};
    State beside = alone;
    ASSERT_TRUE(alone.agents.add_as(1, 4.0, 3.0, 0.06, 0.08, 0.1, 1.0, 0, 0));
    beside.agents.add(1.0, 0.5, 0.0, 0.0, 0.1, 1.0, 0, 0);
    beside.agents.add(4.0, 3.0, 0.06, 0.08, 0.1, 1.0, 0, 0);
    beside.agents.add(8.0, 6.0, 0.0, 0.0, 0.1, 1.0, 0, 0);
    fix(beside.agents, 0);
    fix(beside.agents, 2);
    Counters counters_alone;
    Counters counters_beside;
    auto const engine_alone = make_engine(settings, alone);
    auto const engine_beside = make_engine(settings, beside);
    for (int k = 1; k <= 20; ++k) {
      engine_alone->advance(alone, counters_alone, {.time = 0.27 * k});
      engine_beside->advance(beside, counters_beside, {.time = 0.27 * k});
      EXPECT_EQ(velocity(alone.agents, 0), velocity(beside.agents, 1));
      EXPECT_NEAR(alone.agents.column<X>()[0], beside.agents.column<X>()[1], 1e-12);
    }
    EXPECT_EQ(counters_beside.pair_collisions, 0U);
    EXPECT_NEAR(counters_alone.swum, counters_beside.swum, 1e-9);
    EXPECT_EQ(counters_alone.swum_if_free, counters_beside.swum_if_free);
  }
}

TEST(ThermostatSettings, FillInTheTemperatureOfTheStartAndAShortFlight) {
  State state{.box = Box(3.0, 2.0, Edge::periodic), .seed = 9};
  state.agents.add(1.0, 1.0, 3.0, 4.0, 0.1, 2.0, 0, 0);  // kinetic energy 25
  ThermostatSettings const brownian = resolved({.kind = ThermostatKind::brownian}, state);
  EXPECT_DOUBLE_EQ(brownian.temperature.value(), 25.0);
  EXPECT_DOUBLE_EQ(brownian.interval.value(), 0.05 * 0.2 * std::sqrt(2.0 / 25.0));
  EXPECT_FALSE(brownian.rate);
  BrownianScales const scales = brownian_scales(brownian, 2.0, 0.2);
  EXPECT_DOUBLE_EQ(scales.diffusion, 25.0 * *brownian.interval / 4.0);
  EXPECT_DOUBLE_EQ(scales.flight, 0.05);
  EXPECT_DOUBLE_EQ(scales.kicks_of_sigma2, 0.04 / scales.diffusion / *brownian.interval);
  ThermostatSettings const andersen = resolved({.kind = ThermostatKind::andersen}, state);
  EXPECT_DOUBLE_EQ(andersen.rate.value(), std::sqrt(12.5) / 0.2);
  EXPECT_DOUBLE_EQ(brownian_scales(andersen, 2.0, 0.2).diffusion, 12.5 / *andersen.rate);
}

TEST(ThermostatSettings, AreRefusedForDisksAtRestAndByEnginesWithATimeStep) {
  State state{.box = Box(3.0, 2.0, Edge::periodic), .seed = 9};
  state.agents.add(1.0, 1.0, 0.0, 0.0, 0.1, 2.0, 0, 0);
  auto const problem = [&](EngineSettings const& settings) -> std::string {
    try {
      make_engine(settings, state);
    } catch (Error const& error) {
      return error.problems().front().key + ": " + error.problems().front().what;
    }
    return "";
  };
  EXPECT_EQ(problem({.kind = "exact", .thermostat = {.kind = ThermostatKind::brownian}}),
            "thermostat.temperature: the disks rest at the start, so the temperature of the thermostat is not known");
  for (char const* kind : {"stepped", "tiled"}) {
    EXPECT_EQ(problem({.kind = kind, .thermostat = {.kind = ThermostatKind::andersen, .temperature = 1.0}}),
              std::string("thermostat.kind: the engine \"") + kind + "\" has no thermostat \"andersen\"");
  }
  EXPECT_EQ(problem({.kind = "exact", .thermostat = {.kind = ThermostatKind::brownian, .temperature = 1.0}}), "");
}

TEST(ThermostatSettings, AreRefusedWhereKicksComeTooOftenToBeCounted) {
  State state{.box = Box(3.0, 2.0, Edge::periodic), .seed = 9};
  state.agents.add(1.0, 1.0, 0.0, 0.0, 0.1, 1.0, 0, 0);
  auto const key_of_refusal = [&](ThermostatSettings const& settings) -> std::string {
    try {
      static_cast<void>(resolved(settings, state));
    } catch (Error const& error) {
      return error.problems().front().key;
    }
    return "";
  };
  ThermostatSettings const brownian{.kind = ThermostatKind::brownian, .temperature = 1.0, .interval = 1e-300};
  EXPECT_EQ(key_of_refusal(brownian), "thermostat.interval");
  EXPECT_EQ(key_of_refusal({.kind = ThermostatKind::andersen, .temperature = 1.0, .rate = 1e30}), "thermostat.rate");
  ThermostatSettings const usual{.kind = ThermostatKind::brownian, .temperature = 1.0, .interval = 1e-3};
  EXPECT_EQ(key_of_refusal(usual), "");
  state.clock.time = 1e15;
  EXPECT_EQ(key_of_refusal(usual), "thermostat.interval");
  state.clock.time = -5.0;
  EXPECT_EQ(key_of_refusal(usual), "");
}

}  // namespace
}  // namespace gridlock
