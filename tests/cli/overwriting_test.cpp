#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <ostream>
#include <string>
#include <vector>

#include "program.hpp"

namespace gridlock::test {
namespace {

constexpr char const* mine = "a file of the user\n";
constexpr char const* packing =
    "3\nLattice=\"3 0 0 0 2 0 0 0 1\" Properties=species:S:1:pos:R:3:radius:R:1 pbc=\"T T F\" note=\"mine\"\n"
    "A 0.25 0.25 0 0.2501\nA 0.75 0.25 0 0.2501\nA 1.25 0.75 0 0.25\n";
constexpr char const* settings_with_frames =
    "disks = { count = 9, packing_fraction = 0.3 }\nrun.steps = 20\ntrajectory.every = 10\n"
    "observe = { every = 2, structure_every = 1 }\n";
constexpr char const* protocol =
    "disks = { count = 12 }\nbox.edge = \"periodic\"\nrun.steps = 0\n"
    "protocol = [{ stage = \"quench\", packing_fraction = 0.9 }, { stage = \"decompress\", until_pressure = 1e-4 }]\n";

/// A command, and the names of its results in the directory where it works.
struct Writing {
  std::string name;
  std::vector<std::string> words;
  std::vector<std::string> results;
  std::string needs;  ///< a program without which the command makes nothing

  friend std::ostream& operator<<(std::ostream& stream, Writing const& writing) { return stream << writing.name; }
};

std::vector<std::string> in_folder(std::string const& folder, std::vector<std::string> names) {
  for (std::string& name : names) name.insert(0, folder + "/");
  return names;
}

/// A run, a sweep in two shards, and settings and a packing beside them.
void furnish(Workplace const& workplace) {
  write(workplace / "run.toml", settings_with_frames);
  write(workplace / "protocol.toml", protocol);
  write(workplace / "sweep.toml", std::string(settings_with_frames) + "[sweep]\nrun.seed = [1, 2]\n");
  write(workplace / "packing.xyz", packing);
  fs::create_directory(workplace / "d");
}

void make_results(Workplace const& workplace) {
  ASSERT_EQ(in(workplace, {"run", "run.toml", "-o", "made", "-q", "--no-pictures"}).exit_code, 0);
  for (char const* shard : {"1/2", "2/2"}) {
    std::string const folder = std::string("part") + shard[0];
    ASSERT_EQ(in(workplace, {"sweep", "sweep.toml", "-o", folder, "-q", "--shard", shard, "--no-pictures"}).exit_code,
              0);
  }
}

std::vector<std::string> const of_run{"config.resolved.toml",
                                      "run.log",
                                      "checkpoint.gridlock",
                                      "trajectory.h5",
                                      "series.csv",
                                      "hashes.csv",
                                      "pair_correlation.csv",
                                      "start.xyz",
                                      "trajectory.h5.part",
                                      "speed_distribution.csv",
                                      "checkpoint.previous.gridlock",
                                      "final.xyz",
                                      "summary.json"};

std::vector<Writing> writings() {
  std::vector<std::string> const in_run = in_folder("d/runs/seed=2", of_run);
  std::vector<Writing> all{
      {"run", {"run", "run.toml", "-o", "d", "-q", "--no-pictures"}, in_folder("d", of_run), ""},
      {"protocol",
       {"run", "protocol.toml", "-o", "d", "-q", "--no-pictures"},
       in_folder("d", {"stages.csv", "levels.csv", "contacts.csv", "final.xyz"}),
       ""},
      {"sweep",
       {"sweep", "sweep.toml", "-o", "d", "-q", "--no-pictures"},
       {"d/plan.json", "d/sweep.csv", "d/means.csv"},
       ""},
      {"run_of_sweep", {"sweep", "sweep.toml", "-o", "d", "-q", "--no-pictures"}, in_run, ""},
      {"collect", {"collect", "part1", "part2", "-o", "d"}, {"d/plan.json", "d/sweep.csv", "d/means.csv"}, ""},
      {"run_collected", {"collect", "part1", "part2", "-o", "d"}, in_run, ""},
      {"contacts",
       {"contacts", "packing.xyz", "-o", "d", "--no-pictures"},
       in_folder("d",
                 {"contacts.csv", "gaps.csv", "forces.csv", "spectral_density.csv", "packing.xyz", "summary.json"}),
       ""},
      {"export_to_xyz", {"export", "made", "--to", "xyz", "-o", "mine.xyz"}, {"mine.xyz"}, ""},
      {"export_beside_the_run", {"export", "made", "--to", "csv"}, {"made/trajectory.csv"}, ""},
      {"export_to_vtk", {"export", "made", "--to", "vtk", "-o", "d/x.pvd"}, {"d/x.pvd", "d/x/step_0000000010.vtp"}, ""},
      {"movie", {"movie", "made", "-o", "mine.gif", "--width", "64", "-q"}, {"mine.gif"}, "ffmpeg"},
      {"movie_beside_the_run", {"movie", "made", "--width", "64", "-q"}, {"made/trajectory.mp4"}, "ffmpeg"}};
  return all;
}

class Overwriting : public testing::TestWithParam<Writing> {
 protected:
  void SetUp() override {
    std::string const& needed = GetParam().needs;
    if (!needed.empty() && std::system((needed + " -version >/dev/null 2>&1").c_str()) != 0) {
      GTEST_SKIP() << needed << " is not installed";
    }
    furnish(workplace_);
    make_results(workplace_);
  }

