// Runs and sweeps let the program gridlock-plot draw their pictures; here a script takes its place. What it draws is
// tested in python/tests.
#include <gtest/gtest.h>

#include <map>
#include <string>
#include <vector>

#include "cli/program.hpp"

namespace {

using namespace gridlock::test;

constexpr char const* keep_arguments = "#!/bin/sh\nprintf '<%s>' \"$@\" > said\n";

/// A copy of the program without gridlock-plot beside it, and an empty PATH.
class DrawnByAnother : public testing::Test {
 protected:
  DrawnByAnother() {
    fs::create_directory(workplace_ / "bin");
    fs::copy_file(GRIDLOCK_PROGRAM, workplace_ / "bin/gridlock");
    write(workplace_ / "run.toml", "disks.count = 9\nrun.steps = 2\n");
    write(workplace_ / "sweep.toml", "disks.count = 9\nrun.steps = 2\n[sweep]\nrun.seed = [1, 2]\n");
  }

  void draw_by(std::string const& script) const {
    write(workplace_ / "bin/gridlock-plot", script);
    fs::permissions(workplace_ / "bin/gridlock-plot", fs::perms::owner_all);
  }

  [[nodiscard]] Outcome run(std::vector<std::string> words) const {
    words.insert(words.begin(), {"PATH=/no/such/directory", (workplace_ / "bin/gridlock").string()});
    return Process("/usr/bin/env", std::move(words), workplace_.path()).wait();
  }

  Workplace workplace_;
};

TEST_F(DrawnByAnother, PicturesOfRunsWhereTheyAreAskedForAndOfSweeps) {
  draw_by(keep_arguments);
  auto const said_after = [&](std::vector<std::string> const& words) {
    fs::remove(workplace_ / "said");
    Outcome const outcome = run(words);
    expect_good(outcome);
    EXPECT_EQ(outcome.err, "");
    return text_of(workplace_ / "said");
  };
  EXPECT_EQ(said_after({"run", "run.toml", "-o", "one run"}), "");
  EXPECT_EQ(said_after({"run", "run.toml", "-o", "drawn run", "--pictures"}), "<--if-any><--><drawn run>");
  EXPECT_EQ(said_after({"resume", "one run", "--steps", "4", "--pictures"}), "<--if-any><--><one run>");
  EXPECT_EQ(said_after({"sweep", "sweep.toml", "-o", "sweep"}), "<--if-any><--><sweep>");
  EXPECT_EQ(said_after({"sweep", "sweep.toml", "-o", "plain", "--no-pictures"}), "");
  EXPECT_EQ(said_after({"sweep", "sweep.toml", "-o", "part", "--shard", "1/1"}), "");
  EXPECT_EQ(said_after({"collect", "part", "-o", "whole"}), "<--if-any><--><whole>");
}

TEST_F(DrawnByAnother, RunSaysHowToGetThemWhereThatProgramIsMissing) {
  for (std::vector<std::string> const& words : {std::vector<std::string>{"run", "run.toml", "-o", "run", "--pictures"},
                                                {"sweep", "sweep.toml", "-o", "sweep"}}) {
    Outcome const outcome = run(words);
    expect_good(outcome);
    EXPECT_EQ(
        outcome.err,
        "note: the pictures are drawn by gridlock-plot, which is not installed: it comes with the Python package: "
        "pip install \".[plots]\" in the sources of Gridlock\n");
  }
}

TEST_F(DrawnByAnother, QuietSweepSaysNothingOfThatProgram) {
  Outcome const outcome = run({"sweep", "sweep.toml", "-o", "sweep", "-q"});
  expect_good(outcome);
  EXPECT_EQ(outcome.out + outcome.err, "");
}

TEST_F(DrawnByAnother, NotesAndFailuresAreNotesOfTheRun) {
  draw_by("#!/bin/sh\necho out\necho 'note: too many curves' >&2\n");
  Outcome const noted = run({"run", "run.toml", "-o", "a", "--pictures"});
  expect_good(noted);
  EXPECT_EQ(noted.err, "note: too many curves\n");
  EXPECT_EQ(noted.out.find("out\n"), std::string::npos) << noted.out;
  draw_by("#!/bin/sh\necho 'error: drawing needs a pen' >&2\nexit 2\n");
  Outcome const failed = run({"run", "run.toml", "-o", "b", "--pictures"});
  expect_good(failed);
  EXPECT_EQ(failed.err, "note: the pictures could not be drawn: drawing needs a pen\n");
  EXPECT_EQ(failed.out.substr(0, 8), "finished");
}

TEST_F(DrawnByAnother, RunNeedsItsLastState) {
  draw_by(keep_arguments);
  Outcome const outcome = run({"run", "run.toml", "-o", "run", "--pictures", "--set", "run.final_state=false"});
  expect_good(outcome);
  EXPECT_NE(outcome.err.find("no pictures without the last state"), std::string::npos) << outcome.err;
  EXPECT_FALSE(fs::exists(workplace_ / "said"));
}

TEST_F(DrawnByAnother, CommandThatIsMissingSaysWhatToInstall) {
  for (auto const& [command, parts] : std::map<std::string, std::string>{
           {"plot", "[plots]"}, {"show", ""}, {"paper", "[paper]"}, {"jam", "[paper]"}, {"melt", "[paper]"}}) {
    for (std::vector<std::string> const& words :
         {std::vector<std::string>{command}, {command, "--help"}, {"help", command}}) {
      Outcome const outcome = run(words);
      EXPECT_EQ(outcome.exit_code, 2);
      EXPECT_EQ(outcome.err, "error: the program gridlock-" + command +
                                 " is not installed\n  hint: it comes with the Python package: pip install \"." +
                                 parts + "\" in the sources of Gridlock\n");
    }
  }
  std::string const help = run({"--help"}).out;
  EXPECT_NE(help.find("Commands of the Python package:\n  plot  "), std::string::npos) << help;
  EXPECT_NE(run({"plott"}).err.find("did you mean gridlock plot?"), std::string::npos);
}

}  // namespace
