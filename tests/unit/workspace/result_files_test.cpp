#include "workspace/result_files.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "gridlock/core/error.hpp"
#include "gridlock/workspace/run_directory.hpp"
#include "io/file.hpp"
#include "unit/io/temporary_directory.hpp"
#include "workspace/run_files.hpp"

namespace gridlock {
namespace {

namespace fs = std::filesystem;

TEST(ResultFiles, OnlyThoseRecordedAreRemoved) {
  TemporaryDirectory const directory;
  for (char const* name : {"a.csv", "b.csv", "b.csv", "never written.svg"}) record_result(directory / name);
  for (char const* name : {"a.csv", "b.csv", "mine.csv"}) write_file(directory / name, "1");
  remove_results(directory.path());
  EXPECT_FALSE(fs::exists(directory / "a.csv"));
  EXPECT_FALSE(fs::exists(directory / "b.csv"));
  EXPECT_FALSE(fs::exists(directory / ".gridlock.files"));
  EXPECT_EQ(read_file(directory / "mine.csv"), "1");
}

TEST(ResultFiles, OfTheUserAreListedBeforeTheyAreReplacedAndOnlyWhereTheUserSaysSo) {
  TemporaryDirectory const directory;
  write_file(directory / "mine.csv", "1");
  fs::create_symlink("nowhere", directory / "link.csv");
  fs::create_directory(directory / "folder.csv");
  auto const plan = [&](char const* name, bool overwrites) {
    return PlannedFiles{
        .results = {directory / name}, .inputs = {}, .maker = "", .hint = "move it", .overwrites = overwrites};
  };
  for (char const* name : {"mine.csv", "link.csv", "folder.csv"}) {
    EXPECT_THROW(protect_files(plan(name, false)), Error) << name;
    EXPECT_THROW(record_result(directory / name), Error) << name;
  }
  EXPECT_FALSE(has_list(directory.path()));
  EXPECT_THROW(protect_files(plan("folder.csv", true)), Error);
  protect_files(plan("mine.csv", true));
  EXPECT_TRUE(is_listed(directory / "mine.csv"));
  EXPECT_EQ(read_file(directory / "mine.csv"), "1") << "it is for the command to replace it";
}

TEST(ResultFiles, AreNeverTheInputsOfTheCommandThatWritesThem) {
  TemporaryDirectory const directory;
  record_result(directory / "final.xyz");
  write_file(directory / "final.xyz", "1");
  fs::create_symlink("final.xyz", directory / "link.xyz");
  for (char const* input : {"final.xyz", "link.xyz"}) {
    for (bool const overwrites : {false, true}) {
      EXPECT_THROW(protect_files({.results = {directory / "final.xyz"},
                                  .inputs = {directory / "." / input},
                                  .maker = "",
                                  .hint = "",
                                  .overwrites = overwrites}),
                   Error)
          << input;
    }
    EXPECT_THROW(protect_inputs(directory.path(), std::vector<fs::path>{directory / input}), Error) << input;
  }
  write_file(directory / "mine.xyz", "1");
  EXPECT_NO_THROW(protect_inputs(directory.path(), std::vector<fs::path>{directory / "mine.xyz", ""}));
  fs::create_directories(directory / "runs/a");
  record_result(directory / "runs/a/final.xyz");
  EXPECT_THROW(protect_inputs(directory.path(), std::vector<fs::path>{directory / "runs/a/final.xyz"}), Error);
}

TEST(ResultFiles, OfEveryKindOfRunAreKnownBeforeItBegins) {
  for (char const* text :
       {"disks = { count = 12, packing_fraction = 0.3 }\ntrajectory.every = 10\nobserve.structure_every = 1",
        "model.kind = \"epidemic\"\nepidemic.count = 30\ntrajectory.every = 20",
        "disks = { count = 12 }\nbox.edge = \"periodic\"\nprotocol = [{ stage = \"quench\", packing_fraction = 0.9 }, "
        "{ stage = \"decompress\", until_pressure = 1e-4 }, "
        "{ stage = \"separate\" }]",
        "disks = { count = 12, packing_fraction = 0.3, start = \"random\" }\nprotocol = [{ stage = \"swap\", sweeps = "
        "20, "
        "swap_fraction = 0.0 }]"}) {
    TemporaryDirectory const directory;
    gridlock::Setup setup =
        set_up(SettingsFile::from_text(std::string(text) + "\nrun.steps = 40\nobserve.every = 5\n", "run.toml"));
    std::vector<fs::path> const known = run_files(directory.path(), setup.configuration);
    run_in(directory.path(), std::move(setup));
    for (auto const& entry : fs::directory_iterator(directory.path())) {
      std::string const name = entry.path().filename().string();
      if (name.starts_with('.')) continue;
      EXPECT_NE(std::ranges::find(known, entry.path()), known.end()) << name << " of " << text;
    }
  }
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
  fs::remove(directory / "checkpoint.gridlock");
  record_result(directory / "checkpoint.gridlock");
  write_file(directory / "checkpoint.gridlock", "1");
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
      protect_files({.results = {directory / name}, .inputs = {}, .maker = maker, .hint = ""});
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
  EXPECT_FALSE(is_refused("new.csv", "export"));
  write_file(directory / "mine.csv", "1");
  EXPECT_TRUE(is_refused("mine.csv", "export"));
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
  record_result(directory / "plan.json");
  for (std::string const run : {"runs/a", "runs/b", "runs/of_the_user"}) {
    fs::create_directories(directory / run);
    if (!run.ends_with("user")) record_result(directory / run / "series.csv");
    write_file(directory / run / "series.csv", "1");
  }
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
