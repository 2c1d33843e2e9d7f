// Tiled models on several ranks, here threads: the bits, the names, counts and sums of one process, however the
// tiles are divided, whoever is born, dies or is late where.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "gridlock/core/error.hpp"
#include "model_on_ranks.hpp"
#include "thread_ranks.hpp"
#include "tiled_colloid.hpp"

namespace gridlock {
namespace {

using test::advance;
using test::advance_on_ranks;
using test::all_of;
using test::continue_on_ranks;
using test::EndedWorld;
using test::expect_same;
using test::expect_to_be_whole_where_it_ends;
using test::started;
using test::ThreadRanks;

struct Wealth {
  using type = double;
  static constexpr char const* name = "wealth";
};
struct Trades {
  using type = std::uint32_t;
  static constexpr char const* name = "trades";
};

/// Tiled agents that do all that a model may do: they change themselves and their neighbours by sums that round in the
/// order of the neighbours; they wander, have children beside them and far away, die, and kill. Those that are late
/// search anywhere, change whom they find there, and jump anywhere.
struct Traders {
  static constexpr std::string_view name = "traders_of_test";
  static constexpr std::string_view documentation = "Agents that do all that a tiled model may do.";
  static constexpr Schedule schedule = Schedule::tiled;
  static constexpr bool keeps_counters = true;
  static constexpr std::array<std::string_view, 5> events{"trades", "births", "deaths", "kills", "late"};
  using Agents = Population<X, Y, Wealth, Trades>;

  std::uint64_t count = 500;
  double radius = 0.1;
  double late = 0.0;  ///< probabilities
  double birth = 0.0;
  double far_birth = 0.0;
  double death = 0.0;
  double kill = 0.0;
  double crowd = 1.0;  ///< the part of each side where agents start
  std::uint64_t fails_at = 1'000'000;
  std::uint64_t failing_agents = 1;
  std::uint64_t fails_late = 0;

  void describe(SettingVisitor& visitor) {
    visitor.visit({.key = "count"}, count);
    for (auto& [key, value] : {std::pair("radius", &radius), std::pair("late", &late), std::pair("birth", &birth),
                               std::pair("far_birth", &far_birth), std::pair("death", &death), std::pair("kill", &kill),
                               std::pair("crowd", &crowd)}) {
      visitor.visit({.key = key}, *value);
    }
    visitor.visit({.key = "fails_at"}, fails_at);
    visitor.visit({.key = "failing_agents"}, failing_agents);
    visitor.visit({.key = "fails_late"}, fails_late);
  }
  [[nodiscard]] double cutoff() const { return radius; }
  [[nodiscard]] double time_step() const { return 0.1; }

  void start(World<Traders>& world) const {
    for (std::uint64_t n = 0; n < count; ++n) {
      RandomStream random = world.start_random(n);
      Vector const p = world.anywhere(random);
      world.agents.add(crowd * p.x, crowd * p.y, random.uniform(), 0U);
    }
  }

  [[nodiscard]] bool is_local(Turn<Traders> const& self, double /*room*/) const { return !is_late(self); }

  void turn(Turn<Traders>& self) const {
    RandomStream random = self.random();
    bool const is_first_to_fail = self.clock().step == fails_at && self.id() % 101 < failing_agents;
    if (is_first_to_fail && is_late(self) == (fails_late != 0)) {
      throw std::runtime_error("agent " + std::to_string(self.id()) + " fails");
    }
    ++self.counters().moves;
    trade_around(self, self.position(), random);
    if (is_late(self)) {
      self.count(4);
      for (int n = 0; n < 2; ++n) {
        double const x = random.uniform() * self.box().width();
        trade_around(self, {x, random.uniform() * self.box().height()}, random);
      }
      double const x = random.uniform() * self.box().width();
      self.move_to({x, random.uniform() * self.box().height()});
      trade_around(self, self.position(), random);
    } else {
      self.move_by(0.9 * radius * random.in_unit_disk());
    }
    come_and_go(self, random);
  }

