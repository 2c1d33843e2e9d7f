// The exact engine on several threads against itself on one.

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <numbers>
#include <optional>
#include <ostream>
#include <string>
#include <utility>
#include <vector>

#include "engine/exact/dynamics.hpp"
#include "gridlock/core/detail/message.hpp"
#include "gridlock/core/detail/thread_pool.hpp"
#include "gridlock/core/random.hpp"
#include "gridlock/engine/engine.hpp"
#include "io/checkpoint.hpp"

namespace gridlock {
namespace {

constexpr std::uint64_t all = std::numeric_limits<std::uint64_t>::max();

struct SharingCase {
  std::string name;
  double packing_fraction;
  std::uint64_t columns;
  std::uint64_t rows;
  Edge edge = Edge::periodic;
  double smallest_ratio = 1.0;  ///< of every other disk
  double duration = 4.0;
  exact::Lists lists = exact::Lists::where_they_pay;
  std::optional<Edge> edge_y = {};  ///< of y alone, along which strips follow one another
  double widths = 0.0;              ///< by which an oblique box is shifted

  friend std::ostream& operator<<(std::ostream& out, SharingCase const& c) { return out << c.name; }
};

/// Narrow and high, so that few disks fill many strips.
State start(SharingCase const& c) {
  double const ratio = c.smallest_ratio;
  double const area_of_disk = std::numbers::pi / 8.0 * (1.0 + ratio * ratio);
  double const step = std::sqrt(area_of_disk / c.packing_fraction);
  State state{.box = Box(step * static_cast<double>(c.columns), step * static_cast<double>(c.rows), c.edge,
                         c.edge_y.value_or(c.edge)),
              .seed = 1};
  state.box = state.box.shifted(c.widths * state.box.width());
  for (std::uint64_t row = 0; row < c.rows; ++row) {
    for (std::uint64_t column = 0; column < c.columns; ++column) {
      RandomStream random(1, 0, row * c.columns + column, Purpose::start_velocity);
      double const velocity_x = random.normal();
      double const velocity_y = random.normal();
      bool const is_small = (row + column) % 2 == 1;
      state.agents.add((static_cast<double>(column) + 0.5) * step, (static_cast<double>(row) + 0.5) * step, velocity_x,
                       velocity_y, is_small ? 0.5 * ratio : 0.5, is_small ? ratio * ratio : 1.0, is_small ? 1 : 0, 0);
    }
  }
  return state;
}

/// One flight and what has been counted of it.
struct Flown {
  State state;
  std::unique_ptr<ThreadPool> threads;
  exact::Dynamics dynamics;
  Counters counters;

  Flown(SharingCase const& c, std::size_t thread_count, double caution = 1.0)
      : state(start(c)),
        threads(std::make_unique<ThreadPool>(thread_count)),
        dynamics(state, {.lists = c.lists,
                         .sharing = {.threads = threads.get(), .wherever_possible = true, .caution = caution}}) {}

