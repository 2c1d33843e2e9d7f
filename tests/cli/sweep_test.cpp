// Sweeps over interruptions, growing plans and several machines, through the program itself.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <csignal>
#include <memory>
#include <thread>

#include "cli/program.hpp"
#include "cli/sweeps.hpp"
#include "gridlock/io/table.hpp"

namespace {

using namespace gridlock::test;

Outcome in(fs::path const& directory, std::vector<std::string> arguments) {
  return gridlock::test::gridlock(std::move(arguments), directory);
}

TEST(Sweep, RunAgainKeepsWhatIsFinishedAndMakesOnlyWhatIsNew) {
  Workplace const workplace;
  write(workplace / "s.toml", sweep_toml("0.3, 0.5"));
  expect_good(in(workplace.path(), {"sweep", "s.toml", "--no-pictures", "-o", "out"}));
  auto const first = fs::last_write_time(workplace / "out/runs/packing_fraction=0.3_seed=1/summary.json");
  write(workplace / "s.toml", sweep_toml("0.2, 0.3, 0.5"));
  expect_good(in(workplace.path(), {"sweep", "s.toml", "--no-pictures", "-o", "out"}));
  EXPECT_EQ(fs::last_write_time(workplace / "out/runs/packing_fraction=0.3_seed=1/summary.json"), first);
  expect_good(in(workplace.path(), {"sweep", "s.toml", "--no-pictures", "-o", "afresh"}));
  EXPECT_EQ(rows_of(workplace / "out"), rows_of(workplace / "afresh"));
  EXPECT_EQ(text_of(workplace / "out/means.csv"), text_of(workplace / "afresh/means.csv"));
}

TEST(Sweep, RefusesADirectoryWithOneOfItsRunsUnderOtherSettings) {
  Workplace const workplace;
  write(workplace / "s.toml", sweep_toml("0.3, 0.5"));
  expect_good(in(workplace.path(), {"sweep", "s.toml", "--no-pictures", "-o", "out"}));
  write(workplace / "s.toml", sweep_toml("0.3, 0.5", "400"));
  Outcome const outcome = in(workplace.path(), {"sweep", "s.toml", "--no-pictures", "-o", "out"});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_NE(outcome.err.find("was run with other settings: run.steps is 300 in it, and 400 in this sweep"),
            std::string::npos)
      << outcome.err;
  EXPECT_NE(outcome.err.find("hint: "), std::string::npos) << outcome.err;
  expect_good(in(workplace.path(), {"sweep", "s.toml", "--no-pictures", "-o", "out", "--overwrite"}));
}

TEST(Sweep, KilledAndRunAgainHasTheSameRows) {
  Workplace const workplace;
  write(workplace / "s.toml", sweep_toml("0.3, 0.5, 0.7", "3000"));
  expect_good(in(workplace.path(), {"sweep", "s.toml", "--no-pictures", "-o", "whole"}));
  for (int const milliseconds : {20, 60, 120, 200}) {
    Process const process(GRIDLOCK_PROGRAM, {"sweep", "s.toml", "--no-pictures", "-o", "parts"}, workplace.path());
    std::this_thread::sleep_for(std::chrono::milliseconds(milliseconds));
    process.signal(SIGKILL);
    process.wait();
  }
  expect_good(in(workplace.path(), {"sweep", "s.toml", "--no-pictures", "-o", "parts"}));
  EXPECT_EQ(rows_of(workplace / "whole"), rows_of(workplace / "parts"));
}

TEST(Sweep, InShardsAndCollectedHasTheSameRowsAsAWhole) {
  Workplace const workplace;
  write(workplace / "s.toml", sweep_toml("0.3, 0.5, 0.6"));
  expect_good(in(workplace.path(), {"sweep", "s.toml", "--no-pictures", "-o", "whole"}));
  for (char const* shard : {"1/4", "2/4", "3/4", "4/4"}) {
    expect_good(in(workplace.path(), {"sweep", "s.toml", "--no-pictures", "-o", "shared", "--shard", shard}));
    expect_good(in(workplace.path(),
                   {"sweep", "s.toml", "--no-pictures", "-o", std::string("own") + shard[0], "--shard", shard}));
  }
  EXPECT_FALSE(fs::exists(workplace / "shared/sweep.csv"));
  Outcome const early = in(workplace.path(), {"collect", "own1", "own3", "-o", "half"});
  EXPECT_EQ(early.exit_code, 1);
  EXPECT_NE(early.out.find("3 of 6 runs finished"), std::string::npos) << early.out;
  expect_good(in(workplace.path(), {"collect", "shared"}));
  expect_good(in(workplace.path(), {"collect", "own1", "own2", "own3", "own4", "-o", "joined"}));
  EXPECT_EQ(rows_of(workplace / "whole"), rows_of(workplace / "shared"));
  EXPECT_EQ(rows_of(workplace / "whole"), rows_of(workplace / "joined"));
  EXPECT_TRUE(fs::exists(workplace / "joined/runs/packing_fraction=0.6_seed=2/final.xyz"));
}

TEST(Sweep, MayBeBegunByAllShardsAtOnce) {
  Workplace const workplace;
  write(workplace / "s.toml", sweep_toml("0.3, 0.5"));
  for (std::string const directory : {"out1", "out2", "out3"}) {
    std::vector<std::unique_ptr<Process>> shards;
    for (char const* shard : {"1/4", "2/4", "3/4", "4/4"}) {
      std::vector<std::string> const command{"sweep", "s.toml", "--no-pictures", "-o", directory, "--shard", shard};
      shards.push_back(std::make_unique<Process>(GRIDLOCK_PROGRAM, command, workplace.path()));
    }
    for (auto const& shard : shards) expect_good(shard->wait());
  }
  expect_good(in(workplace.path(), {"collect", "out1"}));
}

TEST(Sweep, RefusesAShardThatIsNone) {
  Workplace const workplace;
  write(workplace / "s.toml", sweep_toml("0.3"));
  for (char const* shard : {"0/2", "3/2", "1", "a/b", "1/0", "1/2/3"}) {
    Outcome const outcome = in(workplace.path(), {"sweep", "s.toml", "--no-pictures", "-o", "out", "--shard", shard});
    EXPECT_EQ(outcome.exit_code, 2) << shard;
    EXPECT_NE(outcome.err.find("is not a shard"), std::string::npos) << outcome.err;
  }
  EXPECT_FALSE(fs::exists(workplace / "out"));
}

TEST(Sweep, SaysWhatTheSameCommandWillDoAboutRunsThatFailed) {
  Workplace const workplace;
  write(workplace / "s.toml", sweep_toml("0.3, 0.9"));
  Outcome const outcome = in(workplace.path(), {"sweep", "s.toml", "--no-pictures", "-o", "out", "--quiet"});
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_NE(outcome.err.find("2 of 4 runs failed"), std::string::npos) << outcome.err;
  EXPECT_NE(outcome.err.find("fix the cause and run the same command again"), std::string::npos) << outcome.err;
  EXPECT_EQ(outcome.err.find("stopped early"), std::string::npos) << "none was: " << outcome.err;
}

TEST(Sweep, OverEnginesNotesWhatHasNoEffectInAnyRunOnly) {
  Workplace const workplace;
  write(workplace / "s.toml",
        "disks.count = 64\nrun.steps = 20\nengine = { audit_every = 100, cells = 4, threads = 2 }\n"
        "[sweep]\nengine.kind = [\"stepped\", \"exact\"]\n");
  std::string const note = "note: engine.cells has no effect in any run\n";
  for (std::vector<std::string> const& command :
       {std::vector<std::string>{"check", "s.toml"}, {"sweep", "s.toml", "-o", "out", "--no-pictures"}}) {
    Outcome const outcome = in(workplace.path(), command);
    expect_good(outcome);
    std::size_t const first = outcome.err.find("note: ");
    ASSERT_NE(first, std::string::npos) << outcome.err;
    EXPECT_EQ(outcome.err.substr(first, note.size()), note) << outcome.err;
    EXPECT_EQ(outcome.err.find("note: ", first + 1), std::string::npos) << outcome.err;
  }
  gridlock::Table const means = gridlock::read_csv(workplace / "out/means.csv");
  std::vector<double> const shares = means.numbers("halted_fraction");
  EXPECT_TRUE(std::isfinite(shares[0]));
  EXPECT_FALSE(std::isfinite(shares[1])) << "the exact engine halts no disk";
}

TEST(Sweep, OfTheExactEngineHasNoHaltedFraction) {
  Workplace const workplace;
  write(workplace / "s.toml", sweep_toml("0.3, 0.5") + "engine.kind = [\"exact\"]\n");
  expect_good(in(workplace.path(), {"sweep", "s.toml", "-o", "out"}));
  EXPECT_FALSE(gridlock::read_csv(workplace / "out/means.csv").contains("halted_fraction"));
  EXPECT_FALSE(fs::exists(workplace / "out/halted_fraction.svg"));
  EXPECT_EQ(fs::exists(workplace / "out/collision_rate.svg"), has_python_commands());
}

TEST(UnusedSettings, AreNotedByCheckAndRunUnlessQuiet) {
  Workplace const workplace;
  write(workplace / "a.toml", "disks.count = 64\nrun.steps = 20\n");
  std::vector<std::string> const settings{"a.toml", "--set", "engine.threads=2"};
  std::string const note = "note: engine.threads has no effect with engine.kind = \"stepped\"\n";
  auto const with = [&](std::vector<std::string> words) {
    words.insert(words.begin() + 1, settings.begin(), settings.end());
    return in(workplace.path(), words).err;
  };
  EXPECT_EQ(with({"check"}), note);
  EXPECT_NE(with({"run", "-o", "one", "--no-pictures"}).find(note), std::string::npos);
  EXPECT_EQ(with({"run", "-o", "two", "--no-pictures", "--quiet"}), "");
}

TEST(Collect, RefusesADirectoryWithoutASweep) {
  Workplace const workplace;
  fs::create_directories(workplace / "empty");
  for (char const* directory : {"empty", "missing"}) {
    Outcome const outcome = in(workplace.path(), {"collect", directory, "-o", "out"});
    EXPECT_EQ(outcome.exit_code, 2);
    EXPECT_NE(outcome.err.find(std::string(directory) + " holds no sweep"), std::string::npos) << outcome.err;
    EXPECT_NE(outcome.err.find("hint: "), std::string::npos) << outcome.err;
  }
  EXPECT_FALSE(fs::exists(workplace / "out"));
}

/// Replaces one text by another wherever it is in a file.
void replace_in(fs::path const& file, std::string const& from, std::string const& to) {
  std::string text = text_of(file);
  ASSERT_NE(text.find(from), std::string::npos) << file;
  for (std::size_t at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size())) {
    text.replace(at, from.size(), to);
  }
  write(file, text);
}