 private:
  [[nodiscard]] bool is_late(Turn<Traders> const& self) const { return self.random(1).uniform() < late; }

  void trade_around(Turn<Traders>& self, Vector p, RandomStream& random) const {
    double sum = self.get<Wealth>();
    double const luck = random.uniform();
    self.for_each_neighbour(p, radius, [&](Neighbour<Traders> const& other) {
      sum += 0.3 * other.get<Wealth>() + 0.01 * other.separation().x;
      other.set<Wealth>(other.get<Wealth>() - 0.1 * sum);
      other.set<Trades>(other.get<Trades>() + 1);
      self.count(0);
      self.counters().pair_virial += sum;
      ++self.counters().pair_collisions;
      if (luck < kill && other.id() % 3 == 0) {
        other.kill();
        self.count(3);
      }
    });
    self.counters().wall_impulse[self.id() % 4] += 0.1 * sum;
    self.set<Wealth>(sum / (1.0 + sum * sum) + 1e-3 * static_cast<double>(self.population()));
  }

  void come_and_go(Turn<Traders>& self, RandomStream& random) const {
    while (random.uniform() < birth) {
      self.give_birth(self.position().x, self.position().y, random.uniform(), 0U);
      self.count(1);
    }
    if (random.uniform() < far_birth) {
      double const x = random.uniform() * self.box().width();
      self.give_birth(x, random.uniform() * self.box().height(), random.uniform(), 0U);
      self.count(1);
    }
    if (random.uniform() < death) {
      self.die();
      self.count(2);
    }
  }
};

struct Market {
  Traders model;
  Box box;
  std::uint64_t seed;

