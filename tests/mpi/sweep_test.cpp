// A sweep that several ranks of MPI carry out together, through the programs themselves.
#include <gtest/gtest.h>
#include <signal.h>

#include <chrono>
#include <string>
#include <vector>

#include "cli/program.hpp"
#include "cli/sweeps.hpp"
#include "mpi/mpirun.hpp"

namespace {

using namespace gridlock::test;
using namespace std::chrono_literals;

std::vector<std::string> sweep_into(std::string const& directory, std::string const& file = "s.toml") {
  return {"sweep", file, "--no-pictures", "-o", directory};
}

class MpiSweep : public ::testing::Test {
 protected:
  void expect_same_tables(std::string const& one, std::string const& other) const {
    EXPECT_EQ(rows_of(workplace_ / one), rows_of(workplace_ / other));
    EXPECT_EQ(text_of(workplace_ / (one + "/means.csv")), text_of(workplace_ / (other + "/means.csv")));
  }
  /// A sweep of some seconds.
  void write_long_one() const { write(workplace_ / "s.toml", sweep_toml("0.3, 0.5, 0.6, 0.7", "120000")); }

  Workplace workplace_;
};

TEST_F(MpiSweep, HasTheTablesOfOneProcessOnAnyNumberOfRanks) {
  write(workplace_ / "s.toml", sweep_toml("0.3, 0.5, 0.6"));
  expect_good(in(workplace_, sweep_into("alone")));
  for (int const ranks : {1, 2, 3, 8}) {
    std::string const directory = "ranks" + std::to_string(ranks);
    Outcome const outcome = on_ranks(workplace_, ranks, sweep_into(directory));
    expect_good(outcome);
    EXPECT_EQ(occurrences(outcome.out, "6 of 6 runs finished"), 1U) << outcome.out;
    expect_same_tables("alone", directory);
  }
  expect_good(on_ranks(workplace_, 2, sweep_into("threads") + std::vector<std::string>{"-j", "2"}));
  expect_same_tables("alone", "threads");
}

/// Runs that ranks can share. In those of the longer step disks become too fast for their sub-steps and the run fails.
std::string shared_toml(std::string const& steps) {
  return light_among_heavy + ("[run]\nsteps = " + steps) +
         "\n[observe]\nevery = 50\n[checkpoint]\nevery_seconds = 0.1\n"
         "[sweep]\nengine.time_step = [0.02, 0.5]\nrun.seed = [1, 2]\n";
}

std::vector<std::string> in_groups_of(int ranks) {
  return sweep_into("out") + std::vector<std::string>{"--overwrite", "--ranks-per-run", std::to_string(ranks)};
}

TEST_F(MpiSweep, HasTheTablesOfOneProcessWhereRanksShareRuns) {
  write(workplace_ / "s.toml", shared_toml("2000"));
  Outcome const alone = in(workplace_, sweep_into("alone"));
  ASSERT_NE(alone.out.find("2 of 4 runs finished"), std::string::npos) << alone.out;
  for (auto const& [ranks, of_run] : std::vector<std::pair<int, int>>{{2, 2}, {5, 2}, {3, 8}}) {
    Outcome const outcome = on_ranks(workplace_, ranks, in_groups_of(of_run));
    EXPECT_EQ(outcome.exit_code, 1);
    EXPECT_EQ(occurrences(outcome.out, "2 of 4 runs finished"), 1U) << outcome.out << outcome.err;
    expect_same_tables("alone", "out");
  }
}

TEST_F(MpiSweep, HasTheTablesOfOneProcessWhereRanksShareRunsOfModels) {
  write(workplace_ / "s.toml",
        "[model]\nkind = \"epidemic\"\n[epidemic]\ncount = 500\nradius = 0.05\nturnover_rate = 0.3\n"
        "[run]\nsteps = 200\n[observe]\nevery = 50\n[sweep]\nepidemic.infection_rate = [1.0, 3.0]\n");
  expect_good(in(workplace_, sweep_into("alone")));
  expect_good(on_ranks(workplace_, 4, in_groups_of(2)));
  expect_same_tables("alone", "out");
}

TEST_F(MpiSweep, WhereRanksShareRunsAnyRankMayBeAskedToStop) {
  write(workplace_ / "s.toml", shared_toml("40000"));
  in(workplace_, sweep_into("alone"));
  auto arguments = in_groups_of(2);
  // Rank 3 shares the runs of rank 2.
  RanksAtWork const asked = start_and_wait_for_checkpoint(workplace_, 4, arguments);
  asked.signal(3, SIGTERM, 100ms);
  Outcome const outcome = asked.process.wait();
  EXPECT_EQ(outcome.exit_code, 1) << outcome.err;
  EXPECT_NE(outcome.err.find("were stopped early"), std::string::npos) << outcome.err;
  on_ranks(workplace_, 3, sweep_into("out") + std::vector<std::string>{"--ranks-per-run", "3"});
  expect_same_tables("alone", "out");
}

TEST_F(MpiSweep, RefusesToShareRunsThatRanksCannotShare) {
  write(workplace_ / "s.toml", sweep_toml("0.3"));
  Outcome const outcome = on_ranks(workplace_, 3, in_groups_of(2));
  EXPECT_EQ(outcome.exit_code, 2) << outcome.err;
  EXPECT_EQ(occurrences(outcome.err, "cannot be shared by 2 ranks"), 1U) << outcome.err;
}

TEST_F(MpiSweep, MakesEveryRunOnce) {
  write(workplace_ / "s.toml", sweep_toml("0.2, 0.3, 0.4, 0.5, 0.6", "20"));
  expect_good(on_ranks(workplace_, 4, sweep_into("out")));
  for (fs::directory_entry const& run : fs::directory_iterator(workplace_ / "out/runs")) {
    EXPECT_EQ(occurrences(text_of(run.path() / "run.log"), "state hash"), 1U) << text_of(run.path() / "run.log");
  }
}

TEST_F(MpiSweep, AgainKeepsWhatIsFinished) {
  write(workplace_ / "s.toml", sweep_toml("0.3, 0.5"));
  expect_good(in(workplace_, sweep_into("out")));
  auto const kept = fs::last_write_time(workplace_ / "out/runs/packing_fraction=0.3_seed=1/summary.json");
  write(workplace_ / "s.toml", sweep_toml("0.3, 0.4, 0.5"));
  expect_good(on_ranks(workplace_, 3, sweep_into("out")));
  EXPECT_EQ(fs::last_write_time(workplace_ / "out/runs/packing_fraction=0.3_seed=1/summary.json"), kept);
  expect_good(in(workplace_, sweep_into("afresh")));
  expect_same_tables("out", "afresh");
  expect_good(on_ranks(workplace_, 2, sweep_into("out") + std::vector<std::string>{"--overwrite"}));
  EXPECT_NE(fs::last_write_time(workplace_ / "out/runs/packing_fraction=0.3_seed=1/summary.json"), kept);
}

TEST_F(MpiSweep, RefusesWhatCannotBeUsedAndSaysItOnce) {
  write(workplace_ / "s.toml", sweep_toml("0.3") + "[engine]\nkin = \"exact\"\n");
  expect_refused(workplace_, {{sweep_into("out"), "did you mean kind?"},
                              {{"sweep", "nothing.toml"}, "nothing.toml"},
                              {{"check", "s.toml"},
                               "hint: it has run, resume and sweep; all others are those of gridlock: gridlock check"},
                              {{"sweep", "s.toml", "--shard", "1/2"}, "no option --shard"}});
}

TEST_F(MpiSweep, RefusesADirectoryInWhichAnotherProcessWorks) {
  write_long_one();
  Process const other = start(workplace_, 2, sweep_into("out"));
  wait_for(workplace_ / "out/plan.json");
  fs::create_directories(workplace_ / "elsewhere");
  Outcome const outcome =
      Process(GRIDLOCK_PROGRAM, {"sweep", workplace_ / "s.toml", "-o", workplace_ / "out"}, workplace_ / "elsewhere")
          .wait();
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_NE(outcome.err.find("another process is working in"), std::string::npos) << outcome.err;
  other.signal(SIGTERM);
  other.wait();
}

TEST_F(MpiSweep, ARunThatFailsDoesNotEndTheOthers) {
  write(workplace_ / "s.toml", sweep_toml("0.3, 0.5, 0.95"));
  // Nothing can be written where this one is to go.
  fs::create_directories(workplace_ / "out/runs");
  write(workplace_ / "out/runs/packing_fraction=0.5_seed=2", "in the way");
  Outcome const outcome = on_ranks(workplace_, 3, sweep_into("out"));
  EXPECT_EQ(outcome.exit_code, 1) << outcome.err;
  EXPECT_NE(outcome.out.find("3 of 6 runs finished"), std::string::npos) << outcome.out;
  EXPECT_NE(outcome.err.find("3 of 6 runs failed"), std::string::npos) << outcome.err;
  EXPECT_NE(outcome.err.find("packing_fraction=0.5_seed=2"), std::string::npos) << outcome.err;
  fs::remove(workplace_ / "out/runs/packing_fraction=0.5_seed=2");
  EXPECT_NE(on_ranks(workplace_, 2, sweep_into("out")).out.find("4 of 6 runs finished"), std::string::npos);
}

TEST_F(MpiSweep, RefusesRanksThatReadDifferentFiles) {
  write(workplace_ / "one.toml", sweep_toml("0.3"));
  write(workplace_ / "other.toml", sweep_toml("0.5"));
  auto const beside = [&](std::string const& first, std::string const& second) {
    return mpirun(workplace_, std::vector<std::string>{"-n", "1", GRIDLOCK_MPI_PROGRAM} + sweep_into("out", first) +
                                  std::vector<std::string>{":", "-n", "1", GRIDLOCK_MPI_PROGRAM} +
                                  sweep_into("out", second))
        .wait();
  };
  Outcome const mixed = beside("one.toml", "other.toml");
  EXPECT_EQ(mixed.exit_code, 2);
  EXPECT_EQ(occurrences(mixed.err, "error: rank 1 has read another plan or command line"), 1U) << mixed.err;
  Outcome const missing = beside("one.toml", "missing.toml");
  EXPECT_NE(missing.exit_code, 0);
  EXPECT_NE(missing.err.find("error: rank 1 cannot take part: cannot"), std::string::npos) << missing.err;
  Outcome const alone = beside("missing.toml", "one.toml");
  EXPECT_EQ(alone.exit_code, 2);
  EXPECT_EQ(occurrences(alone.err, "error: "), 1U) << alone.err;
}

TEST_F(MpiSweep, SavesItselfWhenAskedToStopAndContinuesOnAnotherNumberOfRanks) {
  write_long_one();
  expect_good(in(workplace_, sweep_into("alone")));
  for (int const signal : {SIGTERM, SIGUSR1}) {
    RanksAtWork const asked = start_and_wait_for_checkpoint(workplace_, 3, sweep_into("out"));
    asked.process.signal(signal);
    expect_stopped_by(signal, asked.process.wait());
  }
  // A scheduler asks all processes of a job, and mpirun its ranks once more.
  RanksAtWork const twice = start_and_wait_for_checkpoint(workplace_, 2, sweep_into("out"));
  for (pid_t const rank : twice.ranks) kill(rank, SIGTERM);
  twice.process.signal(SIGUSR1);
  Outcome const of_twice = twice.process.wait();
  EXPECT_EQ(of_twice.exit_code, 1);
  EXPECT_NE(of_twice.err.find("the same command continues them"), std::string::npos) << of_twice.err;
  // One rank hears of it and tells the others.
  for (std::size_t const rank : {0U, 1U}) {
    RanksAtWork const asked = start_and_wait_for_checkpoint(workplace_, 2, sweep_into("out"));
    asked.signal(rank, SIGTERM, 0ms);
    Outcome const outcome = asked.process.wait();
    EXPECT_EQ(outcome.exit_code, 1) << outcome.err;
    EXPECT_NE(outcome.err.find("the same command continues them"), std::string::npos) << outcome.err;
  }
  expect_good(on_ranks(workplace_, 4, sweep_into("out")));
  expect_same_tables("alone", "out");
}

TEST_F(MpiSweep, EndsWhereARankIsKilledAndContinuesToTheSameTables) {
  write_long_one();
  expect_good(in(workplace_, sweep_into("alone")));
  for (std::size_t const attempt : {0U, 1U, 2U}) {
    RanksAtWork const at_work = start_and_wait_for_checkpoint(workplace_, 3, sweep_into("out"));
    at_work.signal(attempt, SIGKILL, 50ms * attempt);
    expect_ended_by_kill(at_work.process.wait(), attempt);
  }
  expect_good(on_ranks(workplace_, 2, sweep_into("out")));
  expect_same_tables("alone", "out");
}

}  // namespace
