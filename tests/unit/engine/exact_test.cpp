#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>

#include "engine/exact/dynamics.hpp"
#include "gridlock/core/error.hpp"
#include "gridlock/engine/engine.hpp"
#include "gridlock/grid/validate.hpp"
#include "io/checkpoint.hpp"
#include "reference/hard_engines.hpp"
#include "reference/random_scene.hpp"

namespace gridlock {
namespace {

constexpr double forever = 1e6;

EngineSettings audited_settings() { return {.kind = "exact", .audit_every = 1}; }

/// Disks of radius 0.1 and mass 1 in a box.
class Scene {
 public:
  explicit Scene(Edge edge, double width = 1.0, double height = 1.0) { state.box = Box(width, height, edge); }
  Scene& add(double x, double y, double vx, double vy, double radius = 0.1, double mass = 1.0) {
    state.agents.add(x, y, vx, vy, radius, mass, 0, 0);
    return *this;
  }
  Scene& run(StopCondition const& stop_condition) {
    if (!engine) engine = make_engine(audited_settings(), state);
    engine->advance(state, counters, stop_condition);
    return *this;
  }
  [[nodiscard]] Vector place(std::size_t i) const { return position(state.agents, i); }
  [[nodiscard]] Vector speed(std::size_t i) const { return velocity(state.agents, i); }