  [[nodiscard]] World<Traders> start() const { return started(model, box, seed); }
};

Market any_market(std::uint64_t seed) {
  RandomStream random(seed, 0, 0, Purpose::model_start);
  auto const one_of = [&](auto... values) {
    std::array const all{values...};
    return all[random.below(all.size())];
  };
  Market market{.model = {},
                .box = Box(one_of(1.0, 0.3, 3.0), one_of(1.0, 0.25, 2.0), one_of(Edge::wall, Edge::periodic),
                           one_of(Edge::wall, Edge::periodic)),
                .seed = seed};
  Traders& model = market.model;
  double const shorter = std::min(market.box.width(), market.box.height());
  // Few cells and one tile, or as many tiles as there may be for so many agents.
  model.count = one_of(0UL, 1UL, 60UL, 400UL, 900UL, 2500UL);
  model.radius = shorter * one_of(0.5, 0.3, 0.03, 0.01, 0.004);
  model.late = one_of(0.0, 0.0, 0.002, 0.02, 1.0);
  // Each late agent looks far, so that few of them do.
  if (model.late == 1.0) model.count = std::min<std::uint64_t>(model.count, 60);
  model.birth = one_of(0.0, 0.02, 0.04);
  model.far_birth = one_of(0.0, 0.0, 0.02);
  model.death = one_of(0.0, 0.02, 0.05);
  model.kill = one_of(0.0, 0.0, 0.01);
  model.crowd = one_of(1.0, 1.0, 1.0, 0.2, 0.02);
  // In a crowd everybody would trade with everybody.
  if (model.radius > 0.1 * shorter || model.crowd < 1.0) model.count = std::min<std::uint64_t>(model.count, 400);
  return market;
}

TEST(TiledModelOnRanks, HasTheBitsOfOneProcess) {
  std::array<std::size_t, 5> happened{};
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    Market const s = any_market(seed);
    EndedWorld const one = advance(s.model, s.start(), {.step = 15}, {.threads = 1});
    for (std::size_t k = 0; k < happened.size(); ++k) happened[k] += one.world.events[k];
    for (std::size_t const ranks : {2U, 3U, 4U, 9U}) {
      ASSERT_NO_FATAL_FAILURE(expect_same(one, advance_on_ranks(s.model, s.start(), {.step = 15}, ranks, 1 + seed % 2),
                                          "seed " + std::to_string(seed) + ", " + std::to_string(ranks) + " ranks"));
    }
  }
  for (std::size_t const times : happened) EXPECT_GT(times, 100U);
}

TEST(TiledModelOnRanks, HasTheBitsOfOneProcessOnAsManyRanksAsTiles) {
  for (Edge const edge : {Edge::wall, Edge::periodic}) {
    Market const s{.model = {.count = 2500, .radius = 0.02, .late = 0.004, .birth = 0.02, .death = 0.02},
                   .box = Box(1.25, 1.0, edge),
                   .seed = 6};
    std::size_t const tiles = Tiling(cells_of_step(s.box, s.model.radius, s.model.count).layout).tiles().size();
    ASSERT_GE(tiles, 9U);
    EndedWorld const one = advance(s.model, s.start(), {.step = 20}, {});
    for (std::size_t const ranks : {tiles, tiles + 3}) {
      ASSERT_NO_FATAL_FAILURE(
          expect_same(one, advance_on_ranks(s.model, s.start(), {.step = 20}, ranks, 1), std::to_string(ranks)));
    }
  }
}

TEST(TiledModelOnRanks, HasTheBitsOfOneProcessWherePopulationsGrowAndDieOut) {
  for (bool const dies : {false, true}) {
    Market s{.model = {.count = dies ? 2000U : 1U, .radius = 0.02}, .box = Box(2.0, 1.0, Edge::periodic), .seed = 2};
    (dies ? s.model.death : s.model.birth) = 0.3;
    EndedWorld const one = advance(s.model, s.start(), {.step = 24}, {});
    EXPECT_TRUE(dies ? one.world.agents.size() < 5 : one.world.agents.size() > 500) << one.world.agents.size();
    expect_same(one, advance_on_ranks(s.model, s.start(), {.step = 24}, 4, 1), dies ? "dies out" : "grows");
  }
}

TEST(TiledModelOnRanks, ContinuesOnAnotherNumberOfRanks) {
  for (Edge const edge : {Edge::wall, Edge::periodic}) {
    Market const s{.model = {.count = 900, .radius = 0.03, .late = 0.003, .birth = 0.03, .death = 0.02},
                   .box = Box(1.0, 1.5, edge),
                   .seed = 5};
    EndedWorld const one = advance(s.model, s.start(), {.step = 20}, {});
    EndedWorld<Traders> many = advance_on_ranks(s.model, s.start(), {.step = 5}, 3, 1);
    std::uint64_t step = 5;
    for (std::size_t const count : {1U, 5U, 2U}) {
      ThreadRanks ranks(count);
      continue_on_ranks(s.model, many, {.step = step += 5}, ranks, 1);
    }
    expect_same(one, many, "continued");
  }
}

TEST(TiledModelOnRanks, FailsWhereOneProcessDoesWithTheSameWords) {
  for (std::uint64_t const failing_agents : {1U, 40U}) {
    for (std::uint64_t const fails_at : {0U, 1U, 13U}) {
      for (bool const is_late : {false, true}) {
        Market s{.model = {.count = 1000, .radius = 0.02, .late = is_late ? 0.1 : 0.0, .birth = 0.02, .death = 0.02},
                 .box = Box(1.0, 2.0, Edge::wall),
                 .seed = 4};
        s.model.fails_at = fails_at;
        s.model.failing_agents = failing_agents;
        s.model.fails_late = is_late ? 1 : 0;
        EndedWorld const one = advance(s.model, s.start(), {.step = 20}, {.threads = 1});
        ASSERT_NE(one.failure.find("fails"), std::string::npos) << one.failure;
        EndedWorld const before = advance(s.model, s.start(), {.step = one.world.clock.step}, {});
        EXPECT_EQ(all_of(before), all_of(one)) << "the world is not as it was before the step";
        expect_same(one, advance(s.model, s.start(), {.step = 20}, {.threads = 3}), "threads");
        for (std::size_t const ranks : {2U, 5U}) {
          expect_same(one, advance_on_ranks(s.model, s.start(), {.step = 20}, ranks, 2), "ranks");
        }
      }
    }
  }
}

TEST(TiledModelOnRanks, EndsWhereItIsAskedToOrTheQuestionFails) {
  Market const s{
      .model = {.radius = 0.03, .birth = 0.01, .death = 0.01}, .box = Box(1.25, 0.8, Edge::periodic), .seed = 9};
  expect_to_be_whole_where_it_ends(s.model, s.start());
}

TEST(TiledModelOnRanks, EndsAtTheStepWithEnoughCollisions) {
  Market const s{.model = {.radius = 0.03}, .box = Box(1.25, 0.8, Edge::wall), .seed = 3};
  StopCondition const enough{.pair_collisions = 30'000};
  EndedWorld const one = advance(s.model, s.start(), enough, {});
  EXPECT_GT(one.world.clock.step, 5U);
  expect_same(one, advance_on_ranks(s.model, s.start(), enough, 4, 1), "collisions");
}

TEST(TiledModelOnRanks, HasTheBitsOfOneProcessForColloidsWithLateDisks) {
  for (Box const& box : {Box(1.25, 0.8, Edge::wall), Box(1.3, 0.7, Edge::periodic)}) {
    TiledColloid model;
    model.disks = {.count = 1500, .packing_fraction = 0.6, .start = StartKind::triangular};
    model.velocities.kind = VelocityKind::maxwell;
    EndedWorld const one = advance(model, started(model, box, 3), {.step = 40}, {});
    ASSERT_EQ(one.failure, "");
    for (std::size_t const ranks : {2U, 6U}) {
      expect_same(one, advance_on_ranks(model, started(model, box, 3), {.step = 40}, ranks, 2), "colloid");
    }
  }
}

/// Agents that go too far, though they do not say that they are not local.
struct FarMovers {
  static constexpr std::string_view name = "far_movers_of_test";
  static constexpr std::string_view documentation = "Agents that go too far.";
  static constexpr Schedule schedule = Schedule::tiled;
  using Agents = Population<X, Y>;

  [[nodiscard]] double cutoff() const { return 0.02; }
  [[nodiscard]] double time_step() const { return 0.1; }
  void start(World<FarMovers>& world) const {
    for (int n = 0; n < 1000; ++n) world.agents.add(0.001 * n, 0.799 - 0.0007 * n);
  }
  void turn(Turn<FarMovers>& self) const {
    self.move_by(self.clock().step == 3 && self.id() % 100 == 17 ? Vector{0.3, 0.0} : Vector{0.01, 0.0});
  }
};

TEST(TiledModelOnRanks, RefusesAMoveOfALocalAgentBeyondTheCellsNextToItsOwn) {
  Box const box(1.25, 0.8, Edge::periodic);
  EndedWorld const one = advance(FarMovers{}, started(FarMovers{}, box, 1), {.step = 9}, {.threads = 1});
  EXPECT_NE(one.failure.find("step 3: agent "), std::string::npos) << one.failure;
  EXPECT_NE(one.failure.find("farther than the cells next to its own"), std::string::npos) << one.failure;
  EXPECT_EQ(one.world.clock.step, 3U);
  expect_same(one, advance(FarMovers{}, started(FarMovers{}, box, 1), {.step = 9}, {.threads = 2}), "threads");
  expect_same(one, advance_on_ranks(FarMovers{}, started(FarMovers{}, box, 1), {.step = 9}, 3, 1), "ranks");
}

}  // namespace
}  // namespace gridlock
