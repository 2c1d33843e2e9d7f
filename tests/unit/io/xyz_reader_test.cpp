#include "io/xyz_reader.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "gridlock/core/error.hpp"
#include "gridlock/core/random.hpp"
#include "io/file.hpp"
#include "unit/io/temporary_directory.hpp"

namespace gridlock {
namespace {

/// Rows with numbers of all lengths, Ids downwards, and columns that disks do not have.
std::string text_of_rows(std::size_t count) {
  RandomStream random(5, 0, 0, Purpose::start_position);
  std::string text =
      fmt::format("{}\nLattice=\"1 0 0 0 1 0 0 0 1\" Properties=heat:R:1:pos:R:2:id:I:1:radius:R:1:tag:S:1\n", count);
  for (std::size_t k = 0; k < count; ++k) {
    text += fmt::format("{} {} {} {} 0.01 {}\n", random.normal(), random.uniform(), random.below(2), count - k,
                        std::string(1 + random.below(5), 't'));
  }
  return text;
}

std::vector<double> numbers_of(xyz::Rows const& rows) {
  std::vector<double> numbers = rows.others;
  for (xyz::Row const& row : rows.disks) {
    numbers.insert(numbers.end(), {static_cast<double>(row.id), row.position.x, row.position.y, row.radius, row.mass,
                                   static_cast<double>(row.number)});
  }
  return numbers;
}

std::optional<Problem> problem_of(TextReader text) {
  try {
    xyz::Reader reader(std::move(text));
    xyz::read_all(reader);
  } catch (Error const& error) {
    return error.problems().at(0);
  }
  return std::nullopt;
}

void expect_same(std::optional<Problem> const& one, std::optional<Problem> const& other) {
  ASSERT_TRUE(one && other);
  EXPECT_EQ(one->what, other->what);
  EXPECT_EQ(one->hint, other->hint);
  EXPECT_EQ(one->line, other->line);
  EXPECT_EQ(one->column, other->column);
}

TEST(XyzReader, PiecesOfEverySizeHoldTheSameRows) {
  std::string const text = text_of_rows(40);
  xyz::Rows whole;
  xyz::Reader at_once(TextReader(text, "rows.xyz"));
  ASSERT_TRUE(at_once.read(40, whole));
  for (std::size_t most = 1; most <= 45; ++most) {
    xyz::Reader reader(TextReader(text, "rows.xyz"));
    xyz::Rows all;
    std::size_t largest = 0;
    for (std::size_t had = 0; reader.read(most, all); had = all.disks.size()) {
      largest = std::max(largest, all.disks.size() - had);
    }
    EXPECT_EQ(numbers_of(all), numbers_of(whole)) << most;
    EXPECT_EQ(largest, std::min<std::size_t>(most, 40));
    EXPECT_FALSE(reader.read(most, all)) << "also when it is asked again";
  }
}

TEST(XyzReader, WhatIsWrongHasItsPlaceInPiecesOfEverySize) {
  std::string text = text_of_rows(40);
  text.replace(text.find(" 0.01", text.size() / 2), 5, " -0.1");
  std::optional<Problem> const expected = problem_of({text, "rows.xyz"});
  ASSERT_TRUE(expected);
  EXPECT_GT(expected->line, 15);
  for (std::size_t most = 1; most <= 41; ++most) {
    xyz::Reader reader(TextReader(text, "rows.xyz"));
    xyz::Rows rows;
    std::optional<Problem> found;
    try {
      while (reader.read(most, rows)) {
      }
    } catch (Error const& error) {
      found = error.problems().at(0);
    }
    expect_same(found, expected);
    EXPECT_EQ(found->source_line, expected->source_line);
  }
}

/// What a pipe gives of a text, a few bytes at a time.
template <class Read>
void through_pipe(std::string const& text, std::size_t bytes_at_a_time, Read read) {
  TemporaryDirectory const directory;
  std::filesystem::path const pipe = directory / "pipe";
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  std::thread writer([&] {
    std::ofstream out(pipe);
    for (std::size_t at = 0; at < text.size(); at += bytes_at_a_time)
      out << text.substr(at, bytes_at_a_time) << std::flush;
  });
  read(pipe);
  writer.join();
}

TEST(XyzReader, BytesMayComeInPiecesOfEverySize) {
  std::string const text = text_of_rows(30);
  xyz::Reader reader(TextReader(text, "rows.xyz"));
  std::uint64_t const expected = hash(xyz::read_all(reader).state);
  for (std::size_t const bytes : {1U, 2U, 3U, 7U, 50U, 4096U}) {
    through_pipe(text, bytes,
                 [&](std::filesystem::path const& pipe) { EXPECT_EQ(hash(read_xyz(pipe).state), expected); });
  }
}

TEST(XyzReader, APipeIsNotReadAgainToShowALine) {
  std::string text = text_of_rows(30);
  text.replace(text.find(" 0.01", text.size() / 2) - 2, 2, "30");
  std::optional<Problem> const expected = problem_of({text, "rows.xyz"});
  ASSERT_TRUE(expected);
  EXPECT_NE(expected->what.find("given twice, first on line"), std::string::npos) << expected->what;
  EXPECT_NE(expected->source_line, "");
  through_pipe(text, 100, [&](std::filesystem::path const& pipe) {
    std::optional<Problem> const found = problem_of(TextReader(pipe));
    expect_same(found, expected);
    EXPECT_EQ(found->source_line, "");
  });
}

TEST(XyzReader, ALineMayBeLongerThanAPiece) {
  std::string text = text_of_rows(30);
  text.insert(text.find("Lattice"), "note=\"" + std::string(3'000'000, 'n') + "\" ");
  XyzFrame const frame = parse_xyz(text, "rows.xyz");
  EXPECT_EQ(frame.state.agents.size(), 30U);
  EXPECT_EQ(problem_of({text + "x", "rows.xyz"})->line, 33);
}

TEST(XyzReader, DamageOfAPackedFileIsTheErrorWhateverItsBytesSay) {
  TemporaryDirectory const directory;
  std::string text = text_of_rows(3000);
  text.replace(text.find(" 0.01", text.size() / 3), 5, " -0.1");
  write_file(directory / "rows.xyz", text);
  std::string const packed = (directory / "rows.xyz.gz").string();
  ASSERT_EQ(std::system(fmt::format("gzip -c {} > {}", (directory / "rows.xyz").string(), packed).c_str()), 0);
  expect_same(problem_of(TextReader(std::filesystem::path(packed))), problem_of({text, "rows.xyz"}));
  std::string const bytes = read_file(packed);
  write_file(packed, bytes.substr(0, bytes.size() - 3));
  EXPECT_NE(problem_of(TextReader(std::filesystem::path(packed)))->what.find("cannot unpack"), std::string::npos);
}

TEST(XyzReader, OfWrongIdsThatOfTheLowestSlotIsFound) {
  constexpr Id reborn = Id{1} << 32;
  std::vector<xyz::IdOfRow> good{{7, 0}, {5, 1}, {reborn + 6, 2}};
  EXPECT_FALSE(xyz::find_wrong_id(good, 3));
  std::vector<xyz::IdOfRow> wrong{{0xFFFFFFFF, 0}, {9, 1}, {reborn + 4, 2}, {9, 3}, {4, 4}, {4, 5}};
  auto const found = xyz::find_wrong_id(wrong, 6);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->id, 4U);
  EXPECT_EQ(found->row, 4U);
  EXPECT_EQ(found->first_row, 2U);
  std::vector<xyz::IdOfRow> beyond{{1, 0}, {0xFFFFFFFE, 1}, {0xFFFFFFFF, 2}};
  EXPECT_EQ(xyz::find_wrong_id(beyond, 3)->id, 0xFFFFFFFEU);
  EXPECT_FALSE(xyz::find_wrong_id(beyond, 3)->first_row);
}

}  // namespace
}  // namespace gridlock
