// What happens to a run when everything goes wrong, with the real program. GRIDLOCK_FAULTS says how often each fault is
// tried at a random moment (8 where it is not set); GRIDLOCK_FAULT_SEED replays a failure.
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <sys/resource.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <random>
#include <regex>
#include <thread>

#include "cli/program.hpp"
#include "gridlock/io/h5md.hpp"

namespace {

using namespace gridlock::test;
using Arguments = std::vector<std::string>;

int number_from(char const* variable, int otherwise) {
  char const* const text = std::getenv(variable);
  return text == nullptr ? otherwise : std::atoi(text);
}

int tries() { return number_from("GRIDLOCK_FAULTS", 6); }
unsigned seed() { return static_cast<unsigned>(number_from("GRIDLOCK_FAULT_SEED", 1)); }

struct Kind {
  char const* name;
  char const* settings;
  bool keeps_frames = true;
};

void PrintTo(Kind const& kind, std::ostream* stream) { *stream << kind.name; }

constexpr int frame_every = 150;

std::string toml_of(Kind const& kind) {
  bool const is_model = std::string(kind.settings).find("model.kind") != std::string::npos;
  std::string const disks = "[disks]\ncount = 144\npacking_fraction = 0.6\n";
  std::string const on_request =
      "density_profile = \"both\"\nclusters_every = 4\nlocal_density_every = 3\ndisplacement_lag = 12\n"
      "temperature_by_kind = true\nflux_line = \"horizontal\"\n";
  return std::string(kind.settings) + "\n" + (is_model ? "" : disks) +
         "[observe]\nevery = 50\nstructure_every = 4\nvelocity_origin_every = 20\n" + (is_model ? "" : on_request) +
         "[checkpoint]\nevery_seconds = "
         "0.01\n" +
         (kind.keeps_frames ? "[trajectory]\nevery = " + std::to_string(frame_every) + "\n" : "");
}

std::string summary_without_times(fs::path const& directory) {
  auto json = nlohmann::json::parse(text_of(directory / "summary.json"));
  json.erase("timing");
  return json.dump(1);
}

/// The run as nothing happened to it, and how long it takes.
class WholeRun {
 public:
  WholeRun(Kind const& kind, fs::path const& workplace)
      : directory_(workplace / "whole"), keeps_frames_(kind.keeps_frames) {
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
    EXPECT_EQ(text_of(directory_ / "final.xyz"), text_of(other / "final.xyz"));
    std::size_t tables = 0;
    for (auto const& entry : fs::directory_iterator(directory_)) {
      if (entry.path().extension() != ".csv") continue;
      ++tables;
      EXPECT_EQ(text_of(entry.path()), text_of(other / entry.path().filename())) << entry.path().filename();
    }
    EXPECT_GE(tables, 1U);
    if (!keeps_frames_) return;
    gridlock::H5mdReader const frames(directory_ / "trajectory.h5");
    gridlock::H5mdReader const same(other / "trajectory.h5");
    ASSERT_EQ(frames.frame_count(), same.frame_count());
    ASSERT_GT(frames.frame_count(), 2U);
    for (std::size_t k = 0; k < frames.frame_count(); ++k) {
      EXPECT_EQ(frames.frame(k).frame, same.frame(k).frame) << "frame " << k;
      EXPECT_EQ(frames.frame(k).state_hash, same.frame(k).state_hash) << "frame " << k;
    }
  }

 private:
  fs::path directory_;
  bool keeps_frames_;
  double milliseconds_ = 0.0;
};

bool is_finished(fs::path const& directory) {
  std::string const text = text_of(directory / "summary.json");
  return text.find("\"status\": \"finished\"") != std::string::npos;
}

/// The trajectories as the signals left them, for an independent reader at the end.
class StoppedTrajectories {
 public:
  explicit StoppedTrajectories(fs::path directory) : directory_(std::move(directory)) {
    fs::create_directories(directory_);
  }

  /// Every frame before the last checkpoint has to be there; the one of its own step is due after it.
  void keep(fs::path const& run) {
    if (!fs::exists(run / "trajectory.h5")) return;
    gridlock::H5mdReader const reader(run / "trajectory.h5");
    EXPECT_GE(reader.frame_count(), (last_checkpoint(text_of(run / "run.log")) + frame_every - 1) / frame_every);
    std::string const name = std::to_string(++files_) + ".h5";
    fs::copy(run / "trajectory.h5", directory_ / name);
    list_ += name;
    for (std::size_t k = 0; k < reader.frame_count(); ++k) {
      list_ += " " + std::to_string(reader.frame(k).frame.size());
    }
    list_ += "\n";
  }

