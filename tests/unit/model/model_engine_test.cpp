// What the engine of models promises, in worlds small enough to count by hand.

#include "gridlock/model/model_engine.hpp"

#include <gtest/gtest.h>

#include <array>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "gridlock/core/error.hpp"
#include "gridlock/model/model.hpp"
#include "thread_ranks.hpp"

namespace gridlock {
namespace {

struct Kind {
  using type = std::uint32_t;
};

/// Agents that do what the test says in their turn.
template <Schedule order>
struct Scripted {
  static constexpr std::string_view name = "scripted";
  static constexpr Schedule schedule = order;
  static constexpr std::array<std::string_view, 1> events{"turns"};
  using Agents = Population<X, Y, ImageX, ImageY>;

  std::function<void(Turn<Scripted>&)> script;

  [[nodiscard]] double cutoff() const { return 0.1; }
  [[nodiscard]] double time_step() const { return 0.5; }
  void turn(Turn<Scripted>& self) const {
    self.count(0);
    script(self);
  }
};

template <Schedule order>
World<Scripted<order>> world_of(Box const& box, std::vector<Vector> const& places) {
  World<Scripted<order>> world{.box = box, .seed = 3};
  for (Vector const p : places) world.agents.add(p.x, p.y, 0, 0);
  return world;
}

template <class Order>
class ModelEngineOf : public testing::Test {};
template <Schedule order>
struct Takes {
  static constexpr Schedule schedule = order;
};
using Orders = testing::Types<Takes<Schedule::synchronous>, Takes<Schedule::sequential>, Takes<Schedule::tiled>>;
TYPED_TEST_SUITE(ModelEngineOf, Orders);

TYPED_TEST(ModelEngineOf, GivesEveryAgentOneTurnAStepHoweverManyThereComeToBe) {
  using Model = Scripted<TypeParam::schedule>;
  for (std::uint64_t const threads : {1, 3}) {
    // Each has a child somewhere in every step: the cells become more and smaller while they double.
    Model const model{.script = [](Turn<Model>& self) {
      RandomStream random = self.random();
      double const x = 4.0 * random.uniform();
      self.give_birth(x, 3.0 * random.uniform(), 0, 0);
    }};
    auto world = world_of<TypeParam::schedule>(Box(4.0, 3.0, Edge::periodic), std::vector<Vector>(20, {1.0, 2.0}));
    ModelEngine<Model> engine(model, world.box, {.threads = threads});
    engine.advance(world, {.step = 3});
    engine.advance(world, {.step = 7});
    EXPECT_EQ(world.agents.size(), 20U << 7);
    EXPECT_EQ(world.events[0], 20U * ((1U << 7) - 1)) << threads << " threads";
  }
}

TYPED_TEST(ModelEngineOf, FindsTheSameNeighboursWhetherOrNotAgentsStoodStillBefore) {
  using Model = Scripted<TypeParam::schedule>;
  // They stand still, but for a step in which they move, one in which some die and one in which some have a child.
  Model const model{.script = [](Turn<Model>& self) {
    self.for_each_neighbour(0.1, [&](auto const& other) {
      self.template set<ImageX>(self.template get<ImageX>() + static_cast<std::int32_t>(other.id()));
    });
    std::uint64_t const step = self.clock().step;
    if (step == 3) self.move_by(0.09 * self.random().in_unit_disk());
    if (step == 6 && self.id() % 3 == 0) self.die();
    if (step == 9 && self.id() % 4 == 0) self.give_birth(self.position().x, self.position().y, 0, 0);
  }};
  std::vector<Vector> places;
  for (std::uint64_t k = 0; k < 60; ++k)
    places.push_back({0.016 * static_cast<double>(k), 0.5 + 0.004 * static_cast<double>(k % 7)});
  auto at_once = world_of<TypeParam::schedule>(Box(1.0, 1.0, Edge::periodic), places);
  auto step_by_step = at_once;
  ModelEngine<Model> engine(model, at_once.box, {.verify_every = 1});
  engine.advance(at_once, {.step = 13});
  for (std::uint64_t step = 1; step <= 13; ++step) {
    ModelEngine<Model>(model, at_once.box, {}).advance(step_by_step, {.step = step});
  }
  EXPECT_EQ(hash(at_once), hash(step_by_step));
  EXPECT_EQ(at_once.agents.size(), 50U);
}

TYPED_TEST(ModelEngineOf, EndsWithTheStepThatReachesTheTime) {
  using Model = Scripted<TypeParam::schedule>;
  auto world = world_of<TypeParam::schedule>(Box(1.0, 1.0, Edge::wall), {{0.5, 0.5}});
  ModelEngine<Model> engine({.script = [](Turn<Model>&) {}}, world.box, {});
  engine.advance(world, {.time = 1.5});  // three steps, exactly
  EXPECT_EQ(world.clock.step, 3U);
  engine.advance(world, {.time = 1.75});
  EXPECT_EQ(world.clock.step, 4U);
}

TYPED_TEST(ModelEngineOf, LetsAnAgentThatIsKilledByManyDieOnce) {
  using Model = Scripted<TypeParam::schedule>;
  Model const model{.script = [](Turn<Model>& self) {
    if (self.id() == 0) self.die();
    self.for_each_neighbour(0.1, [](Neighbour<Model> const& other) {
      if (other.id() == 0) other.kill();
    });
  }};
  auto world =
      world_of<TypeParam::schedule>(Box(1.0, 1.0, Edge::wall), {{0.5, 0.5}, {0.52, 0.5}, {0.5, 0.53}, {0.46, 0.5}});
  ModelEngine<Model>(model, world.box, {}).advance(world, {.step = 1});
  EXPECT_EQ(world.agents.size(), 3U);
  EXPECT_FALSE(world.agents.contains(0));
}

TYPED_TEST(ModelEngineOf, NamesTheNewbornInTheOrderOfTheirParentsWhereverTheyLive) {
  using Model = Scripted<TypeParam::schedule>;
  // The parents stand against the order of the cells.
  std::vector<Vector> const places{{0.9, 0.9}, {0.1, 0.9}, {0.9, 0.1}, {0.1, 0.1}};
  auto world = world_of<TypeParam::schedule>(Box(1.0, 1.0, Edge::wall), places);
  Model const model{.script = [](Turn<Model>& self) { self.give_birth(self.position().x, self.position().y, 0, 0); }};
  ModelEngine<Model>(model, world.box, {.threads = 2}).advance(world, {.step = 1});
  for (Id child = 4; child < 8; ++child) {
    std::size_t const row = world.agents.index_of(child);
    ASSERT_NE(row, World<Model>::Agents::not_found);
    EXPECT_EQ(world.agents.template column<X>()[row], places[child - 4].x) << child;
    EXPECT_EQ(world.agents.template column<Y>()[row], places[child - 4].y) << child;
  }
}

TYPED_TEST(ModelEngineOf, MovesCountTheEdgesTheyCrossOnEachAxis) {
  using Model = Scripted<TypeParam::schedule>;
  auto world = world_of<TypeParam::schedule>(Box(1.0, 2.0, Edge::periodic), {{0.5, 1.95}, {0.02, 1.0}});
  Model const model{.script = [](Turn<Model>& self) {
    self.move_by(self.id() == 0 ? Vector{0.0, 0.125} : Vector{-0.125, 0.0});
  }};
  ModelEngine<Model>(model, world.box, {}).advance(world, {.step = 1});
  auto const images = [&](Id id) {
    std::size_t const row = world.agents.index_of(id);
    return std::pair(world.agents.template column<ImageX>()[row], world.agents.template column<ImageY>()[row]);
  };
  EXPECT_EQ(images(0), (std::pair{0, 1}));
  EXPECT_EQ(images(1), (std::pair{-1, 0}));
}

TYPED_TEST(ModelEngineOf, RandomNumbersOfDifferentPurposesAndStepsDiffer) {
  using Model = Scripted<TypeParam::schedule>;
  std::vector<double> drawn;
  Model const model{.script = [&](Turn<Model>& self) {
    for (std::uint64_t const purpose : {0, 1, 2}) drawn.push_back(self.random(purpose).uniform());
  }};
  auto world = world_of<TypeParam::schedule>(Box(1.0, 1.0, Edge::wall), {{0.5, 0.5}});
  ModelEngine<Model>(model, world.box, {}).advance(world, {.step = 2});
  std::ranges::sort(drawn);
  ASSERT_EQ(drawn.size(), 6U);
  EXPECT_EQ(std::ranges::adjacent_find(drawn), drawn.end());
}

TYPED_TEST(ModelEngineOf, VerifiesSearchesWithinSearches) {
  using Model = Scripted<TypeParam::schedule>;
  std::size_t found = 0;
  Model const model{.script = [&](Turn<Model>& self) {
    self.for_each_neighbour(0.1, [&](Neighbour<Model> const&) {
      self.for_each_neighbour(0.05, [&](Neighbour<Model> const&) { ++found; });
    });
  }};
  auto world = world_of<TypeParam::schedule>(Box(1.0, 1.0, Edge::wall), {{0.5, 0.5}, {0.53, 0.5}, {0.58, 0.5}});
  EXPECT_NO_THROW(ModelEngine<Model>(model, world.box, {.verify_every = 1}).advance(world, {.step = 1}));
  // 0 sees 1 and 2 and each time 1; 1 sees 0 and 2 and each time 0 (2 is exactly 0.05 away, give or take the rounding).
  EXPECT_GE(found, 4U);
}

TYPED_TEST(ModelEngineOf, ASearchAroundAFarPointEndsTheRunOrMissesNobody) {
  using Model = Scripted<TypeParam::schedule>;
  // Around a point many cells away from the agent whose turn it is, though no farther than the model says.
  Model const model{.script = [](Turn<Model>& self) {
    if (self.id() == 0) self.for_each_neighbour({0.93, 0.5}, 0.1, [](Neighbour<Model> const&) {});
  }};
  auto world = world_of<TypeParam::schedule>(Box(1.0, 1.0, Edge::wall), {{0.05, 0.5}, {0.95, 0.5}, {0.9, 0.5}});
  std::string message;
  try {
    ModelEngine<Model>(model, world.box, {.verify_every = 5}).advance(world, {.step = 1});
  } catch (RunFailure const& failure) {
    message = failure.what();
  }
  if constexpr (TypeParam::schedule == Schedule::sequential) {
    // Here the cells of any search are looked at.
    EXPECT_EQ(message, "");
  } else if constexpr (TypeParam::schedule == Schedule::synchronous) {
    EXPECT_NE(message.find("step 0: agent 0 searches within 0.1 of (0.93, 0.5) from (0.05, 0.5)"), std::string::npos)
        << message;
  } else {
    EXPECT_NE(message.find("step 0: "), std::string::npos) << message;
    EXPECT_NE(message.find("found 0 agents where there are 2; the first difference is agent 1"), std::string::npos)
        << message;
  }
}

/// Agents in cells of unequal sides, of which none is local: every turn is taken late.
struct Latecomers {
  static constexpr std::string_view name = "latecomers";
  static constexpr Schedule schedule = Schedule::tiled;
  static constexpr std::array<std::string_view, 1> events{"turns"};
  using Agents = Population<X, Y>;
  double* room_told;

