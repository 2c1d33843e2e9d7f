// Protocols through the program: what they print and write, what is refused, and what a user does next.
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <string>
#include <vector>

#include "cli/program.hpp"
#include "gridlock/io/table.hpp"

namespace {

using namespace gridlock::test;

fs::path const scenes = fs::path(GRIDLOCK_SOURCE_DIR) / "scenes";

nlohmann::json summary_of(fs::path const& directory) {
  return nlohmann::json::parse(text_of(directory / "summary.json"));
}

/// Disks of one size in a fluid, then these stages.
std::string fluid_with(std::string const& stages) {
  return "box.edge = \"periodic\"\nvelocities.kind = \"maxwell\"\n"
         "[disks]\ncount = 64\npacking_fraction = 0.5\nstart = \"random\"\n" +
         stages;
}

Outcome run(std::string const& settings, fs::path const& workplace) {
  write(workplace / "a.toml", settings);
  return gridlock::test::gridlock({"run", "a.toml", "-o", "out", "--overwrite", "--no-pictures"}, workplace);
}

TEST(Protocol, OfTheSceneJamsAndSaysSo) {
  Workplace const workplace;
  Outcome const outcome = gridlock::test::gridlock(
      {"run", (scenes / "jamming.toml").string(), "-o", "out", "--no-pictures"}, workplace.path());
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_EQ(outcome.out.find("finished 2 stages of 64 agents in "), 0U) << outcome.out;
  auto const summary = summary_of(workplace / "out");
  EXPECT_NEAR(summary["jamming_packing_fraction"]["value"].get<double>(), 0.838, 0.02);
  EXPECT_EQ(summary["is_jammed"]["value"], 1.0);
  EXPECT_EQ(summary["excess_contacts"]["value"], 0.0);
  // Nothing was run, so nothing was displaced.
  EXPECT_FALSE(summary.contains("mean_displacement"));
  EXPECT_EQ(outcome.out.find("agent-steps"), std::string::npos) << outcome.out;
  EXPECT_NE(text_of(workplace / "out/stages.csv").find("\n2,\"decompress\","), std::string::npos);
  EXPECT_GT(gridlock::read_csv(workplace / "out/levels.csv").row_count(), 8U);
  // With one state of self-stress some shear always costs nothing, which need not be said.
  EXPECT_EQ(summary["is_shear_stable"]["value"], 0.0);
  EXPECT_LT(summary["least_shear_modulus"]["value"].get<double>(), 0.0);
  EXPECT_EQ(outcome.err.find("note: "), std::string::npos) << outcome.err;
}

TEST(Protocol, ThatEndsAtAMinimumWritesItsContacts) {
  Workplace const workplace;
  std::string const scene = (scenes / "jamming.toml").string();
  expect_good(gridlock::test::gridlock({"run", scene, "-o", "out", "-q", "--no-pictures"}, workplace.path()));
  expect_good(gridlock::test::gridlock({"contacts", "out", "-o", "found", "--no-pictures"}, workplace.path()));
  EXPECT_EQ(text_of(workplace / "out/contacts.csv"), text_of(workplace / "found/contacts.csv"));
  expect_good(gridlock::test::gridlock(
      {"run", scene, "--set", "protocol[0].packing_fraction=0.6", "--set",
       "protocol=[{stage=\"quench\",packing_fraction=0.5}]", "-o", "apart", "-q", "--no-pictures"},
      workplace.path()));
  EXPECT_FALSE(fs::exists(workplace / "apart/contacts.csv")) << "no disks press";
}

TEST(Protocol, OfHardDisksAloneEndsWithTheirPressure) {
  Workplace const workplace;
  Outcome const outcome =
      run(fluid_with("[[protocol]]\nstage = \"grow\"\nrate = 0.05\nuntil_pressure = 2e3\n"), workplace.path());
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  auto const summary = summary_of(workplace / "out");
  EXPECT_GE(summary["reduced_pressure"]["value"].get<double>(), 2e3);
  EXPECT_NE(outcome.out.find("  reduced_pressure "), std::string::npos) << outcome.out;
  EXPECT_NE(outcome.err.find("note: stage 1 of the protocol, \"grow\", ends at a reduced pressure of "),
            std::string::npos)
      << outcome.err;
  EXPECT_TRUE(summary["counters"].empty()) << "nothing was run after the protocol";
  EXPECT_GT(gridlock::read_csv(workplace / "out/stages.csv").numbers("pair_collisions").front(), 1000.0);
}

TEST(Protocol, IsExplainedEntryByEntryAndColumnByColumn) {
  Workplace const workplace;
  std::string const scene = (scenes / "jamming.toml").string();
  expect_good(gridlock::test::gridlock({"run", scene, "-o", "out", "-q", "--no-pictures"}, workplace.path()));
  std::vector<std::string> names;
  auto const summary = summary_of(workplace / "out");
  for (auto const& [name, value] : summary.items()) {
    if (value.is_object() && value.contains("value")) names.push_back(name);
  }
  EXPECT_GT(names.size(), 10U);
  for (char const* table : {"stages.csv", "levels.csv", "contacts.csv"}) {
    gridlock::Table const written = gridlock::read_csv(workplace / "out" / table);
    for (std::string const& name : written.names()) {
      if (name != "name") names.push_back(name);
    }
  }
  Outcome const all = gridlock::test::gridlock({"explain", "observables"}, workplace.path());
  for (std::string const& name : names) EXPECT_NE(("\n" + all.out).find("\n" + name + "\n"), std::string::npos) << name;
  Outcome const one = gridlock::test::gridlock({"explain", "is_jammed"}, workplace.path());
  EXPECT_NE(one.out.find("entry of summary.json"), std::string::npos) << one.out << one.err;
}

TEST(Protocol, SaysWhereAStageFallsShort) {
  Workplace const workplace;
  auto const expect_note = [&](std::string const& stages, std::string const& note) {
    Outcome const outcome = run(fluid_with(stages), workplace.path());
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_NE(outcome.err.find("note: " + note), std::string::npos) << outcome.err;
    EXPECT_NE(text_of(workplace / "out/run.log").find(note), std::string::npos);
  };
  expect_note(
      "[[protocol]]\nstage = \"quench\"\npacking_fraction = 0.6\n"
      "[[protocol]]\nstage = \"decompress\"\nuntil_pressure = 1e-4\n",
      "stage 2 of the protocol, \"decompress\", ends with disks that do not press on each other");
  expect_note(
      "[[protocol]]\nstage = \"quench\"\npacking_fraction = 1.0\n"
      "[[protocol]]\nstage = \"compress\"\nuntil_pressure = 1e-4\n",
      "stage 2 of the protocol, \"compress\", ends short of its goal, at pressure ");
  expect_note(
      "[[protocol]]\nstage = \"quench\"\npacking_fraction = 1.0\n"
      "[[protocol]]\nstage = \"decompress\"\nuntil_pressure = 1e-11\n",
      "stage 2 of the protocol, \"decompress\", ends short of its goal, at pressure ");
  expect_note("[[protocol]]\nstage = \"quench\"\npacking_fraction = 0.78\n",
              "stage 1 of the protocol, \"quench\", ends with disks that do not press on each other");
  // Pressed between two walls, free along them.
  Outcome const pressed =
      run("[box]\nwidth = 2.0\n[disks]\ncount = 1\npacking_fraction = 0.1\nstart = \"uniform\"\n"
          "[[protocol]]\nstage = \"quench\"\npacking_fraction = 0.42\n",
          workplace.path());
  EXPECT_NE(pressed.err.find("\"quench\", is not jammed: no disk is held by three contacts"), std::string::npos)
      << pressed.err;
  expect_note("[[protocol]]\nstage = \"swap\"\nsweeps = 3\n", "stage 1 of the protocol, \"swap\", is no equilibrium");
}

TEST(Protocol, OfOneDiskBetweenWallsEnds) {
  Workplace const workplace;
  // Its pressure falls below what counts as none before it reaches the end.
  Outcome const outcome = gridlock::test::gridlock({"run", (scenes / "jamming.toml").string(), "--set", "disks.count=1",
                                                    "--set", "box.edge=wall", "-o", "out", "--no-pictures"},
                                                   workplace.path());
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_NE(outcome.err.find("ends short of its goal, at pressure "), std::string::npos) << outcome.err;
}

TEST(Protocol, IsRefusedWithTheStageAndTheSettingThatIsWrong) {
  struct Case {
    std::string stages;
    std::string words;
    std::string line;
  };
  std::vector<Case> const cases{
      {"packing_fraction = 0.9", "protocol[0] does not say what happens in it", "[[protocol]]"},
      {"stage = \"melt\"", "protocol[0].stage is \"melt\"", "stage = \"melt\""},
      {"stage = \"grow\"\nuntil_packing_fraction = 0.95", "\"grow\", cannot begin: packing fraction 0.95",
       "until_packing_fraction = 0.95"},
      {"stage = \"grow\"\nuntil_pressure = 0.5", "a stage \"grow\" cannot end at a pressure of 0.5",
       "until_pressure = 0.5"},
      {"stage = \"decompress\"\nuntil_pressure = 1e9", "a stage \"decompress\" cannot end at a pressure of 1000000000",
       "until_pressure = 1e9"},
      {"stage = \"decompress\"\nuntil_pressure = nan", "must be a finite number", "until_pressure = nan"},
      {"stage = \"decompress\"\nuntil_packing_fraction = 0.7", "the packing fraction is 0.5, and the stage ends at 0.7",
       "until_packing_fraction = 0.7"},
      {"stage = \"quench\"\npacking_fraction = 0.9\n[[protocol]]\nstage = \"decompress\"\nuntil_packing_fraction = "
       "0.95",
       "a stage \"decompress\" leads down, but the packing fraction is 0.9, and the stage ends at 0.95",
       "until_packing_fraction = 0.95"},
      {"stage = \"grow\"\nrate = 1e-300\nuntil_pressure = 10", "must be at least 1e-09 and at most 1", "rate = 1e-300"},
      {"stage = \"quench\"\npacking_fraction = 1e-300", "must be at least 1e-06 and at most 1.5",
       "packing_fraction = 1e-300"},
      {"stage = \"run\"\ncollisions_per_disk = 1e300", "no stage reaches 1e+300 collisions per disk",
       "collisions_per_disk = 1e300"},
      {"stage = \"quench\"\npacking_fraction = 2.0", "must be at least 1e-06 and at most 1.5",
       "packing_fraction = 2.0"},
      {"stage = \"decompress\"\nuntil_pressure = 1e-4", "no two disks press on each other", "stage = \"decompress\""},
      {"stage = \"compress\"\nuntil_packing_fraction = 0.9\nstep = 1e-7", "are 4e+06 levels, each of which is kept",
       "step = 1e-7"},
      {"stage = \"shear\"\nuntil_strain = 0.0", "a stage \"shear\" cannot end at the strain 0", "until_strain = 0.0"},
      {"stage = \"shear\"\nuntil_strain = 1.0\nstrain_step = 0.5", "must be above 0 and at most 0.1",
       "strain_step = 0.5"},
      {"stage = \"shear\"\nuntil_strain = 1e3\nstrain_step = 1e-6", "are 1e+09 minima, each of which is kept",
       "strain_step = 1e-6"},
      {"stage = \"quench\"\ndeformation = \"pure_shear\"", "a stage \"quench\" has no setting deformation",
       "deformation = \"pure_shear\""},
      {"stage = \"shear\"\ndeformation = \"pure_shear\"\nuntil_strain = 2.0", "pure shear until 2",
       "until_strain = 2.0"},
      {"stage = \"shear\"\nuntil_strain = 0.1\ncycles = 2\nuntil_stress = 1e-3",
       "cycles of strain cannot end at a stress", "until_stress = 1e-3"},
      {"stage = \"shear\"\nuntil_strain = 0.1\nbox_shape = \"free\"", "a stage \"shear\" has no setting box_shape",
       "box_shape = \"free\""},
      {"stage = \"run\"\nuntil_time = 1e300", "no clock counts up to time 1e+300", "until_time = 1e300"},
  };
  Workplace const workplace;
  for (Case const& one : cases) {
    Outcome const outcome = run(fluid_with("[[protocol]]\n" + one.stages + "\n"), workplace.path());
    EXPECT_EQ(outcome.exit_code, 2) << one.stages;
    EXPECT_NE(outcome.err.find(one.words), std::string::npos) << outcome.err;
    EXPECT_NE(outcome.err.find("   " + one.line + "\n  hint: "), std::string::npos) << outcome.err;
    EXPECT_FALSE(fs::exists(workplace / "out")) << "refused after something was written: " << one.stages;
  }
}

TEST(Protocol, ThatFailsLaterNamesTheStageAndKeepsWhatItHas) {
  Workplace const workplace;
  // Where a pressure is reached is not known before.
  Outcome const outcome = run(fluid_with("[[protocol]]\nstage = \"quench\"\npacking_fraction = 0.9\n"
                                         "[[protocol]]\nstage = \"compress\"\nuntil_pressure = 1e-2\n"
                                         "[[protocol]]\nstage = \"decompress\"\nuntil_packing_fraction = 1.2\n"),
                              workplace.path());
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_NE(
      outcome.err.find("error: stage 3 of the protocol, \"decompress\", cannot begin: the packing fraction is 0.9"),
      std::string::npos)
      << outcome.err;
  EXPECT_NE(outcome.err.find("failed after 2 of 3 stages; partial results are in out\n  hint: change the settings of "
                             "stage 3, \"decompress\""),
            std::string::npos)
      << outcome.err;
  EXPECT_EQ(outcome.err.find("continue with"), std::string::npos) << "resumed, it fails again";
  EXPECT_EQ(gridlock::read_csv(workplace / "out/stages.csv").row_count(), 2U);
}

TEST(Protocol, GrowthToADensityThatIsOutOfReachEndsWithTheReason) {
  Workplace const workplace;
  Outcome const outcome =
      run("box.edge = \"periodic\"\nvelocities.kind = \"maxwell\"\n"
          "[disks]\ncount = 32\npacking_fraction = 0.4\nstart = \"random\"\n"
          "species = [{ fraction = 0.5 }, { fraction = 0.5, size_ratio = 1.4 }]\n"
          "[[protocol]]\nstage = \"grow\"\nrate = 0.1\nuntil_packing_fraction = 0.95\n",
          workplace.path());
  EXPECT_EQ(outcome.exit_code, 1) << outcome.err;
  EXPECT_NE(outcome.err.find("error: stage 1 of the protocol, \"grow\", failed: "), std::string::npos) << outcome.err;
  EXPECT_NE(outcome.err.find("the disks have jammed at packing fraction 0.8"), std::string::npos) << outcome.err;
  EXPECT_NE(outcome.err.find(" and cannot grow to 0.95: "), std::string::npos) << outcome.err;
}

TEST(Protocol, SaysWhichOfTwoEndsEndsAStage) {
  Workplace const workplace;
  Outcome const outcome = run(fluid_with("[[protocol]]\nstage = \"grow\"\nrate = 0.05\nuntil_packing_fraction = 0.55\n"
                                         "until_pressure = 100\n"),
                              workplace.path());
  expect_good(outcome);
  EXPECT_NE(outcome.err.find("note: stage 1 of the protocol, \"grow\", has two ends, until_packing_fraction and "
                             "until_pressure: the one that it reaches first ends it"),
            std::string::npos)
      << outcome.err;
}

TEST(Protocol, SaysThatAPackingIsFarAboveJamming) {
  Workplace const workplace;
  Outcome const outcome =
      run(fluid_with("[[protocol]]\nstage = \"quench\"\npacking_fraction = 1.5\n"), workplace.path());
  expect_good(outcome);
  EXPECT_NE(outcome.err.find("\"quench\", is far above jamming: the disks cover 1.5 of the box"), std::string::npos)
      << outcome.err;
  EXPECT_NE(summary_of(workplace / "out")["notes"].dump().find("far above jamming"), std::string::npos);
}

TEST(Protocol, IsSetAndSweptStageByStage) {
  Workplace const workplace;
  std::string const stage = "protocol[0].packing_fraction";
  std::string const scene = (scenes / "jamming.toml").string();
  expect_good(gridlock::test::gridlock({"run", scene, "--set", stage + "=0.9", "-o", "set", "-q", "--no-pictures"},
                                       workplace.path()));
  gridlock::Table const stages = gridlock::read_csv(workplace / "set/stages.csv");
  EXPECT_NEAR(stages.numbers("packing_fraction").front(), 0.9, 1e-12);
  write(workplace / "sweep.toml", text_of(scene) + "[sweep]\n\"" + stage + "\" = [0.86, 0.9]\n");
  expect_good(
      gridlock::test::gridlock({"sweep", "sweep.toml", "-o", "swept", "-q", "--no-pictures"}, workplace.path()));
  gridlock::Table const sweep = gridlock::read_csv(workplace / "swept/sweep.csv");
  ASSERT_EQ(sweep.row_count(), 2U);
  EXPECT_EQ(sweep.numbers("jamming_packing_fraction").back(),
            summary_of(workplace / "set")["jamming_packing_fraction"]["value"].get<double>());
  Outcome const outside = gridlock::test::gridlock(
      {"run", scene, "--set", "protocol[7].packing_fraction=0.9", "-o", "no"}, workplace.path());
  EXPECT_EQ(outside.exit_code, 2);
  EXPECT_NE(outside.err.find("the list has 2 tables, counted from 0"), std::string::npos) << outside.err;
}

TEST(Protocol, ShearsTheBoxAndTellsTheStressAndItsDrops) {
  Workplace const workplace;
  std::string const scene = (scenes / "shear.toml").string();
  for (char const* threads : {"1", "3"})
    expect_good(gridlock::test::gridlock({"run", scene, "-o", threads, "-q", "-j", threads}, workplace.path()));
  EXPECT_EQ(text_of(workplace / "1/shear.csv"), text_of(workplace / "3/shear.csv"));
  EXPECT_EQ(text_of(workplace / "1/final.xyz"), text_of(workplace / "3/final.xyz"));
  EXPECT_NE(text_of(workplace / "1/final.xyz").find("Lattice=\"1.0 0 0 0.2 1.0 0 0 0 1\""), std::string::npos);
  EXPECT_EQ(std::ranges::count(text_of(workplace / "1/shear.csv"), '\n'), 202);
  EXPECT_GT(std::ranges::count(text_of(workplace / "1/shear_events.csv"), '\n'), 1);
  // The packing is read again with the box that it has.
  Outcome const contacts = gridlock::test::gridlock({"contacts", "1/final.xyz"}, workplace.path());
  EXPECT_NE(contacts.out.find("is_converged                     true"), std::string::npos) << contacts.out;
  write(workplace / "again.toml", "disks.file = \"1/final.xyz\"\n[[protocol]]\nstage = \"quench\"\n");
  expect_good(gridlock::test::gridlock({"run", "again.toml", "-o", "again", "-q"}, workplace.path()));
  EXPECT_NE(text_of(workplace / "again/final.xyz").find("Lattice=\"1.0 0 0 0.2 1.0 0 0 0 1\""), std::string::npos);
  Outcome const walled = gridlock::test::gridlock({"check", scene, "--set", "box.edge=\"wall\""}, workplace.path());
  EXPECT_EQ(walled.exit_code, 2);
  EXPECT_NE(walled.err.find("a stage \"shear\" in a box that is walled"), std::string::npos) << walled.err;
  write(workplace / "hertzian.toml",
        "box = { edge = \"periodic\", tilt = 0.25 }\nsoft.potential = \"hertzian\"\n"
        "disks = { count = 32, packing_fraction = 0.9, start = \"uniform\" }\n[[protocol]]\nstage = \"quench\"\n");
  expect_good(gridlock::test::gridlock({"run", "hertzian.toml", "-o", "hertzian", "-q"}, workplace.path()));
  Outcome const hertzian = gridlock::test::gridlock({"contacts", "hertzian"}, workplace.path());
  EXPECT_NE(hertzian.out.find("is_converged                     true"), std::string::npos) << hertzian.out;
  EXPECT_NE(hertzian.out.find("periodic box 1 × 1, tilt 0.25"), std::string::npos) << hertzian.out;
  Outcome const moved = gridlock::test::gridlock(
      {"check", "hertzian.toml", "--set", "engine.kind=\"soft\"", "--set", "run.steps=10"}, workplace.path());
  EXPECT_NE(moved.err.find("the protocol presses disks with soft.potential = \"hertzian\", and the run moves them with "
                           "potential.kind = \"harmonic\""),
            std::string::npos)
      << moved.err;
  Outcome const stepped = gridlock::test::gridlock(
      {"check", scene, "--set", "protocol=[{stage=\"quench\",box_shape=\"free\"},{stage=\"separate\"}]", "--set",
       "run.steps=10"},
      workplace.path());
  EXPECT_EQ(stepped.exit_code, 2);
  EXPECT_NE(stepped.err.find("the engine \"stepped\" knows rectangles only, and the stage \"quench\" of the protocol "
                             "leaves a tilt"),
            std::string::npos)
      << stepped.err;
  Outcome const swapped = gridlock::test::gridlock(
      {"check", scene, "--set",
       "protocol=[{stage=\"quench\",box_shape=\"free\"},{stage=\"separate\"},{stage=\"swap\",sweeps=10}]"},
      workplace.path());
  EXPECT_EQ(swapped.exit_code, 2);
  EXPECT_NE(
      swapped.err.find("a stage \"swap\" knows rectangles only, and the stage \"quench\" before it leaves a tilt"),
      std::string::npos)
      << swapped.err;
  Outcome const free = gridlock::test::gridlock(
      {"check", (scenes / "shear_stable.toml").string(), "--set", "box.edge=\"wall\""}, workplace.path());
  EXPECT_EQ(free.exit_code, 2);
  EXPECT_NE(free.err.find("a stage \"quench\" with box_shape = \"free\" in a box that is walled"), std::string::npos)
      << free.err;
  Outcome const hard = gridlock::test::gridlock(
      {"check", (scenes / "soft_liquid.toml").string(), "--set", "box.tilt=0.1"}, workplace.path());
  EXPECT_EQ(hard.exit_code, 2);
  EXPECT_NE(hard.err.find("knows rectangles only, and box.tilt is 0.1"), std::string::npos) << hard.err;
}

TEST(Protocol, IsDrawnWithItsLevelsAndWithoutDisplacements) {
  if (!has_python_commands()) GTEST_SKIP() << "this build has no gridlock-plot";
  Workplace const workplace;
  expect_good(gridlock::test::gridlock({"run", (scenes / "jamming.toml").string(), "-o", "out", "-q", "--pictures"},
                                       workplace.path()));
  for (char const* name : {"final.svg", "start.svg", "levels.svg"}) EXPECT_TRUE(fs::exists(workplace / "out" / name));
  EXPECT_FALSE(fs::exists(workplace / "out/displacement.svg"));
}

TEST(Protocol, IsFollowedByARunAsLongAsOneLikes) {
  Workplace const workplace;
  std::string const stages = "[[protocol]]\nstage = \"grow\"\nrate = 0.05\nuntil_packing_fraction = 0.7\n";
  std::string const settings = "engine.kind = \"exact\"\nobserve.every = 10\n" + fluid_with(stages);
  Outcome const prepared = run(settings, workplace.path());
  ASSERT_EQ(prepared.exit_code, 0) << prepared.err;
  expect_good(gridlock::test::gridlock({"resume", "out", "--steps", "40", "-q", "--no-pictures"}, workplace.path()));
  expect_good(gridlock::test::gridlock({"run", "a.toml", "--set", "run.steps=40", "-o", "whole", "-q", "--no-pictures"},
                                       workplace.path()));
  EXPECT_EQ(summary_of(workplace / "out")["state_hash"], summary_of(workplace / "whole")["state_hash"]);
  EXPECT_TRUE(summary_of(workplace / "whole").contains("mean_displacement"));
}

}  // namespace
