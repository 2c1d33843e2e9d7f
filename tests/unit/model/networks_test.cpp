// What agents of models in C++ do on networks, counted by hand, and what a run keeps of them.

#include "gridlock/model/networks.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "gridlock/core/error.hpp"
#include "gridlock/io/h5md.hpp"
#include "gridlock/io/settings_file.hpp"
#include "gridlock/model/model.hpp"
#include "gridlock/simulation/configuration.hpp"
#include "gridlock/workspace/run_directory.hpp"
#include "gridlock/workspace/verify.hpp"
#include "model_on_ranks.hpp"
#include "simulation/check.hpp"

namespace gridlock {
namespace {

struct Friends {
  static constexpr std::string_view name = "friends";
};
struct Debts {
  static constexpr std::string_view name = "debts";
  static constexpr bool is_directed = true;
};
struct Wealth {
  using type = double;
  static constexpr char const* name = "wealth";
};

/// Four agents on two networks, which do in their turn what the test says.
template <Schedule order>
struct Circle {
  static constexpr std::string_view name = "circle";
  static constexpr Schedule schedule = order;
  using Agents = Population<X, Y, Wealth>;
  using Networks = NetworkSet<Friends, Debts>;

  std::function<void(Turn<Circle>&)> script;
  std::function<void(NetworksOfStep<Circle>&)> script_of_step = [](NetworksOfStep<Circle>&) {};

