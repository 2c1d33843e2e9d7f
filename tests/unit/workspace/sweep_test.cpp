#include "gridlock/workspace/sweep.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <filesystem>
#include <new>
#include <set>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "gridlock/core/error.hpp"
#include "gridlock/io/table.hpp"
#include "gridlock/io/xyz.hpp"
#include "gridlock/simulation/register_model.hpp"
#include "gridlock/workspace/run_directory.hpp"
#include "io/file.hpp"
#include "simulation/expected_work.hpp"
#include "simulation/memory.hpp"
#include "unit/io/temporary_directory.hpp"
#include "workspace/job_pool.hpp"
#include "workspace/sweep_tables.hpp"

namespace gridlock {
namespace {

namespace fs = std::filesystem;

/// A model that some of its settings let fail, in the ways a run can fail.
struct Brittle {
  static constexpr std::string_view name = "brittle";
  static constexpr Schedule schedule = Schedule::synchronous;
  using Agents = Population<X, Y>;
  std::uint64_t count = 10;
  std::string failure;
  void describe(SettingVisitor& visitor) {
    visitor.visit({.key = "count", .documentation = "Agents."}, count);
    visitor.visit({.key = "failure", .documentation = "How it fails."}, failure);
  }
  double cutoff() const { return 0.1; }
  double time_step() const { return 1.0; }
  void start(World<Brittle>& world) const {
    if (failure == "memory") throw std::bad_alloc();
    if (failure == "logic") throw std::logic_error("something unforeseen");
    for (std::uint64_t n = 0; n < count; ++n) {
      RandomStream random = world.start_random(n);
      Vector const p = world.anywhere(random);
      world.agents.add(p.x, p.y);
    }
  }
  void turn(Turn<Brittle>& self) const {
    RandomStream random = self.random();
    self.move_by(0.05 * random.in_unit_disk());
  }
};

class SweepDirectory : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    if (known_models().find("brittle") == nullptr) register_model<Brittle>();
  }
  void SetUp() override {
    place_ = fs::temp_directory_path() / ("gridlock-sweep-" + std::to_string(getpid()));
    fs::remove_all(place_);
  }
  void TearDown() override { fs::remove_all(place_); }

  static SweepPlan plan(std::string const& text) { return plan_sweep(SettingsFile::from_text(text, "sweep.toml")); }
  SweepResult sweep(std::string const& text, unsigned threads = 0) const {
    return run_sweep(plan(text), {.directory = place_, .threads = threads});
  }
  [[nodiscard]] std::string resolved(std::string const& run) const {
    return read_file(place_ / "runs" / run / "config.resolved.toml");
  }
  /// The names of runs begun by one thread, in the order in which they were.
  [[nodiscard]] std::vector<std::string> order(SweepPlan const& plan) const {
    std::vector<std::pair<fs::file_time_type, std::string>> begun;
    for (SweepRun const& run : plan.runs) {
      begun.emplace_back(fs::last_write_time(place_ / "runs" / run.name / "config.resolved.toml"), run.values.front());
    }
    std::ranges::sort(begun);
    std::vector<std::string> values;
    for (auto const& [time, value] : begun) values.push_back(value);
    return values;
  }

  fs::path place_;
};

std::vector<std::string> names_of(SweepPlan const& plan) {
  std::vector<std::string> names;
  for (SweepRun const& run : plan.runs) names.push_back(run.name);
  return names;
}

TEST_F(SweepDirectory, NamesOfRunsDoNotDependOnTheOrderOfTheValues) {
  std::string const model = "model.kind = \"brittle\"\n[sweep]\nbrittle.failure = ";
  std::vector<std::string> const names = names_of(plan(model + "[\"a b\", \"ab\", \"a_b\"]\n"));
  std::vector<std::string> reversed = names_of(plan(model + "[\"a_b\", \"ab\", \"a b\"]\n"));
  std::ranges::reverse(reversed);
  EXPECT_EQ(names, reversed);
  EXPECT_EQ(names[1], "failure=ab");
  EXPECT_EQ(names[2], "failure=a_b");
  EXPECT_EQ(std::set(names.begin(), names.end()).size(), 3U);
}

