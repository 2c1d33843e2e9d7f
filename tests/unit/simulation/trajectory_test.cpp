#include "simulation/trajectory.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <filesystem>
#include <limits>
#include <string>
#include <vector>

#include "gridlock/core/error.hpp"
#include "gridlock/workspace/run_directory.hpp"
#include "io/file.hpp"
#include "unit/io/temporary_directory.hpp"

namespace gridlock {
namespace {

std::vector<std::uint64_t> steps_of(TrajectorySettings const& settings, std::uint64_t end, double time_step = 0.25) {
  FrameSchedule const schedule(settings, time_step);
  std::vector<std::uint64_t> steps;
  for (std::uint64_t step = 0; step <= end; step = schedule.next_after(step)) {
    EXPECT_TRUE(schedule.is_due(step));
    steps.push_back(step);
  }
  return steps;
}

using Steps = std::vector<std::uint64_t>;

TEST(FrameSchedule, HasTheStartAndEveryMultiple) { EXPECT_EQ(steps_of({.every = 40}, 130), (Steps{0, 40, 80, 120})); }

TEST(FrameSchedule, IsEvenInTheLogarithmOfTheSteps) {
  EXPECT_EQ(steps_of({.per_decade = 3}, 1000), (Steps{0, 1, 2, 5, 10, 22, 46, 100, 215, 464, 1000}));
}

TEST(FrameSchedule, BeginsAnewAtEveryOrigin) {
  EXPECT_EQ(steps_of({.per_decade = 2, .origin_every = 20}, 45), (Steps{0, 1, 3, 10, 20, 21, 23, 30, 40, 41, 43}));
  EXPECT_EQ(steps_of({.every = 15, .per_decade = 1, .origin_every = 20, .steps = {2}}, 31),
            (Steps{0, 1, 2, 10, 15, 20, 21, 30}));
  EXPECT_EQ(steps_of({.per_decade = 1, .origin_every = 1}, 3), (Steps{0, 1, 2, 3}));
}

TEST(FrameSchedule, ATimeIsTheFirstStepThatReachesIt) {
  EXPECT_EQ(steps_of({.times = {1.0, 1.1, 0.7 + 0.1 + 0.2}}, 100), (Steps{0, 4, 5}));
}

TEST(FrameSchedule, UnitesAllThatIsAskedFor) {
  TrajectorySettings const settings{.every = 10, .per_decade = 1, .steps = {7, 10, 3}, .times = {2.0}};
  EXPECT_EQ(steps_of(settings, 20), (Steps{0, 1, 3, 7, 8, 10, 20}));
  EXPECT_FALSE(FrameSchedule(settings, 0.25).is_due(2));
  EXPECT_EQ(FrameSchedule({.steps = {3}}, 1.0).next_after(3), std::numeric_limits<std::uint64_t>::max());
}

TEST(FrameSchedule, RefusesWhatIsNoStepOrTime) {
  EXPECT_THROW(FrameSchedule({.steps = {1.5}}, 1.0), Error);
  EXPECT_THROW(FrameSchedule({.steps = {-1.0}}, 1.0), Error);
  EXPECT_THROW(FrameSchedule({.times = {-0.5}}, 1.0), Error);
  EXPECT_THROW(FrameSchedule({.every = 5, .origin_every = 20}, 1.0), Error) << "there is nothing to begin anew";
}

TEST(Trajectory, HoldsOnlyTheColumnsAskedForAndRefusesOthers) {
  State const nobody;
  std::unique_ptr<FrameSource> const all = frame_source_of(nobody);
  std::unique_ptr<FrameSource> const chosen = with_columns(*all, " radius  x ");
  ASSERT_EQ(chosen->columns().size(), 2U);
  EXPECT_EQ(chosen->columns()[0].name, "x");
  EXPECT_EQ(chosen->columns()[1].name, "radius");
  EXPECT_EQ(with_columns(*all, "all")->columns(), frame_of(nobody).columns);
  EXPECT_THROW(with_columns(*all, "x colour"), Error);
}

Setup setup_with_frames(TrajectorySettings const& trajectory = {.every = 10}) {
  Configuration configuration;
  configuration.disks = {.count = 25, .packing_fraction = 0.5};
  configuration.run.steps = 60;
  configuration.observe.every = 20;
  configuration.trajectory = trajectory;
  return set_up(configuration);
}

TEST(Trajectory, OfARunHasItsFramesItsHashesAndTheValuesOfItsSamples) {
  TemporaryDirectory const directory;
  RunRecord const record = run_in(directory.path(), setup_with_frames());
  ASSERT_EQ(record.status, RunStatus::finished) << record.failure;
  H5mdReader const reader(directory / "trajectory.h5");
  ASSERT_EQ(reader.frame_count(), 7U);
  EXPECT_EQ(reader.clocks()[3].step, 30U);
  EXPECT_EQ(reader.frame(6).state_hash, record.state_hash);
  std::vector<double> const energies = record.series.numbers(reader.settings().observables[0].name);
  EXPECT_EQ(reader.frame(4).observables[0], energies[2]);
  EXPECT_NE(reader.frame(3).observables[0], reader.frame(3).observables[0]) << "no sample was taken there";
}

TEST(Trajectory, HasWhatTheModelCallsTheNumbersOfAColumn) {
  TemporaryDirectory const directory;
  Configuration configuration;
  configuration.model.kind = "epidemic";
  configuration.run.steps = 2;
  configuration.trajectory.every = 1;
  run_in(directory / "all", set_up(configuration));
  std::vector<std::string> const names{"susceptible", "infected", "recovered"};
  EXPECT_EQ(H5mdReader(directory / "all/trajectory.h5").settings().value_names.at("health"), names);
  EXPECT_NE(read_file(directory / "all/summary.json").find("\"recovered\""), std::string::npos);
  configuration.trajectory.columns = "x y";
  run_in(directory / "some", set_up(configuration));
  EXPECT_TRUE(H5mdReader(directory / "some/trajectory.h5").settings().value_names.empty());
}

void expect_same_frames_after_an_interruption(TrajectorySettings const& trajectory, std::size_t frames) {
  TemporaryDirectory const whole;
  TemporaryDirectory const parts;
  run_in(whole.path(), setup_with_frames(trajectory));
  run_in(parts.path(), setup_with_frames(trajectory),
         {.on_progress = [](Progress const& p) { return p.steps < 25; }, .on_event = {}, .threads = {}});
  // As after a kill that lost the newest checkpoint: the file is ahead of the run.
  for (auto const& entry : std::filesystem::directory_iterator(parts.path())) {
    if (entry.path().filename().string().find("checkpoint") != std::string::npos) std::filesystem::remove(entry.path());
  }
  ASSERT_EQ(resume_in(parts.path()).status, RunStatus::finished);
  H5mdReader const a(whole / "trajectory.h5");
  H5mdReader const b(parts / "trajectory.h5");
  ASSERT_EQ(a.frame_count(), frames);
  ASSERT_EQ(b.frame_count(), frames);
  for (std::size_t k = 0; k < frames; ++k) EXPECT_EQ(a.frame(k).frame, b.frame(k).frame);
}

TEST(Trajectory, OfARunThatWasInterruptedIsTheSame) {
  expect_same_frames_after_an_interruption({.every = 10}, 7);
  expect_same_frames_after_an_interruption({.per_decade = 2, .origin_every = 20}, 13);
}

TEST(Trajectory, OfAnotherRunIsNotContinued) {
  TemporaryDirectory const directory;
  Configuration configuration = setup_with_frames().configuration;
  run_in(directory.path(), set_up(configuration),
         {.on_progress = [](Progress const&) { return false; }, .on_event = {}, .threads = {}});
  TemporaryDirectory const other;
  configuration.run.seed = 2;
  run_in(other.path(), set_up(configuration),
         {.on_progress = [](Progress const&) { return false; }, .on_event = {}, .threads = {}});
  std::filesystem::copy_file(other / "trajectory.h5", directory / "trajectory.h5",
                             std::filesystem::copy_options::overwrite_existing);
  for (auto const& entry : std::filesystem::directory_iterator(directory.path())) {
    if (entry.path().filename().string().find("checkpoint") != std::string::npos) std::filesystem::remove(entry.path());
  }
  EXPECT_EQ(resume_in(directory.path()).status, RunStatus::failed);
}

/// A run that was interrupted after step 25, with frames of the steps 0, 10 and 20.
void leave_half_a_run(std::filesystem::path const& directory) {
  OnProgress const stop = [](Progress const& p) { return p.steps < 25; };
  run_in(directory, setup_with_frames(), {.on_progress = stop, .on_event = {}, .threads = {}});
}

std::string refusal_to_resume(std::filesystem::path const& directory) {
  try {
    resume_in(directory);
  } catch (Error const& error) {
    return error.what();
  }
  return "";
}

TEST(Trajectory, ThatWasRemovedIsMissedByTheRunThatIsResumed) {
  TemporaryDirectory const directory;
  leave_half_a_run(directory.path());
  std::filesystem::remove(directory / "trajectory.h5");
  std::string const summary = read_file(directory / "summary.json");
  std::string const text = refusal_to_resume(directory.path());
  EXPECT_NE(text.find("trajectory.h5 is missing"), std::string::npos) << text;
  EXPECT_EQ(text.find("remove the file"), std::string::npos) << text;
  EXPECT_FALSE(std::filesystem::exists(directory / "trajectory.h5"));
  EXPECT_EQ(read_file(directory / "summary.json"), summary);
}

TEST(Trajectory, ThatLacksFramesOrWasCutOffIsRefusedBeforeTheRunIsResumed) {
  TemporaryDirectory const directory;
  leave_half_a_run(directory.path());
  TemporaryDirectory const shorter;
  run_in(shorter.path(), setup_with_frames(),
         {.on_progress = [](Progress const& p) { return p.steps < 5; }, .on_event = {}, .threads = {}});
  std::filesystem::copy(directory / "trajectory.h5", directory / "whole.h5");
  auto const replace_by = [&](std::filesystem::path const& file) {
    std::filesystem::copy(file, directory / "trajectory.h5", std::filesystem::copy_options::overwrite_existing);
  };
  replace_by(shorter / "trajectory.h5");
  std::string const lacking = refusal_to_resume(directory.path());
  EXPECT_NE(lacking.find("lacks frames: the last is of step 0, and the run has written one of step 10"),
            std::string::npos)
      << lacking;
  write_file(directory / "cut.h5", read_file(directory / "whole.h5").substr(0, 3000));
  replace_by(directory / "cut.h5");
  std::string const cut = refusal_to_resume(directory.path());
  EXPECT_NE(cut.find("it is cut off: 3000 of its"), std::string::npos) << cut;
  EXPECT_EQ(cut.find("remove the file"), std::string::npos) << cut;
  EXPECT_NE(cut.find("hint: put the whole file back"), std::string::npos) << cut;
  EXPECT_EQ(read_file(directory / "trajectory.h5"), read_file(directory / "cut.h5"));
  replace_by(directory / "whole.h5");
  EXPECT_EQ(resume_in(directory.path()).status, RunStatus::finished);
}

TEST(Trajectory, OfAnotherRunIsRefusedBeforeTheRunIsResumed) {
  TemporaryDirectory const directory;
  leave_half_a_run(directory.path());
  TemporaryDirectory const other;
  Configuration configuration = setup_with_frames().configuration;
  configuration.run.seed += 1;
  run_in(other.path(), set_up(configuration));
  std::filesystem::copy(other / "trajectory.h5", directory / "trajectory.h5",
                        std::filesystem::copy_options::overwrite_existing);
  std::string const log = read_file(directory / "run.log");
  std::string const refusal = refusal_to_resume(directory.path());
  EXPECT_NE(refusal.find("is of another run: run.seed is"), std::string::npos) << refusal;
  EXPECT_EQ(read_file(directory / "run.log"), log);
  EXPECT_EQ(read_file(directory / "trajectory.h5"), read_file(other / "trajectory.h5"));
}

}  // namespace
}  // namespace gridlock