  [[nodiscard]] double cutoff() const { return 0.1; }
  [[nodiscard]] double time_step() const { return 1.0; }
  [[nodiscard]] std::uint64_t agents_at_start() const { return 4; }
  typename Agents::Values first_agent(World<Circle> const& /*world*/, std::uint64_t number) const {
    // Rows are sorted by cells, so that they are not in the order of the Ids.
    return {0.9 - 0.2 * static_cast<double>(number), 0.5, static_cast<double>(1 << number)};
  }
  void start_networks(World<Circle>& world) const {
    network_of<Friends>(world).connect({{3, 0, 0.5}, {0, 1, 2.0}, {2, 0, 4.0}});
    network_of<Debts>(world).connect({{1, 3, 1.0}, {3, 1, 1.0}, {1, 0, 1.0}});
  }
  void turn(Turn<Circle>& self) const { script(self); }
  void step_networks(NetworksOfStep<Circle>& networks) const { script_of_step(networks); }
};

template <class Model>
World<Model> started_circle(Model const& model) {
  World<Model> world{.box = Box(1.0, 1.0, Edge::periodic), .seed = 3};
  start_agents(model, world);
  return world;
}
template <class Model>
World<Model> after(Model const& model, std::uint64_t steps) {
  World<Model> world = started_circle(model);
  ModelEngine<Model>(model, world.box, {.threads = 2}).advance(world, {.step = steps});
  return world;
}

template <Schedule order>
void expect_neighbours_in_the_order_of_their_ids() {
  using Model = Circle<order>;
  using Seen = std::vector<std::pair<Id, double>>;
  std::array<Seen, 4> friends;
  std::array<Seen, 4> debts;
  Model const model{.script = [&](Turn<Model>& self) {
    auto const note_in = [](Seen& seen) {
      return [&](Neighbour<Model> const& other, double weight) {
        EXPECT_EQ(other.template get<Wealth>(), static_cast<double>(1 << other.id()));
        seen.emplace_back(other.id(), weight);
      };
    };
    self.template for_each_neighbour<Friends>(note_in(friends[self.id()]));
    self.template for_each_neighbour<Debts>(note_in(debts[self.id()]));
    EXPECT_EQ(self.template degree<Friends>(), friends[self.id()].size());
    EXPECT_EQ(self.template neighbour<Friends>(0).id(), friends[self.id()].front().first);
    EXPECT_TRUE(self.template network<Friends>().has(3, 0));
  }};
  static_cast<void>(after(model, 1));
  EXPECT_EQ(friends, (std::array<Seen, 4>{Seen{{1, 2.0}, {2, 4.0}, {3, 0.5}}, {{0, 2.0}}, {{0, 4.0}}, {{0, 0.5}}}));
  EXPECT_EQ(debts, (std::array<Seen, 4>{Seen{}, {{0, 1.0}, {3, 1.0}}, {}, {{1, 1.0}}}));
}

TEST(ModelNetworks, GiveAnAgentItsNeighboursInTheOrderOfTheirIds) {
  expect_neighbours_in_the_order_of_their_ids<Schedule::synchronous>();
  expect_neighbours_in_the_order_of_their_ids<Schedule::sequential>();
}

TEST(ModelNetworks, LoseTheEdgesOfTheDeadAndConnectTheNewbornWithTheirParents) {
  using Model = Circle<Schedule::synchronous>;
  std::size_t friends_of_one = 0;
  Model const model{.script =
                        [&](Turn<Model>& self) {
                          if (self.clock().step == 1) {
                            if (self.id() == 1) friends_of_one = self.degree<Friends>();
                            return;
                          }
                          if (self.id() == 0) self.die();
                          if (self.id() == 1) self.give_birth(0.5, 0.5, 7.0);
                        },
                    .script_of_step =
                        [](NetworksOfStep<Model>& networks) {
                          for (auto const& [parent, child] : networks.births()) {
                            networks.get<Friends>().connect({{.from = parent, .to = child, .weight = 0.25}});
                          }
                        }};
  World<Model> const world = after(model, 2);
  Id const child = world.agents.ids()[static_cast<std::size_t>(std::ranges::find(world.agents.column<Wealth>(), 7.0) -
                                                               world.agents.column<Wealth>().begin())];
  ASSERT_EQ(world.networks[1].name(), "friends");
  EXPECT_TRUE(std::ranges::equal(world.networks[1].edges(), std::vector<NetworkEdge>{{1, child, 0.25}}));
  EXPECT_TRUE(std::ranges::equal(world.networks[0].edges(), std::vector<NetworkEdge>{{1, 3, 1.0}, {3, 1, 1.0}}));
  EXPECT_EQ(friends_of_one, 1U);
}

template <class Act>
std::string failure_by(Act act) {
  try {
    act();
  } catch (RunFailure const& failure) {
    return failure.what();
  } catch (Error const& error) {
    return error.what();
  }
  return "nothing";
}

TEST(ModelNetworks, RefuseWhatAMistakenModelAsksOfThem) {
  using Model = Circle<Schedule::synchronous>;
  auto const failure_after = [](std::vector<NetworkEdge> const& edges) {
    return failure_by([&] {
      after(Model{.script = [](Turn<Model>&) {},
                  .script_of_step = [&](NetworksOfStep<Model>& networks) { networks.get<Friends>().connect(edges); }},
            1);
    });
  };
  EXPECT_EQ(failure_after({{0, 1, 1.0}}).find("step 0: an edge is there twice in the network friends: agents 0 and 1"),
            0U);
  EXPECT_EQ(
      failure_after({{0, 9, 1.0}}).find("step 0: an edge of the network friends leads to agent 9, which does not"), 0U);
  World<Model> const without{.box = Box(1.0, 1.0, Edge::periodic)};
  EXPECT_NE(failure_by([&] { require_networks(without); }).find("other networks than its model"), std::string::npos);
}

struct Opinion {
  using type = std::uint32_t;
  static constexpr char const* name = "opinion";
};

/// Copies of one graph of five agents, each of which takes over the opinion of a random neighbour in every step.
struct Voters {
  static constexpr std::string_view name = "voters";
  static constexpr Schedule schedule = Schedule::synchronous;
  static constexpr std::uint64_t copies = 3000;
  using Agents = Population<X, Y, Opinion>;
  using Networks = NetworkSet<Friends>;

