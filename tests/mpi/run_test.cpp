// One run that several ranks of MPI share, through the programs themselves.
#include <gtest/gtest.h>
#include <signal.h>

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "cli/program.hpp"
#include "mpi/mpirun.hpp"

namespace {

using namespace gridlock::test;
using namespace std::chrono_literals;

std::string run_toml(std::string const& steps = "300", std::string const& more = "") {
  return "[disks]\ncount = 2000\npacking_fraction = 0.6\n[engine]\nkind = \"tiled\"\n[run]\nsteps = " + steps +
         "\nseed = 4\n[observe]\nevery = 20\nstructure_every = 2\ndensity_profile = \"both\"\nclusters_every = 2\n"
         "local_density_every = 1\ndisplacement_lag = 5\ntemperature_by_kind = true\nflux_line = \"vertical\"\n"
         "[trajectory]\nevery = 100\n" +
         more;
}

/// Births and deaths in every step.
std::string model_toml(std::string const& steps = "300", std::string const& more = "") {
  return "[model]\nkind = \"epidemic\"\n[epidemic]\ncount = 3000\nradius = 0.03\nturnover_rate = 0.5\n"
         "infected_at_start = 0.1\n[run]\nsteps = " +
         steps + "\nseed = 4\n[observe]\nevery = 20\n[trajectory]\nevery = 100\n" + more;
}

std::vector<std::string> run_into(std::string const& directory) { return {"run", "r.toml", "-q", "-o", directory}; }

std::string state_hash_of(fs::path const& directory) {
  std::string const summary = text_of(directory / "summary.json");
  std::string const key = "\"state_hash\": \"";
  std::size_t const at = summary.find(key);
  return at == std::string::npos ? "" : summary.substr(at + key.size(), 16);
}

/// Calls a program, and says on standard error how much memory it had at most, in KB.
constexpr char const* measured =
    "import resource, subprocess, sys; code = subprocess.call(sys.argv[1:]); "
    "print('peak', resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss, file=sys.stderr); sys.exit(code)";

/// The peak of the process that had the largest.
double largest_peak(Outcome const& outcome) {
  expect_good(outcome);
  double largest = 0.0;
  for (std::size_t at = outcome.err.find("peak "); at != std::string::npos; at = outcome.err.find("peak ", at + 1)) {
    largest = std::max(largest, std::stod(outcome.err.substr(at + 5)));
  }
  return largest;
}

class MpiRun : public ::testing::Test {
 protected:
  /// All but times.
  void expect_same_results(std::string const& one, std::string const& other) const {
    ASSERT_NE(state_hash_of(workplace_ / one), "");
    EXPECT_EQ(state_hash_of(workplace_ / one), state_hash_of(workplace_ / other));
    for (char const* file : {"series.csv", "final.xyz"})
      ASSERT_NE(text_of(workplace_ / (one + "/" + file)), "") << file;
    EXPECT_EQ(text_of(workplace_ / (one + "/final.xyz")), text_of(workplace_ / (other + "/final.xyz")));
    for (auto const& entry : fs::directory_iterator(workplace_ / one)) {
      std::string const file = entry.path().filename();
      if (entry.path().extension() != ".csv") continue;
      EXPECT_EQ(text_of(entry.path()), text_of(workplace_ / (other + "/" + file))) << file;
    }
    for (std::string const& directory : {one, other}) {
      expect_good(in(workplace_, {"export", directory, "--to", "xyz", "-o", directory + ".xyz", "--overwrite"}));
    }
    EXPECT_EQ(text_of(workplace_ / (one + ".xyz")), text_of(workplace_ / (other + ".xyz")));
  }
  /// A run of some seconds that saves itself often.
  void write_long_one() const {
    write(workplace_ / "r.toml", run_toml("12000", "[checkpoint]\nevery_seconds = 0.1\n"));
  }

