// Runs of models whose agents are divided among ranks, here threads: the files of one process, to the bit, whoever is
// born or dies where, and however often the number of ranks changes.

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "gridlock/core/error.hpp"
#include "gridlock/core/random.hpp"
#include "models/epidemic.hpp"
#include "models/flocking.hpp"
#include "runs_on_ranks.hpp"
#include "unit/io/temporary_directory.hpp"
#include "wanderers.hpp"

namespace gridlock {
namespace {

namespace fs = std::filesystem;
using test::carry_out;
using test::expect_same_results;
using test::KnownModels;
using test::ThreadRanks;

/// A model that makes its start row by row and adds up over all rows; its agents are born and die.
struct Heirs {
  static constexpr std::string_view name = "heirs_of_test";
  static constexpr std::string_view documentation = "Agents whose shares of one heritage add up to 1.";
  static constexpr Schedule schedule = Schedule::synchronous;
  using Agents = Population<X, Y, test::Weight>;

  std::uint64_t count = 300;

  void describe(SettingVisitor& visitor) { visitor.visit({.key = "count"}, count); }
  [[nodiscard]] double cutoff() const { return 0.1; }
  [[nodiscard]] double time_step() const { return 0.1; }
  [[nodiscard]] std::uint64_t agents_at_start() const { return count; }

  void start(World<Heirs>& world) const {
    auto const weight = [&](std::uint64_t row) { return world.start_random(row).exponential(); };
    double sum = 0.0;
    for (std::uint64_t row = 0; row < count; ++row) sum += weight(row);
    for (std::uint64_t row = 0; row < count; ++row) {
      RandomStream random = world.start_random(count + row);
      Vector const p = world.anywhere(random);
      world.agents.add(p.x, p.y, weight(row) / sum);
    }
  }

