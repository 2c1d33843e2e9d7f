// What a user does from the first run to a sweep, through the program itself.
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <sys/wait.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <thread>

#include "cli/program.hpp"
#include "gridlock/core/target.hpp"
#include "gridlock/io/table.hpp"
#include "gridlock/io/xyz.hpp"

namespace {

using namespace gridlock::test;
using Arguments = std::vector<std::string>;

nlohmann::json summary_of(fs::path const& directory) {
  return nlohmann::json::parse(text_of(directory / "summary.json"));
}

TEST(Run, LeavesEverythingItPromises) {
  Workplace const workplace;
  write(workplace / "a.toml", small_run);
  Outcome const run = gridlock::test::gridlock({"run", "a.toml", "-o", "out"}, workplace.path());
  expect_good(run);
  EXPECT_NE(run.out.find("pictures: gridlock plot out\n"), std::string::npos) << run.out;
  for (char const* name : {"config.resolved.toml", "summary.json", "series.csv", "final.xyz", "pair_correlation.csv"}) {
    EXPECT_GT(fs::file_size(workplace / "out" / name), 100U) << name;
  }
  auto const summary = summary_of(workplace / "out");
  EXPECT_EQ(summary["state_hash"].get<std::string>().size(), 16U);
  EXPECT_EQ(summary["status"], "finished");
  EXPECT_EQ(summary["steps"], 400);
  for (char const* name :
       {"mean_displacement", "mean_squared_displacement", "kinetic_energy", "mean_speed", "compressibility_factor",
        "wall_pressure", "collision_rate", "wall_hit_rate", "halted_fraction", "global_bond_orientation_order"}) {
    ASSERT_TRUE(summary.contains(name)) << name;
    EXPECT_TRUE(std::isfinite(summary[name]["value"].get<double>())) << name;
    EXPECT_GE(summary[name]["error"].get<double>(), 0.0) << name;
  }
  gridlock::Table const series = gridlock::read_csv(workplace / "out/series.csv");
  EXPECT_EQ(series.row_count(), 21U);
  EXPECT_EQ(series.numbers("mean_displacement").back(), summary["mean_displacement"]["value"].get<double>());
}

TEST(Info, ShowsTheWordsOfAnEditedSummaryWithoutControlCharacters) {
  Workplace const workplace;
  write(workplace / "summary.json",
        R"({"status": "\u001b[2Jfinished", "state_hash": "0", "a\u0007b": {"value": 1, "unit": "m\n\u001b[31m"},)"
        R"( "c": {"value": 2, "unit": 5}})");
  Outcome const info = gridlock::test::gridlock({"info", "."}, workplace.path());
  expect_good(info);
  EXPECT_EQ(info.out.find_first_of("\x1b\x07"), std::string::npos) << info.out;
  EXPECT_NE(info.out.find("  1  m  [31m\n"), std::string::npos) << info.out;
  EXPECT_NE(info.out.find("  2  5\n"), std::string::npos) << info.out;
}

TEST(Run, FromItsResolvedConfigurationGivesTheSameBytes) {
  Workplace const workplace;
  write(workplace / "a.toml", small_run);
  expect_good(gridlock::test::gridlock({"run", "a.toml", "-o", "one", "--no-pictures"}, workplace.path()));
  expect_good(gridlock::test::gridlock({"run", "one/config.resolved.toml", "-o", "two", "--no-pictures", "--quiet"},
                                       workplace.path()));
  for (char const* name : {"series.csv", "final.xyz", "config.resolved.toml", "pair_correlation.csv"}) {
    EXPECT_EQ(text_of(workplace / "one" / name), text_of(workplace / "two" / name)) << name;
  }
  EXPECT_EQ(summary_of(workplace / "one")["state_hash"], summary_of(workplace / "two")["state_hash"]);
}

class Continuation : public testing::TestWithParam<char const*> {};

TEST_P(Continuation, FromTheFinalStateEndsWithTheBitsOfOneLongRun) {
  Workplace const workplace;
  write(workplace / "a.toml", std::string(small_run) + "[box]\nedge = \"" + GetParam() + "\"\n");
  expect_good(gridlock::test::gridlock({"run", "a.toml", "-o", "half", "--no-pictures", "--set", "run.steps=200"},
                                       workplace.path()));
  expect_good(gridlock::test::gridlock(
      {"run", "a.toml", "-o", "rest", "--no-pictures", "--set", "run.steps=200", "--set", "disks.file=half/final.xyz"},
      workplace.path()));
  expect_good(gridlock::test::gridlock({"run", "a.toml", "-o", "whole", "--no-pictures"}, workplace.path()));
  EXPECT_EQ(summary_of(workplace / "rest")["state_hash"], summary_of(workplace / "whole")["state_hash"]);
  // And the directory of the continued run can be run again by itself.
  expect_good(
      gridlock::test::gridlock({"run", "rest/config.resolved.toml", "-o", "again", "--no-pictures"}, workplace.path()));
  EXPECT_EQ(summary_of(workplace / "again")["state_hash"], summary_of(workplace / "rest")["state_hash"]);
}
INSTANTIATE_TEST_SUITE_P(Edges, Continuation, testing::Values("wall", "periodic"));

TEST(Run, GivesTheSameBitsForEveryGrid) {
  Workplace const workplace;
  write(workplace / "a.toml", small_run);
  std::set<std::string> hashes;
  for (std::string const cells : {"3", "5", "10", "20"}) {
    expect_good(gridlock::test::gridlock(
        {"run", "a.toml", "-o", cells, "--no-pictures", "--set", "engine.cells=" + cells}, workplace.path()));
    hashes.insert(summary_of(workplace / cells)["state_hash"].get<std::string>());
  }
  EXPECT_EQ(hashes.size(), 1U);
}

TEST(Run, WritesFilesThatAseReads) {
  Workplace const workplace;
  write(workplace / "a.toml", small_run);
  expect_good(gridlock::test::gridlock({"run", "a.toml", "-o", "out", "--no-pictures"}, workplace.path()));
  write(workplace / "read.py",
        "import ase.io\n"
        "atoms = ase.io.read('out/final.xyz')\n"
        "p = atoms.get_positions()\n"
        "assert len(atoms) == 100 and not atoms.pbc.any(), atoms\n"
        "assert abs(atoms.cell[0][0] - 1.0) < 1e-12\n"
        "print(repr(float(p[7][0])))\n");
  Outcome const outcome = Process("/usr/bin/python3", {"read.py"}, workplace.path()).wait();
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  gridlock::State const state = gridlock::read_xyz(workplace / "out/final.xyz").state;
  EXPECT_EQ(std::stod(outcome.out), state.agents.column<gridlock::X>()[7]);
}

TEST(Run, StopsOnCtrlCAndKeepsWhatThereIs) {
  Workplace const workplace;
  write(workplace / "a.toml", std::string(small_run) + "");
  Process const process(GRIDLOCK_PROGRAM,
                        {"run", "a.toml", "-o", "out", "--no-pictures", "--set", "run.steps=100_000_000"},
                        workplace.path());
  std::this_thread::sleep_for(std::chrono::milliseconds(700));
  process.signal(SIGINT);
  Outcome const outcome = process.wait();
  EXPECT_EQ(outcome.exit_code, 1) << outcome.err;
  EXPECT_NE(outcome.err.find("interrupted"), std::string::npos) << outcome.err;
  auto const summary = summary_of(workplace / "out");
  EXPECT_EQ(summary["status"], "interrupted");
  EXPECT_GT(summary["steps"].get<std::uint64_t>(), 0U);
  EXPECT_EQ(gridlock::read_xyz(workplace / "out/final.xyz").state.clock.step, summary["step"].get<std::uint64_t>());
}

TEST(Run, ShowsPlainLinesOfProgressInAPipe) {
  Workplace const workplace;
  write(workplace / "a.toml", small_run);
  Process const process(GRIDLOCK_PROGRAM,
                        {"run", "a.toml", "-o", "out", "--no-pictures", "--set", "run.time=20", "--set",
                         "run.steps=100_000_000", "--set", "disks.count=400"},
                        workplace.path());
  Outcome const outcome = process.wait();
  expect_good(outcome);
  EXPECT_EQ(outcome.err.find('\r'), std::string::npos);
  EXPECT_EQ(outcome.err.find('\033'), std::string::npos);
}

TEST(Sweep, RunsEveryCombinationAndAveragesOverSeeds) {
  Workplace const workplace;
  write(workplace / "s.toml",
        "[disks]\ncount = 64\n[run]\nsteps = 100\n[observe]\nevery = 10\n"
        "[sweep]\ndisks.start = [\"square\", \"triangular\"]\n\"disks.packing_fraction\" = [0.3, 0.5]\n"
        "run.seed = [1, 2, 3]\n");
  expect_good(gridlock::test::gridlock({"sweep", "s.toml", "-o", "one", "-j", "1"}, workplace.path()));
  expect_good(gridlock::test::gridlock({"sweep", "s.toml", "-o", "two", "-j", "2"}, workplace.path()));
  gridlock::Table const rows = gridlock::read_csv(workplace / "one/sweep.csv");
  ASSERT_EQ(rows.row_count(), 12U);
  auto const hashes = std::get<std::vector<std::string>>(rows.column("state_hash"));
  EXPECT_EQ(hashes,
            std::get<std::vector<std::string>>(gridlock::read_csv(workplace / "two/sweep.csv").column("state_hash")));
  EXPECT_EQ(std::set(hashes.begin(), hashes.end()).size(), 12U);

  gridlock::Table const means = gridlock::read_csv(workplace / "one/means.csv");
  ASSERT_EQ(means.row_count(), 4U);
  auto const values = rows.numbers("mean_displacement");
  auto const errors = rows.numbers("mean_displacement_error");
  for (std::size_t group = 0; group < 4; ++group) {
    double const a = values[3 * group];
    double const b = values[3 * group + 1];
    double const c = values[3 * group + 2];
    double const mean = (a + b + c) / 3.0;
    double const scatter =
        std::sqrt(((a - mean) * (a - mean) + (b - mean) * (b - mean) + (c - mean) * (c - mean)) / 6.0);
    double const by_runs = std::hypot(errors[3 * group], errors[3 * group + 1], errors[3 * group + 2]) / 3.0;
    double const error = std::max(scatter, by_runs);
    EXPECT_NEAR(means.numbers("mean_displacement")[group], mean, 1e-14);
    EXPECT_NEAR(means.numbers("mean_displacement_error")[group], error, 1e-14);
    EXPECT_EQ(means.numbers("runs")[group], 3.0);
  }
  EXPECT_EQ(fs::exists(workplace / "one/mean_displacement.svg"), has_python_commands());
}

TEST(Sweep, GoesOnWhenOneRunCannotBeMade) {
  Workplace const workplace;
  write(workplace / "s.toml",
        "[disks]\ncount = 64\n[run]\nsteps = 50\n[sweep]\ndisks.packing_fraction = [0.3, 0.8, 0.5]\n");
  Outcome const outcome = gridlock::test::gridlock({"sweep", "s.toml", "-o", "out"}, workplace.path());
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_NE(outcome.err.find("0.8"), std::string::npos) << outcome.err;
  gridlock::Table const rows = gridlock::read_csv(workplace / "out/sweep.csv");
  EXPECT_EQ(std::get<std::vector<std::string>>(rows.column("status")),
            (std::vector<std::string>{"finished", "failed", "finished"}));
}

TEST(Explain, KnowsEverySettingOfAResolvedConfiguration) {
  Workplace const workplace;
  Outcome const all = gridlock::test::gridlock({"explain"}, workplace.path());
  expect_good(all);
  for (char const* key :
       {"box.edge", "disks.packing_fraction", "velocities.max", "engine.cells", "run.seed", "observe.every"}) {
    EXPECT_NE(all.out.find(key), std::string::npos) << key;
    Outcome const one = gridlock::test::gridlock({"explain", key}, workplace.path());
    expect_good(one);
    EXPECT_NE(one.out.find("default"), std::string::npos) << one.out;
  }
}

TEST(Target, IsWhatTheEnvironmentNames) {
  Workplace const workplace;
  auto const version_with = [&](std::string const& variable) {
    return Process("/usr/bin/env", {variable, GRIDLOCK_PROGRAM, "--version"}, workplace.path()).wait();
  };
  Outcome const scalar = version_with("GRIDLOCK_TARGET=scalar");
  expect_good(scalar);
  EXPECT_NE(scalar.out.find("instructions: scalar"), std::string::npos) << scalar.out;
  if (gridlock::is_available(gridlock::Target::avx2)) {
    EXPECT_NE(version_with("GRIDLOCK_TARGET=avx2").out.find("instructions: avx2"), std::string::npos);
  }
  Outcome const unknown = version_with("GRIDLOCK_TARGET=axv2");
  EXPECT_EQ(unknown.exit_code, 2);
  EXPECT_NE(unknown.err.find("GRIDLOCK_TARGET is \"axv2\"; this processor has: scalar"), std::string::npos)
      << unknown.err;
}

TEST(Output, ThatDoesNotArriveIsAFailure) {
  if (!fs::exists("/dev/full")) GTEST_SKIP() << "no /dev/full on this system";
  Workplace const workplace;
  write(workplace / "good.toml", "[disks]\ncount = 9\n[run]\nsteps = 10\n");
  std::string const packing = GRIDLOCK_SOURCE_DIR "/tests/reference/packings/harmonic64_mid.xyz";
  // The last of them prints more than a buffer holds.
  for (std::string const& words : {std::string("run good.toml -o out --no-pictures"), std::string("info out"),
                                   "contacts " + packing + " --json", std::string("explain --markdown")}) {
    auto const print_to = [&](std::string const& place) {
      std::string const command = GRIDLOCK_PROGRAM " " + words + " > " + place;
      return Process("/bin/sh", {"-c", command}, workplace.path()).wait();
    };
    Outcome const outcome = print_to("/dev/full");
    EXPECT_EQ(outcome.exit_code, 1) << words;
    EXPECT_NE(outcome.err.find("error: cannot write to standard output: "), std::string::npos) << outcome.err;
    EXPECT_TRUE(words.starts_with("run") || print_to("printed").exit_code == 0) << words;
  }
  EXPECT_TRUE(fs::exists(workplace / "out/summary.json")) << "the results themselves are whole";
}

TEST(Help, IsThereForEveryVerb) {
  Workplace const workplace;
  expect_good(gridlock::test::gridlock({"--help"}, workplace.path()));
  expect_good(gridlock::test::gridlock({"--version"}, workplace.path()));
  for (char const* verb : {"run", "resume", "sweep", "collect", "check", "explain", "info", "export", "movie"}) {
    expect_good(gridlock::test::gridlock({verb, "--help"}, workplace.path()));
  }
}

TEST(Info, KnowsRunsSweepsStatesAndTables) {
  Workplace const workplace;
  write(workplace / "a.toml", small_run);
  expect_good(gridlock::test::gridlock({"run", "a.toml", "-o", "out", "--no-pictures"}, workplace.path()));
  std::string const state_hash = summary_of(workplace / "out")["state_hash"];
  for (char const* path : {"out", "out/final.xyz", "out/summary.json"}) {
    Outcome const outcome = gridlock::test::gridlock({"info", path}, workplace.path());
    expect_good(outcome);
    EXPECT_NE(outcome.out.find(state_hash), std::string::npos) << outcome.out;
  }
  expect_good(gridlock::test::gridlock({"info", "out/series.csv"}, workplace.path()));
}

}  // namespace