  /// Of r.toml.
  void expect_same_results_on_any_number_of_ranks(char const* program = GRIDLOCK_PROGRAM,
                                                  char const* mpi_program = GRIDLOCK_MPI_PROGRAM) const {
    expect_good(Process(program, run_into("alone"), workplace_.path()).wait());
    for (int const ranks : {1, 2, 3, 8}) {
      std::string const directory = "ranks" + std::to_string(ranks);
      expect_good(on_ranks(workplace_, ranks, run_into(directory), mpi_program));
      expect_same_results("alone", directory);
    }
    expect_good(on_ranks(workplace_, 2, run_into("threads") + std::vector<std::string>{"-j", "2"}, mpi_program));
    expect_same_results("alone", "threads");
  }

  /// A run, by its number of agents, takes on each of four ranks a fourth of the memory of one process.
  template <class TomlOf>
  void expect_divided_memory(TomlOf toml_of) const {
    auto const peak = [&](int ranks, std::string const& agents) {
      write(workplace_ / "r.toml", toml_of(agents));
      std::vector<std::string> const words{"-c",  measured, ranks == 0 ? GRIDLOCK_PROGRAM : GRIDLOCK_MPI_PROGRAM,
                                           "run", "r.toml", "-q",
                                           "-j",  "1",      "--overwrite",
                                           "-o",  "out"};
      if (ranks == 0)
        return largest_peak(
            Process("/usr/bin/python3", words + std::vector<std::string>{"--no-pictures"}, workplace_.path()).wait());
      return largest_peak(
          mpirun(workplace_, std::vector<std::string>{"-n", std::to_string(ranks), "/usr/bin/python3"} + words).wait());
    };
    // What agents take: the rest is the program, MPI, and pieces of messages and frames.
    double const of_one = peak(0, "1500000") - peak(0, "300000");
    double const of_rank = peak(4, "1500000") - peak(4, "300000");
    // Rank 0 also writes; who had all agents would be at four.
    EXPECT_LT(of_rank, 1.5 * of_one / 4.0) << of_one;
    EXPECT_GT(of_rank, 0.5 * of_one / 4.0) << of_one;
  }

