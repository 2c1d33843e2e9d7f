#include "gridlock/engine/growth.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "core/temperature.hpp"
#include "engine/exact/dynamics.hpp"
#include "gridlock/core/error.hpp"
#include "gridlock/grid/validate.hpp"
#include "reference/random_scene.hpp"

namespace gridlock {
namespace {

/// Disks of radius 0.1 in a box, growing by `rate` radii per time.
class GrowingDisks {
 public:
  explicit GrowingDisks(Edge edge, double width = 1.0, double height = 1.0) { state.box = Box(width, height, edge); }
  GrowingDisks& add(double x, double y, double vx, double vy, double mass = 1.0) {
    state.agents.add(x, y, vx, vy, 0.1, mass, 0, 0);
    return *this;
  }
  /// To the next collision of two disks; its time.
  double collide(double rate) {
    exact::Dynamics dynamics(state, {.rate = rate});
    EXPECT_FALSE(dynamics.grow({.pair_collisions = 1}, 1, counters));
    dynamics.write_at_last_event(state);
    return dynamics.last_event();
  }
  [[nodiscard]] Vector speed(std::size_t i) const { return velocity(state.agents, i); }

  State state;
  Counters counters;
};

double packing_fraction(State const& state) { return covered_area(state.agents) / state.box.area(); }

TEST(GrowingDisksTest, MeetWhereTheirRimsMeetAndPartFasterByTwiceTheSpeedOfGrowth) {
  for (Edge const edge : {Edge::wall, Edge::periodic}) {
    GrowingDisks disks(edge);
    disks.add(0.25, 0.5, 1.0, 0.25).add(0.75, 0.5, -0.5, 0.25);
    // The gap of 0.3 closes by 1.5 and by twice the speed of growth, 2 · 0.1 · 0.5.
    EXPECT_NEAR(disks.collide(0.5), 0.3 / 1.6, 1e-15);
    EXPECT_NEAR(disks.speed(0).x, -0.5 - 0.1, 1e-14);
    EXPECT_NEAR(disks.speed(1).x, 1.0 + 0.1, 1e-14);
    EXPECT_NEAR(disks.speed(0).y, 0.25, 1e-15);
    EXPECT_NEAR(disks.state.agents.column<Radius>()[0], 0.1 * (1.0 + 0.5 * 0.3 / 1.6), 1e-16);
    // σ |Δp|: both change their velocity by 1.6.
    EXPECT_NEAR(disks.counters.pair_virial, 0.2 * (1.0 + 0.5 * 0.3 / 1.6) * 1.6, 1e-14);
  }
}

TEST(GrowingDisksTest, MeetAcrossThePeriodicEdge) {
  GrowingDisks disks(Edge::periodic);
  disks.add(0.2, 0.5, -1.0, 0.0).add(0.8, 0.5, 0.5, 0.0);
  EXPECT_NEAR(disks.collide(0.5), 0.2 / 1.6, 1e-15);
}

// |d + w t| = σ (1 + g t) with d = (0.5, 0.3), w = (−1, −0.25), σ = 0.2, g = 0.5.
TEST(GrowingDisksTest, MeetObliquelyAtTheRootOfTheirQuadraticEquation) {
  GrowingDisks disks(Edge::wall, 2.0, 2.0);
  disks.add(0.5, 0.5, 0.5, 0.25).add(1.0, 0.8, -0.5, 0.0);
  double const a = 1.0 + 0.0625 - 0.01;
  double const b = -0.5 - 0.075 - 0.02;
  double const c = 0.25 + 0.09 - 0.04;
  EXPECT_NEAR(disks.collide(0.5), (-b - std::sqrt(b * b - a * c)) / a, 1e-15);
}

TEST(GrowingDisksTest, AreOvertakenByGrowthWhereTheyPartSlowly) {
  GrowingDisks disks(Edge::wall, 10.0, 10.0);
  disks.add(4.0, 5.0, -0.01, 0.0).add(4.5, 5.0, 0.01, 0.0);
  // The gap of 0.3 opens by 0.02 and closes by 0.1.
  EXPECT_NEAR(disks.collide(0.5), 0.3 / 0.08, 1e-13);
  EXPECT_NEAR(disks.speed(1).x - disks.speed(0).x, -0.02 + 2.0 * 0.1, 1e-14);
}

TEST(GrowingDisksTest, AtRestAndInContactPushEachOtherApart) {
  GrowingDisks disks(Edge::wall, 10.0, 10.0);
  disks.add(4.0, 5.0, 0.0, 0.0).add(4.2, 5.0, 0.0, 0.0).add(6.0, 5.0, 1.0, 0.0);
  EXPECT_NEAR(disks.collide(0.5), 0.0, 1e-14);
  EXPECT_NEAR(disks.speed(1).x - disks.speed(0).x, 2.0 * 0.1, 1e-13);
}

TEST(GrowingDisksTest, ShareTheImpulseByTheirMasses) {
  GrowingDisks disks(Edge::wall, 10.0, 10.0);
  disks.add(4.0, 5.0, 1.0, 0.0, 3.0).add(5.0, 5.0, 0.0, 0.0, 1.0);
  // Relative velocity −1 becomes 1 + 2 · 0.1; the momentum stays 3.
  EXPECT_NEAR(disks.collide(0.5), 0.8 / 1.1, 1e-15);
  EXPECT_NEAR(disks.speed(1).x - disks.speed(0).x, 1.2, 1e-14);
  EXPECT_NEAR(3.0 * disks.speed(0).x + disks.speed(1).x, 3.0, 1e-14);
}

// From wall to wall the free length ℓ falls by 2 r τ, with r the speed of growth and τ = ℓ / (v + r), and v rises by 2
// r: ℓ (v − r) stays what it was.
TEST(GrowingDisksTest, OneBetweenTwoWallsKeepsItsAction) {
  GrowingDisks disk(Edge::wall);
  disk.add(0.1, 0.5, 1.0, 0.0);
  double const rate = 0.2;
  double const growth = 0.1 * rate;
  exact::Dynamics dynamics(disk.state, {.rate = rate});
  double length = 0.8;
  double speed = 1.0;
  double time = 0.0;
  double impulse = 0.0;
  for (int bounce = 0; bounce < 20; ++bounce) {
    double const flight = length / (speed + growth);
    time += flight;
    length -= 2.0 * growth * flight;
    impulse += 2.0 * (speed + growth);
    speed += 2.0 * growth;
    EXPECT_NEAR(length * (speed - growth), 0.8 * (1.0 - growth), 1e-15);
  }
  ASSERT_TRUE(dynamics.grow({.scale = 1.0 + rate * (time + 1e-9)}, 0, disk.counters));
  dynamics.write_grown(1.0 + rate * (time + 1e-9), disk.state);
  EXPECT_EQ(disk.counters.all_wall_hits(), 20U);
  EXPECT_NEAR(disk.speed(0).x, speed, 1e-12);
  EXPECT_NEAR(disk.counters.wall_impulse[Counters::left] + disk.counters.wall_impulse[Counters::right], impulse, 1e-12);
  EXPECT_NEAR(disk.state.agents.column<Radius>()[0], 0.1 + growth * time, 1e-9);
}

TEST(GrowingDisksTest, SlowlyLeavingAWallTouchesItAgain) {
  GrowingDisks disk(Edge::wall);
  disk.add(0.2, 0.5, 0.01, 0.0);
  exact::Dynamics dynamics(disk.state, {.rate = 0.5});
  // The gap of 0.1 opens by 0.01 and closes by 0.05.
  double const touch = 0.1 / 0.04;
  ASSERT_TRUE(dynamics.grow({.scale = 1.0 + 0.5 * touch * 1.001}, 0, disk.counters));
  dynamics.write_grown(1.0 + 0.5 * touch * 1.001, disk.state);
  EXPECT_EQ(disk.counters.wall_hits, (std::array<std::uint64_t, 4>{1, 0, 0, 0}));
  EXPECT_NEAR(disk.speed(0).x, -0.01 + 2.0 * 0.05, 1e-14);
}

class GrowthTest : public testing::Test {
 protected:
  GrowthTest() : state_(reference::random_scene({.edge = Edge::periodic, .count = 60, .packing_fraction = 0.3})) {}
  /// The texts and keys of what is refused.
  [[nodiscard]] std::string error_of(GrowthSettings const& settings) const {
    try {
      Growth const growth(settings, state_);
    } catch (Error const& error) {
      std::string text;
      for (Problem const& problem : error.problems()) text += problem.key + ": " + problem.what + "\n";
      return text;
    }
    return "";
  }
  std::string failure_of(GrowthSettings const& settings) {
    try {
      Growth(settings, state_).advance(state_, counters_);
    } catch (RunFailure const& failure) {
      return failure.what();
    }
    return "";
  }
  State state_;
  Counters counters_;
};

TEST_F(GrowthTest, EndsAtExactlyTheDensityAskedForWithTheTemperatureOfTheStart) {
  double const kt = *temperature(state_);
  Growth growth({.rate = 0.05, .packing_fraction = 0.5}, state_);
  EXPECT_FALSE(growth.reduced_pressure());
  EXPECT_TRUE(growth.advance(state_, counters_));
  EXPECT_NEAR(packing_fraction(state_), 0.5, 1e-14);
  EXPECT_NEAR(*temperature(state_), kt, 1e-13 * kt);
  EXPECT_TRUE(growth.is_finished());
  EXPECT_TRUE(growth.reduced_pressure());
  EXPECT_EQ(growth.collisions(), counters_.pair_collisions);
  // The smallest disk, of mass 1, has grown by γ √kT for all that time.
  double const start = std::sqrt(0.3 / 0.5) * 2.0 * radius_range(state_.agents).smallest;
  EXPECT_NEAR(2.0 * radius_range(state_.agents).smallest, start + 0.05 * std::sqrt(kt) * state_.clock.time, 1e-12);
  std::uint64_t const end = hash(state_);
  EXPECT_TRUE(growth.advance(state_, counters_));
  EXPECT_EQ(hash(state_), end);
}

TEST_F(GrowthTest, EndsWhereThePressureIsReached) {
  Growth growth({.rate = 0.01, .pressure = 50.0}, state_);
  EXPECT_TRUE(growth.advance(state_, counters_));
  EXPECT_GE(*growth.reduced_pressure(), 50.0);
  EXPECT_LT(*growth.reduced_pressure(), 80.0);
  EXPECT_EQ(growth.collisions() % (20 * 60), 0U);
  EXPECT_EQ(growth.rescalings() + 1, growth.collisions() / (20 * 60));
}

TEST_F(GrowthTest, EndsAtOnceAtTheDensityThatItHas) {
  Growth growth({.packing_fraction = packing_fraction(state_)}, state_);
  EXPECT_TRUE(growth.advance(state_, counters_));
  EXPECT_EQ(counters_.pair_collisions, 0U);
}

TEST_F(GrowthTest, TakesUpWhatTheCallerChanged) {
  Growth growth({.rate = 0.01, .packing_fraction = 0.5, .audit_every = 10}, state_);
  EXPECT_FALSE(growth.advance(state_, counters_, [] { return false; }));
  EXPECT_EQ(counters_.pair_collisions, 10U);
  for (double& v : state_.agents.column<VelocityX>()) v = -v;
  EXPECT_TRUE(growth.advance(state_, counters_));
  EXPECT_NEAR(packing_fraction(state_), 0.5, 1e-14);
}

TEST_F(GrowthTest, RefusesEndsThatCannotBe) {
  EXPECT_NE(error_of({}).find("growth: the disks would grow without end"), std::string::npos);
  EXPECT_NE(error_of({.packing_fraction = 0.2}).find("growth.packing_fraction: packing fraction 0.2"),
            std::string::npos);
  EXPECT_NE(error_of({.packing_fraction = 0.91}).find("0.9069 is full"), std::string::npos);
  EXPECT_NE(error_of({.pressure = 1.0}).find("growth.pressure"), std::string::npos);
  EXPECT_NE(error_of({.pressure = 1e15}).find("last digits of their coordinates"), std::string::npos);
  EXPECT_NE(error_of({.pressure = std::nan("")}).find("growth.pressure"), std::string::npos);
  EXPECT_EQ(error_of({.packing_fraction = 0.5, .pressure = 1e12}), "");
}

TEST_F(GrowthTest, RefusesRatesAndRescalingsThatCannotBe) {
  for (double const rate : {0.0, -1.0, 1.5, std::nan("")}) {
    EXPECT_NE(error_of({.rate = rate, .pressure = 10.0}).find("growth.rate"), std::string::npos) << rate;
  }
  for (double const collisions : {0.0, 1e10, std::nan("")}) {
    EXPECT_NE(error_of({.pressure = 10.0, .collisions_per_rescaling = collisions}).find("collisions_per_rescaling"),
              std::string::npos)
        << collisions;
  }
}

TEST_F(GrowthTest, RefusesDisksThatCannotGrow) {
  for (double& v : state_.agents.column<VelocityX>()) v = 0.5;
  for (double& v : state_.agents.column<VelocityY>()) v = 0.0;
  EXPECT_NE(error_of({.pressure = 10.0}).find("no disk moves relative to the others"), std::string::npos);
  state_.agents = {};
  state_.agents.add(0.5, 0.5, 1.0, 0.0, 0.1, 1.0, 0, 0);
  EXPECT_NE(error_of({.pressure = 10.0}).find("growth needs two"), std::string::npos);
  // Two disks in a periodic box would touch two images of one another long before they fill it.
  state_.agents.add(0.2, 0.2, 0.0, 0.0, 0.1, 1.0, 0, 0);
  EXPECT_NE(error_of({.pressure = 10.0}).find("two images"), std::string::npos);
  EXPECT_EQ(error_of({.packing_fraction = 0.2}), "");
}

TEST_F(GrowthTest, SaysSoWhereADensityCannotBeReached) {
  state_ = reference::random_scene(
      {.edge = Edge::periodic, .count = 40, .packing_fraction = 0.5, .smallest_ratio = 0.7, .seed = 3});
  std::string const failure = failure_of({.rate = 0.02, .packing_fraction = 0.98});
  EXPECT_NE(failure.find("the gaps between the disks are the last digits"), std::string::npos) << failure;
  EXPECT_LE(largest_overlap(state_), rounding_of_contact(state_));
}

TEST_F(GrowthTest, EndsWhereOneDiskIsStuckBetweenTwoWalls) {
  state_ = State{.box = Box(6.0, 0.3, Edge::wall)};
  state_.agents.add(3.0, 0.15, 0.3, 0.2, 0.13, 1.0, 0, 0);
  for (int n = 0; n < 8; ++n) state_.agents.add(0.3 + 0.25 * n, 0.15, 0.4 - 0.1 * n, 0.1, 0.02, 1.0, 0, 0);
  // The large disk fills the channel before the others feel anything.
  std::string const failure = failure_of({.rate = 0.01, .packing_fraction = 0.3});
  EXPECT_TRUE(failure.find("no time passes: disk 0 ") != std::string::npos ||
              failure.find("last digits") != std::string::npos)
      << failure;
}

// Gaps of 10⁻¹² diameters, of which the coordinates hold two digits.
TEST_F(GrowthTest, ReachesTheHighestPressuresAndGoesOnWithoutGrowing) {
  state_ =
      reference::random_scene({.edge = Edge::periodic, .count = 100, .packing_fraction = 0.4, .smallest_ratio = 0.7});
  Growth growth({.rate = 0.02, .pressure = 1e12, .audit_every = 100'003}, state_);
  EXPECT_TRUE(growth.advance(state_, counters_));
  EXPECT_GE(*growth.reduced_pressure(), 1e12);
  EXPECT_LE(largest_overlap(state_), rounding_of_contact(state_));
  auto const engine = make_engine({.kind = "exact", .audit_every = 100'003}, state_);
  // Enough for two looks for a standstill, and for the first epoch to be cut.
  engine->advance(state_, counters_, {.pair_collisions = counters_.pair_collisions + 3'000'000});
  EXPECT_LE(largest_overlap(state_), rounding_of_contact(state_));
}

}  // namespace
}  // namespace gridlock