  State state;
  Counters counters;
  std::unique_ptr<Engine> engine;
};

std::string error_of(State const& state) {
  try {
    make_engine(audited_settings(), state);
  } catch (Error const& error) {
    return error.what();
  }
  return "";
}

TEST(ExactEngine, OneDiskBetweenWallsRepeatsAfterTwiceItsFreeLength) {
  Scene scene(Edge::wall);
  scene.add(0.3, 0.6, 0.7, 0.0);
  double const period = 2.0 * (1.0 - 0.2) / 0.7;
  scene.run({.time = 5.0 * period});
  EXPECT_NEAR(scene.place(0).x, 0.3, 1e-13);
  EXPECT_EQ(scene.place(0).y, 0.6);
  EXPECT_EQ(scene.speed(0), (Vector{0.7, 0.0}));
  EXPECT_EQ(scene.counters.wall_hits, (std::array<std::uint64_t, 4>{5, 5, 0, 0}));
  EXPECT_NEAR(scene.counters.wall_impulse[Counters::left], 5 * 2 * 0.7, 1e-13);
  EXPECT_EQ(scene.counters.pair_collisions, 0U);
}

TEST(ExactEngine, OneDiskInAPeriodicBoxCountsItsImages) {
  Scene scene(Edge::periodic);
  scene.add(0.3, 0.6, 0.75, -0.25);
  scene.run({.time = 10.0});
  EXPECT_NEAR(scene.place(0).x, 0.8, 1e-13);
  EXPECT_NEAR(scene.place(0).y, 0.1, 1e-13);
  EXPECT_EQ(scene.state.agents.column<ImageX>()[0], 7);
  EXPECT_EQ(scene.state.agents.column<ImageY>()[0], -2);
}

TEST(ExactEngine, EqualDisksHeadOnSwapTheirVelocitiesAcrossThePeriodicEdge) {
  Scene scene(Edge::periodic);
  scene.add(0.2, 0.5, -1.0, 0.25).add(0.8, 0.5, 0.5, 0.25);
  scene.run({.pair_collisions = 1});
  EXPECT_NEAR(scene.state.clock.time, 0.2 / 1.5, 1e-15);
  EXPECT_NEAR(scene.speed(0).x, 0.5, 1e-15);
  EXPECT_NEAR(scene.speed(1).x, -1.0, 1e-15);
  EXPECT_EQ(scene.speed(0).y, 0.25);
}

TEST(ExactEngine, DisksApproachingThroughTheMiddleMeetThere) {
  Scene scene(Edge::wall);
  scene.add(0.2, 0.5, 1.0, 0.0).add(0.8, 0.5, -0.5, 0.0);
  scene.run({.pair_collisions = 1});
  EXPECT_NEAR(scene.state.clock.time, 0.4 / 1.5, 1e-15);
  EXPECT_NEAR(scene.speed(0).x, -0.5, 1e-15);
  EXPECT_NEAR(scene.speed(1).x, 1.0, 1e-15);
  // Σ σ m |v_n| with σ = 0.2 and v_n = 1.5.
  EXPECT_NEAR(scene.counters.pair_virial, 0.2 * 1.5, 1e-15);
}

// The target leaves along the line of centres with v cos α, the other at a right angle with v sin α, where the impact
// parameter is σ sin α.
TEST(ExactEngine, ObliqueCollisionsFollowTheImpactParameter) {
  for (double const impact : {0.0, 0.05, 0.1, 0.15, 0.19}) {
    double const sine = impact / 0.2;
    double const cosine = std::sqrt(1.0 - sine * sine);
    Scene scene(Edge::wall, 10.0, 10.0);
    scene.add(2.0, 5.0, 1.0, 0.0).add(5.0, 5.0 + impact, 0.0, 0.0);
    scene.run({.pair_collisions = 1});
    EXPECT_NEAR(scene.state.clock.time, 3.0 - 0.2 * cosine, 1e-13);
    EXPECT_NEAR(scene.speed(1).x, cosine * cosine, 1e-12);
    EXPECT_NEAR(scene.speed(1).y, cosine * sine, 1e-12);
    EXPECT_NEAR(scene.speed(0).x, sine * sine, 1e-12);
    EXPECT_NEAR(scene.speed(0).y, -sine * cosine, 1e-12);
  }
}

TEST(ExactEngine, UnequalMassesExchangeMomentumInTheFrameOfTheirCentre) {
  Scene scene(Edge::wall, 10.0, 10.0);
  scene.add(2.0, 5.0, 1.0, 0.0, 0.1, 3.0).add(5.0, 5.0, 0.0, 0.0, 0.3, 1.0);
  scene.run({.pair_collisions = 1});
  EXPECT_NEAR(scene.state.clock.time, 3.0 - 0.4, 1e-13);
  EXPECT_NEAR(scene.speed(0).x, 0.5, 1e-13);  // (m₁ − m₂)/(m₁ + m₂)
  EXPECT_NEAR(scene.speed(1).x, 1.5, 1e-13);  // 2 m₁/(m₁ + m₂)
}

// Centres of a row of disks of one height behave as sorted free points on a line shorter by all diameters.
TEST(ExactEngine, ARowOfDisksWithOneMoverRepeatsAfterTwiceTheFreeLength) {
  Scene scene(Edge::wall);
  scene.add(0.15, 0.5, 0.0, 0.0).add(0.4, 0.5, 0.8, 0.0).add(0.7, 0.5, 0.0, 0.0);
  scene.run({.time = 2.0 * (1.0 - 3 * 0.2) / 0.8});
  EXPECT_NEAR(scene.place(0).x, 0.15, 1e-13);
  EXPECT_NEAR(scene.place(1).x, 0.4, 1e-13);
  EXPECT_NEAR(scene.place(2).x, 0.7, 1e-13);
  EXPECT_NEAR(scene.speed(1).x, 0.8, 1e-13);
  EXPECT_EQ(scene.counters.pair_collisions, 4U);
}

TEST(ExactEngine, ACradleInContactPassesItsMotionOnAtOnce) {
  Scene scene(Edge::wall, 2.0, 1.0);
  scene.add(0.25, 0.5, 1.0, 0.0, 0.125);
  for (int n = 0; n < 4; ++n) scene.add(0.75 + 0.25 * n, 0.5, 0.0, 0.0, 0.125);  // touching, exactly
  scene.run({.time = 0.5});
  EXPECT_EQ(scene.counters.pair_collisions, 4U);
  for (std::size_t i = 0; i < 4; ++i) EXPECT_EQ(scene.speed(i).x, 0.0);
  EXPECT_EQ(scene.speed(4).x, 1.0);
  EXPECT_NEAR(scene.place(4).x, 1.5 + 0.25, 1e-15);
}

TEST(ExactEngine, DisksTouchingWallsBounceAtOnce) {
  Scene scene(Edge::wall);
  scene.add(0.1, 0.1, -1.0, -0.5).add(0.9, 0.9, 1.0, 0.0);
  scene.run({.time = 0.25});
  EXPECT_EQ(scene.counters.wall_hits, (std::array<std::uint64_t, 4>{1, 1, 1, 0}));
  EXPECT_NEAR(scene.place(0).x, 0.35, 1e-15);
  EXPECT_NEAR(scene.place(0).y, 0.225, 1e-15);
  EXPECT_EQ(scene.speed(1), (Vector{-1.0, 0.0}));
}

TEST(ExactEngine, ADiskAsWideAsTheBoxStaysInTouchWithBothWalls) {
  Scene scene(Edge::wall, 2.0, 0.2);
  scene.add(0.5, 0.1, 1.0, 0.0);
  scene.run({.time = 10.0});
  EXPECT_EQ(scene.place(0).y, 0.1);
  EXPECT_GT(scene.counters.wall_hits[Counters::right], 2U);
}

TEST(ExactEngine, AtRestNothingHappensButTimePasses) {
  Scene scene(Edge::wall);
  scene.add(0.3, 0.5, 0.0, 0.0).add(0.5, 0.5, 0.0, 0.0);
  scene.run({.step = 10});
  EXPECT_EQ(scene.state.clock.step, 10U);
  EXPECT_EQ(scene.counters.moves, 0U);
  EXPECT_EQ(scene.place(0), (Vector{0.3, 0.5}));
  EXPECT_THROW(scene.run({.pair_collisions = 1}), RunFailure);
}

TEST(ExactEngine, OneMoverAmongDisksAtRestSetsThemMoving) {
  Scene scene(Edge::periodic);
  for (int n = 0; n < 4; ++n) {
    for (int m = 0; m < 4; ++m) scene.add(0.125 + 0.25 * n, 0.125 + 0.25 * m, 0.0, 0.0);
  }
  scene.state.agents.column<VelocityX>()[5] = 1.0;
  scene.state.agents.column<VelocityY>()[5] = 0.3;
  scene.run({.time = 50.0});
  EXPECT_GT(scene.counters.pair_collisions, 100U);
  EXPECT_NEAR(kinetic_energy(scene.state.agents), 0.5 * 1.09, 1e-12);
  EXPECT_NEAR(momentum(scene.state.agents).x, 1.0, 1e-12);
}

TEST(ExactEngine, StepsLineUpWithTheSteppedEngine) {
  Scene scene(Edge::wall);
  scene.add(0.3, 0.5, 0.1, 0.2).add(0.7, 0.5, -0.1, 0.3);
  State stepped = scene.state;
  Counters counters;
  make_engine({.kind = "stepped"}, stepped)->advance(stepped, counters, {.step = 1000});
  for (std::uint64_t n = 1; n <= 10; ++n) scene.run({.step = 100 * n});
  EXPECT_EQ(scene.state.clock, stepped.clock);
}

TEST(ExactEngine, StopsAtATimeBetweenTwoSteps) {
  Scene scene(Edge::wall);
  scene.add(0.3, 0.5, 0.1, 0.2).add(0.7, 0.5, -0.1, 0.3);
  double const step = make_engine(audited_settings(), scene.state)->time_step();
  scene.run({.time = 2.5 * step});
  EXPECT_EQ(scene.state.clock.time, 2.5 * step);
  EXPECT_EQ(scene.state.clock.step, 2U);
  scene.run({.step = 3});
  EXPECT_EQ(scene.state.clock.time, step + step + step);
}

TEST(ExactEngine, StopsAtTheCollisionAskedFor) {
  State state = reference::random_scene({.count = 50, .packing_fraction = 0.5});
  auto const engine = make_engine(audited_settings(), state);
  Counters counters;
  for (std::uint64_t n = 1; n < 100; ++n) {
    engine->advance(state, counters, {.pair_collisions = n});
    EXPECT_EQ(counters.pair_collisions, n);
  }
}

TEST(ExactEngine, TakesUpWhatTheCallerChanged) {
  Scene scene(Edge::wall, 10.0, 1.0);
  scene.add(1.0, 0.5, 1.0, 0.0).add(5.0, 0.5, 0.0, 0.0);
  scene.run({.time = 1.0});
  scene.state.agents.column<VelocityX>()[0] = 0.0;
  scene.state.agents.column<VelocityX>()[1] = -1.0;
  scene.run({.time = 2.0});
  EXPECT_NEAR(scene.place(0).x, 2.0, 1e-15);
  EXPECT_NEAR(scene.place(1).x, 4.0, 1e-15);
}

TEST(ExactEngine, AStartThatOverlapsIsRefusedNamingThePair) {
  Scene scene(Edge::wall);
  scene.add(0.2, 0.2, 0.0, 0.0).add(0.3, 0.7, 0.0, 0.0).add(0.45, 0.7, 0.0, 0.0);
  EXPECT_NE(error_of(scene.state).find("disks 1 and 2 overlap by 0.05"), std::string::npos) << error_of(scene.state);
}

TEST(ExactEngine, ADiskOutsideTheWallsIsRefused) {
  Scene scene(Edge::wall);
  scene.add(0.05, 0.2, 0.0, 0.0);
  EXPECT_NE(error_of(scene.state).find("disk 0"), std::string::npos);
}

TEST(ExactEngine, ADiskOutsideAPeriodicBoxIsRefused) {
  for (double const x : {5.3, -5.3, 1.0, -1e-9}) {
    Scene scene(Edge::periodic);
    scene.add(x, 0.3, 1.0, 0.1).add(0.65, 0.3, -1.0, 0.0);
    EXPECT_NE(error_of(scene.state).find("disk 0 at ("), std::string::npos) << x << error_of(scene.state);
  }
}

TEST(ExactEngine, ADiskOnItsOwnImageIsRefused) {
  Scene scene(Edge::periodic, 0.19, 1.0);
  scene.add(0.1, 0.5, 1.0, 0.0);
  EXPECT_NE(error_of(scene.state).find("overlaps its own image"), std::string::npos) << error_of(scene.state);
}

TEST(ExactEngine, ContactAndWallsButForRoundingAreNoOverlap) {
  Scene scene(Edge::wall);
  scene.add(0.1 - 1e-14, 0.5, 1.0, 0.0).add(0.3 - 3e-14, 0.5, -1.0, 0.0);
  EXPECT_EQ(error_of(scene.state), "");
  scene.run({.time = 0.1});
  EXPECT_EQ(scene.counters.pair_collisions, 1U);
}

TEST(ExactEngine, ADiskThatMovesBetweenTwoWallsItTouchesIsRefused) {
  Scene corner(Edge::wall, 0.2, 0.2);
  corner.add(0.1, 0.1, 0.3, -0.2);
  EXPECT_NE(error_of(corner.state).find("while no time passes"), std::string::npos) << error_of(corner.state);
  Scene channel(Edge::wall, 2.0, 0.2);
  channel.add(0.5, 0.1, 1.0, 1e-3);
  EXPECT_NE(error_of(channel.state).find("touches two opposite walls"), std::string::npos) << error_of(channel.state);
}

/// What a run for a long time ends with, without an audit of each of its collisions.
std::string failure_of(Scene& scene) {
  try {
    scene.engine = make_engine({.kind = "exact"}, scene.state);
    scene.run({.time = 10.0});
  } catch (RunFailure const& failure) {
    return failure.what();
  }
  return "";
}

TEST(ExactEngine, TimeThatStandsStillInAFullLatticeEndsTheRun) {
  Scene scene(Edge::periodic);
  for (int n = 0; n < 100; ++n) {
    double const angle = 0.7 * n;
    scene.add(0.05 + 0.1 * (n % 10), 0.05 + 0.1 * (n / 10), std::cos(angle), std::sin(angle), 0.05);
  }
  EXPECT_NE(failure_of(scene).find("no time passes"), std::string::npos) << failure_of(scene);
}

TEST(ExactEngine, TimeThatStandsStillInOneRowAmongFreeDisksEndsTheRun) {
  Scene scene(Edge::wall, 0.6, 2.0);
  scene.add(0.1, 0.1, 0.5, 0.0).add(0.3, 0.1, -0.25, 0.0).add(0.5, 0.1, 0.125, 0.0);
  scene.add(0.3, 1.0, 0.3, 0.1).add(0.3, 1.5, -0.3, 0.1);
  EXPECT_NE(failure_of(scene).find("no time passes"), std::string::npos) << failure_of(scene);
  // What is left is the moment of the failure, and valid.
  EXPECT_LT(scene.state.clock.time, 1e-6);
  EXPECT_EQ(error_of(scene.state), "");
}

TEST(ExactEngine, ADiskPushedBetweenTwoWallsItTouchesEndsTheRun) {
  Scene scene(Edge::wall, 2.0, 0.2);
  scene.add(0.5, 0.1, 0.0, 0.0).add(1.0, 0.11, -1.0, 0.0, 0.05);
  EXPECT_NE(failure_of(scene).find("disk 0 "), std::string::npos) << failure_of(scene);
}

TEST(ExactEngine, ALatticeInContactWithRoomBesideItComesApart) {
  Scene scene(Edge::wall, 2.0, 1.25);
  for (int n = 0; n < 100; ++n) {
    double const angle = 0.7 * n;
    scene.add(0.05 + 0.1 * (n % 10), 0.05 + 0.1 * (n / 10), std::cos(angle), std::sin(angle), 0.05);
  }
  EXPECT_EQ(failure_of(scene), "");
  EXPECT_GT(scene.counters.pair_collisions, 100U);
}

TEST(ExactEngine, AFullLatticeAtRestStaysAtRest) {
  Scene scene(Edge::periodic);
  for (int n = 0; n < 16; ++n) scene.add(0.125 + 0.25 * (n % 4), 0.125 + 0.25 * (n / 4), 0.0, 0.0, 0.125);
  scene.run({.time = 1e3});
  EXPECT_EQ(scene.counters.moves, 0U);
}

TEST(ExactEngine, CollisionsClosePackedAreNoStandstill) {
  // Gaps of 10⁻⁹ diameters: a billion times as many collisions as in a fluid, each of which can be computed.
  Scene scene(Edge::wall, 0.6 + 2e-10, 1.0);
  scene.add(0.1, 0.1, 0.5, 0.0).add(0.3 + 1e-10, 0.1, -0.25, 0.0).add(0.5 + 2e-10, 0.1, 0.125, 0.0);
  scene.engine = make_engine({.kind = "exact"}, scene.state);
  scene.run({.time = 1e3, .pair_collisions = 4'000'000});
  EXPECT_EQ(scene.counters.pair_collisions, 4'000'000U);
}

// Epochs of so many collisions are cut after a million events; after that a state has to know of shorter ones.
TEST(ExactEngine, HasTheSameBitsSavedAndRestoredWhereEpochsAreCut) {
  Scene begin(Edge::wall, 0.6 + 2e-6, 1.0);
  begin.add(0.1, 0.1, 0.5, 0.0).add(0.3 + 1e-6, 0.1, -0.25, 0.0).add(0.5 + 2e-6, 0.1, 0.125, 0.0);
  StopCondition const end{.time = 1e3, .pair_collisions = 2'000'000};
  EngineSettings const settings{.kind = "exact", .time_step = 1e6};
  State whole = begin.state;
  Counters whole_counters;
  make_engine(settings, whole)->advance(whole, whole_counters, end);
  State cut = begin.state;
  Counters cut_counters;
  auto engine = make_engine(settings, cut);
  while (cut_counters.pair_collisions < end.pair_collisions) {
    StopCondition stop = end;
    int looks = 0;
    stop.should_continue = [&] { return ++looks < 9; };
    engine->advance(cut, cut_counters, stop);
    std::string const saved = to_checkpoint([&](Archive& archive) { engine->serialize(archive, cut); });
    engine = make_engine(settings, begin.state);
    from_checkpoint(saved, "saved", [&](Archive& archive) { engine->serialize(archive, cut); });
  }
  EXPECT_EQ(hash(whole), hash(cut));
  EXPECT_EQ(whole_counters.moves, cut_counters.moves);
  EXPECT_EQ(whole_counters.pair_virial, cut_counters.pair_virial);
}

TEST(ExactEngine, IsStoppedWithinAStepAndGoesOnToTheSameBits) {
  State const begin = reference::random_scene({.count = 50, .packing_fraction = 0.5, .seed = 3});
  EngineSettings const settings{.kind = "exact", .time_step = 1e4, .audit_every = 10'000};
  State whole = begin;
  Counters whole_counters;
  auto const engine = make_engine(settings, whole);
  engine->advance(whole, whole_counters, {.time = 0.25 * engine->time_step()});
  ASSERT_GT(whole_counters.pair_collisions, 100'000U);
  State cut = begin;
  Counters cut_counters;
  auto const cut_engine = make_engine(settings, cut);
  int stops = 0;
  double const end = whole.clock.time;
  while (cut.clock.time < end) {
    cut_engine->advance(cut, cut_counters, {.time = end, .should_continue = [] { return false; }});
    EXPECT_LE(largest_overlap(cut), rounding_of_contact(cut));
    ++stops;
  }
  EXPECT_GT(stops, 10);
  EXPECT_EQ(cut.clock.step, 0U);
  EXPECT_EQ(hash(whole), hash(cut));
  EXPECT_EQ(whole_counters.moves, cut_counters.moves);
  EXPECT_EQ(whole_counters.pair_virial, cut_counters.pair_virial);
}

// The time of a run has fewer digits the longer it lasts; the places of the disks keep theirs.
TEST(ExactEngine, HandsOutDisksInContactWithoutOverlapHoweverLateItIs) {
  State state = reference::random_scene({.edge = Edge::periodic, .count = 16, .packing_fraction = 0.1});
  state.clock.time = 1e9;
  auto const engine = make_engine(audited_settings(), state);
  Counters counters;
  for (std::uint64_t n = 1; n <= 200; ++n) {
    engine->advance(state, counters, {.pair_collisions = n});
    ASSERT_LE(largest_overlap(state), rounding_of_contact(state)) << "collision " << n;
    for (std::string const& kind : reference::hard_engine_kinds()) {
      EXPECT_NO_THROW(make_engine({.kind = kind}, state)) << kind << " from collision " << n;
    }
  }
}

TEST(ExactEngine, APeriodicBoxWhereTwoImagesCouldBeTouchedIsRefused) {
  Scene scene(Edge::periodic, 0.4, 1.0);
  scene.add(0.1, 0.2, 0.0, 0.0).add(0.1, 0.7, 0.0, 0.0);
  EXPECT_NE(error_of(scene.state).find("two images"), std::string::npos);
  scene.state.box = Box(0.41, 1.0, Edge::periodic);
  EXPECT_EQ(error_of(scene.state), "");
}

TEST(ExactEngine, ADiskMeetsTwoSidesOfAnotherInANarrowPeriodicBox) {
  Scene scene(Edge::periodic, 0.5, 1.0);
  scene.add(0.1, 0.5, 0.0, 0.0).add(0.35, 0.5, 1.0, 0.0);
  // Gaps of 0.05 on both sides: the motion is passed on at once, and comes back after the other gap.
  scene.run({.time = 0.32});
  EXPECT_EQ(scene.counters.pair_collisions, 3U);  // after 0.05, 0.15, 0.25 — the sum of the gaps is 0.1
}

class AuditTest : public testing::Test {
 protected:
  AuditTest() : state_(reference::random_scene({.count = 30, .packing_fraction = 0.4})), dynamics_(state_) {
    dynamics_.run(0.1, std::numeric_limits<std::uint64_t>::max(), 0, counters_);
  }
  State state_;
  Counters counters_;
  exact::Dynamics dynamics_;
};

TEST_F(AuditTest, PassesAHealthyRun) { EXPECT_NO_THROW(dynamics_.audit()); }

TEST_F(AuditTest, FindsTwoDisksOnTopOfEachOther) {
  dynamics_.disks()[3].x = dynamics_.disks()[4].x;
  dynamics_.disks()[3].y = dynamics_.disks()[4].y;
  EXPECT_THROW(dynamics_.audit(), RunFailure);
}

TEST_F(AuditTest, FindsAnEventThatWasForgotten) {
  // Without the events of the two disks of a pair that is bound to meet, the meeting is missed.
  for (std::size_t i = 0; i < dynamics_.size(); ++i) dynamics_.disks()[i].event_time = forever;
  EXPECT_THROW(dynamics_.audit(), RunFailure);
}

TEST_F(AuditTest, FindsADiskBeyondAWall) {
  for (std::size_t i = 0; i < dynamics_.size(); ++i) {
    exact::MovingDisk& disk = dynamics_.disks()[i];
    if (dynamics_.prediction_input().cells[i].row == 0) disk.y -= 0.3;
  }
  EXPECT_THROW(dynamics_.audit(), RunFailure);
}

}  // namespace
}  // namespace gridlock