  void turn(Turn<Heirs>& self) const {
    RandomStream random = self.random();
    double sum = self.get<test::Weight>();
    self.for_each_neighbour(0.1, [&](Neighbour<Heirs> const& other) { sum += 0.1 * other.get<test::Weight>(); });
    self.set<test::Weight>(sum);
    self.move_by(0.05 * random.in_unit_disk());
    if (random.uniform() < 0.05) self.give_birth(self.position().x, self.position().y, 0.5 * sum);
    if (random.uniform() < 0.05) self.die();
  }
};

std::string number(double value) { return std::to_string(value); }

/// A run of a model that ranks can divide: with and without births, of agents that each rank makes by itself and of
/// others.
std::string any_run_of_model(std::uint64_t seed) {
  RandomStream random(seed, 0, 0, Purpose::start_position);
  auto const is = [&] { return random.below(2) == 0; };
  auto const one_of = [&](std::vector<double> const& values) { return values[random.below(values.size())]; };
  std::string text = "[box]\nedge = \"" + std::string(is() ? "wall" : "periodic") + "\"\n";
  if (is()) text += "height = " + number(0.6 + random.uniform()) + "\n";
  std::string const count = std::to_string(random.below(4) == 0 ? 1 + random.below(8) : 50 + random.below(900));
  std::uint64_t const kind = seed % 4;
  if (kind == 0) {
    text += "[model]\nkind = \"epidemic\"\n[epidemic]\ncount = " + count +
            "\nradius = " + number(0.02 + 0.1 * random.uniform()) +
            "\nspeed = 0.3\ninfected_at_start = 0.2\nturnover_rate = " + number(one_of({0.0, 0.5, 3.0})) + "\n";
  } else if (kind == 1) {
    text += "[model]\nkind = \"flocking\"\n[flocking]\ncount = " + count +
            "\nradius = " + number(0.02 + 0.1 * random.uniform()) + "\nspeed = 0.02\nrule = \"" +
            std::string(is() ? "vicsek" : "boids") + "\"\n";
  } else if (kind == 2) {
    // Tile by tile, with counters and with disks that are late.
    text += "[model]\nkind = \"colloid_tiled\"\n[colloid_tiled.disks]\ncount = " + count +
            "\npacking_fraction = " + number(0.1 + 0.3 * random.uniform()) + "\nstart = \"" +
            std::string(is() ? "random" : "triangular") + "\"\n[colloid_tiled.velocities]\nkind = \"maxwell\"\n";
  } else {
    text += "[model]\nkind = \"wanderers_of_test\"\n[wanderers_of_test]\ncount = " + count +
            "\nradius = " + number(one_of({0.2, 0.05, 0.01})) + "\nspeed = 0.05\njump = " + number(one_of({0.0, 0.1})) +
            "\nbirth = " + number(one_of({0.0, 0.02, 0.04})) + "\nfar_birth = " + number(one_of({0.0, 0.02})) +
            "\ndeath = " + number(one_of({0.0, 0.04, 0.3})) + "\nkill = " + number(one_of({0.0, 0.005})) +
            "\ncrowd = " + number(one_of({1.0, 0.05})) + "\n";
  }
  text += "[observe]\nevery = " + std::to_string(1 + random.below(12)) +
          "\nstructure_every = " + std::to_string(random.below(3)) +
          "\nvelocity_origin_every = " + std::to_string(random.below(3)) +
          "\nequilibration = " + number(one_of({0.0, 0.3})) + "\n";
  text += "[trajectory]\nevery = " + std::to_string(5 + random.below(20)) + "\n";
  text += "[run]\nsteps = 40\nseed = " + std::to_string(seed) + "\n";
  return text;
}

TEST(DividedModels, HaveTheFilesOfOneProcess) {
  KnownModels const known;
  TemporaryDirectory const temporary;
  for (std::uint64_t seed = 0; seed < 28; ++seed) {
    std::string const text = any_run_of_model(seed);
    fs::path const one = temporary / ("one" + std::to_string(seed));
    carry_out(text, one, 0);
    for (std::size_t const ranks : {1 + seed % 2, 3 + seed % 3, std::uint64_t{seed % 8 == 0 ? 12U : 6U}}) {
      fs::path const many = temporary / ("many" + std::to_string(seed) + "_" + std::to_string(ranks));
      carry_out(text, many, ranks);
      ASSERT_NO_FATAL_FAILURE(expect_same_results(
          one, many, "seed " + std::to_string(seed) + " on " + std::to_string(ranks) + " ranks\n" + text));
    }
  }
}

TEST(DividedModels, ContinueOnAnotherNumberOfRanksAndInOneProcess) {
  KnownModels const known;
  TemporaryDirectory const temporary;
  for (std::uint64_t seed = 100; seed < 136; ++seed) {
    std::string const text = any_run_of_model(seed);
    fs::path const one = temporary / ("one" + std::to_string(seed));
    fs::path const many = temporary / ("many" + std::to_string(seed));
    carry_out(text, one, 0);
    std::vector<std::size_t> const numbers = seed / 4 % 3 == 0   ? std::vector<std::size_t>{3, 0, 2}
                                             : seed / 4 % 3 == 1 ? std::vector<std::size_t>{0, 4, 1}
                                                                 : std::vector<std::size_t>{4, 2, 7};
    EXPECT_EQ(carry_out(text, many, numbers[0], 11), RunStatus::interrupted);
    EXPECT_EQ(carry_out(text, many, numbers[1], 25), RunStatus::interrupted);
    EXPECT_EQ(carry_out(text, many, numbers[2]), RunStatus::finished);
    ASSERT_NO_FATAL_FAILURE(expect_same_results(one, many, "seed " + std::to_string(seed) + "\n" + text));
  }
}

TEST(DividedModels, StartFromAgentsThatDependOnOneAnother) {
  test::KnownModel<Heirs> const known;
  TemporaryDirectory const temporary;
  for (std::string const count : {"1", "5", "300"}) {
    std::string const text = "model.kind = \"heirs_of_test\"\nheirs_of_test.count = " + count +
                             "\nbox.edge = \"periodic\"\nobserve.every = 5\ntrajectory.every = 10\nrun.steps = 20\n";
    fs::path const one = temporary / ("one" + count);
    carry_out(text, one, 0);
    for (std::size_t ranks = 1; ranks <= 6; ++ranks) {
      fs::path const many = temporary / ("many" + count + "_" + std::to_string(ranks));
      carry_out(text, many, ranks);
      ASSERT_NO_FATAL_FAILURE(expect_same_results(one, many, count + " on " + std::to_string(ranks) + " ranks"));
    }
  }
}

TEST(DividedModels, RefuseWhatOneProcessRefuses) {
  KnownModels const known;
  TemporaryDirectory const temporary;
  for (char const* const wrong : {"[model]\nkind = \"wanderers_of_test\"\n[wanderers_of_test]\ncrowd = 1.5\n",
                                  "[model]\nkind = \"wanderers_of_test\"\n[wanderers_of_test]\nradius = 0.7\n",
                                  "[model]\nkind = \"flocking\"\n[flocking]\nradius = 0.7\nspeed = 0.01\n",
                                  "[model]\nkind = \"epidemic\"\n[epidemic]\ncount = 50\nspeed = 1000.0\n"}) {
    auto const problem_of = [&](std::size_t ranks) {
      try {
        carry_out(std::string(wrong) + "[box]\nedge = \"periodic\"\n[run]\nsteps = 5\n", temporary / "refused", ranks);
      } catch (Error const& error) {
        return std::string(error.what());
      }
      return std::string();
    };
    std::string const one = problem_of(0);
    EXPECT_NE(one, "") << wrong;
    EXPECT_EQ(one, problem_of(3)) << wrong;
    EXPECT_FALSE(fs::exists(temporary / "refused")) << wrong;
  }
}

/// The agents of each rank, of a population that has changed for so many steps and then been divided anew.
template <class Model>
std::vector<std::size_t> agents_of_ranks(Model const& model, std::size_t ranks, std::uint64_t steps) {
  std::vector<std::size_t> agents(ranks);
  ThreadRanks(ranks).run([&](Communicator& here) {
    World<Model> own{.box = Box(1.25, 0.8, Edge::periodic), .seed = 5};
    start_together(model, own, here, [](auto const& act) { act(); });
    Counters counters;
    SharedModelEngine<Model> engine(model, here, 1);
    engine.advance(own, counters, {.step = steps});
    engine.advance(own, counters, {.step = steps + 1});
    agents[here.rank()] = own.agents.size();
  });
  return agents;
}

TEST(DividedModels, AreDividedEvenlyAnewByEachCallHoweverFarTheyGrow) {
  test::Wanderers const growing{.count = 30, .radius = 0.01, .birth = 0.1};
  std::vector<std::size_t> const grown = agents_of_ranks(growing, 4, 45);
  double const all = static_cast<double>(grown[0] + grown[1] + grown[2] + grown[3]);
  EXPECT_GT(all, 1500.0);
  for (std::size_t const agents : grown) EXPECT_NEAR(static_cast<double>(agents), all / 4.0, all / 40.0);
  test::Wanderers const shrinking{.count = 4000, .radius = 0.01, .death = 0.03};
  std::vector<std::size_t> const left = agents_of_ranks(shrinking, 4, 45);
  double const few = static_cast<double>(left[0] + left[1] + left[2] + left[3]);
  EXPECT_LT(few, 1500.0);
  for (std::size_t const agents : left) EXPECT_NEAR(static_cast<double>(agents), few / 4.0, few / 40.0);
}

}  // namespace
}  // namespace gridlock
