#include "workspace/sweep_crew.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <limits>
#include <set>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "gridlock/core/error.hpp"
#include "gridlock/workspace/sweep.hpp"
#include "io/file.hpp"
#include "workspace/sweep_plan.hpp"
#include "workspace/sweep_worker.hpp"

namespace gridlock {
namespace {

namespace fs = std::filesystem;

/// Ranks that are threads: the leader hands its runs round.
class CrewOfThreads {
 public:
  explicit CrewOfThreads(std::size_t count) {
    for (std::size_t rank = 0; rank < count; ++rank) members_.emplace_back(*this, rank);
  }

  SweepResult sweep(SweepPlan const& plan, fs::path const& directory) {
    std::vector<std::thread> helpers;
    for (std::size_t rank = 1; rank < members_.size(); ++rank) {
      helpers.emplace_back([&, rank] {
        SweepResult const none = run_sweep(plan, {.directory = directory, .crew = &members_[rank]});
        EXPECT_EQ(none.rows.row_count(), 0U) << "the leader has the results";
      });
    }
    SweepResult result = run_sweep(plan, {.directory = directory, .crew = &members_.front()});
    for (std::thread& helper : helpers) helper.join();
    return result;
  }

  std::multiset<std::uint64_t> made;  ///< runs

 private:
  class Member final : public SweepCrew {
   public:
    Member(CrewOfThreads& crew, std::size_t rank) : crew_(crew), rank_(rank) {}

    [[nodiscard]] bool leads() const override { return rank_ == 0; }
    [[nodiscard]] std::size_t processes_on_machine() const override { return crew_.members_.size(); }
    void meet(std::uint64_t /*plan_hash*/, std::string const& /*failure*/) override {}
    void part() override {}
    void lead(CrewLead const& lead) override {
      while (auto const job = lead.next()) {
        EXPECT_TRUE(lead.report(job->run, 0.5));
        lead.finish(job->run, make(lead.make, *job));
      }
    }
    void help(MakeRun const& /*make*/) override {}

   private:
    std::string make(MakeRun const& make, CrewJob const& job) {
      crew_.made.insert(job.run);
      return make(job, [](double /*share*/) { return true; });
    }

    CrewOfThreads& crew_;
    std::size_t rank_;
  };

  std::vector<Member> members_;
};

SweepPlan plan_of(std::string const& text) { return plan_sweep(SettingsFile::from_text(text, "sweep.toml")); }

std::string const small =
    "disks = { count = 64, packing_fraction = 0.5 }\nrun.steps = 40\nobserve.every = 10\n[sweep]\nrun.seed = [1, 2, "
    "3]\n";

TEST(SweepCrew, MakesEveryRunOnceAndHasTheMeansOfOneProcess) {
  fs::path const place = fs::temp_directory_path() / ("gridlock-crew-" + std::to_string(getpid()));
  CrewOfThreads crew(2);
  SweepResult const result = crew.sweep(plan_of(small), place / "crew");
  SweepResult const alone = run_sweep(plan_of(small), {.directory = place / "alone"});
  EXPECT_EQ(crew.made, (std::multiset<std::uint64_t>{0, 1, 2}));
  EXPECT_EQ(result.failures + result.interruptions, 0U);
  EXPECT_EQ(to_csv(result.means), to_csv(alone.means));
  EXPECT_EQ(read_file(place / "crew/means.csv"), read_file(place / "alone/means.csv"));
  fs::remove_all(place);
}

TEST(SweepCrew, KnowsPlansOfTheSameRuns) {
  EXPECT_EQ(hash_of(plan_of(small)), hash_of(plan_of(small)));
  EXPECT_NE(hash_of(plan_of(small)), hash_of(plan_of("disks.count = 65\n" + small.substr(small.find("run.steps")))));
  EXPECT_NE(hash_of(plan_of(small)),
            hash_of(plan_of(small.substr(0, small.find("[sweep]")) + "[sweep]\nrun.seed = [1, 2]\n")));
}

TEST(SweepOutcome, KeepsEveryBitOnItsWayToAnotherProcess) {
  SweepOutcome const outcome{
      .has_begun = true,
      .status = RunStatus::failed,
      .message = "a \"message\"\nof two lines, \xff",
      .state_hash = 0xFEDCBA9876543210U,
      .seconds = 0.1,
      .results = {{"pressure", {.value = 1.0 / 3.0, .error = 1e-300}, "kT/d²"},
                  {"nothing", {.value = std::numeric_limits<double>::quiet_NaN(), .error = std::nullopt}, ""}}};
  SweepOutcome const copy = decode_outcome(encode(outcome));
  EXPECT_TRUE(copy.has_begun);
  EXPECT_EQ(copy.status, RunStatus::failed);
  EXPECT_EQ(copy.message.substr(0, 22), outcome.message.substr(0, 22));
  EXPECT_EQ(copy.state_hash, outcome.state_hash);
  EXPECT_EQ(copy.seconds, outcome.seconds);
  ASSERT_EQ(copy.results.size(), 2U);
  EXPECT_EQ(copy.results[0].name, "pressure");
  EXPECT_EQ(copy.results[0].estimate.value, 1.0 / 3.0);
  EXPECT_EQ(copy.results[0].estimate.error, 1e-300);
  EXPECT_EQ(copy.results[0].unit, "kT/d²");
  EXPECT_TRUE(std::isnan(copy.results[1].estimate.value));
  EXPECT_FALSE(copy.results[1].estimate.error.has_value());
}

TEST(SweepOutcome, RefusesWhatIsNone) {
  for (char const* text : {"", "{", "{}", "[1]", "{\"has_begun\": 3}"}) {
    EXPECT_THROW(decode_outcome(text), RunFailure) << text;
  }
}

}  // namespace
}  // namespace gridlock
