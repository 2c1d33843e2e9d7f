#include "gridlock/io/settings_file.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <ostream>

#include "gridlock/core/random.hpp"
#include "io/file.hpp"
#include "unit/io/damage.hpp"
#include "unit/io/temporary_directory.hpp"

namespace gridlock {
namespace {

// A small configuration with one setting of every type; the real one belongs to other layers.

enum class Border { wall, periodic };

struct Species {
  double fraction = 1.0;
  double size_ratio = 1.0;

  friend bool operator==(Species const&, Species const&) = default;
};

void describe(Species& species, SettingVisitor& visitor) {
  visitor.visit({.key = "fraction", .documentation = "Share of the disks.", .min = 0, .max = 1}, species.fraction);
  visitor.visit({.key = "size_ratio", .documentation = "Relative radius.", .min = 0, .min_is_allowed = false},
                species.size_ratio);
}

struct Configuration {
  Border edge = Border::wall;
  double side = 1.0;
  std::optional<double> width;
  std::optional<std::uint64_t> count;
  std::optional<double> packing_fraction;
  std::string file;
  std::vector<Species> species;
  std::uint64_t seed = 1;
  bool pictures = true;
  std::vector<double> times;

  friend bool operator==(Configuration const&, Configuration const&) = default;
};

void describe(Configuration& c, SettingVisitor& visitor) {
  static constexpr std::array<std::string_view, 2> borders{"wall", "periodic"};
  visitor.enter("box", "Where the disks live.");
  visit_enum(visitor, {.key = "edge", .documentation = "What a disk meets at the border."}, borders, c.edge);
  visitor.visit(
      {.key = "side", .unit = "length", .documentation = "Side of the square.", .min = 0, .min_is_allowed = false},
      c.side);
  visitor.visit({.key = "width", .unit = "length", .documentation = "Width | of the box.", .default_note = "side"},
                c.width);
  visitor.leave();
  visitor.enter("disks", "Which disks there are.");
  visitor.visit({.key = "count", .documentation = "Number of disks.", .min = 1, .max = 1e9}, c.count);
  visitor.visit({.key = "packing_fraction",
                 .documentation = "Share of the area covered.",
                 .min = 0,
                 .max = 1,
                 .min_is_allowed = false,
                 .max_is_allowed = false,
                 .former_key = "density"},
                c.packing_fraction);
  visitor.visit({.key = "file", .documentation = "Where to read them."}, c.file);
  visitor.visit_tables(
      {.key = "species", .documentation = "A mixture."}, c.species.size(), [&](std::size_t n) { c.species.resize(n); },
      [&](std::size_t k, SettingVisitor& inner) { describe(c.species[k], inner); });
  visitor.leave();
  visitor.enter("run", "How long.");
  visitor.visit({.key = "seed", .documentation = "Names the random numbers."}, c.seed);
  visitor.visit({.key = "pictures", .documentation = "Whether to draw."}, c.pictures);
  visitor.visit({.key = "times", .unit = "time", .documentation = "When to draw.", .min = 0}, c.times);
  visitor.leave();
}

Describe describe_of(Configuration& c) {
  return [&c](SettingVisitor& visitor) { describe(c, visitor); };
}

Configuration read(SettingsFile const& file) {
  Configuration c;
  file.read_into(describe_of(c));
  return c;
}

Configuration read(std::string_view text) { return read(SettingsFile::from_text(text, "dense.toml")); }

std::vector<Problem> problems_of(auto const& action) {
  try {
    action();
  } catch (Error const& error) {
    return error.problems();
  }
  return {};
}

std::vector<Problem> problems_of_text(std::string const& text) {
  return problems_of([&] { read(text); });
}

std::vector<Problem> problems_of_set(std::string const& assignment) {
  return problems_of([&] {
    SettingsFile file;
    file.set(assignment);
    read(file);
  });
}

TEST(SettingsFile, GivesEverySettingItsValueAndLeavesTheOthers) {
  Configuration const c = read(R"(
[box]
edge = "periodic"
side = 2                      # a whole number is a number
[disks]
count = 100_000
packing_fraction = 0.7
file = "a.xyz"
[run]
pictures = false
times = [0, 0.5, 1e3]
)");
  EXPECT_EQ(c, (Configuration{.edge = Border::periodic,
                              .side = 2.0,
                              .count = 100'000,
                              .packing_fraction = 0.7,
                              .file = "a.xyz",
                              .pictures = false,
                              .times = {0.0, 0.5, 1000.0}}));
}

TEST(SettingsFile, NothingGivenKeepsEverything) {
  EXPECT_EQ(read(SettingsFile()), Configuration());
  EXPECT_EQ(read(""), Configuration());
}

TEST(SettingsFile, AListOfTablesReadsTheSameInEveryFormOfToml) {
  std::vector<Species> const expected{{.fraction = 0.25, .size_ratio = 1.4}, {.fraction = 0.75}};
  EXPECT_EQ(read("disks.species = [{fraction = 0.25, size_ratio = 1.4}, {fraction = 0.75}]").species, expected);
  EXPECT_EQ(read("[[disks.species]]\nfraction = 0.25\nsize_ratio = 1.4\n[[disks.species]]\nfraction = 0.75").species,
            expected);
  EXPECT_TRUE(read("disks.species = []").species.empty());
}

TEST(SettingsFile, SetStandsAboveTheFileAndTheLaterAboveTheEarlier) {
  SettingsFile file = SettingsFile::from_text("[box]\nside = 2.0\n[run]\nseed = 5\n", "dense.toml");
  for (auto const* assignment : {"box.side=3", "box.side = 4.5", "box.edge=periodic", "disks.file=run 1/a.xyz",
                                 "disks.species=[{fraction=0.5}, {}]", "run.times=[1, 2]", "run.pictures=false"}) {
    file.set(assignment);
  }
  EXPECT_EQ(read(file), (Configuration{.edge = Border::periodic,
                                       .side = 4.5,
                                       .file = "run 1/a.xyz",
                                       .species = {{.fraction = 0.5}, {}},
                                       .seed = 5,
                                       .pictures = false,
                                       .times = {1.0, 2.0}}));
}

TEST(SettingsFile, SetTakesATextAsTypedEvenWhereItLooksLikeSomethingElse) {
  for (std::string const text : {"2020", "2020-01-01", "1e5", "true", "", "a=b", "it's \"here\"", "1\nfile = 2"}) {
    SettingsFile file;
    file.set("disks.file=" + text);
    EXPECT_EQ(read(file).file, text);
  }
  SettingsFile file;
  file.set("disks.file=\"in quotes\"");
  EXPECT_EQ(read(file).file, "in quotes");
}

TEST(SettingsFile, SetChangesACopyAlone) {
  SettingsFile const original = SettingsFile::from_text("[box]\nside = 2.0\n", "dense.toml");
  SettingsFile copy = original;
  copy.set("box.side=3");
  EXPECT_EQ(read(original).side, 2.0);
  EXPECT_EQ(read(copy).side, 3.0);
}

TEST(SettingsFile, ASeedMayHaveAllSixtyFourBits) {
  EXPECT_EQ(read("run.seed = 9223372036854775807").seed, 9223372036854775807U);
  EXPECT_EQ(read("run.seed = \"18446744073709551615\"").seed, std::numeric_limits<std::uint64_t>::max());
  SettingsFile file;
  file.set("run.seed=18446744073709551615");
  EXPECT_EQ(read(file).seed, std::numeric_limits<std::uint64_t>::max());
}

TEST(SettingsFile, AProblemReadsAsTheUserSeesIt) {
  auto const problems = problems_of_text("[disks]\n  packing_fraction = 1.95   # too much\n");
  ASSERT_EQ(problems.size(), 1U);
  EXPECT_EQ(to_text(problems[0]),
            "disks.packing_fraction is 1.95, but must be above 0 and below 1\n"
            "  --> dense.toml:2:22   packing_fraction = 1.95   # too much\n"
            "  hint: gridlock explain disks.packing_fraction says what it can be");
  EXPECT_EQ(problems[0].key, "disks.packing_fraction");
}

TEST(SettingsFile, ReportsEveryProblemOfAFileAtOnceInItsOrder) {
  SettingsFile file = SettingsFile::from_text(R"([run]
seed = -1
seeds = 3
[box]
side = "1.0"
edge = "walls"
[disks]
species = [{fraction = 2}, {fractoin = 0.5}]
[observ]
every = 3
)",
                                              "dense.toml");
  file.set("disks.count=0");
  auto const problems = problems_of([&] { read(file); });
  std::vector<int> lines;
  for (Problem const& problem : problems) lines.push_back(problem.line);
  EXPECT_EQ(lines, (std::vector<int>{2, 3, 5, 6, 8, 8, 9, 0}));
  EXPECT_EQ(problems.back().file, "--set");
  EXPECT_EQ(problems.back().source_line, "disks.count=0");
}

struct Mistake {
  char const* name;
  std::string text;
  int column;        ///< on the last line of the text
  std::string says;  ///< part of what and hint

