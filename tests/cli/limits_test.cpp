// Input without an end, limits of the system, and lists for stages: refused in time, or used.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "cli/program.hpp"
#include "cli/sweeps.hpp"

namespace {

using namespace gridlock::test;

void expect_refused(Outcome const& outcome, std::string const& reason) {
  EXPECT_EQ(outcome.exit_code, 2) << outcome.err;
  EXPECT_NE(outcome.err.find(reason), std::string::npos) << outcome.err;
  EXPECT_NE(outcome.err.find("hint: "), std::string::npos) << outcome.err;
}

/// The program in a shell, as "$0"; 124 where it does not end.
Outcome in_shell(Workplace const& workplace, std::string const& command) {
  return Process("/usr/bin/timeout", {"300", "/bin/bash", "-c", command, GRIDLOCK_PROGRAM}, workplace.path()).wait();
}

TEST(EndlessInput, OfADeviceIsRefused) {
  Workplace const workplace;
  write(workplace / "a.toml", "disks.file = \"/dev/zero\"\n");
  for (char const* command : {"\"$0\" contacts /dev/zero", "\"$0\" contacts /dev/urandom", "\"$0\" run a.toml -o out",
                              "\"$0\" check /dev/zero"}) {
    SCOPED_TRACE(command);
    expect_refused(in_shell(workplace, command), "it is a device, and has no end");
  }
  EXPECT_FALSE(fs::exists(workplace / "out"));
}

TEST(EndlessInput, OfAPipeWithoutLinesIsRefused) {
  Workplace const workplace;
  expect_refused(in_shell(workplace, "tr '\\0' 8 < /dev/zero | \"$0\" contacts /dev/stdin"), "and does not end");
}

TEST(EndlessInput, IsNotADeviceWithoutContent) {
  Workplace const workplace;
  expect_good(in(workplace, {"check", "/dev/null", "--set", "disks.count=16"}));
}

TEST(LimitOfFiles, EndsARunWithTheReason) {
  Workplace const workplace;
  write(workplace / "a.toml", std::string(small_run));
  Outcome const outcome = in_shell(workplace, "ulimit -f 4; exec \"$0\" run a.toml -o out --no-pictures");
  EXPECT_EQ(outcome.exit_code, 1) << outcome.err;
  EXPECT_NE(outcome.err.find("File too large"), std::string::npos) << outcome.err;
}

TEST(LimitOfFiles, OfTheErrorsThemselvesLeavesTheExitCode) {
  Workplace const workplace;
  EXPECT_EQ(in_shell(workplace, "ulimit -f 0; exec \"$0\" run missing.toml").exit_code, 2);
  EXPECT_EQ(in_shell(workplace, "exec \"$0\" run missing.toml 2> /dev/full").exit_code, 2);
}

TEST(ListsOfStages, AreGivenByTheCommandLineAsInAFile) {
  Workplace const workplace;
  fs::path const scene = fs::path(GRIDLOCK_SOURCE_DIR) / "scenes/jamming.toml";
  std::string const base = text_of(scene) + "\n[sweep]\n";
  write(workplace / "plain.toml", base + "run.seed = [1, 2]\n");
  write(workplace / "file.toml", base + "run.seed = [1, 2]\n\"protocol[0].packing_fraction\" = [0.86, 0.9]\n");
  Outcome const of_file = in(workplace, {"check", "file.toml"});
  expect_good(of_file);
  EXPECT_NE(of_file.out.find("4 runs\n"), std::string::npos) << of_file.out;
  for (char const* key :
       {"sweep.protocol[0].packing_fraction=[0.86, 0.9]", "sweep.\"protocol[0].packing_fraction\"=[0.86, 0.9]"}) {
    Outcome const outcome = in(workplace, {"check", "plain.toml", "--set", key});
    expect_good(outcome);
    std::string expected = of_file.out;
    EXPECT_EQ(outcome.out, expected.replace(expected.find("file.toml"), 9, "plain.toml"));
  }
  expect_refused(in(workplace, {"check", "plain.toml", "--set", "sweep.protocol[2].packing_fraction=[0.9]"}),
                 "the list has 2 tables, counted from 0");
}

TEST(FailedRuns, SayOnceWhatTheyShareAndAreAllNamed) {
  Workplace const workplace;
  write(workplace / "s.toml",
        "disks.start = \"random\"\nrun.steps = 5\ndisks.count = 100\n[sweep]\n"
        "disks.packing_fraction = [0.3, 0.89]\nrun.seed = [1, 2, 3]\n");
  Outcome const outcome = in(workplace, {"sweep", "s.toml", "--no-pictures", "-o", "out", "-q"});
  EXPECT_EQ(outcome.exit_code, 1) << outcome.err;
  std::string const& said = outcome.err;
  EXPECT_EQ(said.find("error: packing_fraction=0.89_seed=1: "), 0U) << said;
  EXPECT_EQ(said.find("error: ", 1), std::string::npos) << said;
  EXPECT_NE(said.find("  the same of packing_fraction=0.89_seed=2, packing_fraction=0.89_seed=3\n"), std::string::npos)
      << said;
  EXPECT_NE(said.find("3 of 6 runs failed"), std::string::npos) << said;
}

TEST(DamagedPlan, WithoutRunsIsRefused) {
  Workplace const workplace;
  fs::create_directories(workplace / "s");
  write(workplace / "s/plan.json", "{\"keys\": [\"run.seed\"], \"base\": {}, \"runs\": []}");
  expect_refused(in(workplace, {"collect", "s", "-o", "out"}), "it lists no runs");
  EXPECT_FALSE(fs::exists(workplace / "out"));
}

TEST(FramesThatWereNotKept, AreAskedForWithASettingThatKeepsSome) {
  Workplace const workplace;
  std::string const scene = (fs::path(GRIDLOCK_SOURCE_DIR) / "scenes/jamming.toml").string();
  write(workplace / "long.toml", "disks.count = 16\nrun.steps = 3000\n");
  expect_good(in(workplace, {"run", scene, "-o", "packing", "-q", "--no-pictures"}));
  expect_good(in(workplace, {"run", "long.toml", "-o", "long", "-q", "--no-pictures"}));
  for (char const* command : {"export", "movie"}) {
    std::vector<std::string> const to =
        command == std::string("export") ? std::vector<std::string>{"--to", "csv"} : std::vector<std::string>{};
    auto const words = [&](char const* run) {
      std::vector<std::string> all{command, run};
      all.insert(all.end(), to.begin(), to.end());
      return all;
    };
    expect_refused(in(workplace, words("packing")), "--set trajectory.every=1, ");
    expect_refused(in(workplace, words("long")), "--set trajectory.every=30, ");
  }
}

}  // namespace
