// Agent models on several ranks, here threads: the bits, the names and counts of one process, however the box
// is cut and whoever is born or dies where.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <vector>

#include "gridlock/core/error.hpp"
#include "model_on_ranks.hpp"
#include "models/epidemic.hpp"
#include "models/flocking.hpp"
#include "thread_ranks.hpp"
#include "wanderers.hpp"

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
using test::Wanderers;

struct System {
  Wanderers model;
  Box box;
  std::uint64_t seed;

  [[nodiscard]] World<Wanderers> start() const { return started(model, box, seed); }
};

System any_system(std::uint64_t seed) {
  RandomStream random(seed, 0, 0, Purpose::model_start);
  auto const one_of = [&](auto... values) {
    std::array const all{values...};
    return all[random.below(all.size())];
  };
  System system{.model = {},
                .box = Box(one_of(1.0, 0.3, 3.0), one_of(1.0, 0.25, 2.0), one_of(Edge::wall, Edge::periodic),
                           one_of(Edge::wall, Edge::periodic)),
                .seed = seed};
  Wanderers& model = system.model;
  double const shorter = std::min(system.box.width(), system.box.height());
  model.count = one_of(0UL, 1UL, 7UL, 60UL, 400UL, 900UL);
  model.radius = shorter * one_of(0.5, 0.3, 0.11, 0.03, 0.004);
  model.speed = shorter * one_of(0.0, 0.01, 0.1, 0.4);
  model.jump = one_of(0.0, 0.0, 0.01, 0.3);
  model.birth = one_of(0.0, 0.02, 0.04);
  model.far_birth = one_of(0.0, 0.0, 0.02);
  model.death = one_of(0.0, 0.02, 0.05);
  model.kill = one_of(0.0, 0.0, 0.01);
  model.crowd = one_of(1.0, 1.0, 0.2, 0.02);
  return system;
}

TEST(ModelOnRanks, HasTheBitsOfOneProcess) {
  std::array<std::size_t, 4> happened{};
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    System const s = any_system(seed);
    EndedWorld const one = advance(s.model, s.start(), {.step = 25}, {.threads = 1});
    for (std::size_t k = 0; k < happened.size(); ++k) happened[k] += one.world.events[k];
    for (std::size_t const ranks : {2U, 3U, 4U, 9U}) {
      ASSERT_NO_FATAL_FAILURE(expect_same(one, advance_on_ranks(s.model, s.start(), {.step = 25}, ranks, 1 + seed % 2),
                                          "seed " + std::to_string(seed) + ", " + std::to_string(ranks) + " ranks"));
    }
  }
  for (std::size_t const times : happened) EXPECT_GT(times, 100U);
}

TEST(ModelOnRanks, HasTheBitsOfOneProcessForShippedModels) {
  Epidemic const epidemic{.count = 700, .infected_at_start = 0.2, .radius = 0.05, .speed = 0.3, .turnover_rate = 1.0};
  Flocking const boids{.count = 500, .rule = FlockingRule::boids, .radius = 0.1, .speed = 0.02, .separation = 0.03};
  for (Box const& box : {Box(1.25, 0.8, Edge::wall), Box(1.3, 0.7, Edge::periodic)}) {
    for (std::size_t const ranks : {2U, 5U}) {
      expect_same(advance(epidemic, started(epidemic, box, 3), {.step = 80}, {}),
                  advance_on_ranks(epidemic, started(epidemic, box, 3), {.step = 80}, ranks, 1), "epidemic");
      expect_same(advance(boids, started(boids, box, 3), {.step = 40}, {}),
                  advance_on_ranks(boids, started(boids, box, 3), {.step = 40}, ranks, 2), "boids");
    }
  }
}

TEST(ModelOnRanks, HasTheBitsOfOneProcessWhereAgentsCrowd) {
  for (Edge const edge : {Edge::wall, Edge::periodic}) {
    System s{.model = {.count = 3000, .radius = 0.01, .speed = 0.01, .birth = 0.01, .death = 0.01, .crowd = 0.05},
             .box = Box(10.0, 8.0, edge),
             .seed = 5};
    for (double const jump : {0.0, 0.02}) {  // without and with a crowd that dissolves
      s.model.jump = jump;
      EndedWorld const one = advance(s.model, s.start(), {.step = 120}, {});
      for (std::size_t const ranks : {2U, 4U, 7U}) {
        ASSERT_NO_FATAL_FAILURE(
            expect_same(one, advance_on_ranks(s.model, s.start(), {.step = 120}, ranks, 1), "crowd"));
      }
    }
  }
}