  friend void PrintTo(Mistake const& mistake, std::ostream* out) { *out << mistake.text; }
};

class MistakenSettings : public testing::TestWithParam<Mistake> {};

TEST_P(MistakenSettings, AreRefusedWithTheirPlaceAndAWayOut) {
  Mistake const& mistake = GetParam();
  auto const problems = problems_of_text(mistake.text);
  ASSERT_EQ(problems.size(), 1U);
  std::string const text = problems[0].what + " | " + problems[0].hint;
  EXPECT_NE(text.find(mistake.says), std::string::npos) << text;
  EXPECT_EQ(problems[0].file, "dense.toml");
  EXPECT_EQ(problems[0].line, 1 + std::ranges::count(mistake.text, '\n')) << text;
  EXPECT_EQ(problems[0].column, mistake.column) << text;
}

INSTANTIATE_TEST_SUITE_P(
    SettingsFile, MistakenSettings,
    testing::ValuesIn(std::vector<Mistake>{
        {"UnknownKeyNear", "[disks]\ncuont = 3", 1, "no setting \"cuont\" in [disks] | did you mean count?"},
        {"UnknownKeyBeginning", "[disks]\npacking = 3", 1, "did you mean packing_fraction?"},
        {"UnknownKeyOfAnotherTable", "[disks]\nseed = 3", 1, "seed belongs in [run]"},
        {"FormerKey", "[disks]\ndensity = 0.3", 1,
         "disks.density was renamed to disks.packing_fraction | write disks.packing_fraction"},
        {"FormerKeyOfAnotherTable", "[run]\ndensity = 0.3", 1, "no setting \"density\" in [run]"},
        {"UnknownKeyFar", "[disks]\ntemperature = 3", 1,
         "the settings of [disks] are count, packing_fraction, file, species"},
        {"UnknownKeyOutsideTables", "count = 3", 1, "no setting \"count\" | count belongs in [disks]"},
        {"UnknownTableNear", "[disk]", 2, "no table \"disk\" | did you mean disks?"},
        {"UnknownTableFar", "[observables]", 2, "the tables are box, disks, run"},
        {"UnknownTableInTable", "[disks.wall]", 8, "no setting \"wall\" in [disks]"},
        {"UnknownKeyInSpecies", "[[disks.species]]\n[[disks.species]]\nsize_ration = 1", 1,
         "no setting \"size_ration\" in [disks.species[1]] | did you mean size_ratio?"},
        {"SweepWhereNoneIsMeant", "[sweep]", 2, "use gridlock sweep"},
        {"TextForNumber", "[box]\nside = \"one\"", 8, "side is the text \"one\", but must be a number (length)"},
        {"QuotedNumber", "[box]\nside = \"1.0\"", 8, "leave the quotes out"},
        {"BooleanForNumber", "[box]\nside = true", 8, "side is true, but must be a number"},
        {"DateForNumber", "[box]\nside = 2020-01-02", 8, "side is the date 2020-01-02"},
        {"ListForNumber", "[box]\nside = [1]", 8, "side is a list"},
        {"TableForNumber", "[box.side]", 1, "side is a table"},
        {"Nan", "[box]\nside = nan", 8, "side is nan, but must be a finite number"},
        {"Infinity", "[box]\nside = -inf", 8, "side is -inf, but must be a finite number"},
        {"BelowBound", "[box]\nside = -0.5", 8, "side is -0.5, but must be above 0 (length)"},
        {"AtOpenLowerBound", "[box]\nside = 0", 8, "side is 0, but must be above 0"},
        {"AtOpenUpperBound", "[disks]\npacking_fraction = 1", 20, "must be above 0 and below 1"},
        {"NegativeCount", "[disks]\ncount = -5", 9, "count is -5, but must be a whole number, at least 1"},
        {"CountBelowBound", "[disks]\ncount = 0", 9, "must be at least 1 and at most 1000000000"},
        {"CountAboveBound", "[disks]\ncount = 1000000001", 9, "must be at least 1"},
        {"FractionalCount", "[disks]\ncount = 2.5", 9, "count is 2.5, but must be a whole number"},
        {"WholeDoubleForCount", "[disks]\ncount = 1e5", 9,
         "count is 100000.0, but must be a whole number, at least 1 | write 100000"},
        {"QuotedCount", "[disks]\ncount = \"5\"", 9, "leave the quotes out"},
        {"NanForCount", "[disks]\ncount = nan", 9, "must be a whole number"},
        {"NumberForBoolean", "[run]\npictures = 1", 12, "pictures is 1, but must be true or false"},
        {"TextForBoolean", "[run]\npictures = \"true\"", 12, "pictures is the text \"true\""},
        {"NumberForText", "[disks]\nfile = 3", 8, "file is 3, but must be a text"},
        {"NumberForList", "[run]\ntimes = 3", 9, "times is 3, but must be a list of numbers (time) | write [3]"},
        {"TextInList", "[run]\ntimes = [1, \"2\"]", 13, "times[1] is the text \"2\", but must be a number"},
        {"NanInList", "[run]\ntimes = [1, nan]", 13, "times[1] is nan"},
        {"OutOfBoundsInList", "[run]\ntimes = [1, 2, -3]", 16, "times[2] is -3, but must be at least 0 (time)"},
        {"UnknownWordNear", "[box]\nedge = \"peridic\"", 8,
         "edge is \"peridic\", but must be one of \"wall\", \"periodic\" | did you mean \"periodic\"?"},
        {"UnknownWordFar", "[box]\nedge = \"soft\"", 8, "one of \"wall\", \"periodic\" | "},
        {"NumberForWord", "[box]\nedge = 1", 8, "edge is 1, but must be one of"},
        {"ValueForTable", "disks = 3", 9, "disks is 3, but must be a table | write [disks]"},
        {"TablesForTable", "[[disks]]", 1, "write [disks] once"},
        {"TableForTables", "[disks.species]", 1,
         "species is a table, but must be a list of tables | write [[disks.species]]"},
        {"NumbersForTables", "[disks]\nspecies = [1]", 12, "species[0] is 1, but must be a table"},
        {"KeyTwice", "[disks]\ncount = 1\ncount = 2", 9, "cannot redefine existing integer 'count' | give every key"},
        {"TableTwice", "[disks]\n[run]\n[disks]", 1, "cannot redefine existing table 'disks'"},
        {"WordWithoutQuotes", "[box]\nedge = wall", 8,
         "could not determine value type | a word has to stand in quotes"},
        {"PointWithoutDigit", "[box]\nside = .5", 8, "a digit on both sides of the point"},
        {"NoValue", "[box]\nside", 5, "this is not TOML"},
        {"OpenHeader", "[box", 5, "this is not TOML"},
        {"OpenText", "[box]\nedge = \"wall", 13, "this is not TOML"},
        {"IntegerTooLarge", "[run]\nseed = 18446744073709551615", 28,
         "whole numbers of TOML end at 9223372036854775807 (2⁶³ − 1); a seed above that"},
        {"SeedBeyondTheProgram", "[run]\nseed = \"18446744073709551616\"", 8,
         "seed is 18446744073709551616, but must be a whole number from 0 to 18446744073709551615 (2⁶⁴ − 1)"},
        {"SeedFarBelowZero", "[run]\nseed = \"-99999999999999999999\"", 8, "seed is -99999999999999999999, but must"},
        {"CountBeyondTheProgram", "[disks]\ncount = \"99999999999999999999\"", 9,
         "count is 99999999999999999999, but must be at least 1 and at most 1000000000"},
        {"DecimalComma", "[box]\nside = 0,7", 9, "numbers have a decimal point and no comma"},
        {"DecimalCommaInQuotes", "[box]\nside = \"0,7\"", 8, "numbers have a decimal point and no comma"},
        {"CommaInCount", "[disks]\ncount = 1,000", 10, "no comma, as in 0.7 and 10_000"},
        {"NotText", "\xff\xfe\x01", 1, "this is not TOML"},
    }),
    [](auto const& given) { return std::string(given.param.name); });

TEST(SettingsFile, SetIsRefusedWithTheAssignmentItself) {
  struct Case {
    char const* assignment;
    char const* says;
  };
  for (Case const& c : std::vector<Case>{
           {"disks.count", "\"disks.count\" sets nothing"},
           {"=3", "\"\" is not the key"},
           {"disks..count=3", "\"disks..count\" is not the key"},
           {".count=3", "is not the key"},
           {"disks.=3", "is not the key"},
           {"disks count=3", "is not the key"},
           {"disks.cuont=3", "there is no setting \"cuont\" in [disks]"},
           {"count=3", "there is no setting \"count\""},
           {"disks.count=many", "disks.count is the text \"many\", but must be a whole number"},
           {"disks.count=1e3", "disks.count is 1000.0, but must be a whole number"},
           {"disks.count=-3", "disks.count is -3"},
           {"box.side=nan", "box.side is nan"},
           {"box.side=", "box.side is the text \"\""},
           {"run.seed=1180591620717411303424", "run.seed is 1180591620717411303424, but must be a whole number from 0"},
           {"run.seed=-1", "run.seed is -1, but must be a whole number, 0 or above"},
           {"box.edge=open", "box.edge is \"open\", but must be one of"},
           {"box=3", "box is 3, but must be a table"},
           {"disks.count.x=3", "disks.count is a table, but must be a whole number"},
       }) {
    auto const problems = problems_of_set(c.assignment);
    ASSERT_EQ(problems.size(), 1U) << c.assignment;
    EXPECT_NE(problems[0].what.find(c.says), std::string::npos) << problems[0].what;
    EXPECT_EQ(problems[0].file, "--set");
    EXPECT_EQ(problems[0].source_line, c.assignment);
    EXPECT_EQ(problems[0].line, 0);
  }
}

TEST(SettingsFile, SetSaysHowANumberIsWritten) {
  auto const hint = [](std::string const& assignment) { return problems_of_set(assignment).at(0).hint; };
  EXPECT_EQ(hint("box.side=0,7"), "numbers have a decimal point and no comma, as in 0.7 and 10_000");
  EXPECT_EQ(hint("disks.count=1,000"), "numbers have a decimal point and no comma, as in 0.7 and 10_000");
  EXPECT_EQ(hint("box.side=.5"), "write 0.5");
  EXPECT_EQ(hint("disks.count=007"), "write 7");
  EXPECT_EQ(hint("disks.count=1e3"), "write 1000");
  EXPECT_EQ(hint("box.side=wide, long"), "gridlock explain box.side says what it can be");
}

TEST(SettingsFile, WhatIsNoTextIsNotShown) {
  EXPECT_EQ(problems_of_text(std::string("\x7f"
                                         "ELF\x02\x01",
                                         6))
                .at(0)
                .source_line,
            "");
  EXPECT_EQ(problems_of_text("side = \x1b[31m3").at(0).source_line, "side = …");
  auto const problems = problems_of_text("side = \xc3\x28");
  EXPECT_EQ(problems.at(0).source_line, "side = …");
  EXPECT_NE(problems.at(0).hint.find("is this the right file?"), std::string::npos) << problems.at(0).hint;
}

TEST(SettingsFile, SetCannotReachThroughAValueOrIntoAList) {
  SettingsFile file = SettingsFile::from_text("disks.count = 3\ndisks.species = [{}]", "dense.toml");
  EXPECT_EQ(problems_of([&] { file.set("disks.count.x=3"); }).at(0).what,
            "disks.count.x cannot be set, because disks.count is 3, not a table");
  EXPECT_EQ(problems_of([&] { file.set("disks.species.fraction=3"); }).at(0).hint,
            "set the whole list: disks.species=[…]");
}

TEST(SettingsFile, KnowsWhatIsGivenAndWhere) {
  SettingsFile file = SettingsFile::from_text(
      "[disks]\n  packing_fraction = 0.95\n[[disks.species]]\n[[disks.species]]\nfraction = 0.5\n", "dense.toml");
  file.set("run.seed=7");
  for (auto const* key :
       {"disks", "disks.packing_fraction", "disks.species", "disks.species[1].fraction", "run.seed"}) {
    EXPECT_TRUE(file.is_given(key)) << key;
  }
  for (auto const* key : {"box", "disks.count", "disks.species[0].fraction", "disks.species[2]", "run.times", "",
                          "a..b", "disks.species[1", "disks.species[x]"}) {
    EXPECT_FALSE(file.is_given(key)) << key;
  }
  auto const at = [&](std::string_view key) {
    auto const where = file.location(key);
    return where ? fmt::format("{}:{}:{} {}", where->file, where->line, where->column, where->source_line) : "nowhere";
  };
  EXPECT_EQ(at("disks.packing_fraction"), "dense.toml:2:22 packing_fraction = 0.95");
  EXPECT_EQ(at("disks.species[1].fraction"), "dense.toml:5:12 fraction = 0.5");
  EXPECT_EQ(at("disks.species[0].size_ratio"), "dense.toml:3:1 [[disks.species]]");
  EXPECT_EQ(at("disks.radius"), "dense.toml:1:1 [disks]") << "not given: the table it would stand in";
  EXPECT_EQ(at("run.seed"), "--set:0:0 run.seed=7");
  EXPECT_EQ(at("box.side"), "nowhere");
}

TEST(SettingsFile, LocatesProblemsFoundLater) {
  SettingsFile const file = SettingsFile::from_text("[disks]\npacking_fraction = 0.95\n", "dense.toml");
  Error const error = file.locate(Error(std::vector<Problem>{
      {.what = "too dense", .hint = "less", .key = "disks.packing_fraction"},
      {.what = "elsewhere", .key = "disks.file", .file = "a.xyz", .line = 3},
      {.what = "no directory", .key = "-o"},
      {.what = "no key"},
  }));
  EXPECT_EQ(to_text(error.problems()[0]), "too dense\n  --> dense.toml:2:20   packing_fraction = 0.95\n  hint: less");
  EXPECT_EQ(error.problems()[1].line, 3);
  EXPECT_EQ(error.problems()[2].file, "");
  EXPECT_EQ(error.problems()[3].file, "");
}

TEST(SettingsFile, ComesFromAFileAndKnowsItsDirectory) {
  TemporaryDirectory const directory;
  write_file(directory / "dense.toml", "[box]\nside = 2.0\nsid = 3\n");
  SettingsFile const file = SettingsFile::from_path(directory / "dense.toml");
  EXPECT_EQ(file.directory(), directory.path());
  EXPECT_EQ(problems_of([&] { read(file); }).at(0).file, (directory / "dense.toml").string());
  EXPECT_EQ(SettingsFile().directory(), ".");
  EXPECT_THROW(SettingsFile::from_path(directory / "missing.toml"), Error);
  EXPECT_THROW(SettingsFile::from_path(directory.path()), Error);
}

TEST(SettingsFile, ListsAreTakenInTheOrderOfTheFileAndCanBeSet) {
  SettingsFile file = SettingsFile::from_text(R"([disks]
packing_fraction = 0.5
[sweep]
run.seed = [3, 1]
"disks.packing_fraction" = [0.70, 1e-1,
                            0.5]
box.edge = ["wall", "periodic"]
disks.species = [[], [{fraction = 1}]]
run.pictures = [true]
)",
                                              "sweep.toml");
  auto const lists = file.take_lists("sweep");
  ASSERT_EQ(lists.size(), 5U);
  EXPECT_EQ(lists[0].key, "run.seed");
  EXPECT_EQ(lists[0].values, (std::vector<std::string>{"3", "1"}));
  EXPECT_EQ(lists[1].key, "disks.packing_fraction");
  EXPECT_EQ(lists[1].values, (std::vector<std::string>{"0.7", "0.1", "0.5"}));
  EXPECT_EQ(lists[1].location.line, 5);
  EXPECT_EQ(lists[1].value_locations[2].line, 6);
  EXPECT_EQ(lists[1].value_locations[2].column, 29);
  EXPECT_EQ(lists[2].values, (std::vector<std::string>{"\"wall\"", "\"periodic\""}));
  EXPECT_EQ(lists[3].values, (std::vector<std::string>{"[]", "[{ fraction = 1 }]"}));
  EXPECT_EQ(lists[4].values, (std::vector<std::string>{"true"}));

