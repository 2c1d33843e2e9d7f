// What a run takes from a start file, from its settings, and how far it goes from there.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "gridlock/core/error.hpp"
#include "gridlock/io/settings_file.hpp"
#include "gridlock/io/xyz.hpp"
#include "gridlock/simulation/configuration.hpp"
#include "gridlock/simulation/simulate.hpp"
#include "gridlock/workspace/run_directory.hpp"
#include "gridlock/workspace/sweep.hpp"
#include "io/file.hpp"
#include "simulation/expected_work.hpp"
#include "simulation/memory.hpp"
#include "simulation/trajectory.hpp"
#include "unit/io/temporary_directory.hpp"
#include "workspace/sweep_tables.hpp"

namespace gridlock {
namespace {

/// Four disks in a box of 2 × 1, at a clock of its own.
State four_disks(Edge edge) {
  State state{.box = Box(2.0, 1.0, edge), .clock = {.step = 40, .time = 20.0}, .seed = 5};
  for (int n = 0; n < 4; ++n) state.agents.add(0.25 + 0.5 * n, 0.5, 0.5, n == 0 ? 0.25 : -0.25, 0.1, 1.0, 0, 0);
  return state;
}

class StartFile : public testing::Test {
 protected:
  gridlock::Setup set_up_from(State const& state, std::string const& settings) {
    write_xyz(state, directory_ / "start.xyz");
    write_file(directory_ / "run.toml", "disks.file = \"start.xyz\"\n" + settings);
    return set_up(SettingsFile::from_path(directory_ / "run.toml"));
  }
  TemporaryDirectory directory_;
};

TEST_F(StartFile, ABoxThatDiffersInOneSideIsRefused) {
  EXPECT_NO_THROW(set_up_from(four_disks(Edge::wall), "box.width = 2.0\nbox.height = 1.0\n"));
  EXPECT_THROW(set_up_from(four_disks(Edge::wall), "box.width = 2.0\nbox.height = 1.5\n"), Error);
  EXPECT_THROW(set_up_from(four_disks(Edge::wall), "box.width = 2.5\nbox.height = 1.0\n"), Error);
}

TEST_F(StartFile, TheEdgesOfEachAxisAreThoseOfTheFileAndOthersAreRefused) {
  State channel = four_disks(Edge::wall);
  channel.box = Box(2.0, 1.0, Edge::periodic, Edge::wall);
  for (char const* const settings :
       {"", "box.edge_x = \"periodic\"\n", "box.edge_y = \"wall\"\nbox.edge = \"periodic\"\n"}) {
    gridlock::Setup const setup = set_up_from(channel, settings);
    EXPECT_EQ(disks_of(setup).box, channel.box) << settings;
    EXPECT_EQ(make_box(setup.configuration.box), channel.box) << "as the resolved configuration has it";
  }
  for (char const* const settings : {"box.edge = \"wall\"\n", "box.edge = \"periodic\"\n", "box.edge_x = \"wall\"\n",
                                     "box.edge_y = \"periodic\"\n"}) {
    EXPECT_THROW(set_up_from(channel, settings), Error) << settings;
  }
}

TEST(SetUpOfEdges, AnEdgeThatBothAxesContradictIsRefused) {
  TemporaryDirectory const directory;
  auto const refused = [&](std::string const& settings) {
    try {
      write_file(directory / "a.toml", settings);
      static_cast<void>(set_up(SettingsFile::from_path(directory / "a.toml")));
    } catch (Error const& error) {
      return error.problems().at(0).key;
    }
    return std::string();
  };
  EXPECT_EQ(refused("box = { edge = \"wall\", edge_x = \"periodic\" }\nrun.steps = 1\n"), "");
  EXPECT_EQ(refused("box = { edge = \"wall\", edge_x = \"wall\", edge_y = \"wall\" }\nrun.steps = 1\n"), "");
  EXPECT_EQ(refused("box = { edge_x = \"periodic\", edge_y = \"wall\" }\nrun.steps = 1\n"), "");
  EXPECT_EQ(refused("box = { edge = \"wall\", edge_x = \"periodic\", edge_y = \"wall\" }\nrun.steps = 1\n"), "");
  EXPECT_EQ(refused("box = { edge = \"wall\", edge_x = \"periodic\", edge_y = \"periodic\" }\nrun.steps = 1\n"),
            "box.edge");
}

TEST_F(StartFile, TheResolvedConfigurationHasBothSidesOfItsBox) {
  gridlock::Setup const setup = set_up_from(four_disks(Edge::wall), "");
  EXPECT_EQ(setup.configuration.box.width, 2.0);
  EXPECT_EQ(setup.configuration.box.height, 1.0);
}

TEST_F(StartFile, TheSeedIsThatOfTheSettingsAndVelocitiesAreThoseOfTheFileUnlessDrawnAnew) {
  gridlock::Setup const kept = set_up_from(four_disks(Edge::wall), "run.seed = 9\n");
  EXPECT_EQ(disks_of(kept).seed, 9U);
  EXPECT_EQ(disks_of(kept).agents.column<VelocityY>()[0], 0.25);
  gridlock::Setup const drawn = set_up_from(four_disks(Edge::wall), "run.seed = 9\nvelocities.redraw = true\n");
  EXPECT_NE(disks_of(drawn).agents.column<VelocityY>()[0], 0.25);
}

TEST_F(StartFile, LengthsOfTheRunCountFromItsClock) {
  StopCondition const in_time = stop_condition_of(set_up_from(four_disks(Edge::wall), "run.time = 3.0\n"));
  EXPECT_EQ(in_time.time, 23.0);
  StopCondition const in_steps = stop_condition_of(set_up_from(four_disks(Edge::wall), "run.steps = 7\n"));
  EXPECT_EQ(in_steps.step, 47U);
}

TEST_F(StartFile, CollisionsPerDiskCountEachCollisionForBothPartners) {
  StopCondition const stop_condition =
      stop_condition_of(set_up_from(four_disks(Edge::wall), "run.collisions_per_disk = 5.0\n"));
  EXPECT_EQ(stop_condition.pair_collisions, 10U);
}

TEST_F(StartFile, DisksInARowThatMoveAlikeMeetBetweenWallsAndNeverInAPeriodicBox) {
  for (Edge const edge : {Edge::wall, Edge::periodic}) {
    State state = four_disks(edge);
    for (double& v : state.agents.column<VelocityY>()) v = 0.0;
    if (edge == Edge::wall) {
      EXPECT_NO_THROW(set_up_from(state, "run.collisions_per_disk = 1.0\n"));
    } else {
      EXPECT_THROW(set_up_from(state, "run.collisions_per_disk = 1.0\n"), Error);
    }
  }
}

TEST_F(StartFile, ASummaryTellsTheStepsOfTheRunAndTheStepOfTheClock) {
  run_in(directory_ / "run", set_up_from(four_disks(Edge::periodic), "run.steps = 7\nobserve.every = 1\n"));
  std::string const summary = read_file(directory_ / "run" / "summary.json");
  EXPECT_NE(summary.find("\"steps\": 7,"), std::string::npos) << summary;
  EXPECT_NE(summary.find("\"step\": 47,"), std::string::npos) << summary;
}

/// The notes of a set-up on a start file with these properties and rows of one disk, in a periodic box of 2 × 1.
std::vector<std::string> notes_on(std::filesystem::path const& directory, std::string const& line,
                                  std::string const& row, std::string const& settings) {
  write_file(directory / "start.xyz", "1\nLattice=\"2 0 0 0 1 0 0 0 1\" " + line + "\n" + row + "\n");
  write_file(directory / "run.toml", "disks.file = \"start.xyz\"\nrun.steps = 1\n" + settings);
  std::vector<std::string> texts;
  for (Event const& note : set_up(SettingsFile::from_path(directory / "run.toml")).notes) {
    if (note.key == "disks.file") texts.push_back(to_text(note));
  }
  return texts;
}

TEST_F(StartFile, NothingIsReplacedOrLeftOutSilently) {
  std::filesystem::path const here = directory_ / "";
  using Texts = std::vector<std::string>;
  EXPECT_EQ(notes_on(here, "Properties=pos:R:2:radius:R:1:velo:R:2", "0.5 0.5 0.1 1 2", ""), Texts());
  EXPECT_EQ(notes_on(here, "Properties=pos:R:2:radius:R:1", "0.5 0.5 0.1", "velocities.kind = \"maxwell\"\n"),
            Texts{"the start file has no velocities: they are drawn anew, velocities.kind = \"maxwell\""});
  EXPECT_EQ(notes_on(here, "Properties=pos:R:2:radius:R:1", "0.5 0.5 0.1", "velocities.redraw = true\n"), Texts());
  EXPECT_EQ(notes_on(here, "Properties=pos:R:2:radius:R:1:momenta:R:3", "0.5 0.5 0.1 1 2 0", ""),
            Texts{"the start file has momenta and no masses: velocities are those of masses of 1"});
  EXPECT_EQ(
      notes_on(here, "Properties=pos:R:2:radius:R:1:velo:R:2:forces:R:2:tag:S:1 step=-1 Time=noon seed=None",
               "-0.5 0.5 0.1 1 2 3 4 a", ""),
      (Texts{
          "columns of the start file that are not used: forces, tag",
          "the start file has Time=noon, step=-1, which is of another kind than here: the run begins at step 0, time 0",
          "1 disk of the start file was outside its periodic box: moved in through its edges, and counted by image"}));
}

TEST_F(StartFile, VelocitiesAreMomentaOverMasses) {
  write_file(directory_ / "start.xyz",
             "2\nLattice=\"2 0 0 0 1 0 0 0 1\" Properties=species:S:1:pos:R:3:radius:R:1:masses:R:1:momenta:R:3\n"
             "X 0.25 0.25 0 0.1 1 1 0 0\nX 0.75 0.75 0 0.1 2 0 3 0\n");
  write_file(directory_ / "run.toml", "disks.file = \"start.xyz\"\nrun.steps = 0\n");
  gridlock::Setup const setup = set_up(SettingsFile::from_path(directory_ / "run.toml"));
  EXPECT_EQ(velocity(disks_of(setup).agents, 0), (Vector{1.0, 0.0}));
  EXPECT_EQ(velocity(disks_of(setup).agents, 1), (Vector{0.0, 1.5}));
}

TEST_F(StartFile, AFrameOfSeveralIsChosenAndWithoutAChoiceRefused) {
  State state = four_disks(Edge::wall);
  write_xyz(state, directory_ / "a.xyz");
  std::string text = read_file(directory_ / "a.xyz");
  state.clock.step = 50;
  write_xyz(state, directory_ / "a.xyz");
  write_file(directory_ / "frames.xyz", text + read_file(directory_ / "a.xyz"));
  auto const step_at = [&](std::string const& settings) {
    write_file(directory_ / "run.toml", "disks.file = \"frames.xyz\"\n" + settings);
    return set_up(SettingsFile::from_path(directory_ / "run.toml")).simulation->clock().step;
  };
  EXPECT_EQ(step_at("disks.frame = 0\n"), 40U);
  EXPECT_EQ(step_at("disks.frame = 1\n"), 50U);
  EXPECT_THROW(step_at("disks.frame = 2\n"), Error);
  try {
    step_at("");
    FAIL() << "one of two frames was taken silently";
  } catch (Error const& error) {
    EXPECT_NE(std::string(error.what()).find("choose one: disks.frame from 0 to 1"), std::string::npos) << error.what();
  }
  run_in(directory_ / "run", [&] {
    write_file(directory_ / "run.toml", "disks.file = \"frames.xyz\"\ndisks.frame = 1\nrun.steps = 2\n");
    return set_up(SettingsFile::from_path(directory_ / "run.toml"));
  }());
  EXPECT_EQ(set_up(SettingsFile::from_path(directory_ / "run" / "config.resolved.toml")).simulation->clock().step, 50U)
      << "the copy of the start has one frame";
}

TEST(SetUpOfSpeeds, TheTimeStepIsMeantForTheLargestSpeedAtTheStart) {
  Configuration configuration;
  configuration.disks = {.count = 16, .packing_fraction = 0.3};
  configuration.velocities.max = 2.0;
  EXPECT_EQ(set_up(configuration).configuration.engine.speed, 2.0);
}

TEST(SetUpOfSpeeds, ASubstepInWhichTwiceTheSpeedCoversADiskIsRefused) {
  auto const is_refused = [](double diameters_at_the_speed) {
    Configuration configuration;
    configuration.disks = {.count = 16, .packing_fraction = 0.3};
    gridlock::Setup const usual = set_up(configuration);
    double const diameter = 2.0 * disks_of(usual).agents.column<Radius>()[0];
    double const displacement = step_duration(usual.configuration.engine, disks_of(usual)) / 5.0;
    configuration.engine.time_step =
        usual.configuration.engine.time_step * diameters_at_the_speed * diameter / displacement;
    try {
      static_cast<void>(set_up(configuration));
    } catch (Error const&) {
      return true;
    }
    return false;
  };
  EXPECT_TRUE(is_refused(0.51));
  EXPECT_FALSE(is_refused(0.49));
}

TEST(ExpectedWork, OfARunGivenInTimeIsThatOfItsSteps) {
  Configuration configuration;
  configuration.disks = {.count = 16, .packing_fraction = 0.3};
  configuration.run.steps = 500;
  gridlock::Setup const in_steps = set_up(configuration);
  configuration.run.steps.reset();
  configuration.run.time = 500.0 * step_duration(in_steps.configuration.engine, disks_of(in_steps));
  EXPECT_NEAR(expectation_of(set_up(configuration)).work, expectation_of(in_steps).work, 1e-6);
}

TEST(ExpectedMemory, OfTheExactEngineIsMoreThanThatOfTheStepped) {
  Configuration configuration;
  configuration.disks.count = 1'000'000;
  double const stepped = expected_memory(configuration);
  configuration.engine.kind = "exact";
  EXPECT_GT(expected_memory(configuration), 1.2 * stepped);
}

TEST(MemoryBudget, WhatIsGivenBackIsThereForTheNext) {
  MemoryBudget budget(10.0);
  MemoryBudget::Part const first(budget, 4.0);
  for (int n = 0; n < 5; ++n) MemoryBudget::Part const next(budget, 6.0);  // one after the other, beside the first
  SUCCEED() << "none of them waited for ever";
}

TEST(SweepPlan, NamesTellValuesApartByTheirSigns) {
  SweepPlan const plan = plan_sweep(SettingsFile::from_text("[sweep]\n\"engine.time_step\" = [1e-5, 1e+5]\n", "signs"));
  ASSERT_EQ(plan.runs.size(), 2U);
  EXPECT_EQ(plan.runs[0].name, "time_step=1e-05");
}

TEST(SweepPlan, ListsOfTheCommandLineVaryFasterThanThoseOfTheFile) {
  SettingsFile file = SettingsFile::from_text("[sweep]\n\"run.seed\" = [1, 2]\n\"disks.count\" = [4, 9]\n", "lists");
  file.set("sweep.run.steps=[1, 2]");
  EXPECT_EQ(plan_sweep(file).keys, (std::vector<std::string>{"run.seed", "disks.count", "run.steps"}));
}

TEST(Audits, AreCountedWhereTheyAreAskedForOnly) {
  for (std::uint64_t const every : {0, 10}) {
    Configuration configuration;
    configuration.disks = {.count = 16, .packing_fraction = 0.4};
    configuration.engine = {.kind = "exact", .audit_every = every};
    configuration.run.steps = 20;
    std::vector<Count> const counts = simulate(set_up(configuration)).counts;
    bool const has_audits = std::ranges::find(counts, "audits", &Count::name) != counts.end();
    EXPECT_EQ(has_audits, every > 0);
  }
}

TEST(DirectoryLock, IsSharedByThoseThatAskForItAndKeepsOthersOut) {
  TemporaryDirectory const directory;
  {
    DirectoryLock const one(directory.path(), Sharing::with_others);
    EXPECT_NO_THROW(DirectoryLock(directory.path(), Sharing::with_others));
    EXPECT_THROW(DirectoryLock(directory.path(), Sharing::alone), Error);
  }
  EXPECT_FALSE(DirectoryLock::is_held(directory.path()));
  DirectoryLock const alone(directory.path(), Sharing::alone);
  EXPECT_TRUE(DirectoryLock::is_held(directory.path()));
  EXPECT_THROW(DirectoryLock(directory.path(), Sharing::with_others), Error);
}

TEST(FrameSchedule, ATimeThatRoundsJustAboveAStepIsThatStep) {
  double const third = 0.1 + 0.1 + 0.1;  // 0.30000000000000004
  ASSERT_GT(third / 0.1, 3.0);
  FrameSchedule const schedule({.times = {third}}, 0.1);
  EXPECT_TRUE(schedule.is_due(3));
  EXPECT_FALSE(schedule.is_due(4));
}

NamedEstimate energy(double value, std::optional<double> error) { return {"energy", {value, error}, ""}; }

SweepPlan plan_of_seeds(std::vector<std::string> const& seeds) {
  SweepPlan plan{.keys = {"run.seed"}, .runs = {}};
  for (std::string const& seed : seeds) plan.runs.push_back({.name = "seed=" + seed, .values = {seed}, .settings = {}});
  return plan;
}

TEST(SweepTables, KeepEveryDigitOfASeedAndLeaveMissingErrorsOpen) {
  SweepPlan const plan = plan_of_seeds({"9007199254740993", "2"});
  std::vector<SweepOutcome> const outcomes{
      {.has_begun = true, .status = RunStatus::finished, .results = {energy(1.0, std::nullopt)}},
      {.has_begun = true, .status = RunStatus::finished, .results = {energy(2.0, 0.5)}}};
  Table const rows = rows_of(plan, outcomes);
  EXPECT_EQ(std::get<std::vector<std::uint64_t>>(rows.column("run.seed")),
            (std::vector<std::uint64_t>{9007199254740993U, 2U}));
  std::vector<double> const errors = rows.numbers("energy_error");
  EXPECT_TRUE(std::isnan(errors[0]));
  EXPECT_EQ(errors[1], 0.5);
}

TEST(SweepTables, MeansAreOfFinishedRunsOnly) {
  SweepPlan const plan = plan_of_seeds({"1", "2", "3", "4"});
  std::vector<SweepOutcome> const outcomes{
      {.has_begun = true, .status = RunStatus::finished, .results = {energy(1.0, 0.1)}},
      {.has_begun = true, .status = RunStatus::interrupted, .results = {energy(50.0, 0.1)}},
      {.has_begun = true, .status = RunStatus::failed, .results = {energy(90.0, 0.1)}},
      {.has_begun = true, .status = RunStatus::finished, .results = {energy(3.0, 0.1)}}};
  Table const means = means_of(plan, outcomes);
  EXPECT_EQ(means.numbers("energy"), (std::vector<double>{2.0}));
  EXPECT_EQ(std::get<std::vector<std::uint64_t>>(means.column("runs")), (std::vector<std::uint64_t>{2}));
}

}  // namespace
}  // namespace gridlock