void expect_refused(Outcome const& outcome, std::string const& reason) {
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_NE(outcome.err.find(reason), std::string::npos) << outcome.err;
}

TEST(Collect, TakesNoNameOfARunThatLeadsElsewhere) {
  Workplace const workplace;
  write(workplace / "s.toml", sweep_toml("0.3"));
  expect_good(in(workplace.path(), {"sweep", "s.toml", "--no-pictures", "-o", "out"}));
  std::string const plan = text_of(workplace / "out/plan.json");
  // A run of the stranger's at a place that the names lead to from the output directory as well.
  fs::create_directories(workplace / "joined/runs");
  fs::create_directories(workplace / "victim");
  write(workplace / "victim/final.xyz", "mine");
  fs::copy(workplace / "out/runs/packing_fraction=0.3_seed=1", workplace / "out/victim");
  for (std::string const& name : {std::string("../../victim"), std::string("../victim"),
                                  (workplace / "victim").string(), std::string("."), std::string()}) {
    write(workplace / "out/plan.json", plan);
    replace_in(workplace / "out/plan.json", "packing_fraction=0.3_seed=1", name);
    expect_refused(in(workplace.path(), {"collect", "out", "-o", "joined"}), "is not the name of a run");
    EXPECT_EQ(contents(workplace / "joined"), std::vector<std::string>{"runs"}) << name;
    EXPECT_EQ(text_of(workplace / "victim/final.xyz"), "mine") << name;
  }
}