  Workplace workplace_;
};

TEST_F(MpiRun, HasTheFilesOfOneProcessOnAnyNumberOfRanks) {
  write(workplace_ / "r.toml", run_toml());
  expect_same_results_on_any_number_of_ranks();
}

TEST_F(MpiRun, HasTheFilesOfOneProcessForModelsToo) {
  write(workplace_ / "r.toml", model_toml());
  expect_same_results_on_any_number_of_ranks();
}

TEST_F(MpiRun, HasTheFilesOfOneProcessForTiledModelsToo) {
  // With counters of collisions, from which pressures follow, and disks too fast for their tiles.
  write(workplace_ / "r.toml",
        "[model]\nkind = \"colloid_tiled\"\n[colloid_tiled.disks]\ncount = 2000\npacking_fraction = 0.6\n"
        "[colloid_tiled.velocities]\nkind = \"maxwell\"\n[run]\nsteps = 200\nseed = 4\n"
        "[observe]\nevery = 20\n[trajectory]\nevery = 100\n");
  expect_same_results_on_any_number_of_ranks(GRIDLOCK_OWN_PROGRAM, GRIDLOCK_OWN_MPI_PROGRAM);
}

TEST_F(MpiRun, SharesATiledModelOfAUsersProgram) {
  write(workplace_ / "r.toml",
        "[model]\nkind = \"market\"\n[run]\nsteps = 60\n[observe]\nevery = 10\n[trajectory]\nevery = 20\n");
  expect_good(Process(GRIDLOCK_OWN_PROGRAM, run_into("alone"), workplace_.path()).wait());
  for (int const ranks : {2, 4}) {
    std::string const directory = "ranks" + std::to_string(ranks);
    expect_good(mpirun(workplace_, std::vector<std::string>{"-n", std::to_string(ranks), GRIDLOCK_OWN_MPI_PROGRAM} +
                                       run_into(directory))
                    .wait());
    expect_same_results("alone", directory);
  }
}

TEST_F(MpiRun, SharesTheModelOfAUsersProgram) {
  write(workplace_ / "r.toml",
        "[model]\nkind = \"schelling\"\n[schelling]\ncount = 800\n[box]\nedge = \"periodic\"\n[run]\nsteps = 60\n"
        "[observe]\nevery = 10\n[trajectory]\nevery = 20\n");
  auto const own = [&](std::vector<std::string> const& arguments) {
    return Process(GRIDLOCK_OWN_PROGRAM, arguments, workplace_.path()).wait();
  };
  auto const own_on_ranks = [&](int ranks, std::vector<std::string> const& arguments) {
    return mpirun(workplace_,
                  std::vector<std::string>{"-n", std::to_string(ranks), GRIDLOCK_OWN_MPI_PROGRAM} + arguments)
        .wait();
  };
  expect_good(own(run_into("alone")));
  expect_good(own_on_ranks(3, run_into("three")));
  expect_same_results("alone", "three");
  // Made longer on two ranks, with a summary that says more than errors alone.
  Outcome const longer = own_on_ranks(2, {"resume", "three", "--steps", "120"});
  expect_good(longer);
  EXPECT_NE(longer.out.find("gridlock_own_program plot three"), std::string::npos) << longer.out;
  expect_good(own({"resume", "alone", "--steps", "120", "-q"}));
  expect_same_results("alone", "three");
  // What it cannot do, the program for one process can; the shipped one does not know the model.
  Outcome const unknown = own_on_ranks(2, {"check", "r.toml"});
  EXPECT_EQ(unknown.exit_code, 2);
  EXPECT_NE(unknown.err.find("gridlock_own_program check"), std::string::npos) << unknown.err;
  Outcome const shipped = on_ranks(workplace_, 2, run_into("out"));
  EXPECT_EQ(shipped.exit_code, 2);
  EXPECT_NE(shipped.err.find("schelling"), std::string::npos) << shipped.err;
  EXPECT_FALSE(fs::exists(workplace_ / "out"));
}

TEST_F(MpiRun, StopsAModelAndContinuesItOnAnotherNumberOfRanks) {
  write(workplace_ / "r.toml", model_toml("3000", "[checkpoint]\nevery_seconds = 0.25\n"));
  expect_good(in(workplace_, run_into("alone")));
  RanksAtWork const asked = start_and_wait_for_checkpoint(workplace_, 3, run_into("out"));
  asked.process.signal(SIGUSR1);
  expect_stopped_by(SIGUSR1, asked.process.wait());
  RanksAtWork const killed = start_and_wait_for_checkpoint(workplace_, 2, {"resume", "out"});
  killed.signal(1, SIGKILL, 20ms);
  EXPECT_EQ(killed.process.wait().exit_code, 1);
  expect_good(on_ranks(workplace_, 4, {"resume", "out", "-q"}));
  expect_same_results("alone", "out");
}

TEST_F(MpiRun, DividesTheMemoryOfTheDisks) {
  expect_divided_memory([](std::string const& disks) {
    return "[disks]\ncount = " + disks +
           "\npacking_fraction = 0.5\n[engine]\nkind = \"tiled\"\n[run]\nsteps = 4\nfinal_state = false\n"
           "[observe]\nevery = 2\nstructure_every = 0\n[trajectory]\nevery = 4\n[checkpoint]\nevery_steps = 2\n";
  });
}

TEST_F(MpiRun, DividesTheMemoryOfTheAgentsOfAModel) {
  expect_divided_memory([](std::string const& agents) {
    return "[model]\nkind = \"epidemic\"\n[epidemic]\ncount = " + agents +
           "\nradius = 0.001\nspeed = 0.01\nturnover_rate = 0.5\n[run]\nsteps = 4\nfinal_state = false\n"
           "[observe]\nevery = 2\nstructure_every = 0\n[trajectory]\nevery = 4\n[checkpoint]\nevery_steps = 2\n";
  });
}

/// A file that disks start from: the last state of a run on a lattice, its rows in another order and with gaps between
/// the Ids.
class MpiRunFromFile : public MpiRun {
 protected:
  void write_start_file(std::size_t disks) const {
    write(workplace_ / "lattice.toml",
          "[disks]\ncount = " + std::to_string(disks) +
              "\npacking_fraction = 0.5\n[engine]\nkind = \"tiled\"\n[run]\nsteps = 2\n[observe]\nevery = 2\n");
    expect_good(in(workplace_, {"run", "lattice.toml", "-q", "--no-pictures", "-o", "lattice"}));
    std::istringstream lines(text_of(workplace_ / "lattice/final.xyz"));
    std::string head;
    std::string line;
    for (int k = 0; k < 2 && std::getline(lines, line); ++k) head += line + '\n';
    std::vector<std::string> rows;
    while (std::getline(lines, line)) rows.push_back(line);
    ASSERT_EQ(rows.size(), disks);
    std::string text = head;
    for (std::size_t k = 0; k < disks; ++k) text += with_id_tripled(rows[997 * k % disks]) + '\n';
    write(workplace_ / "start.xyz", text);
  }
  [[nodiscard]] static std::string from_file(std::string const& file, std::string const& more) {
    return "[disks]\nfile = \"" + file + "\"\n[engine]\nkind = \"tiled\"\n" + more;
  }