TEST_F(SweepDirectory, NamesTooLongForTheirValuesTellThemApart) {
  // 1 and 23, 12 and 3: only the mark of the name holds them, since the text before fills it.
  std::string const text = "model.kind = \"brittle\"\n[sweep]\nbrittle.failure = [\"" + std::string(200, 'x') +
                           "\"]\nrun.seed = [1, 12]\nrun.steps = [3, 23]\n";
  std::vector<std::string> const names = names_of(plan(text));
  EXPECT_EQ(std::set(names.begin(), names.end()).size(), 4U);
  for (std::string const& name : names) EXPECT_LE(name.size(), 120U);
}

TEST_F(SweepDirectory, RefusesAValueThatIsListedTwice) {
  try {
    plan("disks.count = 64\n[sweep]\nrun.seed = [1, 2]\n\"disks.packing_fraction\" = [0.3, 0.5, 0.30]\n");
    FAIL() << "taken";
  } catch (Error const& error) {
    EXPECT_EQ(error.problems().front().what, "disks.packing_fraction lists 0.3 twice");
    EXPECT_EQ(error.problems().front().line, 4);
  }
}

TEST_F(SweepDirectory, TablesListEveryFinishedRunHoweverOftenTheSweepIsStopped) {
  std::string const text = "disks.count = 64\nrun.steps = 20\n[sweep]\nrun.seed = [1, 2, 3, 4, 5]\n";
  auto const sweep_until = [&](std::size_t enough) {
    return run_sweep(plan(text), {.directory = place_, .threads = 1, .on_progress = [=](SweepProgress const& progress) {
                                    return progress.finished < enough;
                                  }});
  };
  std::size_t const finished = 5 - sweep_until(2).interruptions;
  ASSERT_GE(finished, 2U);
  ASSERT_LT(finished, 4U);
  // A run that ends before the wish to stop is seen counts too.
  std::size_t const finished_later = 5 - sweep_until(0).interruptions;
  EXPECT_GE(finished_later, finished);
  EXPECT_LT(finished_later, 5U);
  Table const rows = read_csv(place_ / "sweep.csv");
  auto const& statuses = std::get<std::vector<std::string>>(rows.column("status"));
  EXPECT_EQ(std::ranges::count(statuses, "finished"), finished_later);
  EXPECT_EQ(read_csv(place_ / "means.csv").numbers("runs"), std::vector<double>{static_cast<double>(finished_later)});
  EXPECT_EQ(sweep_until(5).interruptions, 0U);
}

TEST_F(SweepDirectory, MadeAnewAndStoppedHoldsNoOldRunAmongTheNew) {
  std::string const text = "disks.count = 64\nrun.steps = 20\n[sweep]\nrun.seed = [1, 2, 3]\n";
  sweep(text);
  SweepResult const anew = run_sweep(
      plan(text), {.directory = place_, .overwrites = true, .threads = 1, .on_progress = [](SweepProgress const&) {
                     return false;
                   }});
  EXPECT_GE(anew.interruptions, 2U);
  EXPECT_FALSE(read_summary(place_ / "runs/seed=3"));
  EXPECT_EQ(sweep(text).interruptions, 0U);
}

TEST_F(SweepDirectory, ARunThatFailsInAnyWayIsNamedAndTheOthersGoOn) {
  SweepResult const result = sweep(
      "model.kind = \"brittle\"\nrun.steps = 3\n[sweep]\n"
      "brittle.failure = [\"\", \"memory\", \"logic\", \"none\"]\n");
  EXPECT_EQ(result.failures, 2U);
  EXPECT_EQ(result.interruptions, 0U);
  ASSERT_EQ(result.messages.size(), 2U);
  EXPECT_EQ(result.messages[0], "failure=memory: not enough memory");
  EXPECT_EQ(result.messages[1], "failure=logic: something unforeseen");
  EXPECT_TRUE(fs::exists(place_ / "sweep.csv"));
}