  EXPECT_FALSE(file.is_given("sweep"));
  for (SettingList const& list : lists) file.set(list.key, list.values.back(), list.value_locations.back());
  EXPECT_EQ(read(file), (Configuration{.edge = Border::periodic, .packing_fraction = 0.5, .species = {{}}, .seed = 1}));
  file.set(lists[2].key, "\"soft\"", lists[2].value_locations[1]);
  EXPECT_EQ(problems_of([&] { read(file); }).at(0).line, 7);
}

TEST(SettingsFile, NoTableOfListsMeansNoLists) {
  SettingsFile file = SettingsFile::from_text("[box]\nside = 2", "sweep.toml");
  EXPECT_TRUE(file.take_lists("sweep").empty());
  EXPECT_TRUE(SettingsFile().take_lists("sweep").empty());
}

TEST(SettingsFile, ATableOfListsHoldsNothingElse) {
  SettingsFile file = SettingsFile::from_text(R"([sweep]
run.seed = 3
disks.count = []
"disks.packing_fraction" = [0.1]
disks.packing_fraction = [0.2]
"disks count" = [1]
)",
                                              "sweep.toml");
  auto const problems = problems_of([&] { file.take_lists("sweep"); });
  ASSERT_EQ(problems.size(), 4U);
  EXPECT_EQ(problems[0].what, "run.seed in [sweep] is 3, but must be a list");
  EXPECT_EQ(problems[0].hint, "write run.seed = [3]");
  EXPECT_EQ(problems[0].column, 12);
  EXPECT_EQ(problems[1].what, "disks.count in [sweep] is an empty list");
  EXPECT_EQ(problems[2].what, "disks.packing_fraction is given twice in [sweep]");
  EXPECT_EQ(problems[3].what, "\"disks count\" in [sweep] is not a setting");
  SettingsFile value = SettingsFile::from_text("sweep = 3", "sweep.toml");
  EXPECT_EQ(problems_of([&] { value.take_lists("sweep"); }).at(0).what, "sweep is 3, but must be a table of lists");
}