  void put(std::string const& file) const {
    fs::create_directories((workplace_ / file).parent_path());
    write(workplace_ / file, mine);
  }

  Workplace const workplace_;
};

TEST_P(Overwriting, NeedsTheUsersWord) {
  for (std::string const& file : GetParam().results) {
    put(file);
    Outcome const refused = in(workplace_, GetParam().words);
    EXPECT_EQ(refused.exit_code, 2) << file << refused.err;
    EXPECT_NE(refused.err.find("--overwrite"), std::string::npos) << file << refused.err;
    EXPECT_EQ(text_of(workplace_ / file), mine) << file;
    fs::remove(workplace_ / file);
  }
}

TEST_P(Overwriting, ReplacesWithItTheFilesInTheWayAndNoOthers) {
  std::vector<std::string> words = GetParam().words;
  words.emplace_back("--overwrite");
  for (std::string const& file : GetParam().results) put(file);
  put("d/notes.txt");
  put("made/notes.txt");
  expect_good(in(workplace_, words));
  for (std::string const& file : GetParam().results) {
    // A run has some names to itself that it does not write this time.
    EXPECT_NE(text_of(workplace_ / file), mine) << file;
  }
  for (char const* file : {"d/notes.txt", "made/notes.txt"}) EXPECT_EQ(text_of(workplace_ / file), mine) << file;
  if (!GetParam().name.starts_with("export")) return;
  expect_good(in(workplace_, words));
}

INSTANTIATE_TEST_SUITE_P(Every, Overwriting, testing::ValuesIn(writings()),
                         [](auto const& one) { return one.param.name; });

/// Runs a command twice, the second time told to overwrite, and expects the file that it reads to stay.
void expect_kept(Workplace const& workplace, std::vector<std::string> words, std::string const& input) {
  std::string const before = text_of(workplace / input);
  ASSERT_FALSE(before.empty()) << input;
  for (bool const overwrites : {false, true}) {
    if (overwrites) words.emplace_back("--overwrite");
    Outcome const refused = in(workplace, words);
    EXPECT_EQ(refused.exit_code, 2) << input << refused.err;
    EXPECT_EQ(text_of(workplace / input), before) << input << refused.err;
  }
}

TEST(Inputs, AreNeverReplacedNorRemoved) {
  Workplace const workplace;
  furnish(workplace);
  make_results(workplace);
  expect_kept(workplace, {"contacts", "packing.xyz", "-o", ".", "--no-pictures"}, "packing.xyz");
  expect_kept(workplace, {"contacts", "made", "-o", "made", "--packing-fraction", "0.3"}, "made/final.xyz");
  expect_kept(workplace, {"contacts", "made", "-o", "made"}, "made/final.xyz");
  expect_kept(workplace, {"contacts", "part2/runs/seed=2", "-o", "part2"}, "part2/runs/seed=2/final.xyz");
  expect_kept(workplace, {"run", "made/config.resolved.toml", "-o", "made"}, "made/config.resolved.toml");
  expect_kept(workplace, {"export", "made", "--to", "xyz", "-o", "made/trajectory.h5"}, "made/trajectory.h5");
  fs::copy(workplace / "made/trajectory.h5", workplace / "frames.mp4");
  expect_kept(workplace, {"movie", "frames.mp4", "-o", "frames.mp4"}, "frames.mp4");
  fs::copy(workplace / "made/final.xyz", workplace / "start.xyz");
  write(workplace / "again.toml", "disks.file = \"start.xyz\"\nrun.steps = 5\n");
  expect_kept(workplace, {"run", "again.toml", "-o", ".", "-q"}, "start.xyz");
  write(workplace / "next.toml", "disks.file = \"made/final.xyz\"\nrun.steps = 5\n");
  expect_kept(workplace, {"run", "next.toml", "-o", "made", "-q"}, "made/final.xyz");
  write(workplace / "from.toml", "disks.file = \"made/final.xyz\"\nrun.steps = 5\n[sweep]\nrun.seed = [1, 2]\n");
  expect_kept(workplace, {"sweep", "from.toml", "-o", "made", "-q"}, "made/final.xyz");
  write(workplace / "series.csv", "distance,energy\n0.8,5\n0.9,2.5\n1,1\n1.2,0\n");
  write(workplace / "table.toml",
        "box.edge = \"periodic\"\nengine.kind = \"soft\"\nrun.steps = 5\n"
        "potential = { kind = \"table\", file = \"series.csv\" }\n");
  expect_kept(workplace, {"run", "table.toml", "-o", ".", "-q"}, "series.csv");
  EXPECT_TRUE(fs::exists(workplace / "made/checkpoint.gridlock"));
}

TEST(Resuming, ReplacesNoFileOfTheUsers) {
  for (std::string const name : {"final.xyz", "series.csv", "pair_correlation.csv"}) {
    Workplace const workplace;
    furnish(workplace);
    make_results(workplace);
    // The name is given up by the run, as where a user has moved its file away.
    std::string list = text_of(workplace / "made/.gridlock.files");
    list.erase(list.find(name), name.size() + 1);
    write(workplace / "made/.gridlock.files", list);
    write(workplace / "made" / name, mine);
    Outcome const refused = in(workplace, {"resume", "made", "--steps", "40", "-q", "--no-pictures"});
    EXPECT_EQ(refused.exit_code, 2) << refused.err;
    EXPECT_NE(refused.err.find("made/" + name + " would be replaced"), std::string::npos) << refused.err;
    EXPECT_EQ(text_of(workplace / "made" / name), mine);
    fs::remove(workplace / "made" / name);
    expect_good(in(workplace, {"resume", "made", "--steps", "40", "-q", "--no-pictures"}));
  }
}

TEST(Resuming, ContinuesACopyWithoutItsHiddenFiles) {
  Workplace const workplace;
  furnish(workplace);
  make_results(workplace);
  fs::create_directory(workplace / "copy");
  for (auto const& entry : fs::directory_iterator(workplace / "made")) {
    if (!entry.path().filename().string().starts_with('.'))
      fs::copy(entry.path(), workplace / "copy" / entry.path().filename());
  }
  expect_good(in(workplace, {"resume", "copy", "--steps", "40", "-q", "--no-pictures"}));
}

TEST(Exports, GoToDevicesAndPipesThatAreThere) {
  Workplace const workplace;
  furnish(workplace);
  make_results(workplace);
  expect_good(in(workplace, {"export", "made", "--to", "xyz", "-o", "/dev/null"}));
}

}  // namespace
}  // namespace gridlock::test