TEST_F(SweepDirectory, OfRunsThatAllFailForLackOfMemoryNamesEach) {
  SweepResult const result =
      sweep("model.kind = \"brittle\"\nbrittle.failure = \"memory\"\n[sweep]\nrun.seed = [1, 2]\n");
  EXPECT_EQ(result.messages, (std::vector<std::string>{"seed=1: not enough memory", "seed=2: not enough memory"}));
}

TEST_F(SweepDirectory, StartsTheModelWithTheMostAgentsFirst) {
  std::string const text =
      "model.kind = \"brittle\"\nrun.steps = 200\n[sweep]\nbrittle.count = [500, 1000, 2000, 4000]\n";
  EXPECT_EQ(sweep(text, 1).failures, 0U);
  EXPECT_EQ(order(plan(text)), (std::vector<std::string>{"4000", "2000", "1000", "500"}));
}

TEST_F(SweepDirectory, StartsTheListsOfTheFewestCellsFirst) {
  std::string const text =
      "disks = { count = 900, packing_fraction = 0.3 }\nengine.grid = \"linked\"\nrun.steps = 40\n"
      "[sweep]\nengine.cells = [20, 10, 5, 2]\n";
  EXPECT_EQ(sweep(text, 1).failures, 0U);
  EXPECT_EQ(order(plan(text)), (std::vector<std::string>{"2", "5", "10", "20"}));
}

double work_of(std::string const& text) {
  return expectation_of(set_up(SettingsFile::from_text(text, "run.toml"))).work;
}

TEST_F(SweepDirectory, TheWorkOfAModelGrowsWithItsAgents) {
  std::string const run = "model.kind = \"epidemic\"\nrun.steps = 10\nepidemic.count = ";
  EXPECT_NEAR(work_of(run + "60000") / work_of(run + "1000"), 60.0, 1.0);
}

TEST_F(SweepDirectory, TheWorkOnListsGrowsWithTheDisksInThem) {
  std::string const run =
      "disks = { count = 2500, packing_fraction = 0.3 }\nrun.steps = 10\nengine = { grid = \"linked\", cells = ";
  // Every disk of the box is a candidate in four cells, nine in cells of one disk each.
  EXPECT_GT(work_of(run + "2 }") / work_of(run + "50 }"), 50.0);
  EXPECT_GT(work_of(run + "10 }") / work_of(run + "50 }"), 5.0);
  EXPECT_EQ(work_of("disks = { count = 2500, packing_fraction = 0.3 }\nrun.steps = 10\nengine = { cells = 2 }"),
            work_of("disks = { count = 2500, packing_fraction = 0.3 }\nrun.steps = 10"))
      << "the packed grid chooses its own cells";
}

std::uint64_t threads_in(std::string const& resolved) {
  Configuration configuration;
  SettingsFile::from_text(resolved, "resolved").read_into(describing(configuration));
  return configuration.engine.threads;
}

std::string const tiled = "disks.count = 100\nrun.steps = 20\nengine.kind = \"tiled\"\n";

TEST_F(SweepDirectory, FewerRunsThanCoresShareTheCoresAndSayHowMany) {
  auto const jobs = static_cast<std::uint64_t>(jobs_for(0));
  sweep(tiled + "[sweep]\nrun.seed = [1]\n");
  EXPECT_EQ(threads_in(resolved("seed=1")), jobs);
  auto const kept = fs::last_write_time(place_ / "runs/seed=1/summary.json");
  // More runs leave fewer cores to each, which makes no other run of the one that is there.
  EXPECT_EQ(sweep(tiled + "[sweep]\nrun.seed = [1, 2, 3]\n").failures, 0U);
  EXPECT_EQ(fs::last_write_time(place_ / "runs/seed=1/summary.json"), kept);
  EXPECT_EQ(threads_in(resolved("seed=2")), std::max<std::uint64_t>(1, (jobs + 1) / 2));
  EXPECT_EQ(threads_in(resolved("seed=3")), std::max<std::uint64_t>(1, jobs / 2));
}

