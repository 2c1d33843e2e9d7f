// `gridlock verify` replays a run, compares its record, and names each change since.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <sstream>
#include <string>
#include <vector>

#include "cli/program.hpp"
#include "gridlock/core/target.hpp"
#include "gridlock/io/h5md.hpp"

namespace {

using namespace gridlock::test;

char const* const with_states =
    "disks = { count = 64, packing_fraction = 0.5 }\nrun.steps = 1000\nobserve.every = 20\n"
    "checkpoint.keep_states = 4\ntrajectory.every = 250\n";

/// Makes a run in "out" of the workplace, without output.
void make_run(Workplace const& workplace, std::string const& settings, std::vector<std::string> const& words = {}) {
  write(workplace / "a.toml", settings);
  std::vector<std::string> all{"run", "a.toml", "--no-pictures", "-q"};
  all.insert(all.end(), words.begin(), words.end());
  if (std::find(words.begin(), words.end(), "-o") == words.end()) all.insert(all.end(), {"-o", "out"});
  expect_good(in(workplace, all));
}

void expect_words(Outcome const& outcome, int exit_code, std::string const& words) {
  EXPECT_EQ(outcome.exit_code, exit_code) << outcome.out << outcome.err;
  EXPECT_NE((outcome.out + outcome.err).find(words), std::string::npos) << words << "\n" << outcome.out << outcome.err;
}

void flip_bit(fs::path const& file, std::size_t place) {
  std::string bytes = text_of(file);
  ASSERT_LT(place, bytes.size());
  bytes[place] = static_cast<char>(bytes[place] ^ 1);
  write(file, bytes);
}

void replace(fs::path const& file, std::string const& old, std::string const& present) {
  std::string text = text_of(file);
  std::size_t const place = text.find(old);
  ASSERT_NE(place, std::string::npos) << old;
  write(file, text.replace(place, old.size(), present));
}

TEST(Verify, AcceptsARunOfEveryEngineAndModelAndProtocolWholeAndInWindows) {
  for (std::string const kind :
       {"engine.kind = \"stepped\"\ndisks.count = 36\n", "engine.kind = \"tiled\"\ndisks.count = 64\n",
        "engine.kind = \"exact\"\ndisks.count = 36\n",
        "engine.kind = \"soft\"\npotential.kind = \"harmonic\"\nbox.edge = \"periodic\"\ndisks.count = 36\n",
        "engine.kind = \"exact\"\nengine.time_step = 0.01\nthermostat.kind = \"brownian\"\ndisks.count = 36\n",
        "engine.kind = \"event_chain\"\nbox.edge = \"periodic\"\ndisks.count = 36\n",
        "model.kind = \"flocking\"\nflocking.count = 50\n",
        "model.kind = \"epidemic\"\nepidemic.count = 50\nepidemic.turnover_rate = 0.1\n",
        "model.kind = \"predation\"\n",
        "disks.count = 36\nbox.edge = \"periodic\"\nprotocol = [{ stage = \"event_chain\", sweeps = 20, chains = "
        "\"newtonian\" }]\nengine = { kind = \"event_chain\", chains = \"newtonian\" }\n",
        "disks.count = 36\nbox.edge = \"periodic\"\nprotocol = [{ stage = \"grow\", until_packing_fraction = 0.6 "
        "}]\nengine.kind = \"exact\"\n"}) {
    Workplace const workplace;
    make_run(workplace,
             kind + "run.steps = 450\nobserve.every = 50\ncheckpoint.keep_states = 3\ntrajectory.every = 200\n");
    expect_words(in(workplace, {"verify", "out"}), 0, "verified: out: steps 0 to 450: ");
    expect_words(in(workplace, {"verify", "out", "--windows", "2", "-j", "2"}), 0, "verified: out: 2 windows with ");
  }
}

TEST(Verify, AcceptsARunOfOtherThreadsAndInstructions) {
  Workplace const workplace;
  setenv("GRIDLOCK_TARGET", "scalar", 1);
  make_run(workplace, std::string(with_states) + "engine.kind = \"tiled\"\n", {"-j", "3"});
  unsetenv("GRIDLOCK_TARGET");
  Outcome const verified = in(workplace, {"verify", "out", "-j", "1"});
  expect_words(verified, 0, "12 hashes, 4 kept states, 5 frames, 6 files of results agree bit for bit");
  expect_words(verified, 0, "with " + std::string(to_text(gridlock::target())) + " by gridlock ");
  expect_words(verified, 0, "; recorded with scalar by ");
}

TEST(Verify, AcceptsSamplesEvenInTheLogarithmWholeAndInWindows) {
  Workplace const workplace;
  make_run(workplace,
           "disks.count = 16\nrun.steps = 2000\nobserve = { every = 1, per_decade = 5 }\ncheckpoint.keep_states = 3\n"
           "trajectory.steps = [40, 100, 1000]\n");
  // 0; 1, 2, 3, 4, 6; 10, 16, 25, 40, 63; 100 …; 1000, 1585; and the end.
  Outcome const info = in(workplace, {"info", "out/series.csv"});
  expect_words(info, 0, "a table of 19 rows");
  expect_words(in(workplace, {"verify", "out"}), 0, "verified: out: steps 0 to 2000: ");
  expect_words(in(workplace, {"verify", "out", "--windows", "1"}), 0, "verified: out: 1 window with ");
}

TEST(Verify, AcceptsAPackingStageByStage) {
  Workplace const workplace;
  make_run(workplace,
           "disks = { count = 20, packing_fraction = 0.4, start = \"random\" }\nbox.edge = \"periodic\"\n"
           "protocol = [{ stage = \"quench\", packing_fraction = 0.9 }, { stage = \"decompress\", until_pressure = "
           "1e-3 }]\n");
  expect_words(in(workplace, {"verify", "out"}), 0,
               "the start and the stages of its protocol: 5 hashes, 6 files of results agree");
  expect_words(in(workplace, {"verify", "out", "--windows", "1"}), 2, "has kept no states, so only the whole run");
  replace(workplace / "out/config.resolved.toml", "packing_fraction = 0.9", "packing_fraction = 0.91");
  expect_words(in(workplace, {"verify", "out"}), 2, "packing_fraction");
}

TEST(Verify, FindsAFlippedBitInTheChainInAKeptStateAndInAFrame) {
  Workplace const workplace;
  make_run(workplace, std::string(with_states) + "trajectory.compression = 0\n");
  std::string const chain = text_of(workplace / "out/hashes.csv");
  flip_bit(workplace / "out/hashes.csv", chain.find("\"run\",300,\"") + 11);
  expect_words(in(workplace, {"verify", "out", "--windows", "1"}), 1,
               "\"run\" of step 300, of hashes.csv was changed since the run");
  write(workplace / "out/hashes.csv", chain.substr(0, chain.rfind('\n', chain.size() - 2) + 1));
  expect_words(in(workplace, {"verify", "out"}), 1, "summary.json says that the run has finished: lines are missing");
  write(workplace / "out/hashes.csv", chain);

  fs::path const state = workplace / "out/states/000000000400/checkpoint.gridlock";
  ASSERT_TRUE(fs::exists(state));
  std::string const bytes = text_of(state);
  flip_bit(state, bytes.size() / 2);
  for (std::vector<std::string> const& words :
       {std::vector<std::string>{"verify", "out"}, {"verify", "out", "--windows", "4"}}) {
    expect_words(in(workplace, words), 1, "the kept state of step 400: ");
  }
  write(state, bytes);

  fs::path const trajectory = workplace / "out/trajectory.h5";
  gridlock::H5mdFrame const frame = gridlock::H5mdReader(trajectory).frame(2);
  double const x = std::get<std::vector<double>>(frame.frame.find("x")->values)[7];
  std::string const number(reinterpret_cast<char const*>(&x), sizeof x);
  std::string const file = text_of(trajectory);
  std::size_t const place = file.find(number);
  if (place != std::string::npos) {
    flip_bit(trajectory, place);
  } else {  // bytes are shuffled
    flip_bit(trajectory, file.size() / 2);
  }
  expect_words(in(workplace, {"verify", "out"}), 1, "of trajectory.h5, of step ");
}

/// Writes trajectory.h5 anew, with its frames as `change` leaves them; of `frames` frames at most.
void rewrite_frames(fs::path const& file, std::size_t frames,
                    std::function<void(std::size_t, gridlock::H5mdFrame&)> const& change,
                    std::function<void(std::string& configuration)> const& change_settings = {}) {
  fs::path const other = file.string() + ".other";
  {
    gridlock::H5mdReader const reader(file);
    gridlock::H5mdSettings settings = reader.settings();
    if (change_settings) change_settings(settings.configuration);
    auto writer = gridlock::H5mdWriter::create(other, settings, reader.frame(0).frame);
    for (std::size_t k = 0; k < std::min(frames, reader.frame_count()); ++k) {
      gridlock::H5mdFrame frame = reader.frame(k);
      change(k, frame);
      writer.write(frame);
    }
  }
  fs::rename(other, file);
}

TEST(Verify, FindsAMissingLastFrameAndAnotherBoxOrObservableOfAFrame) {
  Workplace const workplace;
  make_run(workplace, with_states);
  fs::path const trajectory = workplace / "out/trajectory.h5";
  std::string const bytes = text_of(trajectory);
  rewrite_frames(trajectory, 9, [](std::size_t, gridlock::H5mdFrame&) {});
  expect_words(in(workplace, {"verify", "out"}), 0, "5 frames, ");
  rewrite_frames(trajectory, 4, [](std::size_t, gridlock::H5mdFrame&) {});
  expect_words(in(workplace, {"verify", "out"}), 1, "trajectory.h5 has no frame of step 1000");
  write(trajectory, bytes);
  rewrite_frames(trajectory, 9, [](std::size_t k, gridlock::H5mdFrame& frame) {
    if (k == 2) frame.frame.box = gridlock::Box(1.0, 1.0 + 1e-15, gridlock::Edge::wall);
  });
  expect_words(in(workplace, {"verify", "out"}), 1, "frame 2 of trajectory.h5, of step 500, has another box");
  write(trajectory, bytes);
  rewrite_frames(trajectory, 9, [](std::size_t k, gridlock::H5mdFrame& frame) {
    if (k == 2) frame.observables.front() = std::nextafter(frame.observables.front(), 1.0);
  });
  Outcome const found = in(workplace, {"verify", "out"});
  expect_words(found, 1, "frame 2 of trajectory.h5, of step 500, has mean_displacement = ");
  // In a window too, since a kept state holds what observables remember.
  expect_words(in(workplace, {"verify", "out", "--windows", "4"}), 1, "of step 500, has mean_displacement = ");
}

TEST(Verify, FindsAnotherCopyOfTheSettingsInTheTrajectoryByTheSetting) {
  Workplace const workplace;
  make_run(workplace, with_states);
  rewrite_frames(
      workplace / "out/trajectory.h5", 9, [](std::size_t, gridlock::H5mdFrame&) {},
      [](std::string& configuration) {
        std::string const radius = "packing_fraction = 0.5";
        configuration.replace(configuration.find(radius), radius.size(), "packing_fraction = 0.6");
      });
  for (std::vector<std::string> const& words :
       {std::vector<std::string>{"verify", "out"}, {"verify", "out", "--windows", "1"}}) {
    expect_words(
        in(workplace, words), 1,
        "the settings differ: disks.packing_fraction is 0.6 in trajectory.h5, and 0.5 in config.resolved.toml");
  }
}

TEST(Verify, NamesAFileThatWasEmptied) {
  Workplace const workplace;
  make_run(workplace, with_states);
  std::string const trajectory = text_of(workplace / "out/trajectory.h5");
  write(workplace / "out/trajectory.h5", "");
  expect_words(in(workplace, {"verify", "out"}), 2, "cannot read out/trajectory.h5: it is empty");
  expect_words(in(workplace, {"info", "out/trajectory.h5"}), 2, "out/trajectory.h5 is empty");
  write(workplace / "out/trajectory.h5", trajectory);
  write(workplace / "out/final.xyz", "");
  expect_words(in(workplace, {"verify", "out"}), 1, "final.xyz is empty");
}

TEST(Verify, FindsAnEditedResultByItsFileAndPlace) {
  Workplace const workplace;
  make_run(workplace, "disks.count = 36\nrun.steps = 200\n");
  struct Edit {
    std::string file, old, present, words;
  };
  for (Edit const& edit :
       {Edit{"final.xyz", ".", ".1", "final.xyz, line 2, has "},
        Edit{"series.csv", "\n100,", "\n101,", "step = 101 in row 2"},
        Edit{"pair_correlation.csv", "distance", "length", "pair_correlation.csv has no column distance"},
        Edit{"summary.json", "\"pair_collisions\": ", "\"pair_collisions\": 1",
             "summary.json has counters/pair_collisions = 1"},
        Edit{"summary.json", "\"mean_speed\": {", "\"mean_speeds\": {",
             "has mean_speed/value = nothing, where the replay has"}}) {
    fs::path const file = workplace / "out" / edit.file;
    std::string const text = text_of(file);
    replace(file, edit.old, edit.present);
    expect_words(in(workplace, {"verify", "out"}), 1, edit.words);
    write(file, text);
  }
  fs::remove(workplace / "out/final.xyz");
  expect_words(in(workplace, {"verify", "out"}), 0, ", 5 files of results agree");
}

TEST(Verify, RefusesChangedSettingsAnotherSeedAndAnEditedStartByName) {
  Workplace const workplace;
  make_run(workplace, with_states);
  replace(workplace / "out/config.resolved.toml", "seed = 1\n", "seed = 2\n");
  expect_words(in(workplace, {"verify", "out"}), 2, "config.resolved.toml was changed since the run: run.seed 1 → 2");
  replace(workplace / "out/config.resolved.toml", "seed = 2\n", "seed = 1\n");
  replace(workplace / "out/config.resolved.toml", "steps = 1000\n", "steps = 900\n");
  expect_words(in(workplace, {"verify", "out"}), 2, "run.steps 1000 → 900");
  make_run(workplace, "disks.file = \"out/final.xyz\"\nrun.steps = 100\n", {"-o", "onward"});
  expect_words(in(workplace, {"verify", "onward"}), 0, "verified: onward: steps 1000 to 1100");
  replace(workplace / "onward/start.xyz", "0.9", "0.8");
  Outcome const refused = in(workplace, {"verify", "onward"});
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_NE(refused.err.find("start.xyz"), std::string::npos) << refused.err;
}

TEST(Verify, NamesWhatAnEditedSummaryLacks) {
  Workplace const workplace;
  make_run(workplace, "disks.count = 4\nrun.steps = 100\n");
  std::string const summary = text_of(workplace / "out/summary.json");
  for (std::vector<std::string> const& change : std::vector<std::vector<std::string>>{
           {"\"timing\"", "\"time\"", "it has no timing"},
           {"\"seconds\"", "\"minutes\"", "it has no timing.seconds"},
           {"\"gridlock\": \"", "\"gridlock\": 1, \"a\": \"", "gridlock = 1 is not"},
           {"\"state_hash\": \"", "\"state_hash\": \"x", "is not what a run writes"}}) {
    write(workplace / "out/summary.json", summary);
    replace(workplace / "out/summary.json", change[0], change[1]);
    expect_words(in(workplace, {"verify", "out"}), 2, "summary.json is damaged: ");
    expect_words(in(workplace, {"verify", "out"}), 2, change[2]);
  }
}

TEST(Verify, TakesARunThatWasKilledUpToItsLastHashAndContinuedToItsEnd) {
  Workplace const workplace;
  write(workplace / "a.toml", std::string(with_states) + "checkpoint.every_steps = 200\n");
  std::string const long_run = "run.steps=100_000_000";
  Process const process(GRIDLOCK_PROGRAM, {"run", "a.toml", "-o", "out", "--no-pictures", "-q", "--set", long_run},
                        workplace.path());
  wait_for(workplace / "out/checkpoint.previous.gridlock");
  expect_words(in(workplace, {"verify", "out"}), 2, "a process works on the run in out");
  process.signal(SIGKILL);
  process.wait();
  replace(workplace / "out/config.resolved.toml", "steps = 100000000\n", "steps = 99999999\n");
  expect_words(in(workplace, {"verify", "out"}), 2, "run.steps 100000000 → 99999999");
  replace(workplace / "out/config.resolved.toml", "steps = 99999999\n", "steps = 100000000\n");
  expect_words(in(workplace, {"verify", "out"}), 0, ", as far as the unfinished run is recorded: ");
}

TEST(Verify, AcceptsARunThatWasKilledAndContinuedAndThenLengthened) {
  Workplace const workplace;
  write(workplace / "a.toml", std::string(with_states) + "checkpoint.every_steps = 200\n");
  Process const process(GRIDLOCK_PROGRAM,
                        {"run", "a.toml", "-o", "out", "--no-pictures", "-q", "--set", "run.steps=40_000"},
                        workplace.path());
  wait_for(workplace / "out/checkpoint.gridlock");
  process.signal(SIGKILL);
  process.wait();
  expect_good(in(workplace, {"resume", "out", "--steps", "41000", "--no-pictures", "-q"}));
  expect_words(in(workplace, {"verify", "out"}), 0, "verified: out: steps 0 to 41000: ");
  expect_words(in(workplace, {"verify", "out", "--windows", "2", "--window-steps", "1000"}), 0, "2 windows with ");
}

TEST(Verify, SaysOfASweepHowManyOfItsRunsAgree) {
  Workplace const workplace;
  write(workplace / "sweep.toml", "disks.count = 25\nrun.steps = 200\n[sweep]\nrun.seed = [1, 2, 3]\n");
  expect_good(in(workplace, {"sweep", "sweep.toml", "-o", "out", "-q"}));
  expect_words(in(workplace, {"verify", "out"}), 0, "3 of 3 runs verified; 0 different, 0 cannot be verified");
  fs::rename(workplace / "out/runs/seed=1", workplace / "taken_away");
  expect_words(in(workplace, {"verify", "out"}), 2, "2 of 3 runs verified; 0 different, 1 cannot be verified");
  fs::rename(workplace / "taken_away", workplace / "out/runs/seed=1");
  fs::remove(workplace / "out/runs/seed=2/hashes.csv");
  expect_words(in(workplace, {"verify", "out"}), 2, "2 of 3 runs verified; 0 different, 1 cannot be verified");
  replace(workplace / "out/runs/seed=3/hashes.csv", "\"end\"", "\"run\"");
  expect_words(in(workplace, {"verify", "out"}), 1, "1 of 3 runs verified; 1 different, 1 cannot be verified");
}

TEST(Verify, OfAStudyNamesTheRowsThatCannotBeReadAsSuch) {
  Workplace const workplace;
  make_run(workplace, "disks.count = 4\nrun.steps = 10\n");
  std::string const summary = text_of(workplace / "out/summary.json");
  std::string const name = "\"state_hash\": \"";
  std::string const hash = summary.substr(summary.find(name) + name.size(), 16);
  std::string const good = R"("{""disks"": {""count"": 4}, ""run"": {""steps"": 10}}",")" + hash + "\"\n";
  auto const verify = [&](std::string const& rows) {
    write(workplace / "study/runs.csv", "settings,state_hash\n" + rows);
    return in(workplace, {"verify", "study"});
  };
  fs::create_directory(workplace / "study");
  expect_words(verify(good + good), 0, "verified: study: 2 of the 2 runs in runs.csv were made again: 2 agree");
  Outcome const unreadable = verify(good + "\"{oops\",\"" + hash + "\"\n" + R"("{""disk"": 4}",")" + hash + "\"\n" +
                                    R"("{""disks"": {""count"": 4}}","x")" + "\n");
  expect_words(unreadable, 2, "cannot be verified: study: row 2 of runs.csv: its settings are no object");
  expect_words(unreadable, 2, "cannot be verified: study: row 3 of runs.csv: ");
  expect_words(unreadable, 2, "cannot be verified: study: row 4 of runs.csv: \"x\" is no state hash");
  expect_words(unreadable, 2,
               "cannot be verified: study: 1 of the 4 runs in runs.csv were made again, 3 cannot be: 1 agree");
  expect_words(verify(R"("{""disks"": {""count"": 4}, ""run"": {""steps"": 11}}",")" + hash + "\"\n"), 1,
               "differs: study: row 1 of runs.csv: the last state hash is ");
}

