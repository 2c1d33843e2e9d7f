// What happens to a run when everything goes wrong, with the real program. GRIDLOCK_FAULTS says how often each fault is
// tried at a random moment (20 where it is not set); GRIDLOCK_FAULT_SEED replays a failure.
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <sys/resource.h>

#include <chrono>
#include <cstdlib>
#include <random>
#include <thread>

#include "cli/program.hpp"

namespace {

using namespace gridlock::test;
using Arguments = std::vector<std::string>;

int number_from(char const* variable, int otherwise) {
  char const* const text = std::getenv(variable);
  return text == nullptr ? otherwise : std::atoi(text);
}

int tries() { return number_from("GRIDLOCK_FAULTS", 20); }
unsigned seed() { return static_cast<unsigned>(number_from("GRIDLOCK_FAULT_SEED", 1)); }

struct Kind {
  char const* name;
  char const* settings;
};

void PrintTo(Kind const& kind, std::ostream* stream) { *stream << kind.name; }

std::string toml_of(Kind const& kind) {
  bool const is_model = std::string(kind.settings).find("model.kind") != std::string::npos;
  std::string const disks = "[disks]\ncount = 144\npacking_fraction = 0.6\n";
  return std::string(kind.settings) + "\n" + (is_model ? "" : disks) +
         "[observe]\nevery = 50\nstructure_every = 4\n[checkpoint]\nevery_seconds = 0.01\n";
}

std::string summary_without_times(fs::path const& directory) {
  auto json = nlohmann::json::parse(text_of(directory / "summary.json"));
  json.erase("timing");
  return json.dump(1);
}

/// The run as nothing happened to it, and how long it takes.
class WholeRun {
 public:
  WholeRun(Kind const& kind, fs::path const& workplace) : directory_(workplace / "whole") {
    write(workplace / "run.toml", toml_of(kind));
    auto const start = std::chrono::steady_clock::now();
    Outcome const outcome =
        gridlock::test::gridlock({"run", "run.toml", "-o", "whole", "-q", "--no-pictures"}, workplace);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    milliseconds_ = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
  }

  [[nodiscard]] double milliseconds() const { return milliseconds_; }

  void expect_same(fs::path const& other) const {
    EXPECT_EQ(summary_without_times(directory_), summary_without_times(other));
    for (char const* name : {"series.csv", "final.xyz", "speed_distribution.csv", "pair_correlation.csv"}) {
      EXPECT_EQ(text_of(directory_ / name), text_of(other / name)) << name;
    }
  }

 private:
  fs::path directory_;
  double milliseconds_ = 0.0;
};

bool is_finished(fs::path const& directory) {
  std::string const text = text_of(directory / "summary.json");
  return text.find("\"ending\": \"finished\"") != std::string::npos;
}

class Faults : public testing::TestWithParam<Kind> {
 protected:
  void stop_at_random_moments(int signal) {
    Workplace const workplace;
    WholeRun const whole(GetParam(), workplace.path());
    std::mt19937 random(seed());
    std::uniform_real_distribution<double> moment(1.0, 1.1 * whole.milliseconds());
    int stopped = 0;
    for (int attempt = 0; stopped < tries(); ++attempt) {
      ASSERT_LT(attempt, 50 * tries()) << "the run ends before it can be stopped";
      fs::remove_all(workplace / "run");
      Process const first(GRIDLOCK_PROGRAM, {"run", "run.toml", "-o", "run", "-q", "--no-pictures"}, workplace.path());
      stopped += stop(first, signal, moment(random));
      // The second, third … time in the middle of a resumed run.
      for (int again = 0; again < 3 && !is_finished(workplace / "run"); ++again) {
        if (!fs::exists(workplace / "run" / "config.resolved.toml")) break;
        Process const next(GRIDLOCK_PROGRAM, {"resume", "run", "-q", "--no-pictures"}, workplace.path());
        stopped += stop(next, signal, moment(random));
      }
      finish(workplace.path());
      whole.expect_same(workplace / "run");
      if (HasFailure()) FAIL() << "attempt " << attempt << " of GRIDLOCK_FAULT_SEED=" << seed();
    }
  }

