// The rule of the paper on systems small enough to follow by hand. Lengths and speeds are sums of few powers of two
// wherever the arithmetic is expected to be exact.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <string>

#include "engine/hot_disks.hpp"
#include "engine/turn.hpp"
#include "gridlock/core/error.hpp"
#include "gridlock/core/random.hpp"
#include "gridlock/engine/engine.hpp"
#include "gridlock/grid/validate.hpp"

namespace gridlock {
namespace {

struct DiskAt {
  Vector position;
  Vector velocity = {};
  double radius = 0.125;
  double mass = 1.0;
};

State make_state(Edge edge, std::initializer_list<DiskAt> disks, double width = 1.0, double height = 1.0) {
  State state{.box = Box(width, height, edge)};
  for (DiskAt const& d : disks) {
    state.agents.add(d.position.x, d.position.y, d.velocity.x, d.velocity.y, d.radius, d.mass, 0, 0);
  }
  return state;
}

/// With disks of radius 1/8 and speed 1: a step lasts 1/16, a sub-step 1/64.
EngineSettings exact_settings(CollisionRule contact = CollisionRule::always) {
  return {.time_step = 0.25, .substeps = 4, .contact = contact};
}
constexpr double substep = 1.0 / 64.0;

Counters advance(State& state, std::uint64_t steps, EngineSettings const& settings = exact_settings()) {
  Counters counters;
  make_engine(settings, state)->advance(state, counters, {.step = state.clock.step + steps});
  return counters;
}

// ---- the turn, step by step -------------------------------------------------------------------------------------

TEST(SteppedTurn, AFreeDiskMovesByItsVelocityTimesTheStep) {
  State state = make_state(Edge::wall, {{.position = {0.25, 0.5}, .velocity = {1.0, -0.5}}});
  Counters const counters = advance(state, 2);
  EXPECT_EQ(position(state.agents, 0), (Vector{0.25 + 8 * substep, 0.5 - 4 * substep}));
  EXPECT_EQ(velocity(state.agents, 0), (Vector{1.0, -0.5}));
  EXPECT_EQ(state.clock, (Clock{.step = 2, .time = 0.125}));
  EXPECT_EQ(counters.moves, 2U);
  EXPECT_EQ(counters.halted_moves, 0U);
  EXPECT_EQ(counters.distance_checks, 0U);
}

TEST(SteppedTurn, HaltingKeepsTheSubStepsMadeBefore) {
  // Three sub-steps of room, the fourth would overlap: the disk stays after three and its turn ends.
  State state = make_state(
      Edge::wall, {{.position = {0.25, 0.5}, .velocity = {1.0, 0.0}}, {.position = {0.5 + 3.5 * substep, 0.5}}});
  EngineSettings settings = exact_settings();
  settings.grid = GridKind::linked;
  Counters const counters = advance(state, 1, settings);
  EXPECT_EQ(position(state.agents, 0), (Vector{0.25 + 3 * substep, 0.5}));
  EXPECT_EQ(velocity(state.agents, 0), (Vector{0.0, 0.0}));
  EXPECT_EQ(velocity(state.agents, 1), (Vector{1.0, 0.0}));
  // Disk 1 takes its turn after it was hit, in the same step, already with its new velocity.
  EXPECT_EQ(position(state.agents, 1), (Vector{0.5 + 7.5 * substep, 0.5}));
  EXPECT_EQ(counters.halted_moves, 1U);
  EXPECT_EQ(counters.pair_collisions, 1U);
  EXPECT_EQ(counters.distance_checks, 8U) << "one candidate in each of four sub-steps of both";
}

TEST(SteppedTurn, TheLowerIdGoesFirst) {
  // Names against rows: the disk of the last row has the lowest Id and is the one that runs into the other.
  State state{.box = Box(1.0, 1.0, Edge::wall)};
  ASSERT_TRUE(state.agents.add_as(9, 0.5 + 0.5 * substep, 0.5, 0.0, 0.0, 0.125, 1.0, 0, 0));
  ASSERT_TRUE(state.agents.add_as(4, 0.25, 0.5, 1.0, 0.0, 0.125, 1.0, 0, 0));
  advance(state, 1);
  EXPECT_EQ(state.agents.column<X>()[0], 0.5 + 4.5 * substep) << "hit first, so its own turn carries it on";
  EXPECT_EQ(state.agents.column<X>()[1], 0.25);
}

TEST(SteppedTurn, TouchingIsNotOverlapping) {
  State state = make_state(Edge::wall,
                           {{.position = {0.25, 0.5}, .velocity = {1.0, 0.0}}, {.position = {0.5 + 4 * substep, 0.5}}});
  Counters const counters = advance(state, 1);
  EXPECT_EQ(position(state.agents, 0), (Vector{0.25 + 4 * substep, 0.5}));
  EXPECT_EQ(counters.halted_moves, 0U);
  EXPECT_NO_THROW(validate(state));
}

TEST(SteppedTurn, ScattersOffTheNearestOfTheOverlappedDisks) {
  // The first trial overlaps both: the small disk 2 straight ahead, its centre 0.148 away where 0.156 are needed, and
  // the large disk 1 at 45 degrees, its centre 0.240 away where 0.25 are needed.
  State state = make_state(Edge::wall, {{.position = {0.25, 0.5}, .velocity = {1.0, 0.0}},
                                        {.position = {0.25 + 0.1772, 0.5 + 0.1772}},
                                        {.position = {0.25 + 0.1640625, 0.5}, .radius = 0.03125}});
  ASSERT_NO_THROW(validate(state));
  advance(state, 1, {.time_step = 1.0, .substeps = 4});  // of the small disk's diameters: sub-steps of 1/64 again
  EXPECT_EQ(velocity(state.agents, 1), (Vector{0.0, 0.0}));
  EXPECT_EQ(velocity(state.agents, 2), (Vector{1.0, 0.0}));
  // The same without disk 2, so that disk 1 was overlapped indeed.
  State without = make_state(
      Edge::wall, {{.position = {0.25, 0.5}, .velocity = {1.0, 0.0}}, {.position = {0.25 + 0.1772, 0.5 + 0.1772}}});
  EXPECT_EQ(advance(without, 1).pair_collisions, 1U);
}

TEST(SteppedTurn, TiesGoToTheLowerIdInWhateverRowAndCellItIs) {
  // Two disks mirrored about the path: bitwise the same distance from every trial point.
  for (bool const lower_is_above : {false, true}) {
    for (std::uint64_t const cells : {1U, 2U, 4U}) {
      State state{.box = Box(1.0, 1.0, Edge::wall)};
      double const y = lower_is_above ? 0.125 : -0.125;
      double const x = 0.25 + 0.25;
      ASSERT_TRUE(state.agents.add_as(7, x, 0.5 - y, 0.0, 0.0, 0.125, 1.0, 0, 0));
      ASSERT_TRUE(state.agents.add_as(3, x, 0.5 + y, 0.0, 0.0, 0.125, 1.0, 0, 0));
      ASSERT_TRUE(state.agents.add_as(1, 0.25, 0.5, 1.0, 0.0, 0.125, 1.0, 0, 0));
      EngineSettings settings = exact_settings();
      settings.cells = cells;
      settings.grid = GridKind::linked;
      Counters const counters = advance(state, 1, settings);
      EXPECT_EQ(counters.pair_collisions, 1U);
      EXPECT_EQ(velocity(state.agents, state.agents.index_of(7)), (Vector{0.0, 0.0}));
      EXPECT_NE(velocity(state.agents, state.agents.index_of(3)), (Vector{0.0, 0.0}));
    }
  }
}

TEST(SteppedTurn, AWallComesBeforeADiskBehindIt) {
  // The trial crosses the right wall and overlaps disk 1: the wall halts it and no pair is scattered.
  State state =
      make_state(Edge::wall, {{.position = {0.875, 0.5}, .velocity = {1.0, 0.5}}, {.position = {0.875, 0.75}}});
  Counters const counters = advance(state, 1);
  EXPECT_EQ(velocity(state.agents, 0), (Vector{-1.0, 0.5}));
  EXPECT_EQ(position(state.agents, 0), (Vector{0.875, 0.5}));
  EXPECT_EQ(counters.pair_collisions, 0U);
  EXPECT_EQ(counters.all_wall_hits(), 1U);
}

// ---- walls --------------------------------------------------------------------------------------------------------

TEST(SteppedWalls, EveryWallTurnsItsOwnComponentBackAndTakesTwiceTheMomentum) {
  struct Hit {
    Counters::Wall wall;
    Vector position;
    Vector velocity;
    Vector reflected;
  };
  for (Hit const& hit : {Hit{Counters::left, {0.125, 0.5}, {-0.75, 0.25}, {0.75, 0.25}},
                         Hit{Counters::right, {0.875, 0.5}, {0.75, 0.25}, {-0.75, 0.25}},
                         Hit{Counters::bottom, {0.5, 0.125}, {0.25, -0.75}, {0.25, 0.75}},
                         Hit{Counters::top, {0.5, 0.875}, {0.25, 0.75}, {0.25, -0.75}}}) {
    State state = make_state(Edge::wall, {{.position = hit.position, .velocity = hit.velocity, .mass = 3.0}});
    Counters const counters = advance(state, 1);
    EXPECT_EQ(position(state.agents, 0), hit.position) << "halted before it moved, also along the wall";
    EXPECT_EQ(velocity(state.agents, 0), hit.reflected);
    EXPECT_EQ(counters.halted_moves, 1U);
    for (std::size_t wall = 0; wall < 4; ++wall) {
      EXPECT_EQ(counters.wall_hits[wall], wall == hit.wall ? 1U : 0U);
      EXPECT_EQ(counters.wall_impulse[wall], wall == hit.wall ? 2.0 * 3.0 * 0.75 : 0.0);
    }
  }
}

TEST(SteppedWalls, ACornerTurnsBothComponentsBackInOneTurn) {
  State state = make_state(Edge::wall, {{.position = {0.875, 0.875}, .velocity = {0.5, 0.75}}});
  Counters const counters = advance(state, 1);
  EXPECT_EQ(velocity(state.agents, 0), (Vector{-0.5, -0.75}));
  EXPECT_EQ(counters.halted_moves, 1U);
  EXPECT_EQ(counters.wall_hits, (std::array<std::uint64_t, 4>{0, 1, 0, 1}));
  EXPECT_EQ(counters.wall_impulse, (std::array<double, 4>{0.0, 1.0, 0.0, 1.5}));
}

TEST(SteppedWalls, OneDiskBetweenWallsRepeatsWithThePeriodOfTheRule) {
  // a = 1 − 2R = 3/4 is 48 sub-steps, 12 steps, exactly; touching the wall is allowed, so the thirteenth step is the
  // one that is blocked and turned back. Period 2·13 steps, against 2a/v = 24 in continuous time.
  State state = make_state(Edge::wall, {{.position = {0.125, 0.5}, .velocity = {1.0, 0.0}}});
  State const start = state;
  Counters counters;
  auto const engine = make_engine(exact_settings(), state);
  for (std::uint64_t period = 1; period <= 5; ++period) {
    engine->advance(state, counters, {.step = 26 * period - 13});
    EXPECT_EQ(position(state.agents, 0), (Vector{0.875, 0.5}));
    EXPECT_EQ(velocity(state.agents, 0), (Vector{-1.0, 0.0}));
    engine->advance(state, counters, {.step = 26 * period});
    EXPECT_EQ(position(state.agents, 0), position(start.agents, 0));
    EXPECT_EQ(velocity(state.agents, 0), velocity(start.agents, 0));
    EXPECT_EQ(counters.wall_hits, (std::array<std::uint64_t, 4>{period, period, 0, 0}));
    EXPECT_EQ(counters.wall_impulse[Counters::left], 2.0 * static_cast<double>(period));
  }
}

TEST(SteppedWalls, ThePeriodBetweenWallsTendsToTwiceTheWayOverTheSpeed) {
  // A crossing covers between a − δ and a, δ = one sub-step, and the hit loses at most one step:
  // (a − δ)/v ≤ half a period ≤ a/v + dt, so the hits in a time T lie between T/(a/v + dt) − 1 and T/((a − δ)/v) + 1.
  double const radius = 0.15;
  double const speed = 0.83;
  double const path = 1.0 - 2.0 * radius;
  double const time = 1000.0;
  for (double const time_step : {0.3, 0.1, 0.03}) {
    State state = make_state(Edge::wall, {{.position = {0.5, 0.5}, .velocity = {speed, 0.0}, .radius = radius}});
    auto const engine = make_engine({.time_step = time_step}, state);
    double const dt = engine->time_step();
    Counters counters;
    engine->advance(state, counters, {.time = time});
    auto const hits = static_cast<double>(counters.all_wall_hits());
    EXPECT_GE(hits, time / (path / speed + dt) - 1.0);
    EXPECT_LE(hits, (time + dt) / (path / speed - dt / 5.0) + 1.0);
  }
}

// ---- pairs --------------------------------------------------------------------------------------------------------

TEST(SteppedPairs, AHeadOnHitOfEqualDisksExchangesTheirVelocities) {
  State state = make_state(Edge::wall, {{.position = {0.25, 0.5}, .velocity = {1.0, 0.0}},
                                        {.position = {0.75, 0.5}, .velocity = {-0.5, 0.0}}});
  Counters counters;
  auto const engine = make_engine(exact_settings(), state);
  engine->advance(state, counters, {.pair_collisions = 1});
  EXPECT_EQ(counters.pair_collisions, 1U);
  EXPECT_EQ(velocity(state.agents, 0), (Vector{-0.5, 0.0}));
  EXPECT_EQ(velocity(state.agents, 1), (Vector{1.0, 0.0}));
}

TEST(SteppedPairs, AHeadOnHitOfUnequalDisksFollowsTheElasticRule) {
  // v₁' = (m₁ − m₂)/(m₁ + m₂) v, v₂' = 2m₁/(m₁ + m₂) v with the target at rest; here m₁ = 1, m₂ = 3.
  State state = make_state(
      Edge::wall, {{.position = {0.25, 0.5}, .velocity = {1.0, 0.0}}, {.position = {0.625, 0.5}, .mass = 3.0}});
  Counters counters;
  make_engine(exact_settings(), state)->advance(state, counters, {.pair_collisions = 1});
  EXPECT_DOUBLE_EQ(velocity(state.agents, 0).x, -0.5);
  EXPECT_DOUBLE_EQ(velocity(state.agents, 1).x, 0.5);
  EXPECT_EQ(velocity(state.agents, 0).y, 0.0);
}

TEST(SteppedPairs, AlwaysScattersAPairThatSeparatesAndApproachingLetsItGo) {
  // Disk 0 trails disk 1, which is faster; but disk 0 has its turn first and its trial overlaps the place disk 1 has
  // not left yet.
  auto const start = [] {
    return make_state(Edge::wall, {{.position = {0.25, 0.5}, .velocity = {0.5, 0.0}},
                                   {.position = {0.5, 0.5}, .velocity = {1.0, 0.0}}});
  };
  State always = start();
  Counters const scattered = advance(always, 1, exact_settings(CollisionRule::always));
  EXPECT_EQ(velocity(always.agents, 0), (Vector{1.0, 0.0})) << "the paper's rule makes it approach";
  EXPECT_EQ(velocity(always.agents, 1), (Vector{0.5, 0.0}));
  EXPECT_EQ(scattered.pair_collisions, 1U);
  EXPECT_LT(scattered.pair_virial, 0.0) << "a pull, not a push";

  State approaching = start();
  Counters const let_go = advance(approaching, 1, exact_settings(CollisionRule::approaching));
  EXPECT_EQ(velocity(approaching.agents, 0), (Vector{0.5, 0.0}));
  EXPECT_EQ(velocity(approaching.agents, 1), (Vector{1.0, 0.0}));
  EXPECT_EQ(let_go.pair_collisions, 0U);
  EXPECT_EQ(let_go.pair_virial, 0.0);

  EXPECT_EQ(scattered.halted_moves, 1U) << "halted under both rules";
  EXPECT_EQ(let_go.halted_moves, 1U);
  EXPECT_EQ(position(always.agents, 0), position(approaching.agents, 0));
}

TEST(SteppedPairs, BothContactRulesAgreeOnAPairThatApproaches) {
  for (CollisionRule const contact : {CollisionRule::always, CollisionRule::approaching}) {
    State state = make_state(Edge::wall, {{.position = {0.25, 0.5}, .velocity = {1.0, 0.0}}, {.position = {0.5, 0.5}}});
    Counters const counters = advance(state, 1, exact_settings(contact));
    EXPECT_EQ(velocity(state.agents, 1), (Vector{1.0, 0.0}));
    EXPECT_EQ(counters.pair_collisions, 1U);
    // σ m |v_n| = 1/4 for two equal disks in contact.
    EXPECT_EQ(counters.pair_virial, 0.25);
  }
}

TEST(SteppedPairs, ScatteringAtAnImpactParameterLiesWithinTheSubStepOfTheExactResult) {
  // The exact result (physics reference, section 6): with j at rest and impact parameter σ sin α, j leaves along
  // n = (r_j − r_i)/σ with v cos α and i at right angles with v sin α. The rule scatters along b at the halt instead,
  // where σ ≤ |b| < σ + δ, δ = one sub-step, and the impact parameter is still p = σ sin α. So the sine of its angle
  // lies in (p/(σ + δ), p/σ].
  double const radius = 0.05;
  double const sigma = 2.0 * radius;
  for (double const sine : {0.0, 0.1, 0.3, 0.5, 0.7, 0.9, 0.99, -0.3, -0.9}) {
    for (double const time_step : {0.5, 0.1, 0.01, 0.001}) {
      double const p = sigma * sine;
      State state = make_state(Edge::wall, {{.position = {0.2, 0.5}, .velocity = {1.0, 0.0}, .radius = radius},
                                            {.position = {0.45, 0.5 + p}, .radius = radius}});
      auto const engine = make_engine({.time_step = time_step}, state);
      Counters counters;
      engine->advance(state, counters, {.time = 1.0, .pair_collisions = 1});
      ASSERT_EQ(counters.pair_collisions, 1U);
      double const delta = engine->time_step() / 5.0;
      Vector const vi = velocity(state.agents, 0);
      Vector const vj = velocity(state.agents, 1);
      double const speed_i = std::sqrt(squared_length(vi));
      double const speed_j = std::sqrt(squared_length(vj));
      double const rounding = 1e-15;
      EXPECT_LE(speed_i, std::abs(sine) + rounding);
      EXPECT_GE(speed_i, std::abs(p) / (sigma + delta) - rounding);
      EXPECT_GE(speed_j, std::sqrt(1.0 - sine * sine) - rounding);
      EXPECT_LE(speed_j, std::sqrt(1.0 - p * p / ((sigma + delta) * (sigma + delta))) + rounding);
      // j leaves along the line of centres, i at right angles to it, and both as the impact parameter says.
      EXPECT_NEAR(dot(vi, vj), 0.0, rounding);
      EXPECT_NEAR(vj.y, speed_j * std::copysign(speed_i, sine), rounding);
      // Conservation to rounding whatever the time step.
      EXPECT_NEAR(vi.x + vj.x, 1.0, rounding);
      EXPECT_NEAR(vi.y + vj.y, 0.0, rounding);
      EXPECT_NEAR(squared_length(vi) + squared_length(vj), 1.0, rounding);
    }
  }
}

TEST(SteppedPairs, AMissedDiskIsNotTouched) {
  double const radius = 0.05;
  State state = make_state(Edge::wall, {{.position = {0.2, 0.5}, .velocity = {1.0, 0.0}, .radius = radius},
                                        {.position = {0.45, 0.5 + 2.0 * radius + 1e-9}, .radius = radius}});
  Counters counters;
  make_engine({.time_step = 0.01}, state)->advance(state, counters, {.time = 0.6});
  EXPECT_EQ(counters.pair_collisions, 0U);
  EXPECT_EQ(velocity(state.agents, 0), (Vector{1.0, 0.0}));
}

TEST(SteppedPairs, CollideAcrossTheEdgeOfAPeriodicBox) {
  State state =
      make_state(Edge::periodic, {{.position = {0.9375, 0.5}, .velocity = {1.0, 0.0}}, {.position = {0.25, 0.5}}});
  Counters counters;
  make_engine(exact_settings(), state)->advance(state, counters, {.pair_collisions = 1});
  EXPECT_EQ(position(state.agents, 0), (Vector{0.0, 0.5})) << "one side further on, in contact";
  EXPECT_EQ(state.agents.column<ImageX>()[0], 1);
  EXPECT_EQ(velocity(state.agents, 1), (Vector{1.0, 0.0}));
  EXPECT_EQ(counters.pair_virial, 0.25);
}

TEST(Scatter, ReversesTheNormalPartOfTheRelativeVelocityAndKeepsTheRest) {
  RandomStream random(5, 0, 0, Purpose::start_velocity);
  for (int n = 0; n < 20000; ++n) {
    State state{.box = Box(1.0, 1.0, n % 2 == 0 ? Edge::wall : Edge::periodic)};
    for (int disk = 0; disk < 2; ++disk) {
      Vector const v = random.in_unit_disk();
      state.agents.add(random.uniform(), random.uniform(), v.x, v.y, 0.01, 0.1 + 10.0 * random.uniform(), 0, 0);
    }
    double const m0 = state.agents.column<Mass>()[0];
    double const m1 = state.agents.column<Mass>()[1];
    Vector const b = state.box.displacement(position(state.agents, 0), position(state.agents, 1));
    Vector const w = velocity(state.agents, 0) - velocity(state.agents, 1);
    Vector const p = momentum(state.agents);
    double const energy = kinetic_energy(state.agents);
    Counters counters;
    HotDisks disks(state, rows_in_order(state.agents.ids()));
    collide(disks.view(state.box, {}, 0.1), 0, 1, counters);
    disks.write_back(state);
    Vector const after = velocity(state.agents, 0) - velocity(state.agents, 1);
    double const length = std::sqrt(squared_length(b));
    double const rounding = 1e-14;
    ASSERT_NEAR(dot(after, b) / length, -dot(w, b) / length, rounding);
    ASSERT_NEAR((after.x * b.y - after.y * b.x) / length, (w.x * b.y - w.y * b.x) / length, rounding);
    ASSERT_NEAR(momentum(state.agents).x, p.x, rounding * (m0 + m1));
    ASSERT_NEAR(momentum(state.agents).y, p.y, rounding * (m0 + m1));
    ASSERT_NEAR(kinetic_energy(state.agents), energy, rounding * (m0 + m1));
    // −b·Δp₀ = 2 (w·b) m₀m₁/(m₀ + m₁)
    ASSERT_NEAR(counters.pair_virial, 2.0 * dot(w, b) * m0 * m1 / (m0 + m1), 10.0 * rounding);
    ASSERT_EQ(counters.pair_collisions, 1U);
  }
}

// ---- periodic boxes -------------------------------------------------------------------------------------------------

TEST(SteppedPeriodic, APathIsUnwrappedByTheImagesCounted) {
  State state = make_state(Edge::periodic, {{.position = {0.25, 0.75}, .velocity = {1.0, -0.5}}});
  advance(state, 100);
  // 100 steps of 1/16: everything is a multiple of 1/128, so nothing rounds.
  EXPECT_EQ(state.agents.column<X>()[0] + state.agents.column<ImageX>()[0], 0.25 + 6.25);
  EXPECT_EQ(state.agents.column<Y>()[0] + state.agents.column<ImageY>()[0], 0.75 - 3.125);
  EXPECT_EQ(state.agents.column<ImageX>()[0], 6);
  EXPECT_EQ(state.agents.column<ImageY>()[0], -3);
}

// ---- the grid ---------------------------------------------------------------------------------------------------------

TEST(SteppedGridCutoff, AFastDiskSeesAsFarAsItMoves) {
  // One step carries disk 0 over a quarter of the box, four cells and more of k = 20: the 3×3 block would miss disk 1.
  for (std::uint64_t const cells : {0U, 1U, 3U, 10U, 20U, 100U}) {
    State state = make_state(Edge::wall, {{.position = {0.25, 0.5}, .velocity = {1.0, 0.0}, .radius = 0.03125},
                                          {.position = {0.46, 0.5}, .radius = 0.03125}});
    EngineSettings settings{.time_step = 4.0, .substeps = 5};
    if (cells > 0) {
      settings.cells = cells;
      settings.grid = GridKind::linked;
    }
    Counters const counters = advance(state, 1, settings);
    EXPECT_EQ(counters.pair_collisions, 1U) << cells << " cells a side, 0 for the packed grid";
    EXPECT_NO_THROW(validate(state));
  }
}

TEST(SteppedGridCutoff, ADiskThatBecameFastSeesFartherThanTheGridWasMadeFor) {
  // A heavy disk kicks a light one to nearly twice its speed; the light one must not miss the next in its way.
  auto const start = [] {
    return make_state(Edge::wall, {{.position = {0.2, 0.5}, .velocity = {1.0, 0.0}, .radius = 0.03, .mass = 1e6},
                                   {.position = {0.265, 0.5}, .radius = 0.03},
                                   {.position = {0.45, 0.5}, .radius = 0.03}});
  };
  EngineSettings settings{.time_step = 2.0, .substeps = 5};
  State coarse = start();
  State fine = start();
  settings.cells = 1;
  settings.grid = GridKind::linked;
  Counters const counters = advance(coarse, 3, settings);
  settings.cells.reset();
  settings.grid = GridKind::packed;
  advance(fine, 3, settings);
  EXPECT_GE(counters.pair_collisions, 2U);
  EXPECT_EQ(hash(coarse), hash(fine));
}

TEST(SteppedGridCutoff, ABoxChangedBetweenCallsGetsANewGrid) {
  // Cells of the old box would put the two disks, neighbours across the edge of the new box, far apart.
  State state = make_state(Edge::periodic, {{.position = {0.3, 0.5}, .velocity = {0.0, 1.0}, .radius = 0.02},
                                            {.position = {0.48, 0.2}, .velocity = {1.0, 0.0}, .radius = 0.02},
                                            {.position = {0.03, 0.2}, .radius = 0.02}});
  auto const engine = make_engine({.cells = 10}, state);
  Counters counters;
  engine->advance(state, counters, {.step = 1});
  ASSERT_EQ(counters.pair_collisions, 0U);
  state.box = Box(0.5, 1.0, Edge::periodic);
  ASSERT_NO_THROW(validate(state));
  engine->advance(state, counters, {.step = 20});
  EXPECT_EQ(counters.pair_collisions, 1U);
  EXPECT_NO_THROW(validate(state));
}

// ---- stop conditions --------------------------------------------------------------------------------------------------

TEST(SteppedStopCondition, StopsAtTheStepTheTimeOrTheCollisionsWhicheverComesFirst) {
  auto const start = [] {
    return make_state(Edge::wall, {{.position = {0.25, 0.5}, .velocity = {1.0, 0.0}}, {.position = {0.75, 0.5}}});
  };
  // A step lasts 1/16; the collision comes in step 5.
  auto const steps_to = [&](StopCondition const& stop_condition) {
    State state = start();
    Counters counters;
    make_engine(exact_settings(), state)->advance(state, counters, stop_condition);
    return state.clock.step;
  };
  EXPECT_EQ(steps_to({.step = 3}), 3U);
  EXPECT_EQ(steps_to({.time = 0.25}), 4U);
  EXPECT_EQ(steps_to({.time = 0.26}), 5U) << "the first whole step at or after the time";
  EXPECT_EQ(steps_to({.pair_collisions = 1}), 5U);
  EXPECT_EQ(steps_to({.step = 3, .time = 0.25, .pair_collisions = 1}), 3U);
  EXPECT_EQ(steps_to({.step = 30, .time = 0.25, .pair_collisions = 1}), 4U);
  EXPECT_EQ(steps_to({.step = 30, .time = 9.0, .pair_collisions = 1}), 5U);
  EXPECT_EQ(steps_to({.step = 0}), 0U);
  EXPECT_EQ(steps_to({.time = 0.0}), 0U);
  EXPECT_EQ(steps_to({.pair_collisions = 0}), 0U);
}

TEST(SteppedStopCondition, AStopConditionAlreadyMetChangesNothing) {
  State state = make_state(Edge::wall, {{.position = {0.25, 0.5}, .velocity = {1.0, 0.0}}});
  auto const engine = make_engine(exact_settings(), state);
  Counters counters;
  engine->advance(state, counters, {.step = 7});
  std::uint64_t const before = hash(state);
  engine->advance(state, counters, {.step = 7});
  engine->advance(state, counters, {.step = 3});
  engine->advance(state, counters, {.time = state.clock.time});
  EXPECT_EQ(hash(state), before);
  EXPECT_EQ(counters.moves, 7U);
}

// ---- set-ups ----------------------------------------------------------------------------------------------------------

TEST(StepDuration, IsTheTimeStepInDiametersOfTheSmallestDiskPerSpeed) {
  State const state =
      make_state(Edge::wall, {{.position = {0.25, 0.5}, .radius = 0.1}, {.position = {0.75, 0.5}, .radius = 0.2}});
  EXPECT_DOUBLE_EQ(step_duration({.time_step = 0.5}, state), 0.5 * 0.2);
  EXPECT_DOUBLE_EQ(step_duration({.time_step = 0.5, .speed = 4.0}, state), 0.5 * 0.2 / 4.0);
  EXPECT_DOUBLE_EQ(step_duration({.time_step = 0.5, .speed = 0.0}, state), 0.5 * 0.2);
  EXPECT_EQ(make_engine({.time_step = 0.5}, state)->time_step(), step_duration({.time_step = 0.5}, state));
}

TEST(MakeEngine, KnowsEveryKindItLists) {
  State const state = make_state(Edge::periodic, {{.position = {0.25, 0.5}}, {.position = {0.75, 0.5}}});
  auto const kinds = engine_kinds();
  EXPECT_NE(std::ranges::find(kinds, "stepped"), kinds.end());
  for (std::string const& kind : kinds) {
    EngineSettings settings;
    settings.kind = kind;
    EXPECT_NE(make_engine(settings, state), nullptr) << kind;
  }
}

void expect_refused(EngineSettings const& settings, State const& state, std::string const& key,
                    std::string const& words) {
  try {
    auto const engine = make_engine(settings, state);
    ADD_FAILURE() << "accepted, but expected: " << words;
  } catch (Error const& error) {
    EXPECT_EQ(error.problems().at(0).key, key);
    EXPECT_NE(error.problems().at(0).what.find(words), std::string::npos) << error.what();
    EXPECT_FALSE(error.problems().at(0).hint.empty());
  }
}

TEST(MakeEngine, RefusesWhatItCannotTreat) {
  State const state =
      make_state(Edge::wall, {{.position = {0.25, 0.5}, .velocity = {1.0, 0.0}}, {.position = {0.75, 0.5}}});
  EngineSettings unknown;
  unknown.kind = "steped";
  expect_refused(unknown, state, "engine.kind", "\"steped\"");
  for (double const bad : {0.0, -0.1, std::nan(""), std::numeric_limits<double>::infinity()}) {
    expect_refused({.time_step = bad}, state, "engine.time_step", "not a positive number");
  }
  expect_refused({.substeps = 0}, state, "engine.substeps", "0 sub-steps");
  expect_refused({.cells = 0}, state, "engine.cells", "0 × 0");
  expect_refused({.cells = 1'000'000}, state, "engine.cells", "1000000 × 1000000");
  expect_refused({}, make_state(Edge::wall, {}), "disks.count", "no disks");
}

TEST(MakeEngine, RefusesAStartInWhichASubStepCouldJumpOverADisk) {
  // Contact distance 1/4, time step in units of 1/4: at speed 1 and one sub-step the limit is a time step of 1.
  State const state =
      make_state(Edge::wall, {{.position = {0.25, 0.5}, .velocity = {1.0, 0.0}}, {.position = {0.75, 0.5}}});
  expect_refused({.time_step = 1.0, .substeps = 1}, state, "engine.time_step", "disk 0 covers 0.25 in one sub-step");
  EXPECT_NO_THROW(make_engine({.time_step = 0.99, .substeps = 1}, state));
  EXPECT_NO_THROW(make_engine({.time_step = 1.0, .substeps = 2}, state));
  // A small disk between large ones is the one that could be jumped over.
  State const mixture = make_state(
      Edge::wall, {{.position = {0.25, 0.5}, .velocity = {0.0, 5.1}}, {.position = {0.75, 0.5}, .radius = 0.03125}});
  expect_refused({.time_step = 0.5, .substeps = 1}, mixture, "engine.time_step", "at contact distance 0.15625");
}

TEST(MakeEngine, RefusesAPeriodicBoxInWhichTwoImagesCouldBeMet) {
  // σ = 1/4: the sides must hold two contact distances and two sub-steps of 1/64.
  std::initializer_list<DiskAt> const disks{{.position = {0.125, 0.125}, .velocity = {1.0, 0.0}},
                                            {.position = {0.125, 0.375}}};
  double const limit = 2.0 * (0.25 + substep);
  EXPECT_NO_THROW(make_engine(exact_settings(), make_state(Edge::periodic, disks, limit, 2.0)));
  EXPECT_NO_THROW(make_engine(exact_settings(), make_state(Edge::wall, disks, 0.5, 2.0)));
  expect_refused(exact_settings(), make_state(Edge::periodic, disks, 0.5, 2.0), "box", "is too small");
  EXPECT_NO_THROW(make_engine(exact_settings(), make_state(Edge::periodic, {{.position = {0.125, 0.125}}}, 0.25, 0.25)))
      << "a disk alone meets nobody";
}

TEST(SteppedFailure, ASubStepThatBecameTooLongStopsTheRunNamingStepDiskAndLengths) {
  // A heavy disk at 0.7 contact distances a sub-step kicks a light one to 1.4.
  State state = make_state(Edge::wall,
                           {{.position = {0.15, 0.5}, .velocity = {0.7, 0.0}, .mass = 1e6}, {.position = {0.5, 0.5}}});
  auto const engine = make_engine({.time_step = 1.0, .substeps = 1}, state);
  Counters counters;
  try {
    engine->advance(state, counters, {.step = 100});
    FAIL() << "the light disk jumped";
  } catch (RunFailure const& failure) {
    std::string const text = failure.what();
    EXPECT_NE(text.find("step 0: disk 1 covers 0.35 in one sub-step"), std::string::npos) << text;
    EXPECT_NE(text.find("0.25"), std::string::npos) << text;
    EXPECT_NE(text.find("hint: "), std::string::npos) << text;
  }
  EXPECT_NO_THROW(validate(state)) << "what is left is still a state that can be looked at";
}

TEST(SteppedFailure, AVelocityThatIsNotANumberStopsTheRun) {
  State state = make_state(Edge::wall, {{.position = {0.25, 0.5}}});
  auto const engine = make_engine({}, state);
  state.agents.column<VelocityX>()[0] = std::nan("");
  Counters counters;
  EXPECT_THROW(engine->advance(state, counters, {.step = 1}), RunFailure);
}

}  // namespace
}  // namespace gridlock