// Written, read: the same bits.

Configuration random_configuration(std::uint64_t seed) {
  RandomStream random(seed, 0, 0, Purpose::start_position);
  auto const number = [&] {
    // Every magnitude, and numbers that look whole.
    double const any = std::abs(std::bit_cast<double>(random.bits()));
    return random.below(2) == 0 || !std::isfinite(any) ? static_cast<double>(random.below(1000)) : any;
  };
  auto const share = [&] { return random.uniform(); };
  Configuration c;
  c.edge = random.below(2) == 0 ? Border::wall : Border::periodic;
  c.side = 1.0 + number();
  if (random.below(2) == 0) c.width = number();
  if (random.below(2) == 0) c.count = 1 + random.below(1000);
  if (random.below(2) == 0) c.packing_fraction = 0.5 + 0.4 * share();
  for (std::uint64_t i = random.below(20); i > 0; --i) c.file += static_cast<char>(random.below(128));
  for (std::uint64_t i = random.below(4); i > 0; --i)
    c.species.push_back({.fraction = share(), .size_ratio = 1 + share()});
  c.seed = random.bits() >> random.below(64);
  c.pictures = random.below(2) == 0;
  for (std::uint64_t i = random.below(5); i > 0; --i) c.times.push_back(number());
  return c;
}

