// A run that is made longer after its end is the run that was that long from its start.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <functional>
#include <ostream>
#include <string>
#include <vector>

#include "gridlock/core/error.hpp"
#include "gridlock/io/h5md.hpp"
#include "gridlock/io/table.hpp"
#include "gridlock/workspace/run_directory.hpp"
#include "io/file.hpp"
#include "unit/io/temporary_directory.hpp"

namespace gridlock {
namespace {

namespace fs = std::filesystem;

struct Kind {
  char const* name;
  char const* toml;  ///< without a length
};

void PrintTo(Kind const& kind, std::ostream* stream) { *stream << kind.name; }

/// The end of 47 steps is no multiple of anything here but of one frame.
constexpr char const* sampling =
    "[observe]\nevery = 5\nstructure_every = 2\nvelocity_origin_every = 4\n"
    "[trajectory]\nevery = 20\nsteps = [47]\n";

SettingsFile settings_of(Kind const& kind, std::string const& length) {
  return SettingsFile::from_text(std::string(kind.toml) + length + "\n" + sampling, "run.toml");
}

OnProgress stopping_after(int chunks) {
  return [chunks, done = 0](Progress const&) mutable { return ++done < chunks; };
}

/// What the first sample that counts for averages begins: the first origin of the correlation, the measurements of
/// structure.
bool depends_on_equilibration(std::string const& column) {
  return column == "velocity_autocorrelation" || column.ends_with("_bond_orientation_order");
}

enum class Equilibration { same, other };

void expect_same_frames(fs::path const& a, fs::path const& b, Equilibration equilibration = Equilibration::same) {
  H5mdReader const frames(a / "trajectory.h5");
  H5mdReader const same(b / "trajectory.h5");
  ASSERT_EQ(frames.frame_count(), same.frame_count());
  for (std::size_t k = 0; k < frames.frame_count(); ++k) {
    H5mdFrame const one = frames.frame(k);
    H5mdFrame const two = same.frame(k);
    EXPECT_EQ(one.frame, two.frame) << "frame " << k;
    EXPECT_EQ(one.state_hash, two.state_hash) << "frame " << k;
    for (std::size_t o = 0; o < one.observables.size(); ++o) {
      std::string const& name = frames.settings().observables[o].name;
      if (equilibration == Equilibration::other && depends_on_equilibration(name)) continue;
      EXPECT_EQ(word_of(one.observables[o]), word_of(two.observables[o])) << "frame " << k << ", " << name;
    }
  }
}

void expect_same_series(fs::path const& a, fs::path const& b, Equilibration equilibration) {
  Table const one = read_csv(a / "series.csv");
  Table const two = read_csv(b / "series.csv");
  ASSERT_EQ(one.names(), two.names());
  for (std::string const& name : one.names()) {
    if (equilibration == Equilibration::other && depends_on_equilibration(name)) continue;
    EXPECT_TRUE(std::ranges::equal(one.numbers(name), two.numbers(name), {}, word_of<double>, word_of<double>)) << name;
  }
}

/// Every file of results of `a` is in `b` with the same bytes, the summary but for its times.
void expect_same_results(fs::path const& a, fs::path const& b) {
  int files = 0;
  for (auto const& entry : fs::directory_iterator(a)) {
    std::string const name = entry.path().filename().string();
    if (!name.ends_with(".csv") && !name.ends_with(".xyz") && !name.ends_with(".toml")) continue;
    EXPECT_EQ(read_file(entry.path()), read_file(b / name)) << name;
    ++files;
  }
  EXPECT_GE(files, 3);
  auto const results = read_summary(a)->results;
  auto const same = read_summary(b)->results;
  ASSERT_EQ(results.size(), same.size());
  for (std::size_t k = 0; k < results.size(); ++k) {
    EXPECT_EQ(results[k].estimate.value, same[k].estimate.value) << results[k].name;
    EXPECT_EQ(results[k].estimate.error, same[k].estimate.error) << results[k].name;
  }
  EXPECT_EQ(read_summary(a)->state_hash, read_summary(b)->state_hash);
  expect_same_frames(a, b);
}

/// The run of the configuration that a directory holds now, made at one go.
void run_at_one_go(fs::path const& of, fs::path const& into) {
  ASSERT_EQ(run_in(into, set_up(SettingsFile::from_path(of / "config.resolved.toml"))).status, RunStatus::finished);
}

class Lengthened : public testing::TestWithParam<Kind> {};

TEST_P(Lengthened, EndsWithTheBitsOfARunThatWasThatLongFromItsStart) {
  TemporaryDirectory const directory;
  run_in(directory / "parts", set_up(settings_of(GetParam(), "[run]\nsteps = 47")));
  EXPECT_EQ(lengthen_in(directory / "parts", {.steps = 110}).status, RunStatus::finished);
  EXPECT_EQ(lengthen_in(directory / "parts", {.steps = 203}).status, RunStatus::finished);
  run_at_one_go(directory / "parts", directory / "whole");
  expect_same_results(directory / "whole", directory / "parts");
  // With the share that the short run left out of averages, all but these and what begins with them.
  run_in(directory / "long", set_up(settings_of(GetParam(), "[run]\nsteps = 203")));
  EXPECT_EQ(read_file(directory / "long" / "final.xyz"), read_file(directory / "parts" / "final.xyz"));
  expect_same_series(directory / "long", directory / "parts", Equilibration::other);
  expect_same_frames(directory / "long", directory / "parts", Equilibration::other);
}

TEST_P(Lengthened, WithoutSamplesLeftOutHasTheAveragesOfTheLongRunToo) {
  TemporaryDirectory const directory;
  auto const settings = [](std::string const& length) {
    SettingsFile file = settings_of(GetParam(), length);
    file.set("observe.equilibration=0");
    return file;
  };
  run_in(directory / "parts", set_up(settings("[run]\nsteps = 47")));
  lengthen_in(directory / "parts", {.steps = 110});
  run_in(directory / "long", set_up(settings("[run]\nsteps = 110")));
  expect_same_results(directory / "long", directory / "parts");
}

TEST_P(Lengthened, AndInterruptedAllTheTimeItEndsWithTheSameBits) {
  TemporaryDirectory const directory;
  run_in(directory / "parts", set_up(settings_of(GetParam(), "[run]\nsteps = 47")));
  RunStatus status = lengthen_in(directory / "parts", {.steps = 110},
                                 {.on_progress = stopping_after(1), .on_event = {}, .threads = {}})
                         .status;
  int interruptions = 0;
  for (; status == RunStatus::interrupted && interruptions < 100; ++interruptions) {
    status = resume_in(directory / "parts", {.on_progress = stopping_after(1), .on_event = {}, .threads = {}}).status;
  }
  EXPECT_GT(interruptions, 5);
  run_at_one_go(directory / "parts", directory / "whole");
  expect_same_results(directory / "whole", directory / "parts");
}

TEST_P(Lengthened, AndKilledBetweenAnyTwoOfItsFilesItResumesToOneOfTheTwoLengths) {
  TemporaryDirectory const directory;
  run_in(directory / "short", set_up(settings_of(GetParam(), "[run]\nsteps = 47")));
  fs::copy(directory / "short", directory / "long");
  lengthen_in(directory / "long", {.steps = 110});
  // Before the configuration was written.
  fs::copy(directory / "short", directory / "first");
  fs::remove(directory / "first" / "summary.json");
  EXPECT_EQ(resume_in(directory / "first").status, RunStatus::finished);
  expect_same_results(directory / "short", directory / "first");
  // After that, before the first checkpoint.
  fs::copy(directory / "short", directory / "second");
  fs::remove(directory / "second" / "summary.json");
  fs::copy(directory / "long" / "config.resolved.toml", directory / "second" / "config.resolved.toml",
           fs::copy_options::overwrite_existing);
  EXPECT_EQ(resume_in(directory / "second").status, RunStatus::finished);
  expect_same_results(directory / "long", directory / "second");
  // The same command again.
  fs::copy(directory / "short", directory / "third");
  fs::remove(directory / "third" / "summary.json");
  EXPECT_EQ(lengthen_in(directory / "third", {.steps = 110}).status, RunStatus::finished);
  expect_same_results(directory / "long", directory / "third");
}

INSTANTIATE_TEST_SUITE_P(
    Kinds, Lengthened,
    testing::Values(Kind{"stepped", "[disks]\ncount = 49\npacking_fraction = 0.55\n"},
                    Kind{"tiled", "[disks]\ncount = 49\npacking_fraction = 0.55\n[engine]\nkind = \"tiled\"\n"},
                    Kind{"exact",
                         "[disks]\ncount = 49\npacking_fraction = 0.55\n[box]\nedge = \"periodic\"\n"
                         "[engine]\nkind = \"exact\"\n"},
                    Kind{"model",
                         "[model]\nkind = \"epidemic\"\n[epidemic]\ncount = 200\nturnover_rate = 0.5\n"
                         "infection_rate = 0.9\nradius = 0.1\n"},
                    Kind{"events", "[model]\nkind = \"catalyst\"\n[catalyst]\nhop_rate = 20.0\n"}),
    [](auto const& instance) { return std::string(instance.param.name); });

Kind const exact{"exact", "[disks]\ncount = 49\npacking_fraction = 0.55\n[engine]\nkind = \"exact\"\n"};

TEST(LengthenedExact, GoesOnFromTheMiddleOfAStepWhereATimeOrACollisionEndedIt) {
  for (char const* length : {"[run]\ntime = 0.4321", "[run]\ncollisions_per_disk = 7"}) {
    TemporaryDirectory const directory;
    run_in(directory / "parts", set_up(settings_of(exact, length)));
    EXPECT_EQ(lengthen_in(directory / "parts", {.time = 0.61}).status, RunStatus::finished);
    EXPECT_EQ(lengthen_in(directory / "parts", {.collisions_per_disk = 60.0}).status, RunStatus::finished);
    run_at_one_go(directory / "parts", directory / "whole");
    expect_same_results(directory / "whole", directory / "parts");
  }
}

TEST(LengthenedExact, FromAStartFileCountsItsLengthFromItsOwnStart) {
  TemporaryDirectory const directory;
  run_in(directory / "first", set_up(settings_of(exact, "[run]\nsteps = 30")));
  std::string const start = "[disks]\nfile = \"" + (directory / "first" / "final.xyz").string() + "\"\n";
  Kind const continued{"continued", start.c_str()};
  run_in(directory / "parts", set_up(settings_of(continued, "[run]\nsteps = 47")));
  RunRecord const record = lengthen_in(directory / "parts", {.steps = 90});
  EXPECT_EQ(record.steps, 90U);
  EXPECT_EQ(record.clock.step, 120U);
  run_at_one_go(directory / "parts", directory / "whole");
  expect_same_results(directory / "whole", directory / "parts");
}

std::string refusal(std::function<void()> const& action) {
  try {
    action();
  } catch (Error const& error) {
    return error.what();
  }
  return "";
}

TEST(Lengthening, OfARunThatWasInterruptedGoesOnToTheNewLength) {
  TemporaryDirectory const directory;
  run_in(directory / "parts", set_up(settings_of(exact, "[run]\nsteps = 47")),
         {.on_progress = stopping_after(1), .on_event = {}, .threads = {}});
  EXPECT_EQ(lengthen_in(directory / "parts", {.steps = 110}).steps, 110U);
  // Nothing was averaged yet, so the share left out is that of a run so long.
  run_in(directory / "long", set_up(settings_of(exact, "[run]\nsteps = 110")));
  expect_same_results(directory / "long", directory / "parts");
}

TEST(Lengthening, SaysWhichShareOfTheNewLengthIsLeftOutOfAverages) {
  TemporaryDirectory const directory;
  run_in(directory / "a", set_up(settings_of(exact, "[run]\nsteps = 50")));
  std::vector<std::string> notes;
  lengthen_in(directory / "a", {.steps = 200}, {.on_progress = {}, .on_event = [&](Event const& event) {
                                                  if (event.severity == Severity::note) notes.push_back(to_text(event));
                                                }});
  // Of 50 steps a fifth were left out, up to step 10: a twentieth of 200.
  EXPECT_NE(read_file(directory / "a" / "config.resolved.toml").find("equilibration = 0.05\n"), std::string::npos);
  ASSERT_EQ(notes.size(), 1U);
  EXPECT_EQ(notes[0].find("observe.equilibration is 0.05 of the new length"), 0U) << notes[0];
}

TEST(Lengthening, ToNoMoreThanThereIsIsRefusedAndChangesNothing) {
  TemporaryDirectory const directory;
  run_in(directory / "a", set_up(settings_of(exact, "[run]\nsteps = 47")));
  std::string const summary = read_file(directory / "a" / "summary.json");
  std::string const log = read_file(directory / "a" / "run.log");
  std::string const shorter = refusal([&] { lengthen_in(directory / "a", {.steps = 46}); });
  EXPECT_NE(shorter.find("has a length of 47 steps already, which 46 steps is below"), std::string::npos) << shorter;
  std::string const equal = refusal([&] { lengthen_in(directory / "a", {.steps = 47}); });
  EXPECT_NE(equal.find("has come to step 47"), std::string::npos) << equal;
  std::string const passed = refusal([&] { lengthen_in(directory / "a", {.time = 1e-3}); });
  EXPECT_NE(passed.find("has come to step 47"), std::string::npos) << passed;
  EXPECT_NE(refusal([&] { lengthen_in(directory / "a", {.time = -1.0}); }).find("--time"), std::string::npos);
  EXPECT_EQ(read_file(directory / "a" / "summary.json"), summary);
  EXPECT_EQ(read_file(directory / "a" / "run.log"), log);
}

TEST(Lengthening, BeyondWhatCanBeCountedIsRefusedAndChangesNothing) {
  TemporaryDirectory const directory;
  run_in(directory / "a", set_up(settings_of(exact, "[run]\nsteps = 47")));
  std::string const summary = read_file(directory / "a" / "summary.json");
  std::string const time = refusal([&] { lengthen_in(directory / "a", {.time = 1e300}); });
  EXPECT_NE(time.find("no run reaches time 1e+300"), std::string::npos) << time;
  std::string const collisions = refusal([&] { lengthen_in(directory / "a", {.collisions_per_disk = 1e300}); });
  EXPECT_NE(collisions.find("no run reaches 1e+300 collisions per disk"), std::string::npos) << collisions;
  Kind const model{"model", "[model]\nkind = \"epidemic\"\n[epidemic]\ncount = 20\n"};
  run_in(directory / "b", set_up(settings_of(model, "[run]\nsteps = 20")));
  std::string const of_model = refusal([&] { lengthen_in(directory / "b", {.time = 1e300}); });
  EXPECT_NE(of_model.find("no run reaches time 1e+300"), std::string::npos) << of_model;
  EXPECT_EQ(read_file(directory / "a" / "summary.json"), summary);
  EXPECT_TRUE(read_summary(directory / "b"));
}

TEST(Lengthening, OfAModelInCollisionsIsRefused) {
  TemporaryDirectory const directory;
  Kind const model{"model", "[model]\nkind = \"epidemic\"\n[epidemic]\ncount = 20\n"};
  run_in(directory / "a", set_up(settings_of(model, "[run]\nsteps = 20")));
  std::string const text = refusal([&] { lengthen_in(directory / "a", {.collisions_per_disk = 5.0}); });
  EXPECT_NE(text.find("--collisions-per-disk"), std::string::npos) << text;
  EXPECT_TRUE(read_summary(directory / "a"));
}

TEST(Lengthening, NeedsTheLastCheckpoint) {
  TemporaryDirectory const directory;
  SettingsFile file = settings_of(exact, "[run]\nsteps = 47");
  run_in(directory / "kept", set_up(file));
  EXPECT_TRUE(fs::exists(directory / "kept" / "checkpoint.gridlock"));
  EXPECT_FALSE(fs::exists(directory / "kept" / "checkpoint.previous.gridlock"));
  std::string const finished = refusal([&] { resume_in(directory / "kept"); });
  EXPECT_NE(finished.find("--steps N lengthens it"), std::string::npos) << finished;
  file.set("checkpoint.keep_last=false");
  run_in(directory / "none", set_up(file));
  EXPECT_FALSE(fs::exists(directory / "none" / "checkpoint.gridlock"));
  std::string const text = refusal([&] { lengthen_in(directory / "none", {.steps = 100}); });
  EXPECT_NE(text.find("kept no checkpoint"), std::string::npos) << text;
}

}  // namespace
}  // namespace gridlock