TEST_F(SweepDirectory, ACoreThatIsLeftOverGoesToOneOfTheRuns) {
  // On machines of two cores there is none.
  auto const jobs = static_cast<std::uint64_t>(jobs_for(3));
  run_sweep(plan(tiled + "[sweep]\nrun.seed = [1, 2]\n"), {.directory = place_, .threads = 3});
  EXPECT_EQ(threads_in(resolved("seed=1")), std::max<std::uint64_t>(1, (jobs + 1) / 2));
  EXPECT_EQ(threads_in(resolved("seed=2")), std::max<std::uint64_t>(1, jobs / 2));
}

TEST_F(SweepDirectory, RefusesARunThatBeganFromAnotherStateInItsStartFile) {
  TemporaryDirectory const directory;
  Configuration configuration;
  configuration.disks = {.count = 16, .packing_fraction = 0.3};
  State state = disks_of(set_up(configuration));
  write_xyz(state, directory / "start.xyz");
  std::string const text =
      "disks.file = \"" + (directory / "start.xyz").string() + "\"\nrun.steps = 5\n[sweep]\nrun.seed = [1]\n";
  EXPECT_EQ(sweep(text).failures, 0U);
  EXPECT_EQ(sweep(text).failures, 0U) << "nothing has changed";
  state.agents.column<X>()[3] += 1e-3;
  write_xyz(state, directory / "start.xyz");
  try {
    sweep(text);
    FAIL() << "taken for the run that is there";
  } catch (Error const& error) {
    EXPECT_NE(std::string(error.what()).find("it began from another state"), std::string::npos) << error.what();
  }
}

TEST_F(SweepDirectory, ThreadsThatTheUserSetAreKept) {
  sweep(tiled + "engine.threads = 3\n[sweep]\nrun.seed = [1]\n");
  EXPECT_EQ(threads_in(resolved("seed=1")), 3U);
}

TEST_F(SweepDirectory, AnInterruptedRunResumesOnAnotherNumberOfThreads) {
  std::string const long_run = "disks.count = 100\nrun.steps = 400\nobserve.every = 10\nengine.kind = \"tiled\"\n";
  std::uint64_t const whole = run_in(place_ / "whole", set_up(SettingsFile::from_text(long_run, "whole"))).state_hash;
  fs::path const runs = place_ / "runs";
  run_in(runs / "seed=1", set_up(SettingsFile::from_text(long_run + "run.seed = 1\nengine.threads = 7\n", "part")),
         {.on_progress = [](Progress const& progress) { return progress.steps < 100; }});
  write_file(place_ / "plan.json", "{}");
  EXPECT_EQ(sweep(long_run + "[sweep]\nrun.seed = [1]\n").failures, 0U);
  EXPECT_EQ(read_summary(runs / "seed=1")->state_hash, whole);
}

TEST_F(SweepDirectory, CollectedTakesTheRunThatWasFinishedWhereverItStands) {
  std::string const text = "disks.count = 64\nrun.steps = 40\nobserve.every = 10\n";
  SweepPlan const one = plan(text + "[sweep]\nrun.seed = [1]\n");
  run_sweep(one, {.directory = place_ / "whole"});
  fs::create_directories(place_ / "part");
  write_file(place_ / "part" / "plan.json", read_file(place_ / "whole" / "plan.json"));
  run_in(place_ / "part/runs/seed=1", set_up(one.runs.front().settings),
         {.on_progress = [](Progress const& progress) { return progress.steps < 20; }});
  ASSERT_EQ(read_summary(place_ / "part/runs/seed=1")->status, RunStatus::interrupted);
  for (auto const& [first, second] : {std::pair{"whole", "part"}, {"part", "whole"}}) {
    EXPECT_EQ(collect_sweep({place_ / first, place_ / second}, place_ / "joined").interruptions, 0U) << first;
    EXPECT_EQ(read_summary(place_ / "joined/runs/seed=1")->status, RunStatus::finished) << first;
    fs::remove_all(place_ / "joined");
  }
}