TEST(SettingsText, WhatIsWrittenReadsBackToTheSameBits) {
  for (std::uint64_t seed = 0; seed < 500; ++seed) {
    SCOPED_TRACE(seed);
    Configuration written = random_configuration(seed);
    std::string const text = to_toml(describe_of(written));
    Configuration back;
    ASSERT_NO_THROW(SettingsFile::from_text(text, "resolved").read_into(describe_of(back))) << text;
    EXPECT_EQ(back, written) << text;
    EXPECT_EQ(to_toml(describe_of(back)), text);
  }
}

TEST(SettingsText, WritesTablesWithoutWhatIsLeftOut) {
  Configuration c{.side = 2.0, .species = {{.fraction = 0.5}, {}}, .seed = 1ULL << 63, .times = {1.0, 0.25}};
  EXPECT_EQ(to_toml(describe_of(c)),
            "[box]\n"
            "edge = \"wall\"\n"
            "side = 2.0\n"
            "\n"
            "[disks]\n"
            "file = \"\"\n"
            "species = [{ fraction = 0.5, size_ratio = 1.0 }, { fraction = 1.0, size_ratio = 1.0 }]\n"
            "\n"
            "[run]\n"
            "seed = \"9223372036854775808\"\n"
            "pictures = true\n"
            "times = [1.0, 0.25]\n");
}