TEST(Verify, OfALongRunComparesNoMoreThan200HashesAlongItWhichAreEvenlySpread) {
  Workplace const workplace;
  make_run(workplace, "disks.count = 4\nrun.steps = 45_000\n");
  std::vector<std::uint64_t> steps;
  std::istringstream lines(text_of(workplace / "out/hashes.csv"));
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with("\"run\",")) steps.push_back(std::stoull(line.substr(6)));
  }
  // Every hundredth step at first, then every second of them, and every second again.
  ASSERT_EQ(steps.size(), 112U);
  for (std::size_t k = 0; k < steps.size(); ++k) EXPECT_EQ(steps[k], 400 * (k + 1));
  expect_words(in(workplace, {"verify", "out"}), 0, "steps 0 to 45000: 114 hashes, ");
}

TEST(Verify, GivesALinkWithWhichThePageMakesTheRun) {
  Workplace const workplace;
  make_run(workplace, "disks.count = 4\nrun.steps = 100\n");
  expect_words(in(workplace, {"verify", "out", "--link"}), 0, ": playground.html#toml=");
}

TEST(Verify, RefusesWhatIsNoRunAndADamagedChain) {
  Workplace const workplace;
  write(workplace / "a.txt", "no run");
  fs::create_directory(workplace / "empty");
  expect_words(in(workplace, {"verify", "missing"}), 2, "there is no directory missing");
  expect_words(in(workplace, {"verify", "a.txt"}), 2, "a.txt is not a directory");
  expect_words(in(workplace, {"verify", "empty"}), 2, "empty holds no run");
  make_run(workplace, "disks.count = 36\nrun.steps = 100\n");
  std::string const chain = text_of(workplace / "out/hashes.csv");
  for (std::string const& damaged :
       {std::string(), std::string("of,step\n1,2\n"), chain.substr(0, chain.find('\n') + 1)}) {
    write(workplace / "out/hashes.csv", damaged);
    expect_words(in(workplace, {"verify", "out"}), 2, "hashes.csv");
  }
  fs::remove(workplace / "out/hashes.csv");
  expect_words(in(workplace, {"verify", "out"}), 2, "has recorded no hashes");
}

}  // namespace
