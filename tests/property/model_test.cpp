// What must hold for any model: the same bits on any number of threads and after any cut into chunks, births and deaths
// included, and no neighbour missed.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "gridlock/core/error.hpp"
#include "models/catalyst.hpp"
#include "models/epidemic.hpp"
#include "models/flocking.hpp"

namespace gridlock {
namespace {

template <class Model>
World<Model> started(Model const& model, Box const& box) {
  World<Model> world{.box = box, .seed = 7};
  start_agents(model, world);
  return world;
}

template <class Model>
std::uint64_t hash_after(Model const& model, Box const& box, std::uint64_t steps, ModelEngineSettings const& settings,
                         std::uint64_t chunk) {
  World<Model> world = started(model, box);
  ModelEngine<Model> engine(model, box, settings);
  for (std::uint64_t step = 0; step < steps; step += chunk) engine.advance(world, {.step = step + chunk});
  EXPECT_EQ(world.clock.step, steps);
  return hash(world);
}

Epidemic restless() {
  return {.count = 700, .infected_at_start = 0.2, .radius = 0.05, .speed = 0.3, .turnover_rate = 1.0};
}

template <class Model>
void expect_same_bits(Model const& model, Box const& box) {
  std::uint64_t const expected = hash_after(model, box, 60, {.threads = 1}, 60);
  for (std::uint64_t const threads : {2, 3, 8}) {
    EXPECT_EQ(hash_after(model, box, 60, {.threads = threads}, 60), expected) << threads << " threads";
  }
  EXPECT_EQ(hash_after(model, box, 60, {.threads = 3}, 1), expected) << "chunks of one step";
}

TEST(ModelThreads, BirthsAndDeathsAndTheirNamesAreTheSameOnAnyNumberOfThreads) {
  expect_same_bits(restless(), Box(1.25, 0.8, Edge::wall));
  expect_same_bits(restless(), Box(1.3, 0.7, Edge::periodic));
}

TEST(ModelThreads, FlocksAreTheSameOnAnyNumberOfThreads) {
  expect_same_bits(Flocking{.count = 500}, Box(12.0, 9.0, Edge::periodic));
  expect_same_bits(Flocking{.count = 300, .rule = FlockingRule::boids, .radius = 5.0, .speed = 1.0},
                   Box(100.0, 100.0, Edge::periodic));
}

struct Coins {
  using type = std::uint32_t;
};

/// Agents that wander, hand a coin to their nearest neighbour, split when they are rich and die when they are poor:
/// each turn changes what the next ones see, so that any other order gives other bits. No coin is lost.
template <Schedule order>
struct Market {
  static constexpr std::string_view name = "market";
  static constexpr Schedule schedule = order;
  static constexpr std::array<std::string_view, 3> events{"gifts", "births", "deaths"};
  using Agents = Population<X, Y, VelocityX, Coins>;

  double step = 0.02;