TEST(SettingsText, ExplainsASettingATableAndEverything) {
  Configuration c;
  EXPECT_EQ(explain(describe_of(c), "box.side"),
            "box.side\n    Side of the square.\n    number, in length, above 0; default: 1.0\n");
  EXPECT_EQ(explain(describe_of(c), "side"), explain(describe_of(c), "box.side"));
  EXPECT_EQ(explain(describe_of(c), "box.edge"),
            "box.edge\n    What a disk meets at the border.\n    one of \"wall\", \"periodic\"; default: \"wall\"\n");
  EXPECT_NE(explain(describe_of(c), "box.width").find("default: side\n"), std::string::npos);
  EXPECT_NE(explain(describe_of(c), "disks.count").find("at least 1 and at most 1000000000; default: none\n"),
            std::string::npos);
  std::string const species = explain(describe_of(c), "disks.species");
  EXPECT_EQ(species.find("[[disks.species]]\n    A mixture.\n"), 0U);
  EXPECT_NE(species.find("disks.species.size_ratio\n"), std::string::npos);
  EXPECT_TRUE(c.species.empty()) << "explaining changes nothing";
  std::string const table = explain(describe_of(c), "box");
  EXPECT_EQ(table.find("[box]\n    Where the disks live.\n"), 0U);
  EXPECT_NE(table.find("\nbox.width\n"), std::string::npos);
  EXPECT_EQ(table.find("disks"), table.find("disks live"));
  std::string const everything = explain(describe_of(c), "");
  for (auto const* key : {"[box]", "box.side", "disks.count", "disks.species.fraction", "run.times"}) {
    EXPECT_NE(everything.find(fmt::format("{}\n", key)), std::string::npos) << key;
  }
}