/// The mean over runs of one group with these values and errors.
Estimate mean_of(std::vector<Estimate> const& estimates) {
  SweepPlan plan{.keys = {"run.seed"}, .base = {}, .runs = {}};
  std::vector<SweepOutcome> outcomes;
  for (std::size_t k = 0; k < estimates.size(); ++k) {
    plan.runs.push_back({.name = "", .values = {std::to_string(k)}, .settings = {}});
    outcomes.push_back({.has_begun = true, .status = RunStatus::finished, .message = "", .results = {}});
    outcomes.back().results.push_back({.name = "z", .estimate = estimates[k], .unit = ""});
  }
  Table const means = means_of(plan, outcomes);
  return {means.numbers("z").front(), means.numbers("z_error").front()};
}

TEST(SweepMeans, HaveTheErrorsOfTheRunsWhereTheseHappenToAgree) {
  Estimate const mean = mean_of({{1.000, 0.03}, {1.002, 0.04}});
  EXPECT_DOUBLE_EQ(mean.value, 1.001);
  EXPECT_DOUBLE_EQ(*mean.error, 0.025) << "√(0.03² + 0.04²)/2; the scatter alone says 0.001";
}

TEST(SweepMeans, HaveTheScatterOfTheRunsWhereTheirErrorsMissIt) {
  EXPECT_DOUBLE_EQ(*mean_of({{1.0, 0.03}, {2.0, 0.04}}).error, 0.5);
  EXPECT_NEAR(*mean_of({{1.0, 0.03}, {1.2, std::nullopt}}).error, 0.1, 1e-12) << "one run has no error";
}

TEST(SweepMeans, SayHowManyRunsTheyLeaveOut) {
  SweepPlan const plan =
      plan_sweep(SettingsFile::from_text("[disks]\ncount = 4\n[sweep]\nrun.seed = [1, 2, 3]\n", "sweep.toml"));
  std::vector<SweepOutcome> outcomes(3, {.has_begun = true, .status = RunStatus::finished});
  for (SweepOutcome& outcome : outcomes) outcome.results.push_back({"everywhere", {.value = 1.0}, ""});
  for (std::size_t run : {0U, 2U})
    outcomes[run].results.push_back({"jamming_packing_fraction", {.value = 0.8 + 0.01 * static_cast<double>(run)}, ""});
  for (std::size_t run = 0; run < 3; ++run)
    outcomes[run].results.push_back({"is_converged", {.value = run == 1 ? 0.0 : 1.0}, ""});
  SweepResult const result = result_of(plan, outcomes);
  EXPECT_NEAR(result.means.numbers("jamming_packing_fraction").front(), 0.81, 1e-12);
  EXPECT_EQ(result.means.numbers("jamming_packing_fraction_runs"), std::vector<double>{2.0});
  EXPECT_FALSE(result.means.contains("everywhere_runs"));
  ASSERT_EQ(result.notes.size(), 2U);
  EXPECT_EQ(result.notes[0],
            "jamming_packing_fraction has no value in 1 of 3 runs, which its means leave out; "
            "jamming_packing_fraction_runs in means.csv says how many have one");
  EXPECT_EQ(result.notes[1].rfind("1 of 3 runs ended short of the goal of their protocol", 0), 0U) << result.notes[1];
}

TEST(MemoryBudget, RunsThatDoNotFitTogetherWaitForOneAnother) {
  MemoryBudget budget(100.0);
  std::atomic<int> large = 0;
  std::atomic<int> max_large = 0;
  std::vector<std::thread> threads;
  for (int k = 0; k < 4; ++k) {
    threads.emplace_back([&] {
      MemoryBudget::Part const part(budget, 60.0);
      int const now = ++large;
      if (now > max_large) max_large = now;
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
      --large;
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(max_large, 1);
}

TEST(MemoryBudget, RunsThatFitTogetherDoNotWaitAndOneThatNeverFitsIsAlone) {
  MemoryBudget budget(100.0);
  {
    MemoryBudget::Part const one(budget, 40.0);
    MemoryBudget::Part const other(budget, 60.0);
  }
  MemoryBudget::Part const alone(budget, 1000.0);
}

}  // namespace
}  // namespace gridlock