  [[nodiscard]] double cutoff() const { return 0.1; }
  [[nodiscard]] double time_step() const { return 0.5; }
  void start(World<Market>& world) const {
    for (std::uint64_t n = 0; n < 900; ++n) {
      RandomStream random = world.start_random(n);
      Vector const p = world.anywhere(random);
      world.agents.add(p.x, p.y, random.uniform(), static_cast<std::uint32_t>(random.below(4)));
    }
  }
  void turn(Turn<Market>& self) const {
    RandomStream random = self.random();
    // Sums round in the order of the neighbours; a walk and a search from its end stay within the cutoff.
    Bounce const bounce = self.move_by(step * random.in_unit_disk());
    double sum = bounce.x ? -self.template get<VelocityX>() : self.template get<VelocityX>();
    std::optional<Neighbour<Market>> nearest;
    self.for_each_neighbour(cutoff() - step, [&](Neighbour<Market> const& other) {
      sum += 0.1 * other.template get<VelocityX>();
      double const distance = squared_length(other.separation());
      double const so_far = nearest ? squared_length(nearest->separation()) : 1.0;
      if (distance < so_far || (distance == so_far && other.id() < nearest->id())) nearest.emplace(other);
    });
    self.template set<VelocityX>(sum / (1.0 + sum * sum));
    std::uint32_t const coins = self.template get<Coins>();
    if (nearest && coins > 0) {
      nearest->template set<Coins>(nearest->template get<Coins>() + 1);
      self.template set<Coins>(coins - 1);
      self.count(0);
    }
    if (coins > 3) {
      self.template set<Coins>(self.template get<Coins>() - 2);
      self.give_birth(self.position().x, self.position().y, sum, 2U);
      self.count(1);
    } else if (coins == 0 && random.below(6) == 0) {
      self.die();
      self.count(2);
    }
  }
};

template <Schedule order>
void expect_market_to_live(Box const& box) {
  World<Market<order>> world = started(Market<order>{}, box);
  ModelEngine<Market<order>>({}, box, {.verify_every = 7}).advance(world, {.step = 60});
  for (std::uint64_t const count : world.events) EXPECT_GT(count, 20U) << "little happens";
  EXPECT_GT(world.agents.size(), 50U);
  EXPECT_GT(std::ranges::max(world.agents.ids()) >> 32, 0U) << "no name of a dead agent was taken over";
}

TEST(ModelThreads, TurnsTileByTileAreTheSameOnAnyNumberOfThreads) {
  for (Box const& box : {Box(2.7, 2.9, Edge::periodic), Box(3.0, 1.5, Edge::wall), Box(0.25, 4.0, Edge::periodic)}) {
    expect_same_bits(Market<Schedule::tiled>{}, box);
    expect_market_to_live<Schedule::tiled>(box);
  }
}

TEST(ModelSequence, TurnsOneAfterTheOtherDoNotDependOnChunksThreadsOrTheOrderOfRows) {
  for (Box const& box : {Box(2.7, 2.9, Edge::periodic), Box(3.0, 1.5, Edge::wall), Box(0.25, 4.0, Edge::periodic)}) {
    expect_same_bits(Market<Schedule::sequential>{}, box);
    expect_market_to_live<Schedule::sequential>(box);
  }
}

TEST(ModelSequence, EventsDoNotDependOnChunksThoughTheGridLastsFromStepToStep) {
  Catalyst const model{.adsorption_rate = 3000.0, .desorption_rate = 1.0, .hop_rate = 5.0, .step_length = 0.01};
  Box const box(1.0, 1.5, Edge::periodic);
  std::uint64_t const expected = hash_after(model, box, 60, {}, 60);
  EXPECT_EQ(hash_after(model, box, 60, {}, 1), expected);
  EXPECT_EQ(hash_after(model, box, 60, {.verify_every = 1}, 20), expected);
}

TEST(ModelSequence, LaterAgentsSeeWhatEarlierOnesHaveDone) {
  // A coin goes round: 0 hands its only one to its only neighbour, which hands it back in the same step.
  Box const box(1.25, 0.8, Edge::wall);
  World<Market<Schedule::sequential>> world{.box = box, .seed = 1};
  world.agents.add(0.50, 0.5, 0.0, 1U);
  world.agents.add(0.52, 0.5, 0.0, 0U);
  ModelEngine<Market<Schedule::sequential>>({.step = 0.0}, box, {}).advance(world, {.step = 1});
  EXPECT_EQ(world.events[0], 2U);
  EXPECT_EQ(world.agents.column<Coins>()[world.agents.index_of(0)], 1U);
}

TEST(ModelSearch, MissesNobodyInAnyBox) {
  for (Edge const edge : {Edge::wall, Edge::periodic}) {
    for (double const side : {2.0, 2.5, 3.1, 4.2, 5.0, 9.7}) {
      Box const box(side, edge == Edge::wall ? 0.7 * side : 2.0 + 0.3 * side, edge);
      Flocking const model{.count = 90, .speed = 0.4};
      EXPECT_NO_THROW(hash_after(model, box, 20, {.threads = 2, .verify_every = 1}, 20)) << side;
    }
  }
}

TEST(ModelSearch, MissesNobodyWhereAgentsCrowdOnAnyNumberOfThreads) {
  for (Edge const edge : {Edge::wall, Edge::periodic}) {
    Box const box(80.0, 90.0, edge);
    std::set<std::uint64_t> hashes;
    for (std::uint64_t const threads : {1U, 2U, 3U}) {
      for (std::uint64_t const chunk : {20U, 3U}) {
        Flocking const model{.count = 500, .speed = 0.1};
        World<Flocking> world{.box = box, .seed = 1};
        start_agents(model, world);
        // Nine in ten of them in a corner.
        for (std::size_t row = 0; row < 450; ++row) {
          world.agents.column<X>()[row] /= 10.0;
          world.agents.column<Y>()[row] /= 10.0;
        }
        ModelEngine<Flocking> engine(model, box, {.threads = threads, .verify_every = 1});
        while (world.clock.step < 20) {
          EXPECT_NO_THROW(engine.advance(world, {.step = std::min<std::uint64_t>(20, world.clock.step + chunk)}));
        }
        hashes.insert(hash(world));
      }
    }
    EXPECT_EQ(hashes.size(), 1U);
  }
}

TEST(ModelSearch, ADifferenceFromBruteForceEndsTheRun) {
  Box const box(20.0, 20.0, Edge::periodic);
  World<Flocking> world{.box = box, .seed = 1};
  start_agents(Flocking{.count = 200}, world);
  DeferredCommands<Flocking> commands;
  EXPECT_THROW(verify_search(world, {1.0, 1.0}, 5.0, {}, [](std::size_t) { return true; }), RunFailure);
}

TEST(ModelBox, APeriodicBoxInWhichAnAgentCouldSeeTwoImagesIsRefused) {
  EXPECT_THROW(ModelEngine<Flocking>({}, Box(1.9, 5.0, Edge::periodic), {}), Error);
  EXPECT_NO_THROW(ModelEngine<Flocking>({}, Box(1.9, 5.0, Edge::wall), {}));
}

/// Each has a child far away in every step.
struct Settlers {
  static constexpr std::string_view name = "settlers";
  static constexpr Schedule schedule = Schedule::synchronous;
  using Agents = Population<X, Y>;
  [[nodiscard]] double cutoff() const { return 1.0; }
  [[nodiscard]] double time_step() const { return 1.0; }
  void turn(Turn<Settlers>& self) const {
    RandomStream random = self.random();
    double const x = 1000.0 * random.uniform();
    self.give_birth(x, 1000.0 * random.uniform());
  }
};

/// Each has a child beside itself in every step, or all die.
struct Tribe {
  static constexpr std::string_view name = "tribe";
  static constexpr Schedule schedule = Schedule::synchronous;
  using Agents = Population<X, Y>;
  bool dies = false;
  double cutoff() const { return 0.1; }
  double time_step() const { return 1.0; }
  void turn(Turn<Tribe>& self) const {
    Vector const p = self.position();
    if (dies) {
      self.die();
    } else {
      self.give_birth(p.x, p.y);  // identical positions
    }
  }
};

TEST(ModelPopulation, OneGrowsToAMillion) {
  Box const box(1000.0, 1000.0, Edge::periodic);
  World<Settlers> world{.box = box, .seed = 1};
  world.agents.add(500.0, 500.0);
  ModelEngine<Settlers>({}, box, {.threads = 2}).advance(world, {.step = 20});
  EXPECT_EQ(world.agents.size(), std::size_t{1} << 20);
  for (Id const id : {Id{0}, Id{1}, Id{1} << 19, (Id{1} << 20) - 1}) {
    EXPECT_EQ(world.agents.ids()[world.agents.index_of(id)], id);
  }
}

TEST(ModelPopulation, EveryoneMayDieAndOneMayBecomeMany) {
  Box const box(1.25, 0.8, Edge::periodic);
  World<Tribe> world{.box = box, .seed = 1};
  world.agents.add(0.5, 0.5);
  ModelEngine<Tribe> growing({}, box, {.threads = 2});
  growing.advance(world, {.step = 14});
  EXPECT_EQ(world.agents.size(), std::size_t{1} << 14);
  ModelEngine<Tribe> dying({.dies = true}, box, {.threads = 2});
  dying.advance(world, {.step = 16});
  EXPECT_EQ(world.agents.size(), 0U);
}

}  // namespace
}  // namespace gridlock