 private:
  /// Signals a process after a while; says whether that came before its end.
  static int stop(Process const& process, int signal, double milliseconds) {
    std::this_thread::sleep_for(std::chrono::duration<double, std::milli>(milliseconds));
    process.signal(signal);
    return process.wait().exit_code == 0 ? 0 : 1;
  }

  static void finish(fs::path const& workplace) {
    if (is_finished(workplace / "run")) return;
    bool const has_begun = fs::exists(workplace / "run" / "config.resolved.toml");
    Arguments const arguments = has_begun ? Arguments{"resume", "run", "-q", "--no-pictures"}
                                          : Arguments{"run", "run.toml", "-o", "run", "-q", "--no-pictures"};
    Outcome const outcome = gridlock::test::gridlock(arguments, workplace);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  }
};

TEST_P(Faults, KilledAtAnyMomentARunResumesToTheSameBits) { stop_at_random_moments(SIGKILL); }

TEST_P(Faults, TerminatedAtAnyMomentARunResumesToTheSameBits) { stop_at_random_moments(SIGTERM); }

INSTANTIATE_TEST_SUITE_P(
    Engines, Faults,
    testing::Values(Kind{"stepped", "run.steps = 9000"}, Kind{"linked", "run.steps = 5000\nengine.grid = \"linked\""},
                    Kind{"tiled", "run.steps = 9000\nengine.kind = \"tiled\"\nengine.threads = 2"},
                    Kind{"exact", "run.steps = 12000\nengine.kind = \"exact\"\nbox.edge = \"periodic\""},
                    Kind{"births_and_deaths",
                         "run.steps = 3000\nmodel.kind = \"epidemic\"\nepidemic.count = 500\n"
                         "epidemic.turnover_rate = 0.02\nengine.threads = 2"},
                    Kind{"events", "run.steps = 300\nmodel.kind = \"catalyst\"\ncatalyst.hop_rate = 20.0"}),
    [](auto const& instance) { return std::string(instance.param.name); });

Kind const quick{"quick", "run.steps = 6000"};

/// A run that was terminated in the middle, with a checkpoint and the previous one.
void leave_half_a_run(fs::path const& workplace) {
  write(workplace / "run.toml", toml_of(quick));
  Process const process(GRIDLOCK_PROGRAM, {"run", "run.toml", "-o", "run", "-q", "--no-pictures"}, workplace);
  for (int wait = 0; wait < 2000 && !fs::exists(workplace / "run" / "checkpoint.previous.gridlock"); ++wait) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  process.signal(SIGTERM);
  EXPECT_EQ(process.wait().exit_code, 1);
  ASSERT_TRUE(fs::exists(workplace / "run" / "checkpoint.gridlock"));
  ASSERT_TRUE(fs::exists(workplace / "run" / "checkpoint.previous.gridlock"));
}

TEST(DamagedCheckpoint, IsRefusedAndThePreviousOneUsedSayingSo) {
  Workplace const workplace;
  WholeRun const whole(quick, workplace.path());
  leave_half_a_run(workplace.path());
  fs::path const checkpoint = workplace / "run" / "checkpoint.gridlock";
  std::string const good = text_of(checkpoint);
  fs::copy(workplace / "run", workplace / "half", fs::copy_options::recursive);
  std::mt19937 random(seed());
  for (int attempt = 0; attempt < tries(); ++attempt) {
    fs::remove_all(workplace / "run");
    fs::copy(workplace / "half", workplace / "run", fs::copy_options::recursive);
    std::string bad = good;
    bool const is_truncated = attempt % 2 == 1;
    std::size_t const at = random() % bad.size();
    if (is_truncated) {
      bad.resize(at);
    } else {
      bad[at] = static_cast<char>(bad[at] ^ (1 << random() % 8));
    }
    write(checkpoint, bad);
    Outcome const outcome = gridlock::test::gridlock({"resume", "run", "--no-pictures"}, workplace.path());
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    bool const is_padding = !is_truncated && at >= 12 && at < 16;
    if (!is_padding) {
      EXPECT_NE(outcome.err.find("going back to the previous one"), std::string::npos) << outcome.err;
    }
    whole.expect_same(workplace / "run");
    if (testing::Test::HasFailure()) FAIL() << "attempt " << attempt << " of GRIDLOCK_FAULT_SEED=" << seed();
  }
}

TEST(DamagedCheckpoint, WithNoOtherIsRefused) {
  Workplace const workplace;
  leave_half_a_run(workplace.path());
  write(workplace / "run" / "checkpoint.gridlock", "GRIDLOCK");
  fs::remove(workplace / "run" / "checkpoint.previous.gridlock");
  Outcome const outcome = gridlock::test::gridlock({"resume", "run", "--no-pictures"}, workplace.path());
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_NE(outcome.err.find("cannot use the checkpoint"), std::string::npos) << outcome.err;
}

/// Runs the program through a shell that limits it first.
Outcome limited(std::string const& limit, Arguments const& arguments, fs::path const& directory) {
  std::string command = limit + "; exec \"$0\" \"$@\"";
  Arguments all{"-c", command, GRIDLOCK_PROGRAM};
  all.insert(all.end(), arguments.begin(), arguments.end());
  return Process("/bin/bash", all, directory).wait();
}

TEST(FullDisk, LeavesARunThatResumesToTheSameBitsOnceThereIsRoom) {
  Workplace const workplace;
  WholeRun const whole(quick, workplace.path());
  // No file may grow beyond 4 KiB: too little for a checkpoint and for the results.
  Outcome const full =
      limited("trap '' XFSZ; ulimit -f 4", {"run", "run.toml", "-o", "run", "--no-pictures"}, workplace.path());
  EXPECT_EQ(full.exit_code, 1) << full.err;
  EXPECT_NE(full.err.find("File too large"), std::string::npos) << full.err;
  EXPECT_NE(full.err.find("no checkpoint"), std::string::npos) << full.err;
  EXPECT_FALSE(is_finished(workplace / "run"));
  Outcome const resumed = gridlock::test::gridlock({"resume", "run", "-q", "--no-pictures"}, workplace.path());
  EXPECT_EQ(resumed.exit_code, 0) << resumed.err;
  whole.expect_same(workplace / "run");
}

TEST(VanishedDirectory, EndsTheRunWithTheReason) {
  Workplace const workplace;
  write(workplace / "run.toml", toml_of({"long", "run.steps = 1_000_000"}));
  Process const process(GRIDLOCK_PROGRAM, {"run", "run.toml", "-o", "run", "--no-pictures"}, workplace.path());
  for (int wait = 0; wait < 2000 && !fs::exists(workplace / "run" / "checkpoint.gridlock"); ++wait) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  // Root may write into directories it may not write into, so they are taken away altogether.
  fs::rename(workplace / "run", workplace / "elsewhere");
  std::this_thread::sleep_for(std::chrono::milliseconds(100));
  process.signal(SIGTERM);
  Outcome const outcome = process.wait();
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_NE(outcome.err.find("No such file or directory"), std::string::npos) << outcome.err;
}

TEST(TwoProcesses, DoNotWorkInOneDirectory) {
  Workplace const workplace;
  write(workplace / "run.toml", toml_of({"long", "run.steps = 1_000_000"}));
  Process const first(GRIDLOCK_PROGRAM, {"run", "run.toml", "-o", "run", "--no-pictures"}, workplace.path());
  for (int wait = 0; wait < 2000 && !fs::exists(workplace / "run" / "checkpoint.gridlock"); ++wait) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  fs::create_directories(workplace / "other");
  Outcome const second =
      Process(GRIDLOCK_PROGRAM, {"resume", (workplace / "run").string()}, workplace / "other").wait();
  EXPECT_EQ(second.exit_code, 2);
  EXPECT_NE(second.err.find("another process"), std::string::npos) << second.err;
  first.signal(SIGKILL);
  first.wait();
}

}  // namespace
