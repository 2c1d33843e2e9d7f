// A program with a model of its own has every command for it, and the shipped program says why it cannot run such a
// model.
#include <gtest/gtest.h>

#include <chrono>
#include <csignal>
#include <thread>

#include "cli/program.hpp"

namespace {

using namespace gridlock::test;

constexpr char const* schelling_toml =
    "model.kind = \"schelling\"\n"
    "schelling.count = 100\n"
    "box.edge = \"periodic\"\n"
    "run.steps = 40\n"
    "observe.every = 10\n";

Outcome own(fs::path const& directory, std::vector<std::string> arguments) {
  return Process(GRIDLOCK_OWN_PROGRAM, std::move(arguments), directory).wait();
}

void expect_says(Outcome const& outcome, std::string const& text) {
  expect_good(outcome);
  EXPECT_NE(outcome.out.find(text), std::string::npos) << outcome.out;
}

std::string state_hash_of(Outcome const& outcome) {
  std::size_t const name = outcome.out.find("state_hash");
  std::size_t const digits = outcome.out.find_first_of("0123456789abcdef", name + std::string("state_hash").size());
  return name == std::string::npos ? "no hash: " + outcome.out + outcome.err : outcome.out.substr(digits, 16);
}

TEST(OwnProgram, ChecksRunsShowsAndExportsItsModel) {
  Workplace const workplace;
  write(workplace / "town.toml", schelling_toml);
  expect_says(own(workplace.path(), {"check", "town.toml"}), "100 agents, periodic box 1 × 1, model schelling");
  expect_says(own(workplace.path(), {"run", "town.toml", "--set", "trajectory.every=20", "-o", "town"}),
              "finished 40 steps of 100 agents");
  expect_says(own(workplace.path(), {"info", "town"}), "schelling");
  expect_good(own(workplace.path(), {"export", "town", "--to", "csv"}));
  EXPECT_TRUE(fs::exists(workplace / "town/trajectory.csv"));
  expect_good(own(workplace.path(), {"movie", "town", "--width", "64"}));
  EXPECT_TRUE(fs::exists(workplace / "town/trajectory.mp4"));
}

TEST(OwnProgram, SweepsAndCollectsItsModel) {
  Workplace const workplace;
  write(workplace / "towns.toml", std::string(schelling_toml) + "[sweep]\nschelling.tolerance = [0.3, 0.6]\n");
  expect_says(own(workplace.path(), {"check", "towns.toml"}), "2 runs");
  expect_says(own(workplace.path(), {"sweep", "towns.toml", "-o", "whole"}), "2 of 2 runs finished");
  for (std::string const shard : {"1/2", "2/2"}) {
    expect_good(own(workplace.path(), {"sweep", "towns.toml", "-o", "parts", "--shard", shard}));
  }
  expect_says(own(workplace.path(), {"collect", "parts"}), "2 of 2 runs finished");
  EXPECT_EQ(text_of(workplace / "parts/means.csv"), text_of(workplace / "whole/means.csv"));
}

TEST(OwnProgram, ResumesItsModelToTheSameBits) {
  Workplace const workplace;
  write(workplace / "town.toml", schelling_toml);
  std::vector<std::string> arguments{"run", "town.toml", "--no-pictures", "--set", "run.steps=20000", "-o", "whole"};
  Outcome const whole = own(workplace.path(), arguments);
  expect_good(whole);
  arguments.back() = "stopped";
  arguments.insert(arguments.end(), {"--set", "checkpoint.every_steps=1000"});
  Process const process(GRIDLOCK_OWN_PROGRAM, arguments, workplace.path());
  wait_for(workplace / "stopped/checkpoint.gridlock");
  process.signal(SIGTERM);
  Outcome const stopped = process.wait();
  EXPECT_EQ(stopped.exit_code, 1) << stopped.out << stopped.err;
  EXPECT_NE(stopped.err.find("gridlock_own_program resume stopped"), std::string::npos) << stopped.err;
  Outcome const resumed = own(workplace.path(), {"resume", "stopped", "--no-pictures"});
  expect_good(resumed);
  EXPECT_EQ(state_hash_of(resumed), state_hash_of(whole));
}

TEST(OwnProgram, ExplainsTheSettingsOfItsModelAndStillRunsDisks) {
  Workplace const workplace;
  expect_says(own(workplace.path(), {"explain", "schelling.tolerance"}), "Share of others an agent bears.");
  write(workplace / "disks.toml", "disks.count = 16\nrun.steps = 5\n");
  expect_says(own(workplace.path(), {"run", "disks.toml", "--no-pictures", "-o", "disks"}), "finished 5 steps of 16");
}

TEST(OwnProgram, RefusesAMisspelledSettingOfItsModelWithTheNearestName) {
  Workplace const workplace;
  write(workplace / "town.toml", std::string(schelling_toml) + "schelling.tolerence = 0.2\n");
  Outcome const outcome = own(workplace.path(), {"run", "town.toml", "-o", "town"});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_NE(outcome.err.find("did you mean tolerance?"), std::string::npos) << outcome.err;
  EXPECT_FALSE(fs::exists(workplace / "town"));
}

/// The shipped program, given a file of somebody's own model.
void expect_sends_to_own_program(fs::path const& directory, std::vector<std::string> arguments) {
  Outcome const outcome = gridlock::test::gridlock(std::move(arguments), directory);
  EXPECT_EQ(outcome.exit_code, 2) << outcome.out << outcome.err;
  EXPECT_NE(outcome.err.find("there is no model \"schelling\" in this program"), std::string::npos) << outcome.err;
  for (char const* hint :
       {"a model of one's own in C++ runs in the program that registers it", "docs/getting_started/own_model.md",
        "gridlock.open(DIR).resume()", "docs/getting_started/own_model_python.md"}) {
    EXPECT_NE(outcome.err.find(hint), std::string::npos) << outcome.err;
  }
  EXPECT_EQ(outcome.err.find("there is no table"), std::string::npos) << outcome.err;
}

TEST(ShippedProgram, SaysThatAModelOfOnesOwnRunsInOnesOwnProgram) {
  Workplace const workplace;
  write(workplace / "town.toml", schelling_toml);
  write(workplace / "towns.toml", std::string(schelling_toml) + "[sweep]\nschelling.tolerance = [0.3, 0.6]\n");
  expect_sends_to_own_program(workplace.path(), {"run", "town.toml", "-o", "town"});
  expect_sends_to_own_program(workplace.path(), {"check", "town.toml"});
  expect_sends_to_own_program(workplace.path(), {"sweep", "towns.toml", "-o", "towns"});
  expect_good(own(workplace.path(), {"run", "town.toml", "--no-pictures", "-o", "town"}));
  expect_sends_to_own_program(workplace.path(), {"run", "town/config.resolved.toml", "-o", "again"});
}

TEST(ShippedProgram, ReportsOtherMistakesBesideAModelItDoesNotHave) {
  Workplace const workplace;
  write(workplace / "town.toml", std::string(schelling_toml) + "run.sede = 3\n");
  Outcome const outcome = gridlock::test::gridlock({"check", "town.toml"}, workplace.path());
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_NE(outcome.err.find("there is no model \"schelling\""), std::string::npos) << outcome.err;
  EXPECT_NE(outcome.err.find("did you mean seed?"), std::string::npos) << outcome.err;
}

}  // namespace