  [[nodiscard]] double cutoff() const { return 0.01; }
  [[nodiscard]] double time_step() const { return 1.0; }
  [[nodiscard]] std::uint64_t agents_at_start() const { return 5 * copies; }
  Agents::Values first_agent(World<Voters> const& world, std::uint64_t number) const {
    RandomStream random = world.start_random(number);
    Vector const p = world.anywhere(random);
    return {p.x, p.y, number % 5 == 0 ? 1U : 0U};
  }
  void start_networks(World<Voters>& world) const {
    NodePairs pairs;
    for (std::uint32_t first = 0; first < 5 * copies; first += 5) {
      for (std::uint32_t const other : {1U, 2U, 3U, 4U}) pairs.push_back({first, first + other});
      pairs.push_back({first + 1, first + 2});
    }
    network_of<Friends>(world).connect(edges_of(pairs, world.agents.ids()));
  }
  void turn(Turn<Voters>& self) const {
    RandomStream random = self.random();
    self.set<Opinion>(self.neighbour<Friends>(random.below(self.degree<Friends>())).get<Opinion>());
  }
};

TEST(ModelNetworks, EndInTheOpinionOfVotersWithTheirShareOfAllDegrees) {
  // K. Suchecki, V. M. Eguíluz & M. San Miguel, 2005, doi:10.1209/epl/i2004-10329-8: 4 of 10 ends are those of the one
  // agent in five that has another opinion.
  World<Voters> const world = after(Voters{}, 150);
  std::vector<int> ones(Voters::copies);
  for (std::size_t row = 0; row < world.agents.size(); ++row) {
    ones[world.agents.ids()[row] / 5] += static_cast<int>(world.agents.column<Opinion>()[row]);
  }
  auto const all_agree = [](int count) { return count == 0 || count == 5; };
  ASSERT_TRUE(std::ranges::all_of(ones, all_agree));
  double const share = static_cast<double>(std::ranges::count(ones, 5)) / Voters::copies;
  EXPECT_NEAR(share, 0.4, 4.0 * std::sqrt(0.4 * 0.6 / Voters::copies));
}

/// Agents that move, multiply, die, share with friends, and make and lose friends.
template <Schedule order>
struct Village {
  static constexpr std::string_view name = "test_village";
  static constexpr std::string_view documentation = "Villagers.";
  static constexpr Schedule schedule = order;
  using Agents = Population<X, Y, Wealth>;
  using Networks = NetworkSet<Friends, Debts>;

  [[nodiscard]] double cutoff() const { return 0.2; }
  [[nodiscard]] double time_step() const { return 0.5; }
  void start(World<Village>& world) const {
    for (std::uint64_t n = 0; n < 300; ++n) {
      RandomStream random = world.start_random(n);
      Vector const p = world.anywhere(random);
      world.agents.add(p.x, p.y, random.uniform());
    }
    RandomStream random = start_random_of_network<Friends>(world);
    network_of<Friends>(world).connect(
        edges_of(small_world_graph(300, {.degree = 4, .rewiring = 0.2}, random), world.agents.ids()));
  }
  void turn(Turn<Village>& self) const {
    RandomStream random = self.random();
    double sum = 0.0;
    self.template for_each_neighbour<Friends>([&](Neighbour<Village> const& other, double weight) {
      sum += weight * (other.template get<Wealth>() - self.template get<Wealth>()) / 3.0;
    });
    self.template for_each_neighbour<Debts>([&](Neighbour<Village> const& other, double weight) {
      if (weight > 0.9) other.kill();
    });
    self.template set<Wealth>(self.template get<Wealth>() + 0.1 * sum);
    self.move_by(0.05 * random.in_unit_disk());
    double const fate = random.uniform();
    if (fate < 0.05) self.give_birth(self.position().x, self.position().y, random.uniform());
    if (fate > 0.97) self.die();
  }
  void step_networks(NetworksOfStep<Village>& networks) const {
    RandomStream random = networks.template random<Debts>();
    std::vector<NetworkEdge> kin;
    std::vector<NetworkEdge> debts;
    for (auto const& [parent, child] : networks.births()) {
      if (!networks.world().agents.contains(parent)) continue;
      kin.push_back({.from = child, .to = parent, .weight = random.uniform()});
      debts.push_back({.from = child, .to = parent, .weight = random.uniform()});
    }
    networks.template get<Friends>().connect(kin);
    networks.template get<Debts>().connect(debts);
    auto const edges = network_of<Friends>(networks.world()).edges();
    if (networks.clock().step % 3 == 0)
      networks.template get<Friends>().disconnect({edges[random.below(edges.size())]});
  }
  void observe(AgentSums<Village> const& agents, Observations& seen) const {
    seen.add("wealth", agents.sum([](auto const& agent) { return agent.template get<Wealth>(); }));
  }
};

template <Schedule order>
std::uint64_t village_after(std::uint64_t steps, std::uint64_t threads, std::uint64_t chunk) {
  World<Village<order>> world{.box = Box(2.0, 1.0, Edge::periodic), .seed = 5};
  start_agents(Village<order>{}, world);
  ModelEngine<Village<order>> engine({}, world.box, {.threads = threads, .verify_every = 9});
  for (std::uint64_t step = chunk; step <= steps; step += chunk) engine.advance(world, {.step = step});
  EXPECT_GT(world.networks[0].size(), 50U);
  EXPECT_GT(world.networks[1].size(), 50U);
  return hash(world);
}

TEST(ModelNetworks, HaveTheSameBitsOnAnyThreadsAndInAnyChunks) {
  std::uint64_t const expected = village_after<Schedule::synchronous>(60, 1, 60);
  for (std::uint64_t const threads : {2, 3, 8}) {
    EXPECT_EQ(village_after<Schedule::synchronous>(60, threads, 60), expected) << threads;
  }
  EXPECT_EQ(village_after<Schedule::synchronous>(60, 2, 1), expected) << "chunks of one step";
  EXPECT_EQ(village_after<Schedule::sequential>(60, 1, 60), village_after<Schedule::sequential>(60, 1, 1));
}

class NetworksOfRun : public testing::Test {
 protected:
  using Kept = Village<Schedule::synchronous>;
  ~NetworksOfRun() override { std::filesystem::remove_all(directory_); }