TEST(Collect, TakesNoKeyThatMakesAPathOfAName) {
  Workplace const workplace;
  write(workplace / "s.toml", "disks.count = 64\nrun.steps = 20\n[sweep]\nrun.seed = [1]\n");
  expect_good(in(workplace.path(), {"sweep", "s.toml", "--no-pictures", "-o", "out"}));
  replace_in(workplace / "out/plan.json", "\"run.seed\"", "\"run./victim\"");
  replace_in(workplace / "out/plan.json", "\"seed=1\"", "\"/victim=1\"");
  expect_refused(in(workplace.path(), {"collect", "out", "-o", "joined"}), "is not the name of a run");
}

TEST(Collect, WritesThroughNoLinkThatLeadsOutOfItsOutput) {
  Workplace const workplace;
  write(workplace / "s.toml", sweep_toml("0.3"));
  std::string const run = "runs/packing_fraction=0.3_seed=1";
  expect_good(in(workplace.path(), {"sweep", "s.toml", "--no-pictures", "-o", "good"}));
  write(workplace / "mine", "mine");
  fs::create_directories(workplace / "home");
  struct Link {
    std::string name;
    std::string target;
    bool is_refused;
  };
  // The last one has the name of a file of the run: told to, collect replaces the link, and not what it leads to.
  for (Link const& link : {Link{"sweep.csv", "mine", true}, Link{"mean_displacement.svg", "mine", true},
                           Link{"means.csv", "not yet there", true}, Link{run, "home", true},
                           Link{"runs", "home", true}, Link{run + "/final.xyz", "mine", false}}) {
    fs::path const out = workplace / ("out_of_" + fs::path(link.name).filename().string());
    fs::create_directories((out / link.name).parent_path());
    fs::create_symlink(workplace / link.target, out / link.name);
    Outcome const outcome = in(workplace.path(), {"collect", "good", "-o", out.filename().string()});
    if (link.is_refused) {
      expect_refused(outcome, "leads");
    } else {
      expect_refused(outcome, "would be replaced");
      expect_good(in(workplace.path(), {"collect", "good", "-o", out.filename().string(), "--overwrite"}));
      EXPECT_EQ(text_of(out / link.name), text_of(workplace / "good" / link.name));
    }
    EXPECT_EQ(text_of(workplace / "mine"), "mine") << link.name;
    EXPECT_FALSE(fs::exists(workplace / "not yet there")) << link.name;
    EXPECT_TRUE(fs::is_empty(workplace / "home")) << link.name;
  }
}