  std::uint64_t hash_at(double time) {
    dynamics.write(time, state);
    return hash(state);
  }
};

void expect_same(Flown& a, Flown& b, double time) {
  EXPECT_EQ(a.hash_at(time), b.hash_at(time)) << "time " << time;
  EXPECT_EQ(a.dynamics.hits(), b.dynamics.hits());
  // Disks go from cell to cell too, and leave their places: how often depends on the cells and lists of the strips.
  auto const moves = static_cast<double>(a.counters.moves);
  EXPECT_NEAR(static_cast<double>(b.counters.moves), moves, moves / 3.0);
  EXPECT_EQ(a.counters.pair_collisions, b.counters.pair_collisions);
  EXPECT_EQ(a.counters.pair_virial, b.counters.pair_virial);
  EXPECT_EQ(a.counters.wall_hits, b.counters.wall_hits);
  EXPECT_EQ(a.counters.wall_impulse, b.counters.wall_impulse);
}

class SharingProperty : public testing::TestWithParam<SharingCase> {};

INSTANTIATE_TEST_SUITE_P(
    Scenes, SharingProperty,
    testing::Values(
        SharingCase{"fluid", 0.70, 20, 160}, SharingCase{"fluid_walls", 0.70, 20, 160, Edge::wall},
        SharingCase{
            .name = "fluid_periodic_in_x", .packing_fraction = 0.70, .columns = 20, .rows = 160, .edge_y = Edge::wall},
        SharingCase{.name = "fluid_periodic_in_y",
                    .packing_fraction = 0.70,
                    .columns = 20,
                    .rows = 160,
                    .edge = Edge::wall,
                    .edge_y = Edge::periodic},
        SharingCase{"dilute", 0.30, 16, 260, Edge::periodic, 1.0, 12.0},
        SharingCase{"dilute_walls", 0.30, 16, 260, Edge::wall, 1.0, 12.0},
        SharingCase{"dense_lists", 0.74, 20, 160, Edge::periodic, 1.0, 3.0, exact::Lists::always},
        SharingCase{"dense_lists_walls", 0.74, 20, 160, Edge::wall, 1.0, 3.0, exact::Lists::always},
        SharingCase{"mixture", 0.65, 20, 200, Edge::periodic, 0.7},
        SharingCase{.name = "oblique",
                    .packing_fraction = 0.65,
                    .columns = 20,
                    .rows = 200,
                    .smallest_ratio = 0.7,
                    .widths = 0.37},
        SharingCase{"unequal_lists", 0.45, 20, 240, Edge::wall, 0.4, 4.0, exact::Lists::always}),
    [](auto const& scene) { return scene.param.name; });

TEST_P(SharingProperty, HasTheSameBitsWithAnyNumberOfThreads) {
  for (std::size_t const threads : {2, 3}) {
    SCOPED_TRACE(testing::Message() << threads << " threads");
    Flown one(GetParam(), 1);
    Flown many(GetParam(), threads);
    // Some of these times are an epoch's end but for rounding.
    for (double time = 0.05; time < GetParam().duration; time += time < 1.5 ? 0.05 : 1.1) {
      EXPECT_TRUE(one.dynamics.run(time, all, 0, one.counters));
      EXPECT_TRUE(many.dynamics.run(time, all, 0, many.counters));
      expect_same(one, many, time);
    }
    EXPECT_EQ(one.dynamics.windows().flown, 0);
    EXPECT_GT(many.dynamics.windows().flown, many.dynamics.windows().given_up);
  }
}

// Copies that reach too little go wrong, and must be seen to.
TEST_P(SharingProperty, FindsOutWhereCopiesWentWrong) {
  Flown one(GetParam(), 1);
  Flown rash(GetParam(), 2, 0.15);
  EXPECT_TRUE(one.dynamics.run(GetParam().duration, all, 0, one.counters));
  EXPECT_TRUE(rash.dynamics.run(GetParam().duration, all, 0, rash.counters));
  expect_same(one, rash, GetParam().duration);
  EXPECT_GT(rash.dynamics.windows().given_up, 0);
}

TEST_P(SharingProperty, StopsAtTheCollisionAskedForAndGoesOnFromACheckpoint) {
  Flown one(GetParam(), 1);
  Flown many(GetParam(), 2);
  std::uint64_t const disks = one.state.agents.size();
  for (std::uint64_t const collisions : {35 * disks + 7, 50 * disks + 1}) {
    EXPECT_FALSE(one.dynamics.run(1e9, collisions, 40 * disks, one.counters));
    EXPECT_FALSE(many.dynamics.run(1e9, collisions, 40 * disks, many.counters));
    EXPECT_EQ(many.counters.pair_collisions, collisions);
    EXPECT_EQ(many.dynamics.audits(), one.dynamics.audits());
    expect_same(one, many, 0.0);
  }
  EXPECT_GT(many.dynamics.windows().flown, 0);

  double const time = many.dynamics.last_event() + 0.4 * GetParam().duration;
  double const later = time + GetParam().duration;
  EXPECT_TRUE(many.dynamics.run(time, all, 0, many.counters));
  many.dynamics.write(time, many.state);
  std::string const saved = to_checkpoint([&](Archive& archive) { many.dynamics.serialize(archive); });
  exact::Dynamics restored(
      many.state, {.lists = GetParam().lists, .sharing = {.threads = many.threads.get(), .wherever_possible = true}});
  from_checkpoint(saved, "saved", [&](Archive& archive) { restored.serialize(archive); });
  Counters counters = many.counters;
  EXPECT_TRUE(restored.run(later, all, 0, counters));
  EXPECT_TRUE(one.dynamics.run(time, all, 0, one.counters));
  EXPECT_TRUE(one.dynamics.run(later, all, 0, one.counters));
  EXPECT_TRUE(many.dynamics.run(later, all, 0, many.counters));
  expect_same(one, many, later);
  State state = many.state;
  restored.write(later, state);
  EXPECT_EQ(hash(state), hash(many.state));
  EXPECT_EQ(counters.pair_virial, many.counters.pair_virial);
  EXPECT_GT(restored.windows().flown, 0);
}

TEST(Sharing, EndsWhereItIsAskedTo) {
  SharingCase const fluid{"fluid", 0.70, 20, 160};
  Flown one(fluid, 1);
  Flown many(fluid, 2);
  int looks = 0;
  auto const has_patience = [&] { return ++looks < 8; };
  EXPECT_FALSE(many.dynamics.run(4.0, all, 0, many.counters, has_patience));
  EXPECT_LT(many.dynamics.last_event(), 4.0);
  EXPECT_TRUE(many.dynamics.run(4.0, all, 0, many.counters));
  EXPECT_TRUE(one.dynamics.run(4.0, all, 0, one.counters));
  expect_same(one, many, 4.0);
}

// Threads fly many steps at once: where a run stops must not tell.
TEST(Sharing, StopsAtTheSameStepAndTimeWithAnyNumberOfThreads) {
  State one = start({"dilute", 0.30, 20, 400});
  State many = one;
  std::unique_ptr<Engine> const engine_of_one = make_engine({.kind = "exact", .time_step = 0.02, .threads = 1}, one);
  std::unique_ptr<Engine> const engine_of_many = make_engine({.kind = "exact", .time_step = 0.02, .threads = 2}, many);
  Counters of_one;
  Counters of_many;
  auto const expect_same_stop = [&](StopCondition const& stop_condition, std::string const& what) {
    SCOPED_TRACE(what);
    int asked_one = 0;
    int asked_many = 0;
    StopCondition stop_of_one = stop_condition;
    StopCondition stop_of_many = stop_condition;
    stop_of_one.should_continue = [&] { return ++asked_one > 0; };
    stop_of_many.should_continue = [&] { return ++asked_many > 0; };
    engine_of_one->advance(one, of_one, stop_of_one);
    engine_of_many->advance(many, of_many, stop_of_many);
    EXPECT_EQ(one.clock.step, many.clock.step);
    EXPECT_EQ(one.clock.time, many.clock.time);
    EXPECT_EQ(hash(one), hash(many));
    EXPECT_EQ(of_one.pair_collisions, of_many.pair_collisions);
    EXPECT_EQ(of_one.pair_virial, of_many.pair_virial);
    return std::pair{asked_one, asked_many};
  };
  auto const [asked_one, asked_many] = expect_same_stop({.step = 151}, "a step");
  EXPECT_LT(asked_many, asked_one / 2);  // threads did share the work
  for (std::uint64_t const more : {1, 2, 7, 40}) {
    expect_same_stop({.step = one.clock.step + more}, "some steps");
    expect_same_stop({.time = one.clock.time + 0.0101 * static_cast<double>(more)}, "a time");
    expect_same_stop({.pair_collisions = of_one.pair_collisions + 991 * more}, "collisions");
    expect_same_stop({.step = one.clock.step + 1}, "the rest of a step");
  }
  int left = 3;
  engine_of_many->advance(many, of_many, {.step = one.clock.step + 100, .should_continue = [&] { return --left > 0; }});
  EXPECT_GT(many.clock.step, one.clock.step);
  EXPECT_LT(many.clock.step, one.clock.step + 100);
  expect_same_stop({.step = one.clock.step + 100}, "after a word to stop");
}

// Reports are those of one thread: whoever asks for them ends the sharing.
TEST(Sharing, EndsWhereCollisionsAreReportedAndEachIsReportedOnce) {
  SharingCase const fluid{"fluid", 0.70, 20, 160};
  Flown one(fluid, 1);
  Flown many(fluid, 2);
  EXPECT_TRUE(one.dynamics.run(1.0, all, 0, one.counters));
  EXPECT_TRUE(many.dynamics.run(1.0, all, 0, many.counters));
  EXPECT_GT(many.dynamics.window(), 0.0);
  std::uint64_t reported = many.counters.pair_collisions;
  double virial = many.counters.pair_virial;
  double last = 7.0;
  ReportCollision const report = [&](PairCollision const& collision) {
    ++reported;
    virial += dot(collision.impulse, collision.separation);
    EXPECT_GE(collision.time, last);
    last = collision.time;
  };
  many.dynamics.report_collisions(report, 7.0);
  EXPECT_TRUE(one.dynamics.run(2.0, all, 0, one.counters));
  EXPECT_TRUE(many.dynamics.run(2.0, all, 0, many.counters));
  expect_same(one, many, 2.0);
  EXPECT_EQ(many.dynamics.window(), 0.0);
  EXPECT_EQ(reported, many.counters.pair_collisions);
  EXPECT_NEAR(virial, many.counters.pair_virial, 1e-10 * virial);
  EXPECT_NEAR(last, 9.0, 0.01);
}

// Many disks of a lattice with few speeds collide at the very same time: whose virial is added first is left to one
// thread.
TEST(Sharing, LeavesCollisionsAtTheSameTimeToOneThread) {
  State state{.box = Box(30.0, 240.0, Edge::periodic), .seed = 1};
  for (std::uint64_t row = 0; row < 160; ++row) {
    for (std::uint64_t column = 0; column < 20; ++column) {
      state.agents.add((static_cast<double>(column) + 0.5) * 1.5, (static_cast<double>(row) + 0.5) * 1.5,
                       (20 * row + column) % 3 == 0 ? 0.25 : -0.25, row % 2 == 0 ? 0.5 : -0.5, 0.5, 1.0, 0, 0);
    }
  }
  ThreadPool threads(2);
  exact::Dynamics one(state);
  exact::Dynamics many(state, {.sharing = {.threads = &threads, .wherever_possible = true}});
  Counters of_one;
  Counters of_many;
  EXPECT_TRUE(one.run(60.0, all, 0, of_one));
  EXPECT_TRUE(many.run(60.0, all, 0, of_many));
  EXPECT_EQ(of_one.pair_virial, of_many.pair_virial);
  EXPECT_EQ(of_one.pair_collisions, of_many.pair_collisions);
  State other = state;
  one.write(60.0, state);
  many.write(60.0, other);
  EXPECT_EQ(hash(state), hash(other));
}

}  // namespace
}  // namespace gridlock