TEST(SettingsText, ListsTheKeyOfEverySetting) {
  Configuration c;
  EXPECT_EQ(setting_keys(describe_of(c)),
            (std::vector<std::string>{"box.edge", "box.side", "box.width", "disks.count", "disks.packing_fraction",
                                      "disks.file", "disks.species.fraction", "disks.species.size_ratio", "run.seed",
                                      "run.pictures", "run.times"}));
}

TEST(SettingsText, KnowsTheSettingBehindAFormerKey) {
  Configuration c;
  EXPECT_EQ(renamed_setting(describe_of(c), "disks.density"), "disks.packing_fraction");
  EXPECT_EQ(renamed_setting(describe_of(c), "disks.packing_fraction"), std::nullopt);
  EXPECT_EQ(renamed_setting(describe_of(c), "disks"), std::nullopt);
}

TEST(SettingsText, AnUnknownKeyIsRefusedWithTheNearest) {
  Configuration c;
  auto const hint = [&](std::string_view key) { return problems_of([&] { explain(describe_of(c), key); }).at(0).hint; };
  EXPECT_EQ(hint("disks.cuont"), "did you mean disks.count?");
  EXPECT_EQ(hint("sid"), "did you mean box.side?");
  EXPECT_EQ(hint("packing"), "did you mean disks.packing_fraction?");
  EXPECT_EQ(hint("magnetisation"), "gridlock explain without a key lists all settings");
}