TEST(Collect, ReplacesARunThatWasStoppedByTheSameOneFinished) {
  Workplace const workplace;
  write(workplace / "s.toml", sweep_toml("0.3"));
  std::string const run = "/runs/packing_fraction=0.3_seed=1";
  expect_good(in(workplace.path(), {"sweep", "s.toml", "--no-pictures", "-o", "good"}));
  expect_good(in(workplace.path(), {"sweep", "s.toml", "--no-pictures", "-o", "part"}));
  replace_in(workplace / ("part" + run) / "summary.json", "\"finished\"", "\"interrupted\"");
  write(workplace / ("part" + run) / "checkpoint.gridlock", "old");
  expect_good(in(workplace.path(), {"collect", "part", "good"}));
  EXPECT_EQ(rows_of(workplace / "part"), rows_of(workplace / "good"));
  EXPECT_EQ(contents(workplace / ("part" + run)), contents(workplace / ("good" + run)));
}

TEST(Collect, StoppedOrKilledWhileItCopiesLeavesNothingThatTheNextOneDoesNotRemove) {
  Workplace const workplace;
  write(workplace / "s.toml", sweep_toml("0.3"));
  std::string const run = "runs/packing_fraction=0.3_seed=1";
  expect_good(in(workplace.path(), {"sweep", "s.toml", "--no-pictures", "-o", "good"}));
  write(workplace / "good" / run / "large.bin", std::string(1'000'000, 'x'));
  // A limit on the size of files ends it in the middle of the large one.
  Outcome const stopped =
      Process("/bin/bash", {"-c", "ulimit -c 0 -f 100; exec \"$0\" collect good -o joined", GRIDLOCK_PROGRAM},
              workplace.path())
          .wait();
  EXPECT_EQ(stopped.exit_code, 1);
  EXPECT_NE(stopped.err.find("cannot copy good/" + run + "/large.bin"), std::string::npos) << stopped.err;
  for (std::string const& name : contents(workplace / "joined" / run)) EXPECT_FALSE(name.starts_with(".large.bin."));
  // A kill leaves such a file.
  write(workplace / "joined" / run / ".large.bin.99999999-0.part", "half");
  expect_good(in(workplace.path(), {"collect", "good", "-o", "joined"}));
  auto const is_of_run = [](std::string const& name) { return !name.starts_with('.') || name == ".gridlock.files"; };
  for (std::string const& name : contents(workplace / "joined" / run)) EXPECT_TRUE(is_of_run(name)) << name;
  EXPECT_EQ(fs::file_size(workplace / "joined" / run / "large.bin"), 1'000'000U);
}

