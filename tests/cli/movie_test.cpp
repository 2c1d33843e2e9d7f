// Movies and colours through the program itself.
#include <gtest/gtest.h>

#include <chrono>
#include <cstdio>
#include <string>
#include <thread>
#include <vector>

#include "cli/program.hpp"

namespace {

using namespace gridlock::test;

bool has_ffmpeg() { return std::system("ffmpeg -version >/dev/null 2>&1") == 0; }

/// Sixteen disks, `steps` steps, a frame of every one and of the start.
void run_with_frames(Workplace const& workplace, std::string const& steps) {
  write(workplace / "run.toml",
        "disks.count = 16\ndisks.packing_fraction = 0.3\ntrajectory.every = 1\nrun.steps = " + steps);
  Outcome const outcome = in(workplace, {"run", "run.toml", "-o", "run", "-q"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
}

/// How many frames ffprobe decodes.
int frames_in(fs::path const& movie) {
  std::string const command =
      "ffprobe -v error -count_frames -select_streams v:0 -show_entries stream=nb_read_frames -of csv=p=0 '" +
      movie.string() + "'";
  FILE* const pipe = popen(command.c_str(), "r");
  int frames = -1;
  if (std::fscanf(pipe, "%d", &frames) != 1) frames = -1;
  pclose(pipe);
  return frames;
}

void expect_refusal(Outcome const& outcome, std::vector<std::string> const& words) {
  EXPECT_EQ(outcome.exit_code, 2) << outcome.err;
  for (std::string const& word : words)
    EXPECT_NE(outcome.err.find(word), std::string::npos) << word << "\n" << outcome.err;
}

/// Waits until a file of the movie in the making lies in the directory.
void wait_for_part(fs::path const& directory) {
  for (int tries = 0; tries < 2000; ++tries) {
    for (std::string const& name : contents(directory)) {
      if (name.ends_with(".part")) return;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  FAIL() << "no movie was begun";
}

TEST(Movie, ShowsOneOfEverySoManyFrames) {
  if (!has_ffmpeg()) GTEST_SKIP() << "ffmpeg is not installed: ./dev install";
  Workplace const workplace;
  run_with_frames(workplace, "7");
  for (auto const& [every, frames] : {std::pair{"1", 8}, {"2", 4}, {"3", 3}, {"7", 2}, {"50", 1}}) {
    Outcome const outcome = in(workplace, {"movie", "run", "--width", "101", "--every", every});
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_EQ(frames_in(workplace / "run/trajectory.mp4"), frames) << every;
  }
}

TEST(Movie, WithoutFfmpegNamesTheCommandThatGetsIt) {
  Workplace const workplace;
  run_with_frames(workplace, "3");
  Outcome const outcome =
      Process("/usr/bin/env", {"PATH=/nowhere", GRIDLOCK_PROGRAM, "movie", "run", "--width", "101"}, workplace.path())
          .wait();
  expect_refusal(outcome, {"ffmpeg", "is not installed", "apt-get install ffmpeg"});
  EXPECT_FALSE(fs::exists(workplace / "run/trajectory.mp4"));
}

TEST(Movie, IsMadeInEveryFormatItOffers) {
  if (!has_ffmpeg()) GTEST_SKIP() << "ffmpeg is not installed: ./dev install";
  Workplace const workplace;
  run_with_frames(workplace, "3");
  for (std::string const name : {"a.mp4", "b.MP4", "a.gif", "a.webm", "a.mov", "a.mkv"}) {
    Outcome const outcome = in(workplace, {"movie", "run", "--width", "101", "-o", name});
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_EQ(outcome.out, name + "\n");
    EXPECT_EQ(frames_in(workplace / name), 4) << name;
  }
}

TEST(Movie, RefusesWhatItCannotWriteAndLeavesNothing) {
  Workplace const workplace;
  run_with_frames(workplace, "3");
  auto const before = contents(workplace.path());
  expect_refusal(in(workplace, {"movie", "run", "-o", "x.png"}), {".png", ".mp4, .gif, .webm"});
  expect_refusal(in(workplace, {"movie", "run", "-o", "x"}), {"which kind", ".mp4, .gif, .webm"});
  expect_refusal(in(workplace, {"movie", "run", "-o", "nowhere/x.mp4"}), {"no directory nowhere", "mkdir -p nowhere"});
  for (std::string const place : {"run", "run/", "nowhere/"}) {
    expect_refusal(in(workplace, {"movie", "run", "-o", place}), {place + " is the name of a directory", "/movie.mp4"});
  }
  expect_refusal(in(workplace, {"movie", "run", "-o", "x.gif", "--rate", "60"}), {"60", "50", "--rate"});
  expect_refusal(in(workplace, {"movie", "run", "--colour", "smell"}), {"smell", "displacement, psi6", "image_x"});
  expect_refusal(in(workplace, {"movie", "run", "--width", "8"}), {"8 pixels"});
  for (std::vector<std::string> const& verb :
       {std::vector<std::string>{"movie", "run"}, {"export", "run", "--to", "csv"}}) {
    std::vector<std::string> words = verb;
    words.insert(words.end(), {"--every", "0"});
    Outcome const outcome = in(workplace, words);
    expect_refusal(outcome, {"--every", "at least 1"});
    EXPECT_LT(outcome.err.size(), 200U) << outcome.err;
  }
  EXPECT_EQ(contents(workplace.path()), before);
  EXPECT_FALSE(fs::exists(workplace / "run/trajectory.mp4"));
}

TEST(Movie, OfARunThatKeptNoFramesSaysHowToKeepSome) {
  Workplace const workplace;
  write(workplace / "run.toml", "disks.count = 16\nrun.steps = 3\n");
  ASSERT_EQ(in(workplace, {"run", "run.toml", "-o", "run", "-q"}).exit_code, 0);
  for (std::vector<std::string> const& words :
       {std::vector<std::string>{"movie", "run"}, {"export", "run", "--to", "csv"}}) {
    expect_refusal(in(workplace, words), {"the run in run kept no frames", "trajectory.every"});
  }
}

TEST(Movie, ReplacesNoResultThroughALinkAndItsOwnFormerOneAnyTime) {
  if (!has_ffmpeg()) GTEST_SKIP() << "ffmpeg is not installed: ./dev install";
  Workplace const workplace;
  run_with_frames(workplace, "3");
  for (std::string const name : {"final.xyz", "trajectory.h5"}) {
    std::string const before = text_of(workplace / "run" / name);
    fs::path const link = workplace / (name + ".mp4");
    fs::create_symlink(fs::path("run") / name, link);
    expect_refusal(in(workplace, {"movie", "run", "-o", link.string()}), {name, "hint: name another file"});
    EXPECT_EQ(text_of(workplace / "run" / name) == before, true) << name;
  }
  fs::create_symlink("run/trajectory.mp4", workplace / "latest.mp4");
  for (std::vector<std::string> const& place : {std::vector<std::string>{}, {}, {"-o", "latest.mp4"}}) {
    std::vector<std::string> words{"movie", "run", "--width", "101"};
    words.insert(words.end(), place.begin(), place.end());
    Outcome const outcome = in(workplace, words);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  }
  EXPECT_TRUE(fs::is_symlink(workplace / "latest.mp4"));
}

TEST(Movie, LeavesADirectoryOfTheUserAlone) {
  if (!has_ffmpeg()) GTEST_SKIP() << "ffmpeg is not installed: ./dev install";
  Workplace const workplace;
  run_with_frames(workplace, "3");
  fs::path const mine = workplace / "run/trajectory.mp4.frames";
  fs::create_directory(mine);
  write(mine / "notes.txt", "mine");
  write(mine / "0000004.png", "mine");
  EXPECT_EQ(in(workplace, {"movie", "run", "--width", "101"}).exit_code, 0);
  EXPECT_EQ(contents(mine), (std::vector<std::string>{"0000004.png", "notes.txt"}));
  EXPECT_EQ(frames_in(workplace / "run/trajectory.mp4"), 4);
}

TEST(Movie, AfterAKilledOneHasItsOwnFramesAlone) {
  if (!has_ffmpeg()) GTEST_SKIP() << "ffmpeg is not installed: ./dev install";
  Workplace const workplace;
  run_with_frames(workplace, "60");
  Process const killed(GRIDLOCK_PROGRAM, {"movie", "run", "--width", "1500"}, workplace.path());
  wait_for_part(workplace / "run");
  std::this_thread::sleep_for(std::chrono::milliseconds(200));
  killed.signal(SIGKILL);
  EXPECT_NE(killed.wait().exit_code, 0);
  EXPECT_FALSE(fs::exists(workplace / "run/trajectory.mp4"));
  EXPECT_EQ(in(workplace, {"movie", "run", "--every", "30", "--width", "101"}).exit_code, 0);
  EXPECT_EQ(frames_in(workplace / "run/trajectory.mp4"), 3);
}

TEST(Movie, MadeTwiceAtOnceIntoOneFileIsOneOfTheTwo) {
  if (!has_ffmpeg()) GTEST_SKIP() << "ffmpeg is not installed: ./dev install";
  Workplace const workplace;
  run_with_frames(workplace, "20");
  Process const all(GRIDLOCK_PROGRAM, {"movie", "run", "--width", "300"}, workplace.path());
  Process const few(GRIDLOCK_PROGRAM, {"movie", "run", "--width", "300", "--every", "4"}, workplace.path());
  EXPECT_EQ(all.wait().exit_code, 0);
  EXPECT_EQ(few.wait().exit_code, 0);
  int const frames = frames_in(workplace / "run/trajectory.mp4");
  EXPECT_TRUE(frames == 21 || frames == 6) << frames;
}

TEST(Movie, StoppedByCtrlCLeavesNothing) {
  if (!has_ffmpeg()) GTEST_SKIP() << "ffmpeg is not installed: ./dev install";
  Workplace const workplace;
  run_with_frames(workplace, "60");
  auto const before = contents(workplace / "run");
  Process const movie(GRIDLOCK_PROGRAM, {"movie", "run", "--width", "2000"}, workplace.path());
  wait_for_part(workplace / "run");
  movie.signal(SIGINT);
  Outcome const outcome = movie.wait();
  EXPECT_EQ(outcome.exit_code, 1) << outcome.err;
  EXPECT_NE(outcome.err.find("interrupted: run/trajectory.mp4 was not written"), std::string::npos) << outcome.err;
  EXPECT_EQ(contents(workplace / "run"), before);
}

TEST(Movie, ThatFfmpegCannotMakeSaysSoInOneSentence) {
  Workplace const workplace;
  run_with_frames(workplace, "3");
  auto const before = contents(workplace / "run");
  fs::create_directory(workplace / "bin");
  write(workplace / "bin/ffmpeg",
        "#!/bin/sh\necho 'a first word' >&2\necho '[mp4 @ 0x5581] No room\tleft' >&2\necho 'Conversion failed!' "
        ">&2\nexit 1\n");
  fs::permissions(workplace / "bin/ffmpeg", fs::perms::owner_all);
  Outcome const outcome =
      Process("/bin/sh", {"-c", "PATH=$PWD/bin:$PATH exec \"$0\" movie run", GRIDLOCK_PROGRAM}, workplace.path())
          .wait();
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_EQ(outcome.err, "error: ffmpeg made no movie: No room\tleft\n");
  EXPECT_EQ(contents(workplace / "run"), before);
}

TEST(Colour, MayBeSpeltTheAmericanWay) {
  if (!has_ffmpeg()) GTEST_SKIP() << "ffmpeg is not installed: ./dev install";
  Workplace const workplace;
  run_with_frames(workplace, "2");
  for (char const* colour : {"psi6", "neighborhood"}) {
    EXPECT_EQ(in(workplace, {"movie", "run", "--color", colour, "--width", "101"}).exit_code, 0) << colour;
  }
}

TEST(Colour, ThatTheAgentsDoNotHaveIsRefusedBeforeAnythingIsDrawn) {
  Workplace const workplace;
  run_with_frames(workplace, "2");
  write(workplace / "walkers.toml",
        "model.kind = \"epidemic\"\nepidemic.count = 20\nrun.steps = 2\ntrajectory.every = 1\n");
  ASSERT_EQ(in(workplace, {"run", "walkers.toml", "-o", "walkers", "-q"}).exit_code, 0);
  for (auto const& [directory, colour] : {std::pair{"run", "velocity_x"}, {"walkers", "health"}}) {
    auto const before = contents(workplace / directory);
    Outcome const outcome = in(workplace, {"movie", directory, "--colour", "smell"});
    expect_refusal(outcome, {"smell", "displacement, psi6", colour});
    EXPECT_EQ(outcome.err.find("smell"), outcome.err.rfind("smell")) << "twice:\n" << outcome.err;
    EXPECT_EQ(contents(workplace / directory), before);
  }
}

}  // namespace