  void expect_readable_by_h5py() const {
    ASSERT_GT(files_, 0);
    write(directory_ / "list.txt", list_);
    std::string const script = std::string(GRIDLOCK_SOURCE_DIR) + "/tests/reference/read_stopped_trajectories.py";
    Outcome const outcome = Process("/usr/bin/python3", {script, std::to_string(frame_every)}, directory_).wait();
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_EQ(outcome.out, std::to_string(files_) + " trajectories read\n");
  }

 private:
  static std::uint64_t last_checkpoint(std::string const& log) {
    std::regex const line("checkpoint at step ([0-9]+)");
    std::uint64_t step = 0;
    for (std::sregex_iterator it(log.begin(), log.end(), line), end; it != end; ++it) step = std::stoull((*it)[1]);
    return step;
  }

  fs::path directory_;
  std::string list_;
  int files_ = 0;
};

class Faults : public testing::TestWithParam<Kind> {
 protected:
  void stop_at_random_moments(int signal) {
    Workplace const workplace;
    WholeRun const whole(GetParam(), workplace.path());
    StoppedTrajectories trajectories(workplace / "stopped");
    std::mt19937 random(seed());
    std::uniform_real_distribution<double> moment(1.0, 1.1 * whole.milliseconds());
    int stopped = 0;
    for (int attempt = 0; stopped < tries(); ++attempt) {
      ASSERT_LT(attempt, 50 * tries()) << "the run ends before it can be stopped";
      fs::remove_all(workplace / "run");
      Process const first(GRIDLOCK_PROGRAM, {"run", "run.toml", "-o", "run", "-q", "--no-pictures"}, workplace.path());
      stopped += stop(first, signal, moment(random));
      trajectories.keep(workplace / "run");
      // The second, third … time in the middle of a resumed run.
      for (int again = 0; again < 3 && !is_finished(workplace / "run"); ++again) {
        if (!fs::exists(workplace / "run" / "config.resolved.toml")) break;
        Process const next(GRIDLOCK_PROGRAM, resuming(), workplace.path());
        stopped += stop(next, signal, moment(random));
        trajectories.keep(workplace / "run");
      }
      finish(workplace.path());
      whole.expect_same(workplace / "run");
      if (HasFailure()) FAIL() << "attempt " << attempt << " of GRIDLOCK_FAULT_SEED=" << seed();
    }
    if (GetParam().keeps_frames) trajectories.expect_readable_by_h5py();
  }

 private:
  /// Signals a process after a while; says whether that came before its end.
  static int stop(Process const& process, int signal, double milliseconds) {
    std::this_thread::sleep_for(std::chrono::duration<double, std::milli>(milliseconds));
    process.signal(signal);
    return process.wait().exit_code == 0 ? 0 : 1;
  }

  /// Where the kind has threads at all, on another number of them than it was begun with.
  static Arguments resuming() {
    Arguments arguments{"resume", "run", "-q", "--no-pictures"};
    bool const has_threads = std::string(GetParam().settings).find("threads") != std::string::npos;
    if (has_threads) arguments.insert(arguments.end(), {"--threads", "3"});
    return arguments;
  }