TEST(Collect, RefusesSweepsThatHaveDifferentSettingsInCommon) {
  Workplace const workplace;
  write(workplace / "one.toml", sweep_toml("0.3", "10"));
  write(workplace / "other.toml", sweep_toml("0.5", "20"));
  write(workplace / "threads.toml", sweep_toml("0.5", "10") + "[engine]\nthreads = 2\n");
  for (char const* name : {"one", "other", "threads"}) {
    expect_good(in(workplace.path(), {"sweep", std::string(name) + ".toml", "-o", name}));
  }
  Outcome const outcome = in(workplace.path(), {"collect", "one", "other", "-o", "joined"});
  expect_refused(outcome, "run.steps is 10 in one, and 20 in other");
  EXPECT_FALSE(fs::exists(workplace / "joined"));
  expect_good(in(workplace.path(), {"collect", "one", "threads", "-o", "joined"}));
  EXPECT_EQ(gridlock::read_csv(workplace / "joined/sweep.csv").row_count(), 4U);
}

TEST(Collect, RefusesOneRunWithDifferentSettings) {
  Workplace const workplace;
  write(workplace / "s.toml", sweep_toml("0.3"));
  for (char const* name : {"one", "other"})
    expect_good(in(workplace.path(), {"sweep", "s.toml", "--no-pictures", "-o", name}));
  replace_in(workplace / "other/runs/packing_fraction=0.3_seed=1/config.resolved.toml", "steps = 300", "steps = 400");
  expect_refused(in(workplace.path(), {"collect", "one", "other", "-o", "joined"}), "run.steps is 300 in one/runs/");
}

TEST(SlurmArrayScript, SaysHowItIsMeantWhereThereIsNoJobArray) {
  Workplace const workplace;
  unsetenv("SLURM_ARRAY_TASK_ID");
  Outcome const outcome =
      Process("bash", {GRIDLOCK_SOURCE_DIR "/examples/slurm_array.sh", "s.toml", "out"}, workplace.path()).wait();
  EXPECT_NE(outcome.exit_code, 0);
  EXPECT_NE(outcome.err.find("runs as a job array: sbatch --array="), std::string::npos) << outcome.err;
  EXPECT_EQ(outcome.err.find("unbound variable"), std::string::npos) << outcome.err;
}

TEST(Sweep, RefusesADirectoryWithASweepOfOtherSettings) {
  Workplace const workplace;
  write(workplace / "s.toml", sweep_toml("0.3", "10"));
  expect_good(in(workplace.path(), {"sweep", "s.toml", "--no-pictures", "-o", "out", "--shard", "1/2"}));
  write(workplace / "s.toml", sweep_toml("0.3", "20"));
  Outcome const outcome = in(workplace.path(), {"sweep", "s.toml", "--no-pictures", "-o", "out", "--shard", "2/2"});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_NE(outcome.err.find("run.steps is 10 in it, and 20 in this"), std::string::npos) << outcome.err;
  expect_good(in(workplace.path(), {"sweep", "s.toml", "--no-pictures", "-o", "out", "--overwrite"}));
}

}  // namespace
