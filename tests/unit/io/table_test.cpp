#include "gridlock/io/table.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <limits>

#include "gridlock/core/error.hpp"
#include "gridlock/core/random.hpp"
#include "io/file.hpp"
#include "unit/io/damage.hpp"
#include "unit/io/temporary_directory.hpp"

namespace gridlock {
namespace {

using Numbers = std::vector<double>;
using Counts = std::vector<std::uint64_t>;
using Words = std::vector<std::string>;

Table example() {
  Table table;
  table.add_column("step", Counts{0, 100, std::numeric_limits<std::uint64_t>::max()});
  table.add_column("time", Numbers{0.0, 0.1, 1e300});
  table.add_column("start", Words{"square", "with \"quotes\", commas", ""});
  return table;
}

std::vector<Problem> problems_of_table(std::string const& text) {
  try {
    parse_csv(text, "series.csv");
  } catch (Error const& error) {
    return error.problems();
  }
  return {};
}

TEST(Table, WritesPlainNamesThenALineForEachRow) {
  EXPECT_EQ(to_csv(example()),
            "step,time,start\n"
            "0,0.0,\"square\"\n"
            "100,0.1,\"with \"\"quotes\"\", commas\"\n"
            "18446744073709551615,1e+300,\"\"\n");
}

TEST(Table, ReadsBackTheSameTable) {
  TemporaryDirectory const directory;
  write_csv(example(), directory / "series.csv");
  EXPECT_EQ(read_csv(directory / "series.csv"), example());
}

TEST(Table, ReadsBackTheSameBitsOfEveryNumber) {
  RandomStream random(20, 0, 0, Purpose::start_position);
  Numbers numbers{0.0, -0.0, 1.0, -17.0, 5e-324, std::numeric_limits<double>::max(), INFINITY, -INFINITY};
  while (numbers.size() < 2000) {
    double const number = std::bit_cast<double>(random.bits());
    if (!std::isnan(number)) numbers.push_back(number);
  }
  Table table;
  table.add_column("x", numbers);
  Numbers const read = parse_csv(to_csv(table), "x.csv").numbers("x");
  ASSERT_EQ(read.size(), numbers.size());
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    EXPECT_EQ(std::bit_cast<std::uint64_t>(read[i]), std::bit_cast<std::uint64_t>(numbers[i])) << numbers[i];
  }
}

TEST(Table, RowsAndColumnsBuildTheSameTable) {
  Table table;
  table.add_column("step", Counts{});
  table.add_column("time", Numbers{});
  table.add_column("start", Words{});
  table.add_row(std::vector<Cell>{std::uint64_t{0}, 0.0, "square"});
  table.add_row(std::vector<Cell>{std::uint64_t{100}, 0.1, "with \"quotes\", commas"});
  table.add_row(std::vector<Cell>{std::numeric_limits<std::uint64_t>::max(), 1e300, ""});
  EXPECT_EQ(table, example());
  EXPECT_EQ(table.row_count(), 3U);
  EXPECT_TRUE(table.contains("time"));
  EXPECT_FALSE(table.contains("tim"));
}

TEST(Table, CountsCanBeTakenAsNumbersAndWordsCannot) {
  EXPECT_EQ(example().numbers("step"), (Numbers{0.0, 100.0, 18446744073709551616.0}));
  EXPECT_TRUE(example().numbers("start").empty());
}

TEST(Table, ReadsWhatOtherProgramsWrite) {
  Table const table = parse_csv("\xEF\xBB\xBF# made by hand\r\na, b,\"c\"\r\n\r\n1, 2.5,3\r\n-4,,+6\r\n", "hand.csv");
  EXPECT_EQ(table.names(), (Words{"a", "b", "c"}));
  EXPECT_EQ(table.numbers("a"), (Numbers{1.0, -4.0}));
  EXPECT_EQ(table.numbers("b")[0], 2.5);
  EXPECT_TRUE(std::isnan(table.numbers("b")[1]));
  EXPECT_EQ(table.column("c"), CellColumn(Counts{3, 6}));
}

TEST(Table, NamesLineAndColumnOfEverythingWrong) {
  auto const problems = problems_of_table("a,b\n1,2\n3\n4,five\n\"6\",7\n8,\"nine\n");
  ASSERT_EQ(problems.size(), 4U);
  EXPECT_EQ(to_text(problems[0]),
            "the line has 1 entry for 2 columns\n  --> series.csv:3   3\n  hint: is the line cut off?");
  EXPECT_EQ(problems[1].what, "\"five\" in column \"b\" is not a number");
  EXPECT_EQ(problems[1].line, 4);
  EXPECT_EQ(problems[1].column, 3);
  EXPECT_EQ(problems[2].what, "\"6\" in column \"a\" is not a number");
  EXPECT_EQ(problems[2].line, 5);
  EXPECT_EQ(problems[3].what, "a quoted word does not end");
  EXPECT_EQ(problems[3].line, 6);
  EXPECT_EQ(problems[3].column, 3);
}

TEST(Table, RefusesAnEmptyFileAndNamesThatDoNotName) {
  EXPECT_EQ(problems_of_table("").at(0).what, "the file holds no table");
  EXPECT_EQ(problems_of_table("# only a comment\n").at(0).what, "the file holds no table");
  EXPECT_EQ(problems_of_table("a,b,a\n1,2,3\n").at(0).what, "two columns are named \"a\"");
  EXPECT_EQ(problems_of_table("a,\"b,c\"\n1,2\n").at(0).what, "\"b,c\" cannot name a column");
  EXPECT_EQ(problems_of_table("a,,b\n1,2,3\n").at(0).what, "a column has no name");
  // Only quotes keep the spaces at the ends of a name, and names are written without quotes.
  EXPECT_EQ(problems_of_table("a,\" b\"\n1,2\n").at(0).what, "\" b\" cannot name a column");
  EXPECT_EQ(problems_of_table("a,\"b \"\n1,2\n").at(0).what, "\"b \" cannot name a column");
  std::string const two_marks = "\xEF\xBB\xBF\xEF\xBB\xBF";
  EXPECT_TRUE(problems_of_table(two_marks + "a,b\n1,2\n").at(0).what.ends_with("a\" cannot name a column"));
}

TEST(Table, ReportsTenProblemsAtMost) {
  std::string text = "a\n";
  for (int i = 0; i < 1000; ++i) text += "x\n";
  EXPECT_EQ(problems_of_table(text).size(), 10U);
}

TEST(Table, AnyDamageIsEitherReadOrRefused) {
  std::string const whole = to_csv(example());
  int refused = 0;
  for (std::uint64_t seed = 0; seed < 3000; ++seed) {
    SCOPED_TRACE(seed);
    try {
      Table const table = parse_csv(damaged(whole, seed), "damaged.csv");
      EXPECT_EQ(to_csv(parse_csv(to_csv(table), "again.csv")), to_csv(table));
    } catch (Error const& error) {
      ++refused;
      EXPECT_EQ(error.problems().at(0).file, "damaged.csv");
    }
  }
  EXPECT_GT(refused, 500);
}

}  // namespace
}  // namespace gridlock
