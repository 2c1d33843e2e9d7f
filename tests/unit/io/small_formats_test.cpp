// The small pieces that files are made of: elements and chunks of a trajectory, words cut for messages, settings at the
// edges of their types.

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "drawing/colour.hpp"
#include "drawing/neighbourhood_colour.hpp"
#include "drawing/picture.hpp"
#include "gridlock/core/error.hpp"
#include "gridlock/io/settings_file.hpp"
#include "io/checkpoint.hpp"
#include "io/deflated_chunk.hpp"
#include "io/file.hpp"
#include "io/h5md_layout.hpp"
#include "io/nearest_name.hpp"
#include "io/text.hpp"
#include "unit/drawing/recording_canvas.hpp"
#include "unit/io/temporary_directory.hpp"

namespace gridlock {
namespace {

TEST(H5mdLayout, JoinsTheComponentsOfOneVectorOnlyAndKnowsTheirUnits) {
  std::vector<double> const reals{1.0};
  Frame const frame{.columns = {{"x", reals},
                                {"y", reals},
                                {"velocity_x", reals},
                                {"velocity_y", reals},
                                {"heading_x", reals},
                                {"wind_y", reals},
                                {"mass", reals},
                                {"radius", reals}}};
  std::string text;
  for (h5md::Element const& element : h5md::elements_of(frame.columns)) {
    text += element.name + (element.is_vector() ? " vector" : "") + " [" + element.unit + "], ";
  }
  EXPECT_EQ(text,
            "position vector [length], velocity vector [length/time], heading_x [], wind_y [], mass [mass], "
            "radius [length], ");
}

TEST(H5mdLayout, TheChecksumIsOfEverythingInAFrame) {
  Frame const frame{.box = Box(2.0, 3.0, Edge::wall),
                    .clock = {4, 5.0},
                    .seed = 6,
                    .ids = {7},
                    .columns = {{"x", std::vector<double>{0.5}}}};
  std::array<double, 1> const observables{8.0};
  std::uint64_t const usual = h5md::checksum(frame, observables, 9);
  EXPECT_EQ(h5md::checksum(frame, observables, 9), usual);
  auto const differs = [&](auto change) {
    Frame other = frame;
    change(other);
    return h5md::checksum(other, observables, 9) != usual;
  };
  EXPECT_TRUE(differs([](Frame& f) { f.box = Box(3.0, 2.0, Edge::wall); }));
  EXPECT_TRUE(differs([](Frame& f) { f.box = Box(2.0, 3.0, Edge::periodic); }));
  EXPECT_TRUE(differs([](Frame& f) { f.clock.step = 5; }));
  EXPECT_TRUE(differs([](Frame& f) { f.clock.time = 5.5; }));
  EXPECT_TRUE(differs([](Frame& f) { f.seed = 7; }));
  EXPECT_TRUE(differs([](Frame& f) { f.ids[0] = 8; }));
  EXPECT_TRUE(differs([](Frame& f) { f.columns[0].name = "y"; }));
  EXPECT_TRUE(differs([](Frame& f) { f.columns[0].values = std::vector<double>{0.25}; }));
  EXPECT_NE(h5md::checksum(frame, observables, 10), usual);
  EXPECT_NE(h5md::checksum(frame, std::array{8.5}, 9), usual);
}

TEST(DeflatedChunk, IsAsSmallAsItsOwnLevelMakesIt) {
  std::vector<double> numbers;
  for (int n = 0; n < 5000; ++n) numbers.push_back(n % 97 + 0.25 * (n % 13));
  ChunkSource const source{.bytes = std::as_bytes(std::span(numbers)), .width = 8, .capacity = 6000};
  std::size_t const fastest = deflated_chunk(source, 1).size();
  std::size_t const smallest = deflated_chunk(source, 9).size();
  EXPECT_LT(smallest, fastest);
  EXPECT_EQ(deflated_chunk(source, 1).size(), fastest) << "after another level on the same thread";
  EXPECT_EQ(deflated_chunk(source, 0).size(), 6000U * 8U);
}

TEST(DeflatedChunk, OfNothingButTheFillValueIsLeftOutUnlessItHasToBeThere) {
  std::vector<std::uint64_t> const numbers(10, 5);
  ChunkSource source{.bytes = std::as_bytes(std::span(numbers)), .width = 8, .capacity = 12, .fill = 5};
  EXPECT_TRUE(deflated_chunk(source, 1).empty());
  source.keeps_fill = true;
  EXPECT_FALSE(deflated_chunk(source, 1).empty());
  std::vector<std::byte> const raw = deflated_chunk(source, 0);
  ASSERT_EQ(raw.size(), 12U * 8U);
  for (std::size_t n = 0; n < 12; ++n) EXPECT_EQ(raw[8 * n], std::byte{5}) << n;
}

TEST(Cut, FallsBetweenTheCharactersOfUtf8) {
  EXPECT_EQ(cut("aéb", 2), "a…");
  EXPECT_EQ(cut("aéb", 3), "aé…");
  EXPECT_EQ(cut("aéb", 4), "aéb");
}

TEST(NeighbourhoodColour, AnAxisOfOneCellNeedsOneColour) {
  for (bool const is_periodic : {false, true}) EXPECT_EQ(neighbourhood_colour(0, 0, 1, 1, is_periodic, is_periodic), 0);
}

TEST(NeighbourhoodColour, ThreeColoursAreForTheAxisThatGoesAround) {
  EXPECT_EQ(neighbourhood_colour(2, 2, 3, 3, true, true), 2 + 3 * 2);
  EXPECT_EQ(neighbourhood_colour(2, 2, 3, 3, true, false), 2);
  EXPECT_EQ(neighbourhood_colour(2, 2, 3, 3, false, true), 3 * 2);
}

TEST(NearestName, OfAShortWordIsNoneWhereEveryLetterDiffers) {
  std::vector<std::string> const names{"x", "ab"};
  EXPECT_EQ(nearest_name("y", names), "");
  EXPECT_EQ(nearest_name("cd", names), "");
}

struct TwoSettings {
  std::uint64_t seed = 1;
  std::string word = "none";
};
Describe describing(TwoSettings& settings) {
  return [&settings](SettingVisitor& visitor) {
    visitor.enter("run", "");
    visitor.visit({.key = "seed", .documentation = ""}, settings.seed);
    visitor.visit({.key = "word", .documentation = ""}, settings.word);
    visitor.leave();
  };
}

TEST(SettingsAtTheEdge, EverySeedIsReadBackAsItIsWritten) {
  constexpr std::uint64_t largest_of_toml = 9223372036854775807U;
  for (std::uint64_t const seed :
       {std::uint64_t{0}, largest_of_toml - 1, largest_of_toml, largest_of_toml + 1, ~std::uint64_t{0}}) {
    TwoSettings written{.seed = seed};
    TwoSettings read;
    SettingsFile::from_text(to_toml(describing(written)), "seeds").read_into(describing(read));
    EXPECT_EQ(read.seed, seed);
  }
}

TEST(SettingsAtTheEdge, BlanksAroundAnAssignmentAreNoPartOfIt) {
  SettingsFile file;
  file.set(" run.word =  some words \t");
  TwoSettings read;
  file.read_into(describing(read));
  EXPECT_EQ(read.word, "some words");
}

TEST(SettingsAtTheEdge, AnAssignmentIsOneSettingAndNoFurtherLines) {
  SettingsFile file;
  file.set("run.seed=5\nother = 6");
  TwoSettings read;
  EXPECT_THROW(file.read_into(describing(read)), Error);
  EXPECT_EQ(read.seed, 1U);
}

TEST(SettingsAtTheEdge, DotsInAValueAreNotDotsOfItsKey) {
  TwoSettings read;
  SettingsFile::from_text("run.word = \"" + std::string(64, '.') + "\"\n", "dots").read_into(describing(read));
  EXPECT_EQ(read.word, std::string(64, '.'));
}

TEST(CheckpointMembers, KeepTheSignOfZero) {
  double saved = -0.0;
  double restored = 1.0;
  from_checkpoint(to_checkpoint([&](Archive& archive) { archive.visit("zero", saved); }), "a",
                  [&](Archive& archive) { archive.visit("zero", restored); });
  EXPECT_EQ(restored, 0.0);
  EXPECT_TRUE(std::signbit(restored));
}

TEST(CheckpointMembers, OfAnotherTypeAreRefusedThoughTheirSizesFit) {
  std::vector<double> saved{1.0, 2.0};
  std::string const bytes = to_checkpoint([&](Archive& archive) { archive.visit("list", saved); });
  std::vector<std::uint64_t> restored;
  EXPECT_THROW(from_checkpoint(bytes, "a", [&](Archive& archive) { archive.visit("list", restored); }), Error);
}

TEST(CheckpointFiles, OfWhichNoneCanBeUsedTheNewestIsNamedAndBothAreRemoved) {
  TemporaryDirectory const directory;
  write_file(directory / "checkpoint.gridlock", "newer");
  write_file(directory / "checkpoint.previous.gridlock", "older");
  try {
    static_cast<void>(restore_checkpoint(directory.path(), [](Archive&) {}));
    FAIL();
  } catch (Error const& error) {
    EXPECT_EQ(error.problems().front().file, (directory / "checkpoint.gridlock").string());
  }
  remove_checkpoints(directory.path());
  EXPECT_TRUE(std::filesystem::is_empty(directory.path()));
}

TEST(Picture, TheBarBeginsAtTheLeastValueAlsoBelowZero) {
  State state{.box = Box(1.0, 1.0, Edge::wall)};
  state.agents.add(0.25, 0.5, 0.0, 0.0, 0.1, 1.0, 0, 0);
  state.agents.add(0.75, 0.5, 0.0, 0.0, 0.1, 1.0, 0, 0);
  std::vector<double> const values{-3.0, 1.0};
  RecordingCanvas canvas;
  draw_picture(state, {.colouring = Colouring::values, .values = values}, canvas);
  EXPECT_EQ(canvas.colours_of_circles(),
            (std::vector<std::string>{RecordingCanvas::hex(viridis(0.0)), RecordingCanvas::hex(viridis(1.0))}));
  EXPECT_EQ(canvas.texts.front(), "-3") << "the least value has its tick";
}

}  // namespace
}  // namespace gridlock