  static Configuration configuration(std::uint64_t threads) {
    SettingsFile file;
    for (char const* setting :
         {"model.kind=test_village", "box.edge=periodic", "run.steps=40", "observe.every=5", "trajectory.every=20"}) {
      file.set(setting);
    }
    file.set("engine.threads=" + std::to_string(threads));
    return read_configuration(file);
  }

  test::KnownModel<Kept> known_;
  std::filesystem::path directory_ =
      std::filesystem::temp_directory_path() / ("gridlock-networks-" + std::to_string(getpid()));
};

TEST_F(NetworksOfRun, AreInFramesAndTheLastFileAndGoOnWithTheSameBitsAfterAnInterruption) {
  RunRecord const whole = run_in(directory_ / "whole", set_up(configuration(1)));
  ASSERT_EQ(whole.status, RunStatus::finished) << whole.failure;
  OnProgress const stops_early = [done = 0](Progress const&) mutable { return ++done < 3; };
  RunRecord parts = run_in(directory_ / "parts", set_up(configuration(2)), {.on_progress = stops_early});
  ASSERT_EQ(parts.status, RunStatus::interrupted);
  parts = resume_in(directory_ / "parts");
  EXPECT_EQ(parts.status, RunStatus::finished) << parts.failure;
  EXPECT_EQ(parts.state_hash, whole.state_hash);
  H5mdReader const one(directory_ / "whole" / "trajectory.h5");
  H5mdReader const other(directory_ / "parts" / "trajectory.h5");
  ASSERT_EQ(one.frame_count(), 3U);
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_EQ(one.frame(k).frame.networks.size(), 2U);
    EXPECT_EQ(one.frame(k).frame.networks, other.frame(k).frame.networks);
  }
  EXPECT_TRUE(std::filesystem::exists(directory_ / "whole" / "final_networks.h5"));
  Verification const found = verify_run(directory_ / "whole");
  EXPECT_EQ(found.difference, "");
  EXPECT_EQ(found.frames, 3U);
}

TEST_F(NetworksOfRun, AreNotSharedByRanks) {
  std::string const refusal = failure_by([&] { require_shareable(configuration(1), 2); });
  EXPECT_NE(
      refusal.find("the model \"test_village\", whose networks no process has in part, cannot be shared by 2 ranks"),
      std::string::npos)
      << refusal;
}

}  // namespace
}  // namespace gridlock