  static void finish(fs::path const& workplace) {
    if (is_finished(workplace / "run")) return;
    bool const has_begun = fs::exists(workplace / "run" / "config.resolved.toml");
    Arguments const arguments =
        has_begun ? resuming() : Arguments{"run", "run.toml", "-o", "run", "-q", "--no-pictures"};
    Outcome const outcome = gridlock::test::gridlock(arguments, workplace);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  }
};

TEST_P(Faults, KilledAtAnyMomentARunResumesToTheSameBits) { stop_at_random_moments(SIGKILL); }

TEST_P(Faults, TerminatedAtAnyMomentARunResumesToTheSameBits) { stop_at_random_moments(SIGTERM); }

INSTANTIATE_TEST_SUITE_P(
    Engines, Faults,
    testing::Values(
        Kind{"stepped", "run.steps = 3000"}, Kind{"linked", "run.steps = 2000\nengine.grid = \"linked\""},
        Kind{"tiled", "run.steps = 3000\nengine.kind = \"tiled\"\nengine.threads = 2"},
        Kind{"exact", "run.steps = 4000\nengine.kind = \"exact\"\nbox.edge = \"periodic\""},
        Kind{"exact_within_steps",
             "run.steps = 60\nengine.kind = \"exact\"\nengine.time_step = 20.0\nbox.edge = \"periodic\"", false},
        Kind{"brownian_within_steps",
             "run.steps = 60\nengine.kind = \"exact\"\nengine.time_step = 20.0\nbox.edge = \"periodic\"\n"
             "thermostat.kind = \"brownian\"",
             false},
        Kind{"andersen_within_steps",
             "run.steps = 60\nengine.kind = \"exact\"\nengine.time_step = 20.0\n"
             "thermostat.kind = \"andersen\"",
             false},
        Kind{"grains_within_steps",
             "run.steps = 30\nengine.kind = \"exact\"\nengine.time_step = 2.0\ngravity.y = -1.0\n"
             "collisions.restitution = 0.99\ncollisions.contact_time = 1e-3",
             false},
        Kind{"active",
             "run.steps = 1500\nengine.kind = \"tiled\"\npropulsion.speed = 1.0\n"
             "propulsion.rotational_diffusion = 3.0"},
        Kind{"brownian_active",
             "run.steps = 24\nengine.kind = \"exact\"\nengine.time_step = 20.0\nbox.edge = \"periodic\"\n"
             "thermostat.kind = \"brownian\"\npropulsion.speed = 1.0\npropulsion.rotational_diffusion = 3.0",
             false},
        Kind{"births_and_deaths",
             "run.steps = 1200\nmodel.kind = \"epidemic\"\nepidemic.count = 500\n"
             "epidemic.turnover_rate = 0.02\nengine.threads = 2"},
        Kind{"events", "run.steps = 300\nmodel.kind = \"catalyst\"\ncatalyst.hop_rate = 20.0"}),
    [](auto const& instance) { return std::string(instance.param.name); });

Kind const quick{"quick", "run.steps = 6000"};

/// Waits for the second checkpoint of a run.
void await_checkpoints(fs::path const& run) {
  for (int wait = 0; wait < 5000 && !fs::exists(run / "checkpoint.previous.gridlock"); ++wait) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  ASSERT_TRUE(fs::exists(run / "checkpoint.previous.gridlock"));
}

/// A run that was terminated in the middle, with a checkpoint and the previous one.
void leave_half_a_run(fs::path const& workplace) {
  write(workplace / "run.toml", toml_of(quick));
  Process const process(GRIDLOCK_PROGRAM, {"run", "run.toml", "-o", "run", "-q", "--no-pictures"}, workplace);
  await_checkpoints(workplace / "run");
  process.signal(SIGTERM);
  EXPECT_EQ(process.wait().exit_code, 1);
  ASSERT_TRUE(fs::exists(workplace / "run" / "checkpoint.gridlock"));
}

TEST(UnfinishedRun, SaysWhereItStands) {
  Workplace const workplace;
  write(workplace / "run.toml", toml_of({"long", "run.steps = 1_000_000"}));
  Process const process(GRIDLOCK_PROGRAM, {"run", "run.toml", "-o", "run", "-q", "--no-pictures"}, workplace.path());
  await_checkpoints(workplace / "run");
  process.signal(SIGKILL);
  process.wait();
  Outcome const outcome = gridlock::test::gridlock({"info", "run"}, workplace.path());
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_NE(outcome.out.find("checkpoint at step"), std::string::npos) << outcome.out;
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

TEST(KilledWhileItIsMadeLonger, ARunEndsWithTheBitsOfALongOne) {
  Workplace const workplace;
  write(workplace / "run.toml", toml_of({"short", "run.steps = 1200"}));
  Arguments const longer{"resume", "run", "--steps", "3600", "-q", "--no-pictures"};
  EXPECT_EQ(
      gridlock::test::gridlock({"run", "run.toml", "-o", "short", "-q", "--no-pictures"}, workplace.path()).exit_code,
      0);
  fs::copy(workplace / "short", workplace / "run", fs::copy_options::recursive);
  auto const start = std::chrono::steady_clock::now();
  EXPECT_EQ(gridlock::test::gridlock(longer, workplace.path()).exit_code, 0);
  double const milliseconds =
      std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
  fs::copy(workplace / "run" / "config.resolved.toml", workplace / "long.toml");
  EXPECT_EQ(
      gridlock::test::gridlock({"run", "long.toml", "-o", "long", "-q", "--no-pictures"}, workplace.path()).exit_code,
      0);
  std::mt19937 random(seed());
  // Half of the kills at the beginning, where the files of the short run give way to those of the long one.
  std::uniform_real_distribution<double> at_the_beginning(1.0, 30.0);
  std::uniform_real_distribution<double> anywhen(1.0, milliseconds);
  for (int attempt = 0; attempt < tries() / 2; ++attempt) {
    fs::remove_all(workplace / "run");
    fs::copy(workplace / "short", workplace / "run", fs::copy_options::recursive);
    Process const process(GRIDLOCK_PROGRAM, longer, workplace.path());
    double const wait = attempt % 2 == 0 ? at_the_beginning(random) : anywhen(random);
    std::this_thread::sleep_for(std::chrono::duration<double, std::milli>(wait));
    process.signal(SIGKILL);
    process.wait();
    bool const is_long = text_of(workplace / "run" / "summary.json").find("\"steps\": 3600") != std::string::npos;
    if (!is_long) {
      Outcome const outcome = gridlock::test::gridlock(longer, workplace.path());
      EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    }
    EXPECT_EQ(summary_without_times(workplace / "run"), summary_without_times(workplace / "long"));
    for (char const* name : {"series.csv", "final.xyz", "speed_distribution.csv", "config.resolved.toml"}) {
      EXPECT_EQ(text_of(workplace / "run" / name), text_of(workplace / "long" / name)) << name;
    }
    gridlock::H5mdReader const frames(workplace / "run" / "trajectory.h5");
    EXPECT_EQ(frames.frame_count(), 25U);
    for (std::string const& name : contents(workplace / "run")) EXPECT_FALSE(name.ends_with(".part")) << name;
    if (HasFailure()) FAIL() << "attempt " << attempt << " of GRIDLOCK_FAULT_SEED=" << seed();
  }
}

/// Runs the program through a shell that limits it first.
Outcome limited(std::string const& limit, Arguments const& arguments, fs::path const& directory) {
  std::string command = limit + "; exec \"$0\" \"$@\"";
  Arguments all{"-c", command, GRIDLOCK_PROGRAM};
  all.insert(all.end(), arguments.begin(), arguments.end());
  return Process("/bin/bash", all, directory).wait();
}

TEST(LackOfMemory, OfOneRunOfASweepIsItsFailureAndTheOthersGoOn) {
#if defined(__SANITIZE_ADDRESS__)
  GTEST_SKIP() << "AddressSanitizer needs more address space than the limit";
#endif
  Workplace const workplace;
  write(workplace / "sweep.toml",
        "run.steps = 20\ndisks.packing_fraction = 0.3\n[sweep]\ndisks.count = [100, 400, 40000000]\n");
  Outcome const outcome = limited("ulimit -v 2000000", {"sweep", "sweep.toml", "-o", "out", "-q"}, workplace.path());
  EXPECT_EQ(outcome.exit_code, 1) << outcome.err;
  EXPECT_NE(outcome.err.find("error: count=40000000: "), std::string::npos) << outcome.err;
  EXPECT_NE(outcome.err.find("1 of 3 runs failed"), std::string::npos) << outcome.err;
  EXPECT_TRUE(fs::exists(workplace / "out/runs/count=100/summary.json"));
  EXPECT_TRUE(fs::exists(workplace / "out/runs/count=400/summary.json"));
}

TEST(LackOfThreads, IsAnErrorThatNamesTheSetting) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "a sanitizer needs more address space than the limit";
#endif
  Workplace const workplace;
  write(workplace / "run.toml",
        "run.steps = 20\ndisks.count = 100\ndisks.packing_fraction = 0.3\nengine.kind = \"tiled\"\n");
  // A thread has a stack of 8 MB.
  Outcome const outcome =
      limited("ulimit -s 8192 -v 3000000", {"run", "run.toml", "-o", "run", "-q", "--set", "engine.threads=1000"},
              workplace.path());
  EXPECT_EQ(outcome.exit_code, 2) << outcome.err;
  EXPECT_NE(outcome.err.find("error: 1000 threads cannot be started: after "), std::string::npos) << outcome.err;
  EXPECT_NE(outcome.err.find("--> --set   engine.threads=1000\n"), std::string::npos) << outcome.err;
  EXPECT_FALSE(fs::exists(workplace / "run/summary.json"));
}

TEST(FullDisk, LeavesARunThatResumesToTheSameBitsOnceThereIsRoom) {
  Workplace const workplace;
  WholeRun const whole({"without_frames", "run.steps = 6000", false}, workplace.path());
  // No file may grow beyond 4 KiB: too little for a checkpoint and for the results.
  Outcome const full = limited("ulimit -f 4", {"run", "run.toml", "-o", "run", "--no-pictures"}, workplace.path());
  EXPECT_EQ(full.exit_code, 1) << full.err;
  EXPECT_NE(full.err.find("File too large"), std::string::npos) << full.err;
  EXPECT_NE(full.err.find("no checkpoint"), std::string::npos) << full.err;
  EXPECT_FALSE(is_finished(workplace / "run"));
  Outcome const resumed = gridlock::test::gridlock({"resume", "run", "-q", "--no-pictures"}, workplace.path());
  EXPECT_EQ(resumed.exit_code, 0) << resumed.err;
  whole.expect_same(workplace / "run");
}

Kind const longer{"longer", "run.steps = 30000"};

TEST(FullDisk, KeepsOutTheFirstFrameWithAPlainReason) {
  Workplace const workplace;
  write(workplace / "run.toml", toml_of({"quick", "run.steps = 6000"}));
  Outcome const full = limited("ulimit -f 4", {"run", "run.toml", "-o", "run", "--no-pictures"}, workplace.path());
  EXPECT_EQ(full.exit_code, 1) << full.err;
  EXPECT_EQ(full.err.find("error: cannot write run/trajectory.h5: cannot write to the file: File too large"), 0U)
      << full.err;
}

TEST(FullDisk, FilledUpByOthersInTheMiddleEndsTheRunWhichResumesToTheSameBits) {
  Workplace const workplace;
  WholeRun const whole(longer, workplace.path());
  // A small disk of its own, which goes with the shell.
  write(workplace / "script", R"(
mount -t tmpfs -o size=24m tmpfs disk || exit 77
"$1" run run.toml -o disk/run -q --no-pictures &
for wait in {1..1000}; do [ -e disk/run/checkpoint.previous.gridlock ] || sleep 0.01; done
head -c 25m /dev/zero >disk/others 2>/dev/null
wait $!; echo "run $?"
rm disk/others
"$1" resume disk/run -q --no-pictures; echo "resume $?"
cp -r disk/run run
)");
  fs::create_directories(workplace / "disk");
  Outcome const outcome =
      Process("/usr/bin/unshare", {"--map-root-user", "--mount", "/bin/bash", "script", GRIDLOCK_PROGRAM},
              workplace.path())
          .wait();
  if (outcome.exit_code == 77 || outcome.err.find("unshare failed") != std::string::npos) {
    GTEST_SKIP() << "no disk can be mounted here: " << outcome.err;
  }
  EXPECT_EQ(outcome.out, "run 1\nresume 0\n") << outcome.err;
  EXPECT_NE(outcome.err.find("No space left on device"), std::string::npos) << outcome.err;
  whole.expect_same(workplace / "run");
}

TEST(ReadOnlyDirectory, EndsTheRunWhichResumesToTheSameBits) {
  Workplace const workplace;
  WholeRun const whole(longer, workplace.path());
  // Root may write anywhere, unless it gives that up.
  std::string const limit = geteuid() == 0 ? "exec setpriv --bounding-set -dac_override,-dac_read_search \"$0\" \"$@\""
                                           : "exec \"$0\" \"$@\"";
  Process const process("/bin/bash", {"-c", limit, GRIDLOCK_PROGRAM, "run", "run.toml", "-o", "run", "--no-pictures"},
                        workplace.path());
  await_checkpoints(workplace / "run");
  fs::permissions(workplace / "run", fs::perms::owner_read | fs::perms::owner_exec);
  Outcome const outcome = process.wait();
  EXPECT_EQ(outcome.exit_code, 1) << outcome.err;
  EXPECT_NE(outcome.err.find("Permission denied"), std::string::npos) << outcome.err;
  fs::permissions(workplace / "run", fs::perms::owner_all);
  EXPECT_FALSE(is_finished(workplace / "run"));
  Outcome const resumed = gridlock::test::gridlock({"resume", "run", "-q", "--no-pictures"}, workplace.path());
  EXPECT_EQ(resumed.exit_code, 0) << resumed.err;
  whole.expect_same(workplace / "run");
}

TEST(VanishedDirectory, EndsTheRunWithTheReason) {
  Workplace const workplace;
  write(workplace / "run.toml", toml_of({"long", "run.steps = 1_000_000"}));
  Process const process(GRIDLOCK_PROGRAM, {"run", "run.toml", "-o", "run", "--no-pictures"}, workplace.path());
  await_checkpoints(workplace / "run");
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
  await_checkpoints(workplace / "run");
  fs::create_directories(workplace / "other");
  Outcome const second =
      Process(GRIDLOCK_PROGRAM, {"resume", (workplace / "run").string()}, workplace / "other").wait();
  EXPECT_EQ(second.exit_code, 2);
  EXPECT_NE(second.err.find("another process"), std::string::npos) << second.err;
  first.signal(SIGKILL);
  first.wait();
}

}  // namespace
