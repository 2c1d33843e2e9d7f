// What stays and what goes when a run is resumed, made longer or overwritten, through the program itself.
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <sys/stat.h>

#include <chrono>
#include <thread>

#include "cli/program.hpp"

namespace {

using namespace gridlock::test;
using Arguments = std::vector<std::string>;

char const* const settings_with_frames =
    "[disks]\ncount = 64\npacking_fraction = 0.5\n[run]\nsteps = 130\n[observe]\nevery = 20\n[trajectory]\nevery = "
    "40\n";

std::string state_hash_of(fs::path const& directory) {
  return nlohmann::json::parse(text_of(directory / "summary.json"))["state_hash"].get<std::string>();
}

TEST(Resume, MakesAFinishedRunLongerWithTheBytesOfARunThatLong) {
  Workplace const workplace;
  write(workplace / "a.toml", settings_with_frames);
  ASSERT_EQ(in(workplace, {"run", "a.toml", "-o", "parts", "--no-pictures", "-q"}).exit_code, 0);
  Outcome const longer = in(workplace, {"resume", "parts", "--steps", "400", "--no-pictures"});
  EXPECT_EQ(longer.exit_code, 0) << longer.err;
  EXPECT_NE(longer.err.find("note: observe.equilibration is 0.05 of the new length"), std::string::npos) << longer.err;
  ASSERT_EQ(in(workplace, {"run", "parts/config.resolved.toml", "-o", "whole", "--no-pictures", "-q"}).exit_code, 0);
  for (char const* name : {"series.csv", "final.xyz", "speed_distribution.csv", "config.resolved.toml"}) {
    EXPECT_EQ(text_of(workplace / "parts" / name), text_of(workplace / "whole" / name)) << name;
  }
  Outcome const again = in(workplace, {"resume", "parts", "--steps", "400"});
  EXPECT_EQ(again.exit_code, 2);
  EXPECT_NE(again.err.find("has come to step 400"), std::string::npos) << again.err;
}

TEST(Resume, ReadsWhatARunOfAnyDynamicsHasWritten) {
  for (std::string const dynamics :
       {"box.edge_x = \"periodic\"\n", "box.edge_x = \"periodic\"\nbox.edge_y = \"periodic\"\n",
        "box.edge_x = \"periodic\"\nbox.edge_y = \"wall\"\n", "propulsion.speed = 0.5\n",
        "engine.kind = \"exact\"\npropulsion.speed = 0.5\nthermostat.kind = \"brownian\"\n",
        "engine.kind = \"exact\"\ngravity.y = -1.0\ncollisions.restitution = 0.9\nwalls = [{ from = [0.0, 1.0], to = "
        "[1.0, "
        "1.0] }]\n",
        "engine.kind = \"exact\"\ndisks.species = [{ fraction = 0.5, fixed = true }, { fraction = 0.5 }]\n"
        "collisions.restitution_by_kind = [0.8, 1.0, 1.0]\n"}) {
    Workplace const workplace;
    write(workplace / "a.toml",
          dynamics + "disks.count = 64\ndisks.packing_fraction = 0.3\nobserve.every = 20\nrun.steps = 60\n");
    Outcome const first = in(workplace, {"run", "a.toml", "-o", "parts", "--no-pictures", "-q"});
    ASSERT_EQ(first.exit_code, 0) << dynamics << first.err;
    Outcome const longer = in(workplace, {"resume", "parts", "--steps", "100", "--no-pictures", "-q"});
    EXPECT_EQ(longer.exit_code, 0) << dynamics << longer.err;
    Outcome const whole = in(workplace, {"run", "parts/config.resolved.toml", "-o", "whole", "--no-pictures", "-q"});
    EXPECT_EQ(whole.exit_code, 0) << dynamics << whole.err;
    EXPECT_EQ(text_of(workplace / "parts/final.xyz"), text_of(workplace / "whole/final.xyz")) << dynamics;
  }
}

TEST(Resume, OfAFinishedRunOfAModelSaysHowToMakeItLonger) {
  Workplace const workplace;
  write(workplace / "a.toml", "model.kind = \"epidemic\"\nepidemic.count = 50\nrun.steps = 20\n");
  ASSERT_EQ(in(workplace, {"run", "a.toml", "-o", "out", "--no-pictures", "-q"}).exit_code, 0);
  Outcome const refused = in(workplace, {"resume", "out"});
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_NE(refused.err.find("hint: gridlock resume out --steps N"), std::string::npos) << refused.err;
  EXPECT_EQ(in(workplace, {"resume", "out", "--steps", "30", "--no-pictures", "-q"}).exit_code, 0);
  EXPECT_EQ(nlohmann::json::parse(text_of(workplace / "out/summary.json"))["steps"], 30);
}

TEST(Resume, OfARunWhoseTrajectoryIsCutOffIsRefusedAtOnceWithPlaceAndHintAndChangesNothing) {
  Workplace const workplace;
  write(workplace / "a.toml", std::string(settings_with_frames) + "per_decade = 40\n");
  ASSERT_EQ(in(workplace, {"run", "a.toml", "-o", "out", "--no-pictures", "-q"}).exit_code, 0);
  fs::path const file = workplace / "out/trajectory.h5";
  std::string const whole = text_of(file);
  for (std::size_t const length : {std::size_t{20'000}, whole.size() / 2, std::size_t{0}}) {
    fs::resize_file(file, length);
    std::string const cut = text_of(file);
    Outcome const refused = in(workplace, {"resume", "out", "--steps", "200", "--no-pictures"});
    EXPECT_EQ(refused.exit_code, 2) << refused.err;
    std::string const reason = length == 0 ? "it is empty"
                                           : "it is cut off: " + std::to_string(length) + " of its " +
                                                 std::to_string(whole.size()) + " bytes are there";
    for (std::string const& words : {"cannot read out/trajectory.h5: " + reason, std::string("--> out/trajectory.h5"),
                                     std::string("hint: put the whole file back")}) {
      EXPECT_NE(refused.err.find(words), std::string::npos) << refused.err;
    }
    EXPECT_EQ(text_of(file) == cut, true) << length;
    write(file, whole);
  }
  Outcome const resumed = in(workplace, {"resume", "out", "--steps", "200", "--no-pictures", "-q"});
  EXPECT_EQ(resumed.exit_code, 0) << resumed.err;
}

TEST(Resume, DoesNotWaitForAPipeInThePlaceOfItsLogOrItsList) {
  for (char const* name : {"run.log", ".gridlock.files"}) {
    Workplace const workplace;
    write(workplace / "a.toml", std::string(settings_with_frames) + "per_decade = 40\n");
    ASSERT_EQ(in(workplace, {"run", "a.toml", "-o", "out", "--no-pictures", "-q"}).exit_code, 0);
    fs::remove(workplace / "out" / name);
    ASSERT_EQ(mkfifo((workplace / "out" / name).c_str(), 0600), 0);
    Outcome const refused = in(workplace, {"resume", "out", "--steps", "200", "--no-pictures"});
    EXPECT_EQ(refused.exit_code, 2) << refused.err;
    EXPECT_NE(refused.err.find(std::string(name) + ": it is not a regular file"), std::string::npos) << refused.err;
  }
}

TEST(Overwrite, LeavesNothingOfARunOfAnotherKindAndEverythingOfTheUser) {
  Workplace const workplace;
  write(workplace / "disks.toml", settings_with_frames);
  write(workplace / "model.toml",
        "model.kind = \"epidemic\"\nepidemic.count = 50\nepidemic.turnover_rate = 0.1\nrun.steps = 20\n");
  ASSERT_EQ(in(workplace, {"run", "model.toml", "-o", "only_model"}).exit_code, 0);
  ASSERT_EQ(in(workplace, {"run", "disks.toml", "-o", "out"}).exit_code, 0);
  ASSERT_EQ(in(workplace, {"export", "out", "--to", "csv"}).exit_code, 0);
  write(workplace / "out/report.html", "my own");
  write(workplace / "out/notes.csv", "my own");
  ASSERT_EQ(in(workplace, {"run", "model.toml", "-o", "out", "--overwrite"}).exit_code, 0);
  std::vector<std::string> expected = contents(workplace / "only_model");
  expected.insert(expected.end(), {"report.html", "notes.csv"});
  std::sort(expected.begin(), expected.end());
  EXPECT_EQ(contents(workplace / "out"), expected);
  EXPECT_EQ(text_of(workplace / "out/report.html"), "my own");
}

TEST(Overwrite, OfASweepByARunLeavesNoneOfItsRuns) {
  Workplace const workplace;
  write(workplace / "sweep.toml", "disks.count = 25\nrun.steps = 20\n[sweep]\nrun.seed = [1, 2]\n");
  write(workplace / "run.toml", "disks.count = 25\nrun.steps = 20\n");
  ASSERT_EQ(in(workplace, {"sweep", "sweep.toml", "-o", "made", "-q"}).exit_code, 0);
  ASSERT_EQ(in(workplace, {"collect", "made", "-o", "out"}).exit_code, 0);
  write(workplace / "out/runs/seed=2/notes.txt", "my own");
  ASSERT_EQ(in(workplace, {"run", "run.toml", "-o", "out", "--overwrite", "--no-pictures", "-q"}).exit_code, 0);
  for (char const* name : {"plan.json", "sweep.csv", "means.csv", "runs/seed=1", "runs/seed=2/summary.json"}) {
    EXPECT_FALSE(fs::exists(workplace / "out" / name)) << name;
  }
  EXPECT_TRUE(fs::exists(workplace / "out/runs/seed=2/notes.txt"));
}

TEST(Overwrite, OfARunByASweepLeavesNoneOfItsResults) {
  Workplace const workplace;
  write(workplace / "sweep.toml", "disks.count = 25\nrun.steps = 20\n[sweep]\nrun.seed = [1, 2]\n");
  write(workplace / "run.toml", "disks.count = 25\nrun.steps = 20\n");
  ASSERT_EQ(in(workplace, {"run", "run.toml", "-o", "out", "--no-pictures", "-q"}).exit_code, 0);
  write(workplace / "out/notes.txt", "my own");
  ASSERT_EQ(in(workplace, {"sweep", "sweep.toml", "-o", "out", "--overwrite", "-q"}).exit_code, 0);
  EXPECT_EQ(contents(workplace / "out"),
            (std::vector<std::string>{".gridlock.files", "means.csv", "notes.txt", "plan.json", "runs", "sweep.csv"}));
}

TEST(Leftovers, OfKilledProcessesGoWithResumeOverwriteAndExport) {
  Workplace const workplace;
  write(workplace / "a.toml", settings_with_frames);
  auto const leave = [&] {
    for (char const* name : {".checkpoint.gridlock.99999999-0.part", ".trajectory.csv.99999999-3.part"}) {
      write(workplace / "out" / name, "half");
    }
  };
  auto const is_clean = [&] {
    for (std::string const& name : contents(workplace / "out")) {
      if (name.ends_with(".part")) return false;
    }
    return true;
  };
  ASSERT_EQ(in(workplace, {"run", "a.toml", "-o", "out", "--no-pictures", "-q"}).exit_code, 0);
  leave();
  ASSERT_EQ(in(workplace, {"export", "out", "--to", "csv"}).exit_code, 0);
  EXPECT_TRUE(is_clean());
  leave();
  ASSERT_EQ(in(workplace, {"resume", "out", "--steps", "200", "--no-pictures", "-q"}).exit_code, 0);
  EXPECT_TRUE(is_clean());
  leave();
  ASSERT_EQ(in(workplace, {"run", "a.toml", "-o", "out", "--overwrite", "--no-pictures", "-q"}).exit_code, 0);
  EXPECT_TRUE(is_clean());
}

TEST(Run, OnANumberOfThreadsKeepsItInItsConfiguration) {
  Workplace const workplace;
  write(workplace / "a.toml", std::string(settings_with_frames) + "[engine]\nkind = \"tiled\"\nthreads = 3\n");
  ASSERT_EQ(in(workplace, {"run", "a.toml", "-o", "one", "--no-pictures", "-q", "-j", "1"}).exit_code, 0);
  ASSERT_EQ(in(workplace, {"run", "a.toml", "-o", "three", "--no-pictures", "-q"}).exit_code, 0);
  EXPECT_NE(text_of(workplace / "one/config.resolved.toml").find("threads = 1\n"), std::string::npos);
  EXPECT_EQ(state_hash_of(workplace / "one"), state_hash_of(workplace / "three"));
  EXPECT_EQ(in(workplace, {"run", "a.toml", "-o", "none", "-j", "1025"}).exit_code, 2);
  EXPECT_EQ(in(workplace, {"run", "a.toml", "-o", "every_core", "-j", "0", "-q", "--no-pictures"}).exit_code, 0);
}

TEST(Notes, OnASetUpAreToldByCheckAndRunAndTheLog) {
  Workplace const workplace;
  write(workplace / "a.toml", "disks.count = 64\nbox.edge = \"periodic\"\nrun.steps = 20\n");
  std::string const note = "the centre of all disks drifts in a periodic box";
  Outcome const check = in(workplace, {"check", "a.toml"});
  EXPECT_EQ(check.err.find("note: with engine.kind = \"stepped\" " + note), 0U) << check.err;
  Outcome const run = in(workplace, {"run", "a.toml", "-o", "out", "--no-pictures"});
  EXPECT_NE(run.err.find("note: with engine.kind = \"stepped\" " + note), std::string::npos) << run.err;
  EXPECT_NE(text_of(workplace / "out/run.log").find(note), std::string::npos);
  EXPECT_EQ(in(workplace, {"run", "a.toml", "-o", "quiet", "--no-pictures", "-q"}).err, "");
  EXPECT_EQ(in(workplace, {"check", "a.toml", "--set", "engine.kind=exact"}).err, "");
}

TEST(Scenes, AreCheckedWithoutANoteOnTheirEngineUnlessTheyAreThePapers) {
  Workplace const workplace;
  for (auto const& entry : fs::directory_iterator(fs::path(GRIDLOCK_SOURCE_DIR) / "scenes")) {
    Outcome const check = in(workplace, {"check", entry.path().string()});
    EXPECT_EQ(check.exit_code, 0) << check.err;
    std::string const name = entry.path().stem().string();
    bool const has_papers_densities = name == "density_sweep" || name == "paper_length";
    EXPECT_EQ(check.err.find("engine.kind") != std::string::npos, has_papers_densities) << name << ": " << check.err;
  }
}

TEST(Run, WhoseFilesWereRemovedMeanwhileDoesNotPromiseToBeResumed) {
  Workplace const workplace;
  write(workplace / "a.toml", "disks.count = 64\ncheckpoint.every_seconds = 0.01\n");
  Process const process(GRIDLOCK_PROGRAM,
                        {"run", "a.toml", "-o", "out", "--no-pictures", "--set", "run.steps=100_000_000"},
                        workplace.path());
  for (int wait = 0; wait < 5000 && !fs::exists(workplace / "out/checkpoint.gridlock"); ++wait) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  fs::remove(workplace / "out/config.resolved.toml");
  process.signal(SIGTERM);
  Outcome const outcome = process.wait();
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_NE(outcome.err.find("interrupted after"), std::string::npos) << outcome.err;
  EXPECT_EQ(outcome.err.find("gridlock resume"), std::string::npos) << outcome.err;
}

TEST(Run, SavesItselfAtEverySignalThatAsksItToStop) {
  for (int const signal : {SIGINT, SIGTERM, SIGUSR1}) {
    Workplace const workplace;
    write(workplace / "a.toml", "disks.count = 64\n");
    Process const process(GRIDLOCK_PROGRAM,
                          {"run", "a.toml", "-o", "out", "--no-pictures", "--set", "run.steps=100_000_000"},
                          workplace.path());
    wait_for(workplace / "out/run.log");
    process.signal(signal);
    EXPECT_EQ(process.wait().exit_code, 1) << signal;
    EXPECT_TRUE(fs::exists(workplace / "out/checkpoint.gridlock")) << signal;
  }
}

TEST(Run, EndsAtOnceWhenItIsAskedToStopAgain) {
  Workplace const workplace;
  // A step takes seconds.
  write(workplace / "a.toml",
        "disks = { count = 250_000, packing_fraction = 0.7 }\nengine = { grid = \"linked\", cells = 10 }\n");
  Process const process(GRIDLOCK_PROGRAM, {"run", "a.toml", "-o", "out", "--no-pictures", "--set", "run.steps=1_000"},
                        workplace.path());
  wait_for(workplace / "out/run.log");
  // Two signals that come together are one request.
  process.signal(SIGTERM);
  process.signal(SIGTERM);
  std::this_thread::sleep_for(std::chrono::milliseconds(700));
  process.signal(SIGTERM);
  EXPECT_EQ(process.wait().exit_code, 128 + SIGTERM);
}

}  // namespace