TEST(ModelOnRanks, HasTheBitsOfOneProcessWherePopulationsGrowAndDieOut) {
  for (bool const dies : {false, true}) {
    System s{.model = {.count = dies ? 2000U : 1U, .radius = 0.05, .speed = 0.1},
             .box = Box(2.0, 1.0, Edge::periodic),
             .seed = 2};
    (dies ? s.model.death : s.model.birth) = 0.3;
    EndedWorld const one = advance(s.model, s.start(), {.step = 24}, {});
    EXPECT_TRUE(dies ? one.world.agents.size() < 5 : one.world.agents.size() > 500) << one.world.agents.size();
    expect_same(one, advance_on_ranks(s.model, s.start(), {.step = 24}, 4, 1), dies ? "dies out" : "grows");
  }
}

TEST(ModelOnRanks, HasTheBitsOfOneProcessOnMoreRanksThanCells) {
  for (std::uint64_t seed = 100; seed < 108; ++seed) {
    System s = any_system(seed);
    s.model.count = 1 + seed % 20;
    EndedWorld const one = advance(s.model, s.start(), {.step = 40}, {});
    ASSERT_NO_FATAL_FAILURE(
        expect_same(one, advance_on_ranks(s.model, s.start(), {.step = 40}, 16, 1), "seed " + std::to_string(seed)));
  }
}

TEST(ModelOnRanks, ContinuesOnAnotherNumberOfRanks) {
  for (std::uint64_t const seed : {2U, 5U, 11U}) {
    System const s = any_system(seed);
    EndedWorld const one = advance(s.model, s.start(), {.step = 40}, {});
    EndedWorld<Wanderers> many = advance_on_ranks(s.model, s.start(), {.step = 10}, 3, 1);
    std::uint64_t step = 10;
    for (std::size_t const count : {1U, 5U, 2U}) {
      ThreadRanks ranks(count);
      continue_on_ranks(s.model, many, {.step = step += 10}, ranks, 1);
    }
    expect_same(one, many, "seed " + std::to_string(seed));
  }
}

TEST(ModelOnRanks, FailsWhereOneProcessDoesWithTheSameWords) {
  for (std::uint64_t const failing_agents : {1U, 40U}) {
    for (std::uint64_t const fails_at : {0U, 1U, 17U}) {
      System s{.model = {.count = 500, .birth = 0.02, .death = 0.02}, .box = Box(1.0, 2.0, Edge::wall), .seed = 4};
      s.model.fails_at = fails_at;
      s.model.failing_agents = failing_agents;
      EndedWorld const one = advance(s.model, s.start(), {.step = 30}, {});
      ASSERT_NE(one.failure.find("fails"), std::string::npos) << one.failure;
      for (std::size_t const ranks : {2U, 5U}) {
        expect_same(one, advance_on_ranks(s.model, s.start(), {.step = 30}, ranks, 2), "fails");
      }
    }
  }
}

TEST(ModelOnRanks, EndsWhereItIsAskedToOrTheQuestionFails) {
  System const s{.model = {.birth = 0.01, .death = 0.01}, .box = Box(1.25, 0.8, Edge::periodic), .seed = 9};
  expect_to_be_whole_where_it_ends(s.model, s.start());
}

TEST(ModelOnRanks, SendsNoMessageThatGrowsWithTheBoxBehindItsRim) {
  // Messages of a step without births: one to each neighbour, and what all tell all.
  auto const messages_of = [](std::size_t agents, std::uint64_t steps) {
    Flocking const model{.count = agents, .radius = 0.05, .speed = 0.01};
    World<Flocking> world{.box = Box(1.25, 0.8, Edge::periodic), .seed = 1};
    start_agents(model, world);
    EndedWorld<Flocking> ended{.world = std::move(world), .counters = {}, .failure = {}, .names = {}};
    ThreadRanks ranks(2);
    continue_on_ranks(model, ended, {.step = steps}, ranks, 1);
    return ranks.messages();
  };
  constexpr std::size_t steps = 60;
  for (std::size_t const agents : {2000U, 8000U}) {
    std::size_t const messages = messages_of(agents, steps);
    EXPECT_GE(messages, steps * (2 + 2)) << "two ranks, and one gathering";
    // On a slow machine the root looks after every step whether to stop.
    EXPECT_LE(messages, steps * (2 + 2 + 2 + 1) + 20)
        << "an order, an answer and a look at most, and what is handed out and gathered";
  }
}

}  // namespace
}  // namespace gridlock
