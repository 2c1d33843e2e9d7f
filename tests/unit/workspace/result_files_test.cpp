#include "workspace/result_files.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "gridlock/core/error.hpp"
#include "gridlock/workspace/run_directory.hpp"
#include "io/file.hpp"
#include "unit/io/temporary_directory.hpp"

namespace gridlock {
namespace {

namespace fs = std::filesystem;

TEST(ResultFiles, OnlyThoseRecordedAreRemoved) {
  TemporaryDirectory const directory;
  for (char const* name : {"a.csv", "b.csv", "mine.csv"}) write_file(directory / name, "1");
  for (char const* name : {"a.csv", "b.csv", "b.csv", "never written.svg"}) record_result(directory / name);
  remove_results(directory.path());
  EXPECT_FALSE(fs::exists(directory / "a.csv"));
  EXPECT_FALSE(fs::exists(directory / "b.csv"));
  EXPECT_FALSE(fs::exists(directory / ".gridlock.files"));
  EXPECT_EQ(read_file(directory / "mine.csv"), "1");
}

TEST(ResultFiles, PartsOfACheckpointGoWithIt) {
  TemporaryDirectory const directory;
  std::string const part = "checkpoint.part.0.0123456789abcdef0123456789abcdef";
  for (std::string const& name : {std::string("checkpoint.gridlock"), part + ".gridlock", part + ".mine"}) {
    write_file(directory / name, "1");
  }
  record_result(directory / "series.csv");
  remove_results(directory.path());
  EXPECT_TRUE(fs::exists(directory / (part + ".gridlock"))) << "no checkpoint of this list";
  record_result(directory / "checkpoint.gridlock");
  remove_results(directory.path());
  EXPECT_FALSE(fs::exists(directory / (part + ".gridlock")));
  EXPECT_TRUE(fs::exists(directory / (part + ".mine")));
}

TEST(ResultFiles, AListFromAStrangerReachesNothingOutsideItsDirectoryAndNoDirectory) {
  TemporaryDirectory const directory;
  fs::create_directories(directory / "run" / "mine");
  write_file(directory / "precious", "1");
  write_file(directory / "run" / "mine" / "precious", "1");
  fs::create_symlink(directory / "precious", directory / "run" / "link");
  write_file(directory / "run" / ".gridlock.files",
             "../precious\n" + (directory / "precious").string() + "\nmine\nmine/precious\n..\n.\n\nlink\n");
  remove_results(directory / "run");
  EXPECT_TRUE(fs::exists(directory / "precious"));
  EXPECT_TRUE(fs::exists(directory / "run" / "mine" / "precious"));
  EXPECT_FALSE(fs::is_symlink(directory / "run" / "link"));
}

TEST(ResultFiles, MadeOnDemandAreReplacedByTheVerbThatMadeThemAlone) {
  TemporaryDirectory const directory;
  auto const is_refused = [&](std::string const& name, std::string const& maker) {
    try {
      require_no_other_result(directory / name, maker);
    } catch (Error const& error) {
      EXPECT_EQ(error.problems()[0].key, "-o");
      return true;
    }
    return false;
  };
  record_further_result(directory / "early.csv", "export");
  EXPECT_FALSE(fs::exists(directory / ".gridlock.files")) << "no results, no list";
  record_result(directory / "series.csv");
  for (int twice = 0; twice < 2; ++twice) record_further_result(directory / "a.csv", "export");
  EXPECT_EQ(read_file(directory / ".gridlock.files"), "series.csv\na.csv/export\n");
  write_file(directory / "a.csv", "1");
  write_file(directory / "series.csv", "1");
  fs::create_symlink(directory / "series.csv", directory / "link.csv");
  fs::create_hard_link(directory / "series.csv", directory / "hard.csv");
  EXPECT_FALSE(is_refused("a.csv", "export"));
  EXPECT_FALSE(is_refused("mine.csv", "export"));
  EXPECT_TRUE(is_refused("a.csv", "movie"));
  for (char const* name : {"series.csv", "link.csv", "hard.csv"}) EXPECT_TRUE(is_refused(name, "export")) << name;
  for (char const* name : {".gridlock.files", ".lock"}) EXPECT_TRUE(is_refused(name, "export")) << name;
  record_result(directory / "a.csv");
  EXPECT_TRUE(is_refused("a.csv", "export")) << "by now a run writes a file of that name";
  remove_results(directory.path());
  EXPECT_FALSE(fs::exists(directory / "a.csv"));
}

TEST(ResultFiles, OfASweepAreThoseOfItsRunsToo) {
  TemporaryDirectory const directory;
  for (char const* run : {"runs/a", "runs/b", "runs/of_the_user"}) {
    fs::create_directories(directory / run);
    write_file(directory / run / "series.csv", "1");
  }
  record_result(directory / "plan.json");
  record_result(directory / "runs/a/series.csv");
  record_result(directory / "runs/b/series.csv");
  write_file(directory / "runs/b/notes.txt", "mine");
  remove_results(directory.path());
  EXPECT_FALSE(fs::exists(directory / "runs/a"));
  EXPECT_FALSE(fs::exists(directory / "runs/b/series.csv"));
  EXPECT_TRUE(fs::exists(directory / "runs/b/notes.txt"));
  EXPECT_TRUE(fs::exists(directory / "runs/of_the_user/series.csv"));
}

TEST(ResultFiles, OfARunOfAnotherKindDoNotOutliveIt) {
  TemporaryDirectory const directory;
  auto const run = [&](std::string const& text) {
    run_in(directory.path(),
           set_up(SettingsFile::from_text(text + "\nrun.steps = 40\nobserve.every = 5\n", "run.toml")));
  };
  run("disks = { count = 25, packing_fraction = 0.5 }\ntrajectory.every = 10");
  ASSERT_TRUE(fs::exists(directory / "pair_correlation.csv"));
  write_file(directory / "report.html", "my own");
  run("model.kind = \"epidemic\"\nepidemic.count = 30\nobserve.structure_every = 0");
  for (char const* name : {"pair_correlation.csv", "speed_distribution.csv", "trajectory.h5"}) {
    EXPECT_FALSE(fs::exists(directory / name)) << name;
  }
  EXPECT_EQ(read_file(directory / "report.html"), "my own");
  std::string const log = read_file(directory / "run.log");
  EXPECT_EQ(log.find("25 disks"), std::string::npos) << log;
}

}  // namespace
}  // namespace gridlock
