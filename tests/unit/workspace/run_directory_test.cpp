#include "gridlock/workspace/run_directory.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <regex>
#include <span>
#include <string>

#include "checkpoint_header.hpp"
#include "gridlock/core/error.hpp"
#include "gridlock/core/version.hpp"
#include "gridlock/io/h5md.hpp"
#include "io/file.hpp"

namespace {

using namespace gridlock;
namespace fs = std::filesystem;

class Directory {
 public:
  Directory() : path_(fs::temp_directory_path() / ("gridlock-run-" + std::to_string(getpid()))) {
    fs::remove_all(path_);
    fs::create_directories(path_);
  }
  ~Directory() { fs::remove_all(path_); }
  [[nodiscard]] fs::path operator/(char const* name) const { return path_ / name; }

 private:
  fs::path path_;
};

struct Kind {
  char const* name;
  char const* engine;
  GridKind grid;
  Edge edge;
  bool is_mixture;
  AxisEdge edge_y = AxisEdge::same;
};

void PrintTo(Kind const& kind, std::ostream* stream) { *stream << kind.name; }

Configuration configuration_of(Kind const& kind) {
  Configuration configuration;
  configuration.box.edge = kind.edge;
  configuration.box.edge_y = kind.edge_y;
  configuration.disks = {.count = 49, .packing_fraction = 0.55};
  if (kind.is_mixture) {
    configuration.disks.start = StartKind::random;
    configuration.disks.packing_fraction = 0.3;
    configuration.disks.species = {{.fraction = 0.5, .size_ratio = 1.0},
                                   {.fraction = 0.5, .size_ratio = 1.4, .mass = 2.0}};
  }
  configuration.engine.kind = kind.engine;
  configuration.engine.grid = kind.grid;
  configuration.run.steps = 73;
  configuration.observe.every = 5;
  configuration.observe.structure_every = 2;
  return configuration;
}

/// Stops a run after so many chunks of work.
OnProgress stopping_after(int chunks) {
  return [chunks, done = 0](Progress const&) mutable { return ++done < chunks; };
}

void expect_same(RunRecord const& a, RunRecord const& b) {
  EXPECT_EQ(a.status, b.status);
  EXPECT_EQ(a.state_hash, b.state_hash);
  EXPECT_EQ(to_csv(a.series), to_csv(b.series));
  ASSERT_EQ(a.results.size(), b.results.size());
  for (std::size_t k = 0; k < a.results.size(); ++k) {
    EXPECT_EQ(a.results[k].estimate.value, b.results[k].estimate.value) << a.results[k].name;
    EXPECT_EQ(a.results[k].estimate.error, b.results[k].estimate.error) << a.results[k].name;
  }
  ASSERT_EQ(a.counts.size(), b.counts.size());
  for (std::size_t k = 0; k < a.counts.size(); ++k) EXPECT_EQ(a.counts[k].value, b.counts[k].value) << a.counts[k].name;
  ASSERT_EQ(a.distributions.size(), b.distributions.size());
}

class Interrupted : public testing::TestWithParam<Kind> {};

TEST_P(Interrupted, ResumedAfterEveryChunkItEndsWithTheSameBitsAsARunNeverInterrupted) {
  Directory const directory;
  Configuration configuration = configuration_of(GetParam());
  std::uint64_t const every = configuration.observe.every;
  configuration.observe = settings_of_all_observables();
  configuration.observe.every = every;
  configuration.observe.displacement_lag = 4;
  bool const reports_collisions =
      configuration.engine.kind == "exact" && GetParam().edge == Edge::periodic && GetParam().edge_y == AxisEdge::same;
  if (reports_collisions) {
    configuration.observe.viscosity_lag = 3;
    configuration.observe.free_flights = true;
  }
  RunRecord const whole = run_in(directory / "whole", set_up(configuration));
  ASSERT_EQ(whole.status, RunStatus::finished);
  RunRecord record = run_in(directory / "parts", set_up(configuration),
                            {.on_progress = stopping_after(1), .on_event = {}, .threads = {}});
  int interruptions = 0;
  while (record.status == RunStatus::interrupted && ++interruptions < 100) {
    record = resume_in(directory / "parts", {.on_progress = stopping_after(1), .on_event = {}, .threads = {}});
  }
  EXPECT_GE(interruptions, 14);
  expect_same(whole, record);
  std::vector<std::string> names{"series.csv", "final.xyz", "config.resolved.toml"};
  for (Distribution const& curve : whole.distributions) names.push_back(curve.name + ".csv");
  for (std::string const& name : names) {
    EXPECT_EQ(read_file(directory / "whole" / name.c_str()), read_file(directory / "parts" / name.c_str())) << name;
  }
  EXPECT_FALSE(fs::exists(directory / "parts" / "checkpoint.previous.gridlock"));
}

INSTANTIATE_TEST_SUITE_P(
    Kinds, Interrupted,
    testing::Values(Kind{"stepped_linked_walls", "stepped", GridKind::linked, Edge::wall, false},
                    Kind{"stepped_packed_walls", "stepped", GridKind::packed, Edge::wall, false},
                    Kind{"stepped_packed_periodic_mixture", "stepped", GridKind::packed, Edge::periodic, true},
                    Kind{"tiled_periodic", "tiled", GridKind::packed, Edge::periodic, false},
                    Kind{"exact_walls", "exact", GridKind::packed, Edge::wall, false},
                    Kind{"exact_walls_mixture", "exact", GridKind::packed, Edge::wall, true},
                    Kind{"exact_periodic", "exact", GridKind::packed, Edge::periodic, false},
                    Kind{"stepped_channel", "stepped", GridKind::packed, Edge::periodic, true, AxisEdge::wall},
                    Kind{"tiled_channel", "tiled", GridKind::packed, Edge::wall, false, AxisEdge::periodic},
                    Kind{"exact_channel", "exact", GridKind::packed, Edge::periodic, true, AxisEdge::wall}),
    [](auto const& instance) { return std::string(instance.param.name); });

Configuration small() { return configuration_of({"", "stepped", GridKind::packed, Edge::wall, false}); }

std::string refusal(std::function<void()> const& action) {
  try {
    action();
  } catch (Error const& error) {
    return error.what();
  }
  return "";
}

/// An observable of a user that cannot be saved.
class Unsavable final : public AveragingObservable {
 public:
  [[nodiscard]] Requirements requirements(Box const& /*box*/) const override { return {}; }
  void begin(Snapshot const& /*start*/) override { reset({{"unsavable", "", "Cannot be saved."}}); }
  void sample(Snapshot const& /*now*/, std::span<double> row, bool /*counts_for_average*/) override { row[0] = 1.0; }
  void serialize(Archive& archive) override { archive.require(false, "it holds more than a file can"); }
};

TEST(RunDirectory, WritesTheResultsOfARunThatCannotBeSaved) {
  for (bool const is_stopped : {false, true}) {
    Directory const directory;
    Configuration configuration = small();
    configuration.checkpoint.every_steps = 10;
    gridlock::Setup setup = set_up(configuration);
    setup.simulation->observe(std::make_unique<Unsavable>());
    std::size_t warnings = 0;
    RunHooks hooks{.on_event = [&](Event const& event) {
      if (event.kind != EventKind::checkpoint_failed) return;
      ++warnings;
      EXPECT_NE(to_text(event).find("it holds more than a file can"), std::string::npos) << to_text(event);
    }};
    if (is_stopped) hooks.on_progress = stopping_after(3);
    RunRecord const record = run_in(directory / "a", std::move(setup), hooks);
    EXPECT_EQ(record.status, is_stopped ? RunStatus::interrupted : RunStatus::finished);
    EXPECT_GT(warnings, 0U);
    for (char const* name : {"series.csv", "summary.json", "final.xyz"})
      EXPECT_TRUE(fs::exists(directory / "a" / name)) << name;
  }
}

TEST(RunDirectory, OfAFinishedRunIsNotResumed) {
  Directory const directory;
  run_in(directory / "a", set_up(small()));
  EXPECT_NE(refusal([&] { resume_in(directory / "a"); }).find("is finished"), std::string::npos);
}

TEST(RunDirectory, HoldsTheLastStateOnlyWhereTheRunWritesIt) {
  Directory const directory;
  Configuration configuration = small();
  RunRecord const with = run_in(directory / "a", set_up(configuration));
  EXPECT_TRUE(fs::exists(directory / "a" / "final.xyz"));
  configuration.run.final_state = false;
  // In a directory that holds one of the run before.
  RunRecord const without = run_in(directory / "a", set_up(configuration));
  expect_same(with, without);
  EXPECT_FALSE(fs::exists(directory / "a" / "final.xyz"));
  EXPECT_TRUE(fs::exists(directory / "a" / "summary.json"));
  EXPECT_TRUE(fs::exists(directory / "a" / "series.csv"));
}

TEST(RunDirectory, ACheckpointByStepsComesThatManyStepsAfterTheOneBefore) {
  Directory const directory;
  Configuration configuration = small();
  configuration.checkpoint = {.every_seconds = 0.0, .every_steps = 20};
  run_in(directory / "a", set_up(configuration));
  std::string const log = read_file(directory / "a" / "run.log");
  std::string const mark = "checkpoint at step ";
  std::vector<std::string> steps;
  for (std::size_t at = log.find(mark); at != std::string::npos; at = log.find(mark, at + 1)) {
    steps.push_back(log.substr(at + mark.size(), log.find('\n', at) - at - mark.size()));
  }
  EXPECT_EQ(steps, (std::vector<std::string>{"20", "40", "60", "73"})) << log;
}

TEST(RunDirectory, BegunOverOneWithoutAListOfItsFilesIsRefusedOrHoldsNoFramesOfTheOldRun) {
  Directory const directory;
  Configuration configuration = small();
  configuration.trajectory.every = 10;
  run_in(directory / "a", set_up(configuration));
  // As versions left it that kept no such list.
  fs::remove(directory / "a" / ".gridlock.files");
  configuration.run.seed = 2;
  EXPECT_NE(refusal([&] { run_in(directory / "a", set_up(configuration)); }).find("which Gridlock has not written"),
            std::string::npos);
  open_run_directory(directory / "a", set_up(configuration), true);
  RunRecord const record = run_in(directory / "a", set_up(configuration));
  EXPECT_EQ(record.status, RunStatus::finished) << record.failure;
  H5mdReader const trajectory(directory / "a" / "trajectory.h5");
  EXPECT_EQ(trajectory.frame(0).frame.seed, 2U);
  EXPECT_EQ(trajectory.frame_count(), 8U);
}

TEST(RunDirectory, WithoutARunIsRefused) {
  Directory const directory;
  EXPECT_NE(refusal([&] { resume_in(directory / "none"); }).find("holds no run"), std::string::npos);
}

TEST(RunDirectory, ThatAnotherProcessWorksInIsRefused) {
  Directory const directory;
  fs::create_directories(directory / "a");
  DirectoryLock const lock(directory / "a");
  EXPECT_NE(refusal([&] { run_in(directory / "a", set_up(small())); }).find("another process"), std::string::npos);
}

TEST(RunDirectory, RefusesACheckpointOfAnotherConfiguration) {
  Directory const directory;
  OnProgress const stop = [](Progress const&) { return false; };
  run_in(directory / "a", set_up(small()), {.on_progress = stop, .on_event = {}, .threads = {}});
  Configuration other = small();
  other.run.seed = 2;
  run_in(directory / "b", set_up(other), {.on_progress = stop, .on_event = {}, .threads = {}});
  fs::copy(directory / "a" / "checkpoint.gridlock", directory / "b" / "checkpoint.gridlock",
           fs::copy_options::overwrite_existing);
  EXPECT_NE(refusal([&] { resume_in(directory / "b"); }).find("configuration"), std::string::npos);
}

/// The checkpoint of a run as another version with a name of the same length would have written it.
void pretend_version(fs::path const& checkpoint, std::string const& other) {
  std::string content = read_file(checkpoint).substr(32);  // behind the header
  std::size_t const place = content.find(version());
  ASSERT_NE(place, std::string::npos) << "a checkpoint names the version that wrote it";
  write_file(checkpoint, test::with_header(content.replace(place, other.size(), other)));
}

TEST(RunDirectory, ContinuedByAnotherVersionNamesBothAndSaysSo) {
  Directory const directory;
  std::string const other = '9' + std::string(version()).substr(1);
  run_in(directory / "a", set_up(small()), {.on_progress = stopping_after(1), .on_event = {}, .threads = {}});
  pretend_version(directory / "a" / "checkpoint.gridlock", other);
  std::vector<Event> notes;
  RunHooks const hooks{.on_progress = stopping_after(1),
                       .on_event =
                           [&](Event const& event) {
                             if (event.kind == EventKind::version_changed) notes.push_back(event);
                           },
                       .threads = {}};
  resume_in(directory / "a", hooks);
  ASSERT_EQ(notes.size(), 1U);
  EXPECT_EQ(notes.front().severity, Severity::note);
  EXPECT_NE(to_text(notes.front()).find(other), std::string::npos) << to_text(notes.front());
  // Once is enough, and the summary has both at the end.
  while (resume_in(directory / "a", hooks).status == RunStatus::interrupted) {
  }
  EXPECT_EQ(notes.size(), 1U);
  EXPECT_NE(
      read_file(directory / "a" / "summary.json").find(fmt::format("\"gridlock\": \"{}, then {}\"", other, version())),
      std::string::npos);
}

TEST(RunDirectory, OfOneVersionNamesItInItsSummaryAlsoAfterAnInterruption) {
  Directory const directory;
  RunHooks const hooks{.on_progress = stopping_after(1), .on_event = {}, .threads = {}};
  run_in(directory / "a", set_up(small()), hooks);
  while (resume_in(directory / "a", hooks).status == RunStatus::interrupted) {
  }
  EXPECT_NE(read_file(directory / "a" / "summary.json").find(fmt::format("\"gridlock\": \"{}\"", version())),
            std::string::npos);
}

TEST(RunDirectory, KeepsALogOverInterruptions) {
  Directory const directory;
  std::vector<std::string> notes;
  run_in(directory / "a", set_up(small()),
         {.on_progress = stopping_after(2),
          .on_event = [&](Event const& event) { notes.push_back(to_text(event)); },
          .threads = {}});
  resume_in(directory / "a");
  ASSERT_GE(notes.size(), 3U);
  EXPECT_TRUE(notes.front().find("begins") != std::string::npos);
  std::string const log = read_file(directory / "a" / "run.log");
  // At which step the second report comes depends on the time that the first steps take.
  std::smatch step;
  ASSERT_TRUE(std::regex_search(log, step, std::regex("interrupted at step ([0-9]+) "))) << log;
  for (std::string const& word : {std::string("begins"), fmt::format("checkpoint at step {}\n", step[1].str()),
                                  fmt::format("continues from step {} of", step[1].str()), std::string("finished")}) {
    EXPECT_NE(log.find(word), std::string::npos) << word << " in\n" << log;
  }
}

TEST(RunDirectory, NamesTheModelInItsLog) {
  Directory const directory;
  SettingsFile const file =
      SettingsFile::from_text("model.kind = \"epidemic\"\nepidemic.count = 70\nrun.steps = 2\n", "run.toml");
  run_in(directory / "a", set_up(file));
  std::string const log = read_file(directory / "a" / "run.log");
  EXPECT_NE(log.find("model epidemic, 70 agents"), std::string::npos) << log;
  EXPECT_EQ(log.find("stepped"), std::string::npos) << log;
}

std::uint64_t count_of(RunRecord const& record, std::string const& name) {
  auto const found = std::ranges::find(record.counts, name, &Count::name);
  return found == record.counts.end() ? 0 : found->value;
}

TEST(RunDirectory, SaysHowOftenTheExactEngineAuditedItselfOverInterruptions) {
  Directory const directory;
  SettingsFile file = SettingsFile::from_text(
      "disks = { count = 49, packing_fraction = 0.5 }\nengine = { kind = \"exact\", audit_every = 10 }\n"
      "run.steps = 60\nobserve.every = 5\n",
      "run.toml");
  run_in(directory / "a", set_up(file), {.on_progress = stopping_after(3), .on_event = {}, .threads = {}});
  RunRecord const record = resume_in(directory / "a");
  std::uint64_t const audits = count_of(record, "audits");
  EXPECT_GT(audits, 3U);
  EXPECT_EQ(audits, count_of(record, "pair_collisions") / 10);
  EXPECT_EQ(count_of(record, "audits_for_missed_events"), audits);
  std::string const log = read_file(directory / "a" / "run.log");
  EXPECT_NE(log.find(std::to_string(audits) + " audits found no overlap and no missed event"), std::string::npos)
      << log;
  std::string const summary = read_file(directory / "a" / "summary.json");
  EXPECT_NE(summary.find("\"audits\": " + std::to_string(audits)), std::string::npos) << summary;
  EXPECT_EQ(summary.find("halted_fraction"), std::string::npos) << "the exact engine halts no disk";
}

TEST(RunDirectory, SaysWhereAnAuditDoesNotLookForMissedEvents) {
  Directory const directory;
  SettingsFile const file = SettingsFile::from_text(
      "disks = { count = 2500, packing_fraction = 0.5 }\nengine = { kind = \"exact\", audit_every = 1000 }\n"
      "run.steps = 20\nobserve.structure_every = 0\n",
      "run.toml");
  RunRecord const record = run_in(directory / "a", set_up(file));
  EXPECT_GT(count_of(record, "audits"), 0U);
  EXPECT_EQ(count_of(record, "audits_for_missed_events"), 0U);
  std::string const log = read_file(directory / "a" / "run.log");
  EXPECT_NE(log.find("audits found no overlap; for missed events"), std::string::npos) << log;
}

std::vector<std::string> notes_of(std::string const& text) {
  return texts_of({set_up(SettingsFile::from_text(text, "run.toml")).notes});
}

TEST(UnusedSettings, AreNoted) {
  using Notes = std::vector<std::string>;
  EXPECT_EQ(notes_of("engine = { threads = 2, audit_every = 5 }"),
            (Notes{"engine.audit_every has no effect with engine.kind = \"stepped\"",
                   "engine.threads has no effect with engine.kind = \"stepped\""}));
  EXPECT_EQ(notes_of("engine = { kind = \"tiled\", grid = \"linked\", cells = 5, threads = 2 }"),
            (Notes{"engine.cells has no effect with engine.kind = \"tiled\"",
                   "engine.grid has no effect with engine.kind = \"tiled\""}));
  EXPECT_EQ(notes_of("engine = { kind = \"exact\", contact = \"approaching\", substeps = 6, audit_every = 9 }"),
            (Notes{"engine.substeps has no effect with engine.kind = \"exact\"",
                   "engine.contact has no effect with engine.kind = \"exact\""}));
  EXPECT_EQ(notes_of("model.kind = \"epidemic\"\nengine = { kind = \"tiled\", threads = 2 }"),
            Notes{"engine.kind has no effect with model.kind = \"epidemic\""});
  EXPECT_EQ(notes_of("model.verify_every = 3"), Notes{"model.verify_every has no effect with model.kind = \"disks\""});
  EXPECT_EQ(notes_of("engine.cells = 5"), Notes{"engine.cells has no effect with engine.grid = \"packed\""})
      << "the packed grid chooses its own";
  EXPECT_EQ(notes_of("engine = { cells = 5, grid = \"linked\", contact = \"approaching\", substeps = 6 }"), Notes{});
}

TEST(UnusedSettings, OfRunsWithDifferentReasonsHaveNoEffectInAnyRun) {
  auto const notes = [](std::vector<std::string> const& settings) {
    std::vector<std::vector<Event>> runs;
    for (std::string const& of_run : settings) {
      runs.push_back(set_up(SettingsFile::from_text("engine = { cells = 5, " + of_run + " }", "run.toml")).notes);
    }
    return texts_of(runs);
  };
  using Notes = std::vector<std::string>;
  std::string const packed = "kind = \"stepped\"";
  std::string const linked = "kind = \"stepped\", grid = \"linked\"";
  std::string const exact = "kind = \"exact\"";
  EXPECT_EQ(notes({packed, exact}), Notes{"engine.cells has no effect in any run"});
  EXPECT_EQ(notes({exact, exact}), Notes{"engine.cells has no effect with engine.kind = \"exact\""});
  EXPECT_EQ(notes({packed, linked}), Notes{}) << "it has one in the second";
}

TEST(UnusedSettings, OfAResolvedConfigurationAreNotNotedWhereTheyHaveTheirDefaults) {
  for (char const* kind : {"stepped", "tiled", "exact"}) {
    gridlock::Setup const setup =
        set_up(SettingsFile::from_text(std::string("engine.kind = \"") + kind + "\"", "run.toml"));
    EXPECT_TRUE(notes_of(resolved_configuration(setup)).empty()) << kind;
  }
}

TEST(UnusedSettings, StandInTheLogOfTheRun) {
  Directory const directory;
  run_in(directory / "a", set_up(SettingsFile::from_text("engine.threads = 2\nrun.steps = 2", "run.toml")));
  std::string const log = read_file(directory / "a" / "run.log");
  EXPECT_NE(log.find("engine.threads has no effect"), std::string::npos) << log;
}

TEST(SetupEvents, NameExactWhereTheRuleWithATimeStepMisleads) {
  std::string const periodic = "disks.packing_fraction = 0.5\nbox.edge = \"periodic\"\nengine.kind = ";
  for (char const* kind : {"stepped", "tiled"}) {
    auto const notes = notes_of(periodic + "\"" + kind + "\"");
    ASSERT_EQ(notes.size(), 1U) << kind;
    EXPECT_EQ(notes[0], std::string("with engine.kind = \"") + kind +
                            "\" the centre of all disks drifts in a periodic box, because of its time step; \"exact\" "
                            "has none");
  }
  EXPECT_TRUE(notes_of(periodic + "\"exact\"").empty());
  EXPECT_TRUE(notes_of("disks.packing_fraction = 0.72").empty());
  auto const dense = notes_of("disks.packing_fraction = 0.74\nrun.steps = 5");
  ASSERT_EQ(dense.size(), 1U);
  EXPECT_NE(dense[0].find("above a packing fraction of 0.72 (here 0.74)"), std::string::npos) << dense[0];
  auto const both = notes_of("disks.packing_fraction = 0.74\nbox.edge = \"periodic\"\nrun.steps = 5");
  EXPECT_EQ(both.size(), 1U) << "one note on one engine";
}

TEST(SetupEvents, TakeInTheNotesOfAModelOfTheUser) {
  std::string const model = "model.kind = \"colloid_tiled\"\nrun.steps = 5\ncolloid_tiled.disks.packing_fraction = ";
  auto const both = notes_of(model + "0.74\nbox.edge = \"periodic\"");
  ASSERT_EQ(both.size(), 1U);
  EXPECT_EQ(
      both[0],
      "with model.kind = \"colloid_tiled\" the centre of all disks drifts in a periodic box, and displacements can "
      "be wrong by factors above a packing fraction of 0.72 (here 0.74), because of its time step; "
      "engine.kind = \"exact\" has none");
  EXPECT_TRUE(notes_of(model + "0.72").empty());
}

TEST(SetupEvents, TellOfASlowRandomStartThatWasNotTried) {
  // Half a minute of tries; a lattice of the same disks is used instead, and everything else is checked.
  SettingsFile const file =
      SettingsFile::from_text("disks = { count = 100_000, packing_fraction = 0.535, start = \"random\" }", "run.toml");
  double told = 0.0;
  auto const setup = set_up(file, {.on_slow_start = [&](double seconds) {
                              told = seconds;
                              return false;
                            }});
  EXPECT_GT(told, 4.0);
  EXPECT_EQ(setup.simulation->agents(), 100'000U);
  EXPECT_EQ(setup.configuration.disks.start, StartKind::random);
  ASSERT_EQ(setup.notes.size(), 1U);
  EXPECT_EQ(to_text(setup.notes[0]).rfind("the random start was not tried", 0), 0U) << to_text(setup.notes[0]);
}

TEST(SetupEvents, DoNotTellOfARandomStartThatIsSoonFound) {
  SettingsFile const file =
      SettingsFile::from_text("disks = { count = 30_000, packing_fraction = 0.45, start = \"random\" }", "run.toml");
  auto const setup = set_up(file, {.on_slow_start = [](double) {
                              ADD_FAILURE() << "called slow";
                              return false;
                            }});
  EXPECT_TRUE(setup.notes.empty());
  EXPECT_EQ(setup.simulation->state_hash(), set_up(file).simulation->state_hash());
}

TEST(SetupEvents, TellOfFramesThatLieBeyondTheEnd) {
  auto const notes = notes_of("run.steps = 20\ntrajectory = { steps = [5, 20, 21, 500], times = [1e3] }");
  ASSERT_EQ(notes.size(), 2U);
  EXPECT_EQ(notes[0], "2 of 4 in trajectory.steps lie beyond the end of the run at step 20: no frame there");
  EXPECT_NE(notes[1].find("1 of 1 in trajectory.times lies beyond the end of the run at time 0."), std::string::npos)
      << notes[1];
  auto const by_time = notes_of("run.time = 0.01\ntrajectory = { steps = [500], times = [0.01] }");
  ASSERT_EQ(by_time.size(), 1U);
  EXPECT_NE(by_time[0].find("trajectory.steps"), std::string::npos) << by_time[0];
  EXPECT_TRUE(notes_of("run.collisions_per_disk = 3\ntrajectory.steps = [500]").empty()) << "nobody knows";
  EXPECT_EQ(notes_of("model.kind = \"epidemic\"\nrun.steps = 20\ntrajectory.steps = [21]").size(), 1U);
}

TEST(SetupEvents, TellWhereNothingMoves) {
  using Notes = std::vector<std::string>;
  EXPECT_EQ(notes_of("velocities.max = 0"), Notes{"velocities.max is 0: nothing moves"});
}

TEST(SetupEvents, OfSeveralRunsSayHowManyTheyAreOf) {
  auto const note = [](char const* text) {
    return std::vector<Event>{{.kind = EventKind::note_of_model, .key = "model.kind", .values = {{"text", text}}}};
  };
  using Notes = std::vector<std::string>;
  EXPECT_EQ(texts_of({note("a"), {}, note("b")}), Notes{"2 of 3 runs: a"});
  EXPECT_EQ(texts_of({note("a"), note("a")}), Notes{"a"});
  EXPECT_EQ(texts_of({note("a"), note("b")}), Notes{"2 of 2 runs: a"});
}

TEST(SetupEvents, ComeWithTheirLevel) {
  Directory const directory;
  std::vector<std::string> notes;
  run_in(directory / "a",
         set_up(SettingsFile::from_text("disks.count = 9\nvelocities.max = 0\nrun.steps = 2", "run.toml")),
         {.on_progress = {}, .on_event = [&](Event const& event) {
            if (event.severity == Severity::note) notes.push_back(to_text(event));
          }});
  EXPECT_EQ(notes, std::vector<std::string>{"velocities.max is 0: nothing moves"});
}

TEST(RunDirectory, ACheckpointThatIsAPipeIsRefusedAndNotWaitedFor) {
  Directory const directory;
  run_in(directory / "a", set_up(small()), {.on_progress = stopping_after(2), .on_event = {}, .threads = {}});
  fs::remove(directory / "a" / "checkpoint.gridlock");
  ASSERT_EQ(mkfifo((directory / "a" / "checkpoint.gridlock").c_str(), 0600), 0);
  std::string const text = refusal([&] { resume_in(directory / "a"); });
  EXPECT_NE(text.find("checkpoint.gridlock: it is not a regular file"), std::string::npos) << text;
}

TEST(RunDirectory, WhatIsNoFileInThePlaceOfACheckpointIsRefusedUntilItIsRemoved) {
  Directory const directory;
  fs::path const run = directory / "a";
  run_in(run, set_up(small()), {.on_progress = stopping_after(2), .on_event = {}, .threads = {}});
  fs::path const newest = run / "checkpoint.gridlock";
  fs::copy_file(newest, run / "checkpoint.previous.gridlock", fs::copy_options::overwrite_existing);
  fs::remove(newest);
  fs::create_directory(newest);
  auto const expect_refused = [&] {
    std::string const text = refusal([&] { resume_in(run); });
    EXPECT_NE(text.find("checkpoint.gridlock: it is not a regular file"), std::string::npos) << text;
    EXPECT_NE(text.find("the run continues from checkpoint.previous.gridlock"), std::string::npos) << text;
  };
  expect_refused();
  fs::remove(newest);
  fs::create_symlink(directory / "nothing", newest);
  expect_refused();
  fs::remove(newest);
  EXPECT_EQ(resume_in(run).status, RunStatus::finished);
}

TEST(RequireMemory, CountsNoSamplesThatNeverComeWhereAnotherLengthEndsTheRun) {
  std::string const endless = "disks.count = 9\nrun.steps = 9000000000000000000\nobserve.every = 1\n";
  EXPECT_NE(
      refusal([&] { static_cast<void>(set_up(SettingsFile::from_text(endless, "run.toml"))); }).find("a series of"),
      std::string::npos);
  for (char const* length : {"run.collisions_per_disk = 2", "run.time = 1"}) {
    EXPECT_EQ(refusal([&] { static_cast<void>(set_up(SettingsFile::from_text(endless + length, "run.toml"))); }), "");
  }
}

TEST(RunSummary, ReadsBackWhatTheRunWrote) {
  Directory const directory;
  RunRecord const record = run_in(directory / "a", set_up(small()));
  auto const summary = read_summary(directory / "a");
  ASSERT_TRUE(summary);
  EXPECT_EQ(summary->status, RunStatus::finished);
  EXPECT_EQ(summary->state_hash, record.state_hash);
  ASSERT_EQ(summary->results.size(), record.results.size());
  for (std::size_t k = 0; k < record.results.size(); ++k) {
    EXPECT_EQ(summary->results[k].name, record.results[k].name);
    EXPECT_EQ(summary->results[k].estimate.value, record.results[k].estimate.value);
    EXPECT_EQ(summary->results[k].estimate.error, record.results[k].estimate.error);
  }
  EXPECT_FALSE(read_summary(directory / "none"));
  write_file(directory / "a" / "summary.json", "{\"ending\": \"finished\"}");
  EXPECT_NE(refusal([&] { static_cast<void>(read_summary(directory / "a")); }).find("by an earlier version"),
            std::string::npos);
  write_file(directory / "a" / "summary.json", "{\"status\": 3");
  EXPECT_NE(refusal([&] { static_cast<void>(read_summary(directory / "a")); }).find("damaged"), std::string::npos);
}

}  // namespace