  [[nodiscard]] double cutoff() const { return 0.1; }
  [[nodiscard]] double time_step() const { return 0.5; }
  [[nodiscard]] CellLayout cells(World<Latecomers> const& world) const { return {world.box, 8, 8}; }
  [[nodiscard]] bool is_local(Turn<Latecomers> const&, double room) const {
    *room_told = room;
    return false;
  }
  void turn(Turn<Latecomers>& self) const { self.count(0); }
};

TEST(ModelEngineInTiles, TakesLateTurnsOnceAStepAndTellsTheShorterSideOfACell) {
  for (Box const& box : {Box(2.0, 1.0, Edge::wall), Box(1.0, 2.0, Edge::wall)}) {
    double room = 0.0;
    World<Latecomers> world{.box = box, .seed = 3};
    for (int n = 0; n < 10; ++n) world.agents.add(0.05 + 0.09 * n, 0.5);
    ModelEngine<Latecomers>({.room_told = &room}, box, {}).advance(world, {.step = 4});
    EXPECT_EQ(world.events[0], 40U);
    EXPECT_EQ(room, 0.125);
  }
}

/// A world that the test changes.
struct Script {
  static constexpr std::string_view name = "script";
  static constexpr Schedule schedule = Schedule::events;
  using Agents = Population<X, Y, Kind>;
  std::function<void(MutableWorld<Script>&)> script;
  [[nodiscard]] double cutoff() const { return 0.2; }
  [[nodiscard]] double time_step() const { return 1.0; }
  void step(MutableWorld<Script>& world) const { script(world); }
};

World<Script> world_of_events(std::vector<Vector> const& places) {
  World<Script> world{.box = Box(1.0, 1.0, Edge::wall), .seed = 3};
  for (Vector const p : places) world.agents.add(p.x, p.y, 0U);
  return world;
}

TEST(ModelEngineOfEvents, KnowsTheAgentsThatCameBetweenTwoCalls) {
  std::vector<Id> seen;
  ModelEngine<Script> engine({.script =
                                  [&](MutableWorld<Script>& world) {
                                    seen.clear();
                                    world.for_each_neighbour({0.5, 0.5}, 0.2, [&](Id id) { seen.push_back(id); });
                                  }},
                             Box(1.0, 1.0, Edge::wall), {});
  World<Script> world = world_of_events({{0.4, 0.5}, {0.9, 0.9}});
  engine.advance(world, {.step = 1});
  EXPECT_EQ(seen, (std::vector<Id>{0}));
  world.agents.add(0.6, 0.5, 0U);
  engine.advance(world, {.step = 2});
  EXPECT_EQ(seen, (std::vector<Id>{0, 2}));
}

TEST(ModelEngineOfEvents, RefusesARestoredWorldWithAnAgentOutsideTheBoxAsInput) {
  ModelEngine<Script> const engine({}, Box(1.0, 1.0, Edge::wall), {});
  World<Script> world = world_of_events({{0.4, 0.5}, {0.9, 0.9}});
  EXPECT_NO_THROW(engine.require_valid(world));
  world.agents.column<X>()[1] = 1.5;
  EXPECT_THROW(engine.require_valid(world), Error);
}

TEST(MutableWorld, TheNearestIsTheOneOfTheLowerIdAmongEquallyNearAndNeverTheExcepted) {
  World<Script> world = world_of_events({{0.5, 0.5}, {0.625, 0.5}, {0.375, 0.5}, {0.5, 0.6875}});
  ModelEngine<Script>({.script =
                           [](MutableWorld<Script>& open) {
                             Vector const p{0.5, 0.5};
                             EXPECT_EQ(open.nearest(p, 0.2), std::optional<Id>(0));
                             EXPECT_EQ(open.nearest(p, 0.2, Id{0}), std::optional<Id>(1));
                             EXPECT_EQ(open.nearest(p, 0.1, Id{0}), std::nullopt);
                             EXPECT_EQ(open.nearest({0.5, 0.7}, 0.2, Id{0}), std::optional<Id>(3));
                           }},
                      world.box, {.verify_every = 1})
      .advance(world, {.step = 1});
}

TEST(MutableWorld, NeighboursComeInTheOrderOfTheirIds) {
  std::vector<Vector> places;
  for (int n = 0; n < 60; ++n) places.push_back({0.5 + 0.0625 * ((n * 7) % 5 - 2), 0.5 + 0.0625 * ((n * 11) % 3 - 1)});
  World<Script> world = world_of_events(places);
  ModelEngine<Script>({.script =
                           [](MutableWorld<Script>& open) {
                             for (Id const gone : {3, 20, 41}) open.remove(gone);  // the last rows take their places
                             std::vector<Id> seen;
                             open.for_each_neighbour({0.5, 0.5}, 0.2, [&](Id id) { seen.push_back(id); });
                             EXPECT_EQ(seen.size(), 57U);
                             EXPECT_TRUE(std::ranges::is_sorted(seen));
                           }},
                      world.box, {})
      .advance(world, {.step = 1});
}

TEST(MutableWorld, RandomNumbersDifferFromStepToStep) {
  std::vector<double> drawn;
  World<Script> world = world_of_events({});
  ModelEngine<Script>({.script = [&](MutableWorld<Script>& open) { drawn.push_back(open.random().uniform()); }},
                      world.box, {})
      .advance(world, {.step = 2});
  ASSERT_EQ(drawn.size(), 2U);
  EXPECT_NE(drawn[0], drawn[1]);
}

TEST(Observations, CountsAndMeansAreOfTheKindsThatHaveANameWhereverOthersStand) {
  Population<X, Y, Kind> agents;
  // Kind 7 has no name; it stands before others.
  for (auto const& [x, kind] : {std::pair{9.0, 7U}, std::pair{1.0, 0U}, std::pair{2.0, 1U}, std::pair{5.0, 0U}}) {
    agents.add(x, 0.0, kind);
  }
  Observations seen;
  seen.add_counts<Kind>(agents, {"zeros", "ones", "twos"});
  seen.add_means<Kind>(agents, {"x_of_zeros", "x_of_ones", "x_of_twos"},
                       [&](std::size_t row) { return agents.column<X>()[row]; });
  std::vector<double> values;
  for (auto const& entry : seen.entries()) values.push_back(entry.value);
  ASSERT_EQ(values.size(), 6U);
  EXPECT_EQ((std::vector<double>{values[0], values[1], values[2]}), (std::vector<double>{2.0, 1.0, 0.0}));
  EXPECT_EQ(values[3], 3.0);
  EXPECT_EQ(values[4], 2.0);
  EXPECT_TRUE(std::isnan(values[5]));
}

struct Grains {
  using Agents = Population<X, Y, Kind>;
};

TEST(AgentSums, AreExactWhateverTheOrderOfTheAgents) {
  std::vector<double> const terms{1e300, 1.0, -1e300, 0x1p-60, -1.0, 3.0};
  for (bool const is_reversed : {false, true}) {
    World<Grains> world{.box = Box(1.0, 1.0, Edge::wall)};
    for (std::size_t k = 0; k < terms.size(); ++k) {
      std::size_t const n = is_reversed ? terms.size() - 1 - k : k;
      world.agents.add(terms[n], 0.5, static_cast<std::uint32_t>(n % 2));
    }
    AgentSums<Grains> const agents(world);
    EXPECT_EQ(agents.size(), 6U);
    EXPECT_EQ(agents.sum([](auto const& agent) { return agent.template get<X>(); }), 3.0 + 0x1p-60);
    EXPECT_EQ(agents.counts<Kind>(3), (std::vector<std::uint64_t>{3, 3, 0}));
  }
}

TEST(AgentSums, AreThoseOfAllProcesses) {
  World<Grains> world{.box = Box(1.0, 1.0, Edge::wall)};
  for (double const x : {0.25, 0.5}) world.agents.add(x, 0.5, 1);
  World<Grains> elsewhere{.box = Box(1.0, 1.0, Edge::wall)};
  elsewhere.agents.add(10.0, 0.5, 0);
  test::ThreadRanks(2).run([&](Communicator& here) {
    AgentSums<Grains> const agents(here.rank() == 0 ? world : elsewhere, here);
    auto const x = [](auto const& agent) { return agent.template get<X>(); };
    EXPECT_EQ(agents.size(), 3U);
    EXPECT_EQ(agents.sum(x), 10.75);
    EXPECT_EQ(agents.min(x), 0.25);
    EXPECT_EQ(agents.max(x), 10.0);
    Observations seen;
    seen.add_counts<Kind>(agents, {"zeros", "ones"});
    EXPECT_EQ(seen.entries()[0].value, 1.0);
    EXPECT_EQ(seen.entries()[1].value, 2.0);
  });
}

TEST(Motion, AWallMirrorsTheWayBeyondItAndSaysWhichDirectionTurned) {
  Box const box(2.0, 1.0, Edge::wall);
  Motion const right = motion(box, {1.75, 0.5}, {0.5, 0.25});
  EXPECT_EQ(right.end, (Vector{1.75, 0.75}));
  EXPECT_TRUE(right.bounce.x);
  EXPECT_FALSE(right.bounce.y);
  Motion const top = motion(box, {0.5, 0.75}, {-0.25, 0.5});
  EXPECT_EQ(top.end, (Vector{0.25, 0.75}));
  EXPECT_FALSE(top.bounce.x);
  EXPECT_TRUE(top.bounce.y);
  Motion const corner = motion(box, {0.25, 0.25}, {-0.5, -0.375});
  EXPECT_EQ(corner.end, (Vector{0.25, 0.125}));
  EXPECT_TRUE(corner.bounce.x && corner.bounce.y);
}

}  // namespace
}  // namespace gridlock
