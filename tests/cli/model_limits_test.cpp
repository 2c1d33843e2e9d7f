// Models that cannot be run are refused before anything is written, and none of the refusals searches for long.
#include <gtest/gtest.h>

#include "cli/program.hpp"

namespace {

using namespace gridlock::test;

/// `check` and `run` refuse the settings with such a text, and `run` writes nothing.
void expect_refused(std::string const& model, std::vector<std::string> const& settings, std::string const& text,
                    char const* program = GRIDLOCK_PROGRAM) {
  Workplace const workplace;
  write(workplace / "m.toml", "model.kind = \"" + model + "\"\nrun.steps = 2\n");
  for (std::string const verb : {"check", "run"}) {
    // A limit of the memory, so that the test says the same on every machine.
    std::string command = "ulimit -v 8000000; exec \"$0\" " + verb + " m.toml";
    for (std::string const& setting : settings) command += " --set " + setting;
    if (verb == "run") command += " -o out";
    Outcome const outcome = Process("sh", {"-c", command, program}, workplace.path()).wait();
    EXPECT_EQ(outcome.exit_code, 2) << verb << ": " << outcome.out << outcome.err;
    EXPECT_NE(outcome.err.find(text), std::string::npos) << verb << ": " << outcome.err;
    EXPECT_NE(outcome.err.find("hint: "), std::string::npos) << outcome.err;
  }
  EXPECT_FALSE(fs::exists(workplace / "out"));
}

TEST(ModelLimits, MoreMoleculesThanTheClosestPackingAreRefused) {
  expect_refused("catalyst", {"catalyst.count=1000000", "box.edge=periodic"}, "the closest packing holds at most 2886");
  expect_refused("catalyst", {"catalyst.count=1500", "catalyst.count_b=1500"}, "the closest packing holds at most");
  expect_refused("catalyst", {"catalyst.count=9200000000000000000"}, "must be at most 2000000000");
}

TEST(ModelLimits, MoreMoleculesThanRandomPlacesHoldAreRefused) {
  expect_refused("catalyst", {"catalyst.count=2000", "box.edge=periodic"}, "at random places about 1741 find room");
}

TEST(ModelLimits, AgentsThatDoNotFitIntoMemoryAreRefused) {
  expect_refused("flocking", {"flocking.count=2000000000"}, "2000000000 agents would need about");
  expect_refused("epidemic", {"epidemic.count=2000000000"}, "2000000000 agents would need about");
  expect_refused("predation", {"predation.sheep=1000000000"}, "1000000040 agents would need about");
  expect_refused("colloid", {"colloid.disks.count=2000000000"}, "2000000000 agents would need about",
                 GRIDLOCK_OWN_PROGRAM);
}

TEST(ModelLimits, FilesAreNoStartsOfModels) {
  for (std::string const model : {"colloid", "colloid_tiled"}) {
    expect_refused(model, {model + ".disks.file=start.xyz"}, "the model \"" + model + "\" starts from no file",
                   GRIDLOCK_OWN_PROGRAM);
  }
}

TEST(ModelLimits, StartsWithOverlapsAreNoStartsOfModels) {
  for (std::string const model : {"colloid", "colloid_tiled"}) {
    expect_refused(model, {model + ".disks.start=uniform"},
                   "disks at uniform points overlap, and the model \"" + model + "\" is one of hard disks",
                   GRIDLOCK_OWN_PROGRAM);
  }
}

TEST(ModelLimits, CitiesWithoutEdgesOrWithTooFewCellsAreRefused) {
  expect_refused("segregation", {"box.edge=periodic"}, "the city of the model segregation has edges");
  expect_refused("segregation", {"segregation.count=1601"}, "1601 agents have 1600 cells");
}

TEST(ModelLimits, SamplesThatDoNotFitIntoMemoryAreRefused) {
  expect_refused("flocking", {"run.steps=18446744073709551615", "observe.every=1"}, "samples would need about");
}

/// Half an hour of searching for all of them.
TEST(ModelLimits, RandomStartsThatTakeLongAreNotTriedByCheck) {
  Workplace const workplace;
  write(workplace / "colloid.toml",
        "model.kind = \"colloid\"\nrun.steps = 2\n[colloid.disks]\nstart = \"random\"\n"
        "count = 1_000_000\npacking_fraction = 0.54\n");
  write(workplace / "catalyst.toml",
        "model.kind = \"catalyst\"\nrun.steps = 2\nbox.edge = \"periodic\"\n"
        "catalyst.radius = 0.0005\ncatalyst.count = 680_000\n");
  for (char const* file : {"colloid.toml", "catalyst.toml"}) {
    Outcome const outcome = Process(GRIDLOCK_OWN_PROGRAM, {"check", file}, workplace.path()).wait();
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_NE(outcome.err.find("the random start was not tried"), std::string::npos) << outcome.err;
  }
}

TEST(ModelLimits, StepsThatWouldNotEndAreRefused) {
  expect_refused("colloid", {"colloid.substeps=9000000000000000000"}, "at most 1", GRIDLOCK_OWN_PROGRAM);
  expect_refused("catalyst", {"catalyst.adsorption_rate=1e300"}, "events, more than 100000000");
  expect_refused("catalyst", {"catalyst.hop_rate=1e12", "catalyst.count=1"}, "events, more than 100000000");
}

TEST(ModelLimits, DisplacementsAsLongAsTheBoxAreRefused) {
  expect_refused("flocking", {"flocking.speed=3", "box.side=2"}, "would cross the whole box");
  expect_refused("epidemic", {"epidemic.speed=1e300"}, "would cross the whole box");
  expect_refused("catalyst", {"catalyst.hop=1.0", "catalyst.hop_rate=1.0"}, "would cross the whole box");
}

TEST(ModelLimits, ProbabilitiesAboveOneAreRefused) {
  expect_refused("epidemic", {"epidemic.infection_rate=21"}, "infection_rate · step_length is 1.05");
}

TEST(ModelLimits, HugeNumbersArePrintedShort) {
  expect_refused("epidemic", {"epidemic.infection_rate=1e300"}, "infection_rate · step_length is 5e+298, but");
  expect_refused("epidemic", {"epidemic.turnover_rate=1e30"}, "turnover_rate · step_length is 5e+28, but");
}

TEST(ModelLimits, FewerMostAgentsThanAgentsAtTheStartAreRefused) {
  expect_refused("epidemic", {"epidemic.count=100", "epidemic.most_agents=99", "epidemic.turnover_rate=0.1"},
                 "most_agents = 99 is below count = 100");
}

TEST(ModelLimits, AllThatMeansNothingToAModelIsRefusedAtOnce) {
  Workplace const workplace;
  write(workplace / "m.toml",
        "model.kind = \"flocking\"\nrun.collisions_per_disk = 2\ndisks.count = 3\nvelocities.max = 1\nepidemic.count = "
        "3\ncatalyst.count = 3\n");
  Outcome const outcome = gridlock::test::gridlock({"check", "m.toml"}, workplace.path());
  EXPECT_EQ(outcome.exit_code, 2);
  for (std::string const text : {"[disks] means nothing", "[velocities] means nothing", "[epidemic] means nothing",
                                 "[catalyst] means nothing", "cannot be given in collisions"}) {
    EXPECT_NE(outcome.err.find(text), std::string::npos) << text << '\n' << outcome.err;
  }
}

TEST(ModelLimits, ModelsThatWereShippedOnceAreRefusedWithWhatToUse) {
  for (auto const& [model, engine] : {std::pair("colloid", "stepped"), std::pair("colloid_tiled", "tiled")}) {
    std::string const name = model;
    std::string const instead = "use model.kind = \"disks\" with engine.kind = \"" + std::string(engine) + "\"";
    expect_refused(name, {}, "there is no model \"" + name + "\" in this program");
    expect_refused(name, {name + ".disks.count=100"}, instead);
    Workplace const workplace;
    Outcome const outcome = gridlock::test::gridlock({"explain", name}, workplace.path());
    EXPECT_EQ(outcome.exit_code, 2) << outcome.out;
    EXPECT_NE(outcome.err.find(instead), std::string::npos) << outcome.err;
  }
}

}  // namespace
