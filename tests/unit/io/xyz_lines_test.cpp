// The second lines of files in extended XYZ that tests/reference/xyz_lines.json lists, which the tests of the page read
// too.

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <array>
#include <string>
#include <vector>

#include "gridlock/core/error.hpp"
#include "gridlock/io/xyz.hpp"
#include "io/file.hpp"
#include "io/xyz_comment.hpp"
#include "io/xyz_shown.hpp"

namespace gridlock {
namespace {

using Json = nlohmann::json;

Json table_of_lines() { return Json::parse(read_file(GRIDLOCK_SOURCE_DIR "/tests/reference/xyz_lines.json")); }

std::string file_of(Json const& one) {
  return fmt::format("1\n{}\n{}\n", one["line"].get<std::string>(), one.value("row", "X 0.25 0.5 0"));
}

/// The error that the program gives for a file; empty where it is read.
std::string refusal_of(std::string const& text) {
  try {
    parse_xyz(text, "file.xyz");
  } catch (Error const& error) {
    return error.problems().at(0).what;
  }
  return "";
}

std::string refusal_by_page(std::string const& text) {
  try {
    xyz::read_shown(TextReader(text, "file.xyz"), 1);
  } catch (Error const& error) {
    return error.problems().at(0).what;
  }
  return "";
}

std::vector<double> const& column_of(xyz::ShownFrame const& frame, std::string const& name) {
  for (xyz::ShownColumn const& column : frame.columns) {
    if (column.name == name) return column.values;
  }
  throw std::out_of_range(name);
}

/// Whether the box is periodic along x and along y.
std::array<bool, 2> periodic_axes(Json const& one) {
  std::string const edges = one["edges"].get<std::string>();
  return {edges == "periodic" || edges == "periodic in x", edges == "periodic" || edges == "periodic in y"};
}

void expect_shown(xyz::ShownFrame const& frame, Json const& one) {
  ASSERT_EQ(frame.sides.has_value(), !one["box"].is_null());
  if (!frame.sides) return;
  EXPECT_EQ((*frame.sides)[0], one["box"][0].get<double>());
  EXPECT_EQ((*frame.sides)[1], one["box"][1].get<double>());
  EXPECT_EQ(frame.is_periodic, periodic_axes(one));
  EXPECT_DOUBLE_EQ(column_of(frame, "x").at(0), one["first"][0].get<double>());
  EXPECT_DOUBLE_EQ(column_of(frame, "y").at(0), one["first"][1].get<double>());
}

TEST(XyzLines, EverySpellingOfTheSpecificationIsRead) {
  Json const table = table_of_lines();
  ASSERT_GT(table["read"].size(), 100U);
  for (Json const& one : table["read"]) {
    SCOPED_TRACE(one.dump());
    std::string const text = file_of(one);
    ASSERT_EQ(refusal_of(text), "");
    XyzFrame const frame = parse_xyz(text, "file.xyz");
    EXPECT_EQ(frame.state.box.width(), one["box"][0].get<double>());
    EXPECT_EQ(frame.state.box.height(), one["box"][1].get<double>());
    Box const& box = frame.state.box;
    EXPECT_EQ((std::array{box.is_periodic_x(), box.is_periodic_y()}), periodic_axes(one));
    EXPECT_DOUBLE_EQ(position(frame.state.agents, 0).x, one["first"][0].get<double>());
    EXPECT_DOUBLE_EQ(position(frame.state.agents, 0).y, one["first"][1].get<double>());
    expect_shown(xyz::read_shown(TextReader(text, "file.xyz"), 1), one);
  }
}

TEST(XyzLines, WhatTheSpecificationDoesNotHaveIsRefusedByNameInProgramAndPage) {
  Json const table = table_of_lines();
  ASSERT_GT(table["refused"].size(), 30U);
  for (Json const& one : table["refused"]) {
    std::string const says = one["says"].get<std::string>();
    EXPECT_NE(refusal_of(file_of(one)).find(says), std::string::npos) << one.dump() << '\n' << refusal_of(file_of(one));
    EXPECT_NE(refusal_by_page(file_of(one)), "") << one.dump();
  }
}

TEST(XyzLines, ThePageShowsWhatDisksCannotBe) {
  Json const table = table_of_lines();
  ASSERT_GT(table["shown"].size(), 8U);
  for (Json const& one : table["shown"]) {
    SCOPED_TRACE(one.dump());
    EXPECT_NE(refusal_of(file_of(one)).find(one["says"].get<std::string>()), std::string::npos);
    ASSERT_EQ(refusal_by_page(file_of(one)), "");
    expect_shown(xyz::read_shown(TextReader(file_of(one), "file.xyz"), 1), one);
  }
}

/// The key=value pairs of the reference parser's own tests: numbers, truths, words, quotes, vectors and matrices.
std::vector<std::string> foreign_entries() {
  std::vector<std::string> values;
  for (std::string const sign : {"", "+", "-"}) {
    for (std::string const number : {"1", "12", "1.0", "1.", "12.0", "0.12", "0.012", ".012"}) {
      values.push_back(sign + number);
      for (std::string const letter : {"e", "E", "d", "D"}) {
        for (std::string const exponent : {"0", "+2", "-02", "12"}) values.push_back(sign + number + letter + exponent);
      }
    }
  }
  for (std::string const value : {"T",
                                  "true",
                                  "True",
                                  "TRUE",
                                  "F",
                                  "false",
                                  "False",
                                  "FALSE",
                                  "\" 3 \"",
                                  "{ 3}",
                                  "TRuE",
                                  "1.3k7",
                                  "-2.75e",
                                  "+2.75e-",
                                  "0012.1e-6",
                                  "!#$%&'()*+-./0:;<>?@AZ^_`az|~",
                                  "\"line one\\nline two\"",
                                  "\"\\\"a\\\"\"",
                                  "\"a\\\\b\"",
                                  "\"a\\b\"",
                                  "\"1 2 3\"",
                                  "{1.0 2 3}",
                                  "[1, 2.0, 3]",
                                  "\"T F True FALSE\"",
                                  "[T, F, True, FALSE]",
                                  "[ \"a\", \"b\" ]",
                                  "[ a, b ]",
                                  "[a,b]",
                                  "[\"a\",\"b\"]",
                                  "[ \"a, b\", \"c]\" ]",
                                  "[ T, F, bob, TRUE ]",
                                  "[ [ 1, 2 ] ]",
                                  "[ [ 1, 2 ], [ 3, 4 ] ]",
                                  "[ [ 1.1, 2.0 ], [ -3.2, 4.5 ] ]",
                                  "[ [ F, False ], [ TRUE, true ] ]",
                                  "[ [ a, b, bob, \"joe\", sam, \"end\" ] ]",
                                  "[ [ T, FALSE], [ 12, -5 ], [ b, sam ], [ \"a\", \"joe\"] ]"}) {
    values.push_back(value);
  }
  return values;
}

TEST(XyzLines, EntriesOfOtherProgramsChangeNothingWhereverTheyStand) {
  std::string const known =
      "Lattice=\"2 0 0 0 3 0 0 0 1\" Properties=species:S:1:pos:R:3 pbc=\"F F F\" Time=0.5 step=7";
  std::vector<std::string> const values = foreign_entries();
  ASSERT_GT(values.size(), 400U);
  for (std::string const& value : values) {
    for (std::string const sign : {"=", " = ", "= ", " ="}) {
      std::string const entry = "entry" + sign + value;
      for (std::string const& line : {entry + ' ' + known, known + ' ' + entry}) {
        SCOPED_TRACE(line);
        std::string const text = fmt::format("1\n{}\nX 0.25 0.5 0\n", line);
        ASSERT_EQ(refusal_of(text), "");
        XyzFrame const frame = parse_xyz(text, "file.xyz");
        EXPECT_EQ(frame.state.box, Box(2, 3, Edge::wall));
        EXPECT_EQ(frame.state.clock, (Clock{.step = 7, .time = 0.5}));
      }
    }
  }
}

TEST(XyzLines, EntriesHaveTheirTextWithoutQuotesAndEscapes) {
  std::string const text = "a=\"x \\\"y\\\" \\\\ \\n\" \"b c\" = {1 {2} 3} d 'e f'=[[1, 2], [3, 4]] g=h=i it's";
  xyz::Lines lines{TextReader(text, "line")};
  ASSERT_TRUE(lines.next());
  std::vector<std::string> found;
  for (xyz::Entry const& entry : xyz::entries_of(lines)) found.push_back(entry.key + '|' + entry.value);
  EXPECT_EQ(found, (std::vector<std::string>{"a|x \"y\" \\ \n", "b c|1 {2} 3", "d|T", "e f|[[1, 2], [3, 4]]", "g|h=i",
                                             "it's|T"}));
}

}  // namespace
}  // namespace gridlock
