#include "gridlock/io/xyz.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <optional>
#include <ostream>
#include <sstream>
#include <string>

#include "gridlock/core/error.hpp"
#include "gridlock/core/random.hpp"
#include "io/file.hpp"
#include "unit/io/damage.hpp"
#include "unit/io/temporary_directory.hpp"

namespace gridlock {
namespace {

/// A state of `count` disks with every column in use; numbers with all 53 bits.
State state_of(std::size_t count, std::uint64_t seed, Edge edge, std::optional<Edge> edge_y = {}) {
  RandomStream random(seed, 0, 0, Purpose::start_position);
  State state;
  state.box = Box(0.1 + random.uniform(), 10.0 * random.uniform() + 1e-3, edge, edge_y.value_or(edge));
  state.clock = {.step = random.bits(), .time = random.normal()};
  state.seed = random.bits();
  for (std::size_t i = 0; i < count; ++i) {
    state.agents.add(random.uniform() * state.box.width(), random.uniform() * state.box.height(), random.normal(),
                     1e-200 * random.normal(), 1e-3 * (1.0 + static_cast<double>(random.below(3))),
                     1.0 + random.uniform(), static_cast<std::int32_t>(random.bits()),
                     static_cast<std::int32_t>(random.bits()));
  }
  return state;
}

State written_and_read(State const& state) {
  TemporaryDirectory const directory;
  write_xyz(state, directory / "state.xyz");
  return read_xyz(directory / "state.xyz").state;
}

constexpr std::string_view good_header =
    "Lattice=\"2 0 0 0 1 0 0 0 1\" pbc=\"F F F\" Properties=species:S:1:pos:R:3:id:I:1:velo:R:3:radius:R:1 Time=0.5\n";

std::string two_disks(std::string_view header = good_header) {
  return fmt::format("2\n{}Ar 0.5 0.5 0 0 1 -1 0 0.1\nAr 1.5 0.5 0 1 0 0.25 0 0.2\n", header);
}

Problem problem_of(std::string const& text) {
  try {
    parse_xyz(text, "disks.xyz");
  } catch (Error const& error) {
    return error.problems().at(0);
  }
  return {.what = "it was read"};
}

std::string replaced(std::string text, std::string_view old, std::string_view fresh) {
  std::size_t const at = text.find(old);
  EXPECT_NE(at, std::string::npos) << old;
  return text.replace(at, old.size(), fresh);
}

TEST(Xyz, ReadsBackEveryBitOfAnyState) {
  for (std::uint64_t seed = 0; seed < 50; ++seed) {
    SCOPED_TRACE(seed);
    State const state = state_of(seed * seed, seed, seed % 2 == 0 ? Edge::wall : Edge::periodic,
                                 seed % 4 < 2 ? Edge::wall : Edge::periodic);
    State const read = written_and_read(state);
    EXPECT_EQ(hash(read), hash(state));
    EXPECT_EQ(read.agents.size(), state.agents.size());
    EXPECT_EQ(read.box, state.box);
    EXPECT_EQ(read.clock, state.clock);
    EXPECT_EQ(read.seed, state.seed);
  }
}

TEST(Xyz, ReadsBackZerosWithASignAndNumbersAtTheEndsOfTheRange) {
  State state;
  double const largest = std::numeric_limits<double>::max();
  state.agents.add(-0.0, 5e-324, largest, -largest, std::numeric_limits<double>::min(), largest,
                   std::numeric_limits<std::int32_t>::min(), std::numeric_limits<std::int32_t>::max());
  EXPECT_EQ(hash(written_and_read(state)), hash(state));
}

TEST(Xyz, IdsOfAPopulationWithDeathsComeBackInTheirOrder) {
  State state = state_of(40, 5, Edge::wall);
  for (Id const dead : {3U, 17U, 39U, 0U}) state.agents.remove(dead);
  Id const reborn = state.agents.add(0.1, 0.2, 0.0, 0.0, 0.01, 1.0, 0, 0);
  ASSERT_GT(reborn, 0xFFFFFFFFU);
  State const read = written_and_read(state);
  EXPECT_EQ(hash(read), hash(state));
  EXPECT_TRUE(read.agents.contains(reborn));
  EXPECT_FALSE(read.agents.contains(17));
  EXPECT_TRUE(std::ranges::is_sorted(read.agents.ids()));
}

/// The first word of each row of a file.
std::string types_in(std::filesystem::path const& file) {
  std::string types;
  std::istringstream lines(read_file(file));
  std::string line;
  for (int k = 0; std::getline(lines, line); ++k) {
    if (k >= 2) types += line.substr(0, line.find(' '));
  }
  return types;
}

TEST(Xyz, IsTheSameTextOnAnyNumberOfThreads) {
  TemporaryDirectory const directory;
  State const state = state_of(70'000, 3, Edge::periodic);
  EXPECT_EQ(hash(written_and_read(state)), hash(state));
  auto const text_on = [&](std::size_t threads) {
    tbb::global_control const limit(tbb::global_control::max_allowed_parallelism, threads);
    write_xyz(state, directory / "state.xyz");
    return read_file(directory / "state.xyz");
  };
  std::string const text = text_on(1);
  EXPECT_EQ(text_on(2), text);
  EXPECT_EQ(text_on(7), text);
  EXPECT_EQ(std::ranges::count(text, '\n'), 70'002);
}

TEST(Xyz, AFullDiskEndsTheWritingOfManyRows) {
  State const state = state_of(70'000, 3, Edge::periodic);
  EXPECT_THROW(write_xyz(state, "/dev/full"), RunFailure);
}

TEST(Xyz, TheTypeNamesTheKindByRadiusAndMass) {
  TemporaryDirectory const directory;
  State state;
  for (double const radius : {0.2, 0.1, 0.3, 0.1}) state.agents.add(0.5, 0.5, 0, 0, radius, 1, 0, 0);
  state.agents.add(0.5, 0.5, 0, 0, 0.1, 7, 0, 0);
  write_xyz(state, directory / "a.xyz");
  EXPECT_EQ(types_in(directory / "a.xyz"), "CADAB");
  for (int k = 0; k < 20; ++k) state.agents.add(0.5, 0.5, 0, 0, 0.01 * (k + 1), 2, 0, 0);
  write_xyz(state, directory / "a.xyz");
  EXPECT_EQ(types_in(directory / "a.xyz"), std::string(25, 'X'));
}

TEST(Xyz, AColumnOfSpeciesNamesTheTypeAndComesBackUnderItsName) {
  TemporaryDirectory const directory;
  Frame frame = frame_of(state_of(3, 1, Edge::wall));
  frame.columns.push_back({"species", std::vector<std::uint32_t>{2, 0, 1}});
  write_xyz(frame, directory / "a.xyz");
  EXPECT_EQ(types_in(directory / "a.xyz"), "CAB");
  XyzFrame const read = read_xyz(directory / "a.xyz");
  ASSERT_EQ(read.others.size(), 1U);
  EXPECT_EQ(read.others[0], (FrameColumn{"species", std::vector<double>{2.0, 0.0, 1.0}}));
}

TEST(Xyz, ReadsAFileByHand) {
  XyzFrame const frame = parse_xyz(two_disks(), "disks.xyz");
  EXPECT_TRUE(frame.has_velocities);
  EXPECT_TRUE(frame.has_radii);
  EXPECT_FALSE(frame.has_masses || frame.has_images);
  State const& state = frame.state;
  EXPECT_EQ(state.box, Box(2, 1, Edge::wall));
  EXPECT_EQ(state.clock, (Clock{.step = 0, .time = 0.5}));
  EXPECT_EQ(state.seed, 0U);
  ASSERT_EQ(state.agents.size(), 2U);
  EXPECT_EQ(position(state.agents, 1), (Vector{1.5, 0.5}));
  EXPECT_EQ(velocity(state.agents, 1), (Vector{0.0, 0.25}));
  EXPECT_EQ(state.agents.column<Radius>()[1], 0.2);
  EXPECT_EQ(state.agents.column<Mass>()[1], 1.0);
}

TEST(Xyz, ColumnsMayStandInAnyOrderAndOthersAreSkipped) {
  XyzFrame const frame = parse_xyz(
      "2\r\n"
      "note='a = \"b\" c' Properties=forces:R:3:id:I:1:masses:R:1:pos:R:2:tag:S:1 pbc=[T T F] Lattice=\"2 0 0 0 1 0 0 "
      "0 9\"\r\n"
      "nan x 1\t7 2.5 0.5 0.25 hello\r\n"
      "  1 2 3 4 3.5 1.5 +0.75 world  \r\n"
      "\r\n",
      "disks.xyz");
  EXPECT_FALSE(frame.has_velocities);
  EXPECT_FALSE(frame.has_radii);
  EXPECT_TRUE(frame.has_masses);
  EXPECT_FALSE(frame.has_images);
  EXPECT_EQ(frame.state.box, Box(2, 1, Edge::periodic));
  ASSERT_EQ(frame.state.agents.size(), 2U);
  std::size_t const seven = frame.state.agents.index_of(7);
  ASSERT_EQ(seven, 1U) << "rows come in the order of their ids";
  EXPECT_EQ(position(frame.state.agents, seven), (Vector{0.5, 0.25}));
  EXPECT_EQ(position(frame.state.agents, 0), (Vector{1.5, 0.75}));
  EXPECT_EQ(frame.state.agents.column<Mass>()[seven], 2.5);
  EXPECT_EQ(velocity(frame.state.agents, seven), (Vector{0.0, 0.0}));
}

TEST(Xyz, WithoutAnIdColumnRowsAreNumberedFromZero) {
  XyzFrame const frame =
      parse_xyz("2\nLattice=\"1 0 0 0 1 0 0 0 1\" Properties=pos:R:2\n0.5 0.5\n0.1 0.1\n", "disks.xyz");
  EXPECT_TRUE(frame.state.agents.contains(0));
  EXPECT_TRUE(frame.state.agents.contains(1));
  EXPECT_TRUE(frame.state.box.is_periodic()) << "as extended XYZ has it where pbc is left out";
}

/// A frame of one disk in a periodic box of 2 × 3, with these properties.
XyzFrame disk_of(std::string const& properties, std::string const& row, std::string const& entries = "") {
  return parse_xyz(fmt::format("1\nLattice=\"2 0 0 0 3 0 0 0 1\" Properties={} {}\n{}\n", properties, entries, row),
                   "disk.xyz");
}

TEST(Xyz, MomentaOverMassesAreTheVelocitiesOfAFileWithoutThem) {
  XyzFrame const frame = disk_of("momenta:R:3:masses:R:1:pos:R:2", "3 -1 0 2 0.25 0.5");
  EXPECT_TRUE(frame.has_velocities);
  EXPECT_TRUE(frame.unused_columns.empty());
  EXPECT_EQ(velocity(frame.state.agents, 0), (Vector{1.5, -0.5}));
  XyzFrame const both = disk_of("momenta:R:3:velo:R:3:masses:R:1:pos:R:2", "3 -1 0 7 8 0 2 0.25 0.5");
  EXPECT_EQ(velocity(both.state.agents, 0), (Vector{7.0, 8.0}));
  EXPECT_EQ(both.unused_columns, std::vector<std::string>{"momenta"});
  EXPECT_THROW(disk_of("momenta:R:2:masses:R:1:pos:R:2", "1e300 0 1e-300 0.25 0.5"), Error);
}

TEST(Xyz, ColumnsHaveTheNamesOfOtherProgramsToo) {
  for (std::string const name : {"velo", "vel", "velocity", "velocities", "Velocity"}) {
    EXPECT_EQ(velocity(disk_of("pos:R:2:" + name + ":R:2", "0.25 0.5 7 8").state.agents, 0), (Vector{7.0, 8.0}))
        << name;
  }
  XyzFrame const split = disk_of("x:R:1:y:R:1:vx:R:1:vy:R:1:ix:I:1:iy:I:1", "0.25 0.5 7 8 -3 4");
  EXPECT_EQ(position(split.state.agents, 0), (Vector{0.25, 0.5}));
  EXPECT_EQ(velocity(split.state.agents, 0), (Vector{7.0, 8.0}));
  EXPECT_EQ(split.state.agents.column<ImageX>()[0], -3);
  EXPECT_EQ(split.state.agents.column<ImageY>()[0], 4);
  for (std::string const name : {"radius", "radii", "Radius"}) {
    EXPECT_EQ(disk_of("pos:R:2:" + name + ":R:1", "0.25 0.5 0.1").state.agents.column<Radius>()[0], 0.1) << name;
  }
  for (std::string const name : {"mass", "masses"}) {
    EXPECT_EQ(disk_of("pos:R:2:" + name + ":R:1", "0.25 0.5 7").state.agents.column<Mass>()[0], 7.0) << name;
  }
  EXPECT_EQ(disk_of("pos:R:2:diameter:R:1", "0.25 0.5 0.5").state.agents.column<Radius>()[0], 0.25);
  EXPECT_TRUE(disk_of("positions:R:2:ids:I:1", "0.25 0.5 7").state.agents.contains(7));
}

TEST(Xyz, ColumnsThatAreNotUsedAreNamed) {
  XyzFrame const frame = disk_of("species:S:1:pos:R:2:size:R:1:vx:R:1:forces:R:3:radius:R:1:diameter:R:1:tag:S:1",
                                 "A 0.25 0.5 0.2 1 1 2 3 0.1 0.2 hello");
  EXPECT_EQ(frame.unused_columns, (std::vector<std::string>{"size", "vx", "forces", "diameter", "tag"}));
  EXPECT_FALSE(frame.has_velocities) << "one component is no velocity";
}

TEST(Xyz, EntriesOfAnotherKindAreNamedAndNotUsed) {
  XyzFrame const frame = disk_of("pos:R:2", "0.25 0.5", "step=-1 seed=None Time=2024-01-01");
  EXPECT_EQ(frame.unused_entries, (std::vector<std::string>{"Time=2024-01-01", "step=-1", "seed=None"}));
  EXPECT_EQ(frame.state.clock, Clock{});
  EXPECT_EQ(disk_of("pos:R:2", "0.25 0.5", "step=100.0 Time=1d1").state.clock, (Clock{.step = 100, .time = 10.0}));
}

TEST(Xyz, DisksOutsideAPeriodicBoxComeInThroughItsEdgesAndImagesCountThat) {
  auto const expect_at = [](XyzFrame const& frame, Vector place, std::int32_t image_x, std::int32_t image_y) {
    EXPECT_EQ(position(frame.state.agents, 0), place);
    EXPECT_EQ(frame.state.agents.column<ImageX>()[0], image_x);
    EXPECT_EQ(frame.state.agents.column<ImageY>()[0], image_y);
  };
  expect_at(disk_of("pos:R:2", "-0.25 4.5"), {1.75, 1.5}, -1, 1);
  expect_at(disk_of("pos:R:2", "2.0 3.0"), {0.0, 0.0}, 1, 1);
  expect_at(disk_of("pos:R:2", "-1e-18 2.5"), {0.0, 2.5}, 0, 0);
  expect_at(disk_of("pos:R:2:image:I:2", "-0.25 9.5 5 -7"), {1.75, 0.5}, 4, -4);
  expect_at(disk_of("pos:R:2", "-0.25 -0.5", "Origin=\"-1 -1.5 0\""), {0.75, 1.0}, 0, 0);
  EXPECT_TRUE(disk_of("pos:R:2", "-0.25 0.5").has_images);
  EXPECT_FALSE(disk_of("pos:R:2", "0.25 0.5").has_images);
  EXPECT_THROW(disk_of("pos:R:2", "1e300 0.5"), Error);
  XyzFrame const walls = disk_of("pos:R:2", "-0.25 4.5", "pbc=\"F F F\"");
  EXPECT_EQ(position(walls.state.agents, 0), (Vector{-0.25, 4.5})) << "walls stay walls";
  expect_at(disk_of("pos:R:2", "-0.25 4.5", "pbc=\"T F F\""), {1.75, 4.5}, -1, 0);
  expect_at(disk_of("pos:R:2", "-0.25 4.5", "pbc=\"F T F\""), {-0.25, 1.5}, 0, 1);
}

TEST(Xyz, AFrameOfSeveralIsChosenByItsNumber) {
  TemporaryDirectory const directory;
  std::filesystem::path const file = directory / "frames.xyz";
  auto const frame = [](int disks, double x) {
    std::string text = fmt::format("{}\nLattice=\"2 0 0 0 1 0 0 0 1\" Properties=pos:R:2 step={}\n", disks, disks);
    for (int k = 0; k < disks; ++k) text += fmt::format("{} 0.5\n", x);
    return text;
  };
  write_file(file, "\xEF\xBB\xBF" + frame(1, 0.1) + "\n" + frame(2, 0.2) + "\xEF\xBB\xBF" + frame(3, 0.3) + "\n\n");
  EXPECT_EQ(count_xyz_frames(file), 3U);
  for (int k = 0; k < 3; ++k) {
    for (std::int64_t const number : {k, k - 3}) {
      State const state = read_xyz(file, number).state;
      EXPECT_EQ(state.agents.size(), static_cast<std::size_t>(k + 1));
      EXPECT_DOUBLE_EQ(position(state.agents, 0).x, 0.1 * (k + 1));
    }
  }
  for (std::int64_t const number : {3, -4}) EXPECT_THROW(read_xyz(file, number), Error);
  try {
    read_xyz(file, {}, "--frame");
    FAIL() << "one of three frames was taken silently";
  } catch (Error const& error) {
    EXPECT_EQ(error.problems()[0].hint, "choose one: --frame from 0 to 2");
  }
}

TEST(Xyz, WhatIsWrongInALaterFrameHasItsLine) {
  std::string const one = "1\nLattice=\"2 0 0 0 1 0 0 0 1\" Properties=id:I:1:pos:R:2\n0 0.5 0.5\n";
  TemporaryDirectory const directory;
  write_file(directory / "a.xyz",
             one + "2\nLattice=\"2 0 0 0 1 0 0 0 1\" Properties=id:I:1:pos:R:2\n7 0.5 0.5\n7 1.5 0.5\n");
  try {
    read_xyz(directory / "a.xyz", 1);
    FAIL();
  } catch (Error const& error) {
    EXPECT_EQ(error.problems()[0].what, "the id 7 is given twice, first on line 6");
    EXPECT_EQ(error.problems()[0].line, 7);
  }
}

TEST(Xyz, AFileInUtf16IsToldFromOneThatIsNoXyz) {
  EXPECT_EQ(problem_of(std::string("\xFF\xFE"
                                   "1\0\n\0",
                                   6))
                .hint,
            "the file is in UTF-16: save it in UTF-8");
}

TEST(Xyz, EndingsOfOtherProgramsAreThoseOfExtendedXyz) {
  for (char const* name : {"a.xyz", "a.extxyz", "b.exyz", "c/a.xyz.gz", "a.b.extxyz.gz"})
    EXPECT_TRUE(has_xyz_ending(name)) << name;
  for (char const* name : {"xyz", "a.gz", "a.xyz.csv", "a.h5", ".xyz"}) EXPECT_FALSE(has_xyz_ending(name)) << name;
}

struct Damage {
  char const* name;
  std::string text;
  int line;
  int column;
  char const* says;

  friend void PrintTo(Damage const& damage, std::ostream* out) { *out << damage.text; }
};

class DamagedXyz : public testing::TestWithParam<Damage> {};

TEST_P(DamagedXyz, IsRefusedWithItsPlace) {
  Damage const& damage = GetParam();
  Problem const problem = problem_of(damage.text);
  EXPECT_NE(problem.what.find(damage.says), std::string::npos) << problem.what;
  EXPECT_EQ(problem.file, "disks.xyz");
  EXPECT_EQ(problem.line, damage.line) << problem.what;
  EXPECT_EQ(problem.column, damage.column) << problem.what;
}

std::vector<Damage> damages() {
  std::string const good = two_disks();
  auto const with_header = [&](std::string_view old, std::string_view fresh) {
    return replaced(two_disks(), old, fresh);
  };
  return {
      {"Empty", "", 0, 0, "the file is empty"},
      {"NotXyz", "[box]\nside = 1\n", 1, 1, "not the number of disks"},
      {"NegativeCount", "-3\n\n", 1, 1, "not the number of disks"},
      {"CountBeyond64Bits", "100000000000000000000000\n\n", 1, 1, "not the number of disks"},
      {"OnlyACount", "3\n", 2, 0, "ends before the line of the box"},
      {"AbsurdCount", replaced(good, "2\n", "1000000000000000000\n"), 4, 0, "ends after 2 of 1000000000000000000"},
      {"CountTooLarge", replaced(good, "2\n", "3\n"), 4, 0, "ends after 2 of 3 disks"},
      {"CountTooSmall", replaced(good, "2\n", "1\n"), 4, 1, "continues after its 1 disks"},
      {"TwoFrames", good + good, 5, 1, "continues after its 2 disks: it holds 2 frames"},
      {"TwoFramesAndABlankLine", good + "\n" + good, 6, 1, "it holds 2 frames"},
      {"SecondFrameCutOff", good + "2\n", 5, 0, "ends after 0 of 2 disks of frame 1"},
      {"WordsBehindTheLastDisk", good + "the end\n", 5, 1, "continues after its 2 disks"},
      {"NoLattice", with_header("Lattice", "lattice"), 2, 0, "no Lattice"},
      {"EightNumbers", with_header("0 0 1\"", "0 1\""), 2, 1, "nine numbers"},
      {"LatticeOfWords", with_header("\"2 0", "\"two 0"), 2, 1, "nine finite numbers"},
      {"LatticeOfNan", with_header("\"2 0", "\"nan 0"), 2, 1, "nine finite numbers"},
      {"SkewBox", with_header("\"2 0", "\"2 0.5"), 2, 1, "the side (2, 0.5) of the Lattice does not lie along x"},
      {"TurnedBox", with_header("\"2 0 0 0 1", "\"0 2 0 3 0"), 2, 1,
       "the side (0, 2) of the Lattice does not lie along x"},
      {"ObliqueBox", with_header("\"2 0 0 0 1", "\"3 4 0 -8 6"), 2, 1, "the side (3, 4) of the Lattice"},
      {"LowBox", with_header("\"2 0 0 0 1", "\"2 0 0 0 0"), 2, 1, "the box of 2 × 0 has no area"},
      {"FlatBox", with_header("\"2 0", "\"0 0"), 2, 1, "no area"},
      {"NegativeBox", with_header("\"2 0", "\"-2 0"), 2, 1, "no area"},
      {"OpenQuote", with_header("0 1\" pbc=\"F F F\"", "0 1 pbc=F"), 2, 9, "does not end"},
      {"WordsForEdges", with_header("F F F", "yes no no"), 2, 29, "pbc is \"yes no no\""},
      {"NoProperties", with_header("Properties", "properties"), 2, 0, "no Properties"},
      {"NoPositions", with_header(":pos:", ":point:"), 2, 41, "no positions"},
      {"HalfAProperty", with_header("radius:R:1", "radius:R"), 2, 41, "name:type:columns"},
      {"NoColumns", with_header("radius:R:1", "radius:R:0"), 2, 41, "not a number from 1"},
      {"AbsurdColumns", with_header("species:S:1", "species:S:1000000000000"), 2, 41, "not a number from 1"},
      {"PositionsOnALine", with_header("pos:R:3", "pos:R:1"), 2, 41, "must have 2 or 3"},
      {"TwoRadii", with_header("species:S:1", "radius:R:1"), 2, 41, "every radius twice"},
      {"ColumnMissing", replaced(good, " 0.1\n", "\n"), 3, 21, "has 8 columns, but the Properties name 9"},
      {"ColumnTooMany", replaced(good, " 0.1\n", " 0.1 7\n"), 3, 27, "has 10 columns"},
      {"WordForANumber", replaced(good, "Ar 1.5", "Ar 1,5"), 4, 4, "x position is \"1,5\""},
      {"NanPosition", replaced(good, "Ar 1.5", "Ar nan"), 4, 4, "a finite number"},
      {"InfiniteVelocity", replaced(good, "0.25", "-inf"), 4, 18, "y velocity is \"-inf\""},
      {"NumberTooLarge", replaced(good, "Ar 1.5", "Ar 1e999"), 4, 4, "a finite number"},
      {"HalfANumber", replaced(good, "Ar 1.5", "Ar 1.5e"), 4, 4, "a finite number"},
      {"TwoSigns", replaced(good, "Ar 1.5", "Ar +-1.5"), 4, 4, "a finite number"},
      {"NegativeRadius", replaced(good, "0.2\n", "-0.2\n"), 4, 25, "must be above 0"},
      {"NoRadius", replaced(good, "0.2\n", "0\n"), 4, 25, "must be above 0"},
      {"ThreeDimensions", replaced(good, "1.5 0.5 0 ", "1.5 0.5 3 "), 4, 12, "plane z = 0"},
      {"NegativeId", replaced(good, "0.5 0 1 0", "0.5 0 -1 0"), 4, 14, "id is \"-1\""},
      {"FractionalId", replaced(good, "0.5 0 1 0", "0.5 0 1.0 0"), 4, 14, "id is \"1.0\""},
      {"IdTwice", replaced(good, "0.5 0 1 0", "0.5 0 0 0"), 4, 0, "id 0 is given twice, first on line 3"},
      {"AbsurdId", replaced(good, "0.5 0 1 0", "0.5 0 4294967295 0"), 4, 0, "out of proportion to 2 disks"},
  };
}

INSTANTIATE_TEST_SUITE_P(Xyz, DamagedXyz, testing::ValuesIn(damages()),
                         [](auto const& given) { return std::string(given.param.name); });

TEST(Xyz, AnyDamageIsEitherReadOrRefused) {
  std::string whole = two_disks(
      "Lattice=\"2 0 0 0 1 0 0 0 1\" pbc=\"T T F\" "
      "Properties=species:S:1:pos:R:3:id:I:1:velo:R:3:radius:R:1 Time=0.5 step=3 seed=9\n");
  int refused = 0;
  for (std::uint64_t seed = 0; seed < 5000; ++seed) {
    SCOPED_TRACE(seed);
    try {
      State const state = parse_xyz(damaged(whole, seed), "damaged.xyz").state;
      for (std::size_t i = 0; i < state.agents.size(); ++i) {
        EXPECT_TRUE(std::isfinite(position(state.agents, i).x) && std::isfinite(position(state.agents, i).y));
        EXPECT_TRUE(state.agents.column<Radius>()[i] >= 0.0);
      }
    } catch (Error const& error) {
      ++refused;
      EXPECT_EQ(error.problems().at(0).file, "damaged.xyz");
    }
  }
  EXPECT_GT(refused, 1000);
}

TEST(Xyz, PackedByGzipIsReadAndDamageOfItRefused) {
  TemporaryDirectory const directory;
  State const state = state_of(2'000, 8, Edge::periodic);
  write_xyz(state, directory / "state.xyz");
  std::string const packed = (directory / "state.xyz.gz").string();
  std::string const plain = (directory / "state.xyz").string();
  ASSERT_EQ(std::system(fmt::format("gzip -c {} > {}", plain, packed).c_str()), 0);
  EXPECT_EQ(hash(read_xyz(packed).state), hash(state));
  // Two parts, as parallel packers write them.
  ASSERT_EQ(std::system(fmt::format("(head -n 100 {0} | gzip; tail -n +101 {0} | gzip) > {1}", plain, packed).c_str()),
            0);
  EXPECT_EQ(hash(read_xyz(packed).state), hash(state));
  std::string const bytes = read_file(packed);
  for (std::size_t const length : {std::size_t{2}, std::size_t{20}, bytes.size() / 2, bytes.size() - 1}) {
    write_file(packed, bytes.substr(0, length));
    EXPECT_THROW(read_xyz(packed), Error) << length;
  }
  std::string flipped = bytes;
  flipped[bytes.size() / 3] ^= 4;
  write_file(packed, flipped);
  EXPECT_THROW(read_xyz(packed), Error);
  ASSERT_EQ(std::system(fmt::format("head -c 30000000 /dev/zero | gzip > {}", packed).c_str()), 0);
  EXPECT_THROW(read_xyz(packed), Error) << "a small file that asks for much memory";
}

TEST(Xyz, AMissingFileIsRefusedByName) { EXPECT_THROW(read_xyz("/nowhere/disks.xyz"), Error); }

TEST(Xyz, AseReadsPositionsCellEdgesAndColumns) {
  if (std::system("/usr/bin/python3 -c 'import ase.io' 2>/dev/null") != 0) GTEST_SKIP() << "ASE is not installed";
  TemporaryDirectory const directory;
  State state;
  state.box = Box(2.0, 1.0, Edge::periodic);
  state.seed = 7;
  state.clock = {.step = 12, .time = 0.1};
  state.agents.add(0.1, 0.7, 1.0 / 3.0, -0.5, 0.01, 1.0, -1, 2);
  state.agents.add(1.9, 0.3, 0.0, 0.25, 0.02, 4.0, 0, 0);
  write_xyz(state, directory / "state.xyz");
  write_file(
      directory / "check.py",
      "import ase.io, sys\n"
      "a = ase.io.read(sys.argv[1])\n"
      "assert a.positions.tolist() == [[0.1, 0.7, 0], [1.9, 0.3, 0]]\n"
      "assert a.cell.tolist() == [[2, 0, 0], [0, 1, 0], [0, 0, 1]]\n"
      "assert a.pbc.tolist() == [True, True, False]\n"
      "assert a.arrays['type'].tolist() == ['A', 'B']\n"
      "assert a.get_volume() == 2\n"
      "assert a.arrays['velo'].tolist() == [[1 / 3, -0.5, 0], [0, 0.25, 0]]\n"
      "assert a.arrays['radius'].tolist() == [0.01, 0.02]\n"
      "assert a.get_masses().tolist() == [1, 4]\n"
      "assert a.arrays['id'].tolist() == [0, 1]\n"
      "assert a.arrays['image'].tolist() == [[-1, 2], [0, 0]]\n"
      "assert a.info['Time'] == 0.1 and a.info['step'] == 12\n"
      "ase.io.write(sys.argv[2], a, format='extxyz', columns=['symbols', 'positions', 'velo', 'radius', 'id'])\n");
  std::string const command = fmt::format("/usr/bin/python3 {} {} {}", (directory / "check.py").string(),
                                          (directory / "state.xyz").string(), (directory / "ase.xyz").string());
  ASSERT_EQ(std::system(command.c_str()), 0);
  // ASE writes eight digits, and no more than the columns it was asked for.
  XyzFrame const frame = read_xyz(directory / "ase.xyz");
  EXPECT_EQ(frame.state.box, state.box);
  EXPECT_TRUE(frame.has_velocities && frame.has_radii);
  EXPECT_NEAR(velocity(frame.state.agents, 0).x, 1.0 / 3.0, 1e-8);
}

TEST(Xyz, ColumnsThatDisksDoNotHaveComeInTheOrderOfTheIds) {
  // The first Id is the larger one, though its slot is the smaller one.
  XyzFrame const frame = parse_xyz(
      "2\nLattice=\"1 0 0 0 1 0 0 0 1\" Properties=pos:R:2:health:I:1:name:S:1:id:I:1:force:R:2:heat:R:1\n"
      "0.1 0.1 7 a 4294967296 1 2 0.5\n0.2 0.2 8 b 1 3 4 unknown\n",
      "two.xyz");
  ASSERT_EQ(frame.others.size(), 2U) << "words and columns side by side are left out";
  EXPECT_EQ(frame.others[0], (FrameColumn{"health", std::vector<double>{8.0, 7.0}}));
  EXPECT_EQ(frame.others[1].name, "heat");
  auto const& heat = std::get<std::vector<double>>(frame.others[1].values);
  EXPECT_TRUE(std::isnan(heat[0]));
  EXPECT_EQ(heat[1], 0.5);
}

}  // namespace
}  // namespace gridlock