 private:
  /// The fifth word is the Id.
  static std::string with_id_tripled(std::string const& row) {
    std::istringstream words(row);
    std::string text;
    std::string word;
    for (int k = 0; words >> word; ++k) {
      text += (k == 0 ? "" : " ") + (k == 4 ? std::to_string(3 * std::stoull(word) + 1) : word);
    }
    return text;
  }
};

TEST_F(MpiRunFromFile, HasTheFilesOfOneProcessAndContinues) {
  write_start_file(3000);
  ASSERT_EQ(Process("/bin/sh", {"-c", "gzip -k start.xyz"}, workplace_.path()).wait().exit_code, 0);
  for (char const* file : {"start.xyz", "start.xyz.gz"}) {
    write(workplace_ / "r.toml",
          from_file(file, "[run]\nsteps = 100\nseed = 4\n[observe]\nevery = 20\n[trajectory]\nevery = 50\n"));
    expect_good(in(workplace_, run_into("alone") + std::vector<std::string>{"--overwrite"}));
    for (int const ranks : {2, 5}) {
      expect_good(on_ranks(workplace_, ranks, run_into("out") + std::vector<std::string>{"--overwrite"}));
      expect_same_results("alone", "out");
      EXPECT_EQ(text_of(workplace_ / "alone/start.xyz"), text_of(workplace_ / "out/start.xyz"));
    }
  }
  expect_good(in(workplace_, {"resume", "alone", "-q", "--steps", "200"}));
  expect_good(on_ranks(workplace_, 3, {"resume", "out", "-q", "--steps", "200"}));
  expect_same_results("alone", "out");
}

TEST_F(MpiRunFromFile, RefusesAFileAsOneProcessDoes) {
  write_start_file(2500);
  std::string const good = text_of(workplace_ / "start.xyz");
  std::string const last = good.substr(good.rfind('\n', good.size() - 2) + 1);
  std::string const more = "[run]\nsteps = 10\n";
  write(workplace_ / "twice.xyz", "2501" + good.substr(4) + last);
  write(workplace_ / "cut.xyz", good.substr(0, good.size() - 40));
  write(workplace_ / "longer.xyz", good + last);
  write(workplace_ / "none.xyz", "0" + good.substr(4, good.find('\n', 5) - 3));
  for (std::string const name : {"twice.xyz", "cut.xyz", "longer.xyz", "none.xyz", "missing.xyz"}) {
    write(workplace_ / "r.toml", from_file(name, more));
    Outcome const one = in(workplace_, run_into("out"));
    EXPECT_EQ(one.exit_code, 2);
    expect_refused(workplace_, {{run_into("out"), one.err}});
  }
}

TEST_F(MpiRunFromFile, DividesTheMemoryOfTheDisks) {
  write_start_file(1'200'000);
  write(workplace_ / "r.toml", from_file("start.xyz",
                                         "[run]\nsteps = 4\nfinal_state = false\n[observe]\nevery = 2\n"
                                         "structure_every = 0\n[checkpoint]\nevery_steps = 2\n"));
  std::vector<std::string> const words{measured, "run", "r.toml", "-q", "-j", "1", "--overwrite", "-o", "out"};
  auto const of = [&](char const* program) {
    std::vector<std::string> all{"-c", words.front(), program};
    all.insert(all.end(), words.begin() + 1, words.end());
    return all;
  };
  double const of_one = largest_peak(
      Process("/usr/bin/python3", of(GRIDLOCK_PROGRAM) + std::vector<std::string>{"--no-pictures"}, workplace_.path())
          .wait());
  double const of_rank = largest_peak(
      mpirun(workplace_, std::vector<std::string>{"-n", "4", "/usr/bin/python3"} + of(GRIDLOCK_MPI_PROGRAM)).wait());
  // Who read the whole file had all disks: 60 bytes of each at least, beside what the program and MPI take.
  EXPECT_LT(of_rank, 0.45 * of_one) << of_one;
}

TEST_F(MpiRun, RefusesRanksThatWereStartedWithDifferentCommands) {
  write(workplace_ / "r.toml", run_toml());
  auto const beside = [&](std::vector<std::string> const& first, std::vector<std::string> const& second) {
    return mpirun(workplace_, std::vector<std::string>{"-n", "1", GRIDLOCK_MPI_PROGRAM} + first +
                                  std::vector<std::string>{":", "-n", "2", GRIDLOCK_MPI_PROGRAM} + second)
        .wait();
  };
  for (std::vector<std::string> const& other : {run_into("other"), std::vector<std::string>{"resume", "out"},
                                                run_into("out") + std::vector<std::string>{"-j", "2"}}) {
    Outcome const outcome = beside(run_into("out"), other);
    EXPECT_EQ(outcome.exit_code, 2) << outcome.err;
    EXPECT_EQ(occurrences(outcome.err, "error: "), 1U) << outcome.err;
    EXPECT_NE(outcome.err.find("rank 1 has read another plan or command line"), std::string::npos) << outcome.err;
    EXPECT_FALSE(fs::exists(workplace_ / "out"));
  }
  expect_good(beside(run_into("out"), run_into("out")));
}

TEST_F(MpiRun, RefusesWhatIsNoFileInThePlaceOfACheckpointUntilItIsRemoved) {
  write_long_one();
  RanksAtWork const asked = start_and_wait_for_checkpoint(workplace_, 2, run_into("out"));
  asked.process.signal(SIGUSR1);
  expect_stopped_by(SIGUSR1, asked.process.wait());
  fs::path const newest = workplace_ / "out/checkpoint.gridlock";
  fs::rename(newest, workplace_ / "out/checkpoint.previous.gridlock");
  fs::create_directory(newest);
  Outcome const refused = on_ranks(workplace_, 3, {"resume", "out", "-q"});
  EXPECT_EQ(refused.exit_code, 2) << refused.err;
  EXPECT_EQ(occurrences(refused.err, "error: "), 1U) << refused.err;
  EXPECT_NE(refused.err.find("remove it, and the run continues from checkpoint.previous.gridlock"), std::string::npos)
      << refused.err;
  fs::remove(newest);
  expect_good(on_ranks(workplace_, 3, {"resume", "out", "-q"}));
  expect_good(in(workplace_, run_into("alone")));
  expect_same_results("alone", "out");
}

TEST_F(MpiRun, SaysOnceHowItEndedAndWhatEachRankSent) {
  write(workplace_ / "r.toml", run_toml());
  Outcome const outcome = on_ranks(workplace_, 3, {"run", "r.toml", "-o", "out"});
  expect_good(outcome);
  EXPECT_EQ(occurrences(outcome.out, "finished 300 steps of 2000 agents"), 1U) << outcome.out;
  EXPECT_EQ(occurrences(outcome.out, "pictures: gridlock plot out"), 1U) << outcome.out;
  std::string const log = text_of(workplace_ / "out/run.log");
  EXPECT_EQ(occurrences(log, "on 3 ranks, "), 1U) << log;
  for (int const rank : {0, 1, 2}) {
    EXPECT_EQ(occurrences(log, "rank " + std::to_string(rank) + " sent "), 1U) << log;
  }
  EXPECT_EQ(occurrences(text_of(workplace_ / "out/summary.json"), "\"seconds_waiting\": "), 3U);
}

TEST_F(MpiRun, RefusesModelsOfAUsersProgramThatRanksCannotShare) {
  write(workplace_ / "turns.toml", "[model]\nkind = \"colloid\"\n");
  write(workplace_ / "verified_tiles.toml", "[model]\nkind = \"colloid_tiled\"\nverify_every = 5\n");
  expect_refused(workplace_,
                 {{{"run", "turns.toml", "-o", "out"}, "the model \"colloid\" cannot be shared by 3 ranks"},
                  {{"run", "verified_tiles.toml", "-o", "out"}, "a run with model.verify_every"}},
                 GRIDLOCK_OWN_MPI_PROGRAM);
}

TEST_F(MpiRun, RefusesWhatCannotBeUsedAndSaysItOnce) {
  write(workplace_ / "r.toml", run_toml());
  write(workplace_ / "wrong.toml", "[engine]\nkin = \"tiled\"\n");
  write(workplace_ / "exact.toml", "[disks]\ncount = 100\npacking_fraction = 0.3\n[engine]\nkind = \"exact\"\n");
  write(workplace_ / "model.toml", "[model]\nkind = \"catalyst\"\n");
  write(workplace_ / "verified.toml", "[model]\nkind = \"flocking\"\nverify_every = 5\n");
  expect_good(in(workplace_, run_into("taken")));
  expect_refused(workplace_,
                 {{{"run", "wrong.toml", "-o", "out"}, "did you mean kind?"},
                  {{"run", "nothing.toml", "-o", "out"}, "nothing.toml"},
                  {{"run", "exact.toml", "-o", "out"}, "the engine \"exact\" cannot be shared by 3 ranks"},
                  {{"run", "model.toml", "-o", "out"}, "the model \"catalyst\" cannot be shared by 3 ranks"},
                  {{"run", "verified.toml", "-o", "out"}, "a run with model.verify_every"},
                  {{"run", "r.toml", "-o", "taken"}, "taken holds results already"},
                  {{"run", "r.toml", "--shard", "2"}, "no option --shard"},
                  {{"resume", "out"}, "out holds no run"},
                  {{"resume", "taken"}, "the run in taken is finished"}});
  // One rank alone carries out whatever gridlock does.
  expect_good(on_ranks(workplace_, 1, {"run", "exact.toml", "--set", "run.steps=10", "-o", "out"}));
}

TEST_F(MpiRun, SaysOnceWhereDisksAreSoFastThatTheyWaitForOneAnother) {
  write(workplace_ / "r.toml",
        "[disks]\ncount = 100\npacking_fraction = 0.2\nspecies = [{fraction = 0.5}, {fraction = 0.5, mass = 0.01}]\n"
        "[velocities]\nkind = \"maxwell\"\n[engine]\nkind = \"tiled\"\nsubsteps = 20\n[run]\nsteps = 3\n");
  std::string const note = "times as fast as engine.speed = 1:";
  Outcome const one = in(workplace_, {"run", "r.toml", "-o", "alone", "--no-pictures"});
  Outcome const many = on_ranks(workplace_, 2, {"run", "r.toml", "-o", "out"});
  expect_good(one);
  EXPECT_EQ(many.exit_code, 0) << many.err;
  EXPECT_EQ(occurrences(one.err, note), 0U) << one.err;
  EXPECT_EQ(occurrences(many.err, note), 1U) << many.err;
  EXPECT_EQ(state_hash_of(workplace_ / "alone"), state_hash_of(workplace_ / "out"));
}

TEST_F(MpiRun, FailsWhereOneProcessDoesAndSaysItOnce) {
  write(workplace_ / "r.toml", light_among_heavy + std::string("time_step = 0.5\n[run]\nsteps = 2000\n"));
  Outcome const one = in(workplace_, run_into("alone"));
  Outcome const many = on_ranks(workplace_, 3, run_into("out"));
  EXPECT_EQ(one.exit_code, 1);
  EXPECT_EQ(many.exit_code, 1);
  std::string const reason = one.err.substr(0, one.err.find('\n'));
  EXPECT_NE(reason.find("could jump over a disk"), std::string::npos) << reason;
  EXPECT_EQ(reason.find("step 0:"), std::string::npos) << "it is to fail later";
  EXPECT_EQ(occurrences(many.err, reason), 1U) << many.err;
  EXPECT_EQ(state_hash_of(workplace_ / "alone"), state_hash_of(workplace_ / "out"));
}

TEST_F(MpiRun, SavesItselfWhenAskedToStopAndContinuesOnAnotherNumberOfRanks) {
  write_long_one();
  expect_good(in(workplace_, run_into("alone")));
  std::vector<std::string> begin_or_resume = run_into("out");
  for (int const signal : {SIGTERM, SIGUSR1}) {
    RanksAtWork const asked = start_and_wait_for_checkpoint(workplace_, 3, begin_or_resume);
    asked.process.signal(signal);
    expect_stopped_by(signal, asked.process.wait());
    begin_or_resume = {"resume", "out"};
  }
  // One rank hears of it and tells the others.
  for (std::size_t const rank : {0U, 1U}) {
    RanksAtWork const asked = start_and_wait_for_checkpoint(workplace_, 2, begin_or_resume);
    asked.signal(rank, SIGTERM, 0ms);
    Outcome const outcome = asked.process.wait();
    EXPECT_EQ(outcome.exit_code, 1) << outcome.err;
    EXPECT_NE(outcome.err.find("continue with: gridlock-mpi resume out"), std::string::npos) << outcome.err;
  }
  expect_good(on_ranks(workplace_, 4, {"resume", "out", "-q"}));
  expect_same_results("alone", "out");
}

TEST_F(MpiRun, EndsWhereARankIsKilledAndContinuesToTheSameFiles) {
  write_long_one();
  expect_good(in(workplace_, run_into("alone")));
  std::vector<std::string> begin_or_resume = run_into("out");
  for (std::size_t const attempt : {0U, 1U, 2U, 3U}) {
    RanksAtWork const at_work = start_and_wait_for_checkpoint(workplace_, 3, begin_or_resume);
    at_work.signal(attempt % 3, SIGKILL, 20ms * attempt);
    expect_ended_by_kill(at_work.process.wait(), attempt % 3);
    begin_or_resume = {"resume", "out", "-q"};
  }
  // What ranks began, one process ends.
  expect_good(in(workplace_, {"resume", "out", "-q"}));
  expect_same_results("alone", "out");
}

TEST_F(MpiRun, LeavesNoRankBehindWhoseWatcherIsKilled) {
  write_long_one();
  RanksAtWork const at_work = start_and_wait_for_checkpoint(workplace_, 3, run_into("out"));
  kill(at_work.watchers.at(1), SIGKILL);
  EXPECT_NE(at_work.process.wait().exit_code, 0);
  for (pid_t const rank : at_work.ranks) {
    auto const end = std::chrono::steady_clock::now() + std::chrono::seconds(20);
    while (kill(rank, 0) == 0 && std::chrono::steady_clock::now() < end) std::this_thread::sleep_for(10ms);
    EXPECT_NE(kill(rank, 0), 0) << rank;
  }
}

TEST_F(MpiRun, MakesARunLonger) {
  write(workplace_ / "r.toml", run_toml("200"));
  expect_good(on_ranks(workplace_, 2, run_into("out")));
  expect_good(on_ranks(workplace_, 3, {"resume", "out", "-q", "--steps", "300"}));
  write(workplace_ / "r.toml", run_toml("300"));
  expect_good(in(workplace_, run_into("alone")));
  EXPECT_EQ(state_hash_of(workplace_ / "alone"), state_hash_of(workplace_ / "out"));
}

}  // namespace