TEST(SettingsText, TheReferenceHasARowForEverySettingAndNoBrokenCell) {
  Configuration c;
  std::string const page = reference_markdown(describe_of(c));
  EXPECT_NE(page.find("## `[box]`\n\nWhere the disks live.\n\n| setting | values | unit | default | meaning |\n"),
            std::string::npos);
  EXPECT_NE(page.find("| `side` | number, above 0 | length | `1.0` | Side of the square. |\n"), std::string::npos);
  EXPECT_NE(page.find("| `width` | number | length | side | Width \\| of the box. |\n"), std::string::npos);
  EXPECT_NE(page.find("## `[[disks.species]]`\n"), std::string::npos);
  EXPECT_NE(page.find("| `size_ratio` |"), std::string::npos);
}

TEST(SettingsFile, AnyDamageIsEitherReadOrRefused) {
  std::string const whole =
      "# dense\n[box]\nedge = \"periodic\"\nside = 2.0\n[disks]\ncount = 841\npacking_fraction = 0.7\n"
      "species = [{fraction = 0.5, size_ratio = 1.4}, {fraction = 0.5}]\n[run]\nseed = 1\ntimes = [1, 2.5]\n"
      "[sweep]\nrun.seed = [1, 2]\n\"box.side\" = [1.0]\n";
  int refused = 0;
  for (std::uint64_t seed = 0; seed < 3000; ++seed) {
    SCOPED_TRACE(seed);
    try {
      SettingsFile file = SettingsFile::from_text(damaged(whole, seed), "damaged.toml");
      file.take_lists("sweep");
      Configuration c = read(file);
      EXPECT_EQ(read(to_toml(describe_of(c))), c);
    } catch (Error const& error) {
      ++refused;
      EXPECT_EQ(error.problems().at(0).file, "damaged.toml");
    }
  }
  EXPECT_GT(refused, 1000);
}

TEST(SettingsFile, WhatIsNoFileOfSettingsIsRefusedWithoutACrash) {
  std::string const deep = "a" + [] {
    std::string parts;
    for (int i = 0; i < 100'000; ++i) parts += ".a";
    return parts;
  }();
  EXPECT_EQ(problems_of_text(deep + " = 1").size(), 1U);
  EXPECT_EQ(problems_of_text("a = " + std::string(100'000, '[')).size(), 1U);
  EXPECT_EQ(problems_of_text("a = " + std::string(40, '[') + std::string(40, ']')).size(), 1U);
  EXPECT_TRUE(problems_of_text("# " + std::string(1000, '.') + "\n").empty()) << "a ruler in a comment is harmless";
}

}  // namespace
}  // namespace gridlock
