// Sweeps over interruptions, growing plans and several machines, through the program itself.
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <thread>

#include "cli/program.hpp"
#include "gridlock/io/table.hpp"

namespace {

using namespace gridlock::test;

std::string sweep_toml(std::string const& densities, std::string const& steps = "300") {
  return "[disks]\ncount = 64\n[run]\nsteps = " + steps +
         "\n[observe]\nevery = 50\n[checkpoint]\nevery_seconds = 0.01\n[sweep]\n\"disks.packing_fraction\" = [" +
         densities + "]\nrun.seed = [1, 2]\n";
}

Outcome in(fs::path const& directory, std::vector<std::string> arguments) {
  return gridlock::test::gridlock(std::move(arguments), directory);
}

void expect_good(Outcome const& outcome) { EXPECT_EQ(outcome.exit_code, 0) << outcome.out << outcome.err; }

/// sweep.csv without the times runs took.
std::string rows_of(fs::path const& directory) {
  gridlock::Table const table = gridlock::read_csv(directory / "sweep.csv");
  gridlock::Table kept;
  for (std::size_t k = 0; k < table.column_count(); ++k) {
    if (table.names()[k] != "seconds") kept.add_column(table.names()[k], table.column(k));
  }
  return to_csv(kept);
}

TEST(Sweep, RunAgainKeepsWhatIsFinishedAndMakesOnlyWhatIsNew) {
  Workplace const workplace;
  write(workplace / "s.toml", sweep_toml("0.3, 0.5"));
  expect_good(in(workplace.path(), {"sweep", "s.toml", "-o", "out"}));
  auto const first = fs::last_write_time(workplace / "out/runs/packing_fraction=0.3_seed=1/summary.json");
  write(workplace / "s.toml", sweep_toml("0.2, 0.3, 0.5"));
  expect_good(in(workplace.path(), {"sweep", "s.toml", "-o", "out"}));
  EXPECT_EQ(fs::last_write_time(workplace / "out/runs/packing_fraction=0.3_seed=1/summary.json"), first);
  expect_good(in(workplace.path(), {"sweep", "s.toml", "-o", "afresh"}));
  EXPECT_EQ(rows_of(workplace / "out"), rows_of(workplace / "afresh"));
  EXPECT_EQ(text_of(workplace / "out/means.csv"), text_of(workplace / "afresh/means.csv"));
}

TEST(Sweep, RefusesADirectoryWithOneOfItsRunsUnderOtherSettings) {
  Workplace const workplace;
  write(workplace / "s.toml", sweep_toml("0.3, 0.5"));
  expect_good(in(workplace.path(), {"sweep", "s.toml", "-o", "out"}));
  write(workplace / "s.toml", sweep_toml("0.3, 0.5", "400"));
  Outcome const outcome = in(workplace.path(), {"sweep", "s.toml", "-o", "out"});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_NE(outcome.err.find("was run with other settings"), std::string::npos) << outcome.err;
  EXPECT_NE(outcome.err.find("hint: "), std::string::npos) << outcome.err;
  expect_good(in(workplace.path(), {"sweep", "s.toml", "-o", "out", "--overwrite"}));
}

TEST(Sweep, KilledAndRunAgainHasTheSameRows) {
  Workplace const workplace;
  write(workplace / "s.toml", sweep_toml("0.3, 0.5, 0.7", "3000"));
  expect_good(in(workplace.path(), {"sweep", "s.toml", "-o", "whole"}));
  for (int const milliseconds : {20, 60, 120, 200}) {
    Process const process(GRIDLOCK_PROGRAM, {"sweep", "s.toml", "-o", "parts"}, workplace.path());
    std::this_thread::sleep_for(std::chrono::milliseconds(milliseconds));
    process.signal(SIGKILL);
    process.wait();
  }
  expect_good(in(workplace.path(), {"sweep", "s.toml", "-o", "parts"}));
  EXPECT_EQ(rows_of(workplace / "whole"), rows_of(workplace / "parts"));
}

TEST(Sweep, InShardsAndCollectedHasTheSameRowsAsAWhole) {
  Workplace const workplace;
  write(workplace / "s.toml", sweep_toml("0.3, 0.5, 0.6"));
  expect_good(in(workplace.path(), {"sweep", "s.toml", "-o", "whole"}));
  for (char const* shard : {"1/4", "2/4", "3/4", "4/4"}) {
    expect_good(in(workplace.path(), {"sweep", "s.toml", "-o", "shared", "--shard", shard}));
    expect_good(in(workplace.path(), {"sweep", "s.toml", "-o", std::string("own") + shard[0], "--shard", shard}));
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

TEST(Sweep, RefusesAShardThatIsNone) {
  Workplace const workplace;
  write(workplace / "s.toml", sweep_toml("0.3"));
  for (char const* shard : {"0/2", "3/2", "1", "a/b", "1/0", "1/2/3"}) {
    Outcome const outcome = in(workplace.path(), {"sweep", "s.toml", "-o", "out", "--shard", shard});
    EXPECT_EQ(outcome.exit_code, 2) << shard;
    EXPECT_NE(outcome.err.find("is no shard"), std::string::npos) << outcome.err;
  }
  EXPECT_FALSE(fs::exists(workplace / "out"));
}

TEST(Sweep, SaysWhatTheSameCommandWillDoAboutRunsThatFailed) {
  Workplace const workplace;
  write(workplace / "s.toml", sweep_toml("0.3, 0.9"));
  Outcome const outcome = in(workplace.path(), {"sweep", "s.toml", "-o", "out", "--quiet"});
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_NE(outcome.err.find("2 of 4 runs failed"), std::string::npos) << outcome.err;
  EXPECT_NE(outcome.err.find("tries them again, to the same end unless the reason is gone"), std::string::npos)
      << outcome.err;
  EXPECT_EQ(outcome.err.find("stopped early"), std::string::npos) << "none was: " << outcome.err;
}

TEST(Sweep, OverEnginesNotesWhatHasNoEffectInAnyRunOnly) {
  Workplace const workplace;
  write(workplace / "s.toml",
        "disks.count = 64\nrun.steps = 20\nengine = { audit_every = 100, cells = 4, grid = \"linked\", threads = 2 }\n"
        "[sweep]\nengine.kind = [\"stepped\", \"exact\"]\n");
  std::string const note = "note: engine.threads has no effect in any run\n";
  for (std::vector<std::string> const& command :
       {std::vector<std::string>{"check", "s.toml"}, {"sweep", "s.toml", "-o", "out"}}) {
    Outcome const outcome = in(workplace.path(), command);
    expect_good(outcome);
    std::size_t const first = outcome.err.find("note: ");
    ASSERT_NE(first, std::string::npos) << outcome.err;
    EXPECT_EQ(outcome.err.substr(first, note.size()), note) << outcome.err;
    EXPECT_EQ(outcome.err.find("note: ", first + 1), std::string::npos) << outcome.err;
  }
  gridlock::Table const means = gridlock::read_csv(workplace / "out/means.csv");
  std::vector<double> const shares = means.numbers("blocked_share");
  EXPECT_TRUE(std::isfinite(shares[0]));
  EXPECT_FALSE(std::isfinite(shares[1])) << "the exact engine halts no disk";
}

TEST(Sweep, OfTheExactEngineHasNoBlockedShare) {
  Workplace const workplace;
  write(workplace / "s.toml", sweep_toml("0.3, 0.5") + "engine.kind = [\"exact\"]\n");
  expect_good(in(workplace.path(), {"sweep", "s.toml", "-o", "out"}));
  EXPECT_FALSE(gridlock::read_csv(workplace / "out/means.csv").contains("blocked_share"));
  EXPECT_FALSE(fs::exists(workplace / "out/blocked_share.svg"));
  EXPECT_TRUE(fs::exists(workplace / "out/collision_rate.svg"));
}

TEST(IdleSettings, AreNotedByCheckAndRunUnlessQuiet) {
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
  Outcome const outcome = in(workplace.path(), {"collect", "empty"});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_NE(outcome.err.find("plan.json"), std::string::npos) << outcome.err;
}

}  // namespace
