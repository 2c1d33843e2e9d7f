#include "drawing/picture.hpp"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <numbers>
#include <set>
#include <string>
#include <vector>

#include "drawing/colour.hpp"
#include "drawing/neighbourhood_colour.hpp"
#include "gridlock/core/error.hpp"
#include "gridlock/core/random.hpp"
#include "gridlock/grid/cell_layout.hpp"
#include "io/file.hpp"
#include "unit/drawing/number_in_png.hpp"
#include "unit/io/markup_document.hpp"
#include "unit/io/temporary_directory.hpp"

namespace gridlock {
namespace {

/// `count` disks at rest anywhere in the box; pictures do not mind overlaps.
State scattered(Box const& box, std::size_t count, double radius, std::uint64_t seed = 1) {
  State state;
  state.box = box;
  for (std::size_t i = 0; i < count; ++i) {
    RandomStream random(seed, 0, i, Purpose::start_position);
    double const x = random.uniform() * box.width();
    double const y = random.uniform() * box.height();
    state.agents.add(x, y, random.normal(), random.normal(), radius, 1.0, 0, 0);
  }
  return state;
}

/// One small disk in the middle of each cell of a grid, row after row.
State one_disk_per_cell(Edge edge, int columns, int rows) {
  State state;
  state.box = Box(1.0, 1.0, edge);
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      state.agents.add((column + 0.5) / columns, (row + 0.5) / rows, 0, 0, 0.2 / std::max(columns, rows), 1, 0, 0);
    }
  }
  return state;
}

MarkupDocument drawn(State const& state, PictureSettings const& settings) {
  MarkupDocument document(picture_svg(state, settings));
  EXPECT_EQ(document.problem, "");
  return document;
}

std::vector<std::string> colours_of_disks(State const& state, PictureSettings const& settings) {
  std::vector<std::string> colours;
  for (auto const& circle : drawn(state, settings).named("circle")) colours.push_back(circle.attributes.at("fill"));
  return colours;
}

TEST(Picture, OfAWalledBoxHoldsOneCircleForEachDisk) {
  EXPECT_EQ(drawn(scattered(Box(1, 1, Edge::wall), 321, 0.02), {}).count("circle"), 321U);
}

TEST(Picture, OfNoDisksIsAnEmptyBox) {
  State state;
  for (Colouring const colouring : {Colouring::radius, Colouring::neighbourhood, Colouring::speed, Colouring::values}) {
    EXPECT_EQ(drawn(state, {.colouring = colouring, .columns = 3, .rows = 3}).count("circle"), 0U);
    EXPECT_FALSE(picture_png(state, {.colouring = colouring}).empty());
  }
}

RC_GTEST_PROP(Picture, ShowsEveryPeriodicImageThatReachesIntoTheBox, ()) {
  double const width = *rc::gen::inRange(1, 40) / 10.0;
  double const radius = *rc::gen::inRange(1, 50) / 100.0 * std::min(1.0, width);
  State const state = scattered(Box(width, 1.0, Edge::periodic), 20, radius, *rc::gen::arbitrary<std::uint64_t>());
  std::size_t images = 0;
  for (std::size_t i = 0; i < state.agents.size(); ++i) {
    Vector const p = position(state.agents, i);
    // Along an axis: itself, and one more for each edge nearer than the radius.
    auto const along = [&](double x, double side) { return 1U + (x - radius < 0.0) + (x + radius > side); };
    images += along(p.x, width) * along(p.y, 1.0);
  }
  RC_ASSERT(MarkupDocument(picture_svg(state, {})).count("circle") == images);
}

TEST(Picture, PutsDisksWhereTheyAreWithTheOriginAtTheLowerLeft) {
  State state;
  state.agents.add(0.25, 0.25, 0, 0, 0.2, 1, 0, 0);
  state.agents.add(0.75, 0.5, 0, 0, 0.2, 1, 0, 0);
  auto const circles = drawn(state, {.width = 720}).named("circle");
  auto const number = [&](int i, char const* name) { return std::stod(circles.at(i).attributes.at(name)); };
  double const pixels = 2.0 * (number(1, "cx") - number(0, "cx"));  // the side of the box
  EXPECT_GT(pixels, 0.9 * 720);
  EXPECT_NEAR(number(0, "cy") - number(1, "cy"), 0.25 * pixels, 1e-2);
  // The outline of 0.8 pixels lies inside the disk.
  EXPECT_NEAR(number(0, "r"), 0.2 * pixels - 0.4, 0.05);
}

RC_GTEST_PROP(NeighbourhoodColours, DifferBetweenAllAdjacentCellsAcrossPeriodicEdgesToo, ()) {
  int const columns = *rc::gen::inRange(1, 13);
  int const rows = *rc::gen::inRange(1, 13);
  Edge const edge = *rc::gen::element(Edge::wall, Edge::periodic);
  State const state = one_disk_per_cell(edge, columns, rows);
  auto const colours = colours_of_disks(state, {.colouring = Colouring::neighbourhood,
                                                .columns = static_cast<std::uint64_t>(columns),
                                                .rows = static_cast<std::uint64_t>(rows)});
  CellLayout const layout(state.box, columns, rows);
  for (int cell = 0; cell < layout.count(); ++cell) {
    layout.for_each_cell_in_block(cell, 1, 1, [&](int other) {
      if (other != cell) RC_ASSERT(colours.at(cell) != colours.at(other));
    });
  }
}

RC_GTEST_PROP(NeighbourhoodColours, FollowTheCellsOfTheGrid, ()) {
  int const k = *rc::gen::inRange(1, 30);
  Edge const edge = *rc::gen::element(Edge::wall, Edge::periodic);
  State state = scattered(Box(1.3, 0.7, edge), 30, 1e-6, *rc::gen::arbitrary<std::uint64_t>());
  // Points on the lines between cells are where two ways of counting would part.
  for (int i = 1; i < k; ++i) state.agents.add(1.3 * i / k, 0.7 * i / k, 0, 0, 1e-6, 1, 0, 0);
  auto const size = static_cast<std::uint64_t>(k);
  auto const colours = colours_of_disks(state, {.colouring = Colouring::neighbourhood, .columns = size, .rows = size});
  auto const palette = colours_of_disks(one_disk_per_cell(edge, k, k),
                                        {.colouring = Colouring::neighbourhood, .columns = size, .rows = size});
  CellLayout const layout(state.box, size, size);
  for (std::size_t i = 0; i < state.agents.size(); ++i) {
    RC_ASSERT(colours.at(i) == palette.at(layout.cell_of(position(state.agents, i))));
  }
}

TEST(NeighbourhoodColours, AreFourBetweenWallsAndNoMoreThanNineAnywhere) {
  auto const number_of = [](Edge edge, int k) {
    auto const size = static_cast<std::uint64_t>(k);
    auto const colours = colours_of_disks(one_disk_per_cell(edge, k, k),
                                          {.colouring = Colouring::neighbourhood, .columns = size, .rows = size});
    return std::set<std::string>(colours.begin(), colours.end()).size();
  };
  EXPECT_EQ(number_of(Edge::wall, 10), 4U);
  EXPECT_EQ(number_of(Edge::wall, 9), 4U);
  EXPECT_EQ(number_of(Edge::periodic, 10), 4U);
  EXPECT_EQ(number_of(Edge::periodic, 9), 9U);
}

TEST(Picture, ColoursSpeedsFromDarkToBrightAndSaysSo) {
  State state;
  for (int i = 0; i < 5; ++i) state.agents.add(0.1 + 0.2 * i, 0.5, 0.0, -0.5 * i, 0.05, 1, 0, 0);
  MarkupDocument const document = drawn(state, {.colouring = Colouring::speed});
  auto const circles = document.named("circle");
  EXPECT_EQ(circles.front().attributes.at("fill"), to_hex(viridis(0.0)));
  EXPECT_EQ(circles.at(2).attributes.at("fill"), to_hex(viridis(0.5)));
  EXPECT_EQ(circles.back().attributes.at("fill"), to_hex(viridis(1.0)));
  std::vector<std::string> texts;
  for (auto const& text : document.named("text")) texts.push_back(text.text);
  EXPECT_EQ(texts, (std::vector<std::string>{"0", "0.5", "1", "1.5", "2", "speed"}));
}

TEST(Picture, ColoursGivenValuesWithinTheGivenRangeAndUnknownOnesGrey) {
  State const state = one_disk_per_cell(Edge::wall, 4, 1);
  std::vector<double> const values{-1.0, 3.0, std::nan(""), 100.0};
  auto const colours = colours_of_disks(
      state, {.colouring = Colouring::values, .values = values, .least = 1.0, .most = 5.0, .bar_label = "x"});
  EXPECT_EQ(colours,
            (std::vector<std::string>{to_hex(viridis(0.0)), to_hex(viridis(0.5)), "#bfbfbf", to_hex(viridis(1.0))}));
}

std::vector<std::string> texts_of(MarkupDocument const& document) {
  std::vector<std::string> texts;
  for (auto const& text : document.named("text")) texts.push_back(text.text);
  return texts;
}

TEST(Picture, NamesEachKindBesideItsColour) {
  State const state = one_disk_per_cell(Edge::wall, 4, 1);
  std::vector<double> const kinds{0.0, 2.0, 0.0, 1.0};
  PictureSettings settings{.colouring = Colouring::kinds, .values = kinds, .bar_label = "health"};
  settings.kind_names = {"susceptible", "infected"};
  MarkupDocument const document = drawn(state, settings);
  EXPECT_EQ(texts_of(document), (std::vector<std::string>{"health", "susceptible", "infected", "2"}));
  auto const circles = document.named("circle");
  EXPECT_EQ(circles.at(0).attributes.at("fill"), circles.at(2).attributes.at("fill"));
  std::vector<std::string> listed;
  for (auto const& square : document.named("rect")) {
    if (square.attributes.contains("width") && square.attributes.at("width") == "13") {
      listed.push_back(square.attributes.at("fill"));
    }
  }
  EXPECT_EQ(listed, (std::vector<std::string>{circles.at(0).attributes.at("fill"), circles.at(3).attributes.at("fill"),
                                              circles.at(1).attributes.at("fill")}));
}

TEST(Picture, ListsTheRadiiOfAMixtureAndOfNothingElse) {
  State state;
  for (double const r : {0.1, 0.14, 0.1}) state.agents.add(0.5, 0.5, 0, 0, r, 1, 0, 0);
  EXPECT_EQ(texts_of(drawn(state, {})), (std::vector<std::string>{"R = 0.1", "R = 0.14"}));
  EXPECT_TRUE(texts_of(drawn(one_disk_per_cell(Edge::wall, 2, 2), {})).empty());
}

TEST(Picture, GivesOppositeEndsOfTheAnglesOneColour) {
  State const state = one_disk_per_cell(Edge::wall, 4, 1);
  double const pi = std::numbers::pi;
  std::vector<double> const angles{-pi, pi, 0.0, 0.5 * pi};
  PictureSettings const settings{.colouring = Colouring::directions, .values = angles, .bar_label = "direction"};
  auto const colours = colours_of_disks(state, settings);
  EXPECT_EQ(colours.at(0), colours.at(1));
  EXPECT_NE(colours.at(0), colours.at(2));
  EXPECT_NE(colours.at(2), colours.at(3));
  EXPECT_EQ(texts_of(drawn(state, settings)), (std::vector<std::string>{"−π", "−π/2", "0", "π/2", "π", "direction"}));
}

TEST(ColourCircle, GoesAroundInSmallStepsToWhereItBegan) {
  auto const distance = [](Colour a, Colour b) {
    return std::hypot(a.red - b.red, a.green - b.green, a.blue - b.blue);
  };
  EXPECT_EQ(to_hex(colour_circle(0.0)), to_hex(colour_circle(1.0)));
  for (int i = 0; i < 100; ++i) {
    EXPECT_LT(distance(colour_circle(i / 100.0), colour_circle((i + 1) / 100.0)), 0.06) << i;
    EXPECT_GT(distance(colour_circle(i / 100.0), colour_circle(i / 100.0 + 0.5)), 0.3) << i;
  }
}

TEST(Picture, AsPdfIsAPdfOfTheSizeAskedForEvenOfManyDisks) {
  State const state = one_disk_per_cell(Edge::wall, 3, 3);
  std::string const vectors = picture_pdf(state, {.width = 300});
  std::string const raster = picture_pdf(state, {.width = 300, .most_vector_disks = 4});
  for (std::string const& pdf : {vectors, raster}) {
    EXPECT_TRUE(pdf.starts_with("%PDF-")) << pdf.substr(0, 20);
    EXPECT_NE(pdf.find("%%EOF"), std::string::npos);
    EXPECT_NE(pdf.find("/MediaBox [ 0 0 300 300 ]"), std::string::npos);
  }
  EXPECT_EQ(vectors.find("/Subtype /Image"), std::string::npos);
  EXPECT_NE(raster.find("/Subtype /Image"), std::string::npos);
}

TEST(Picture, SurvivesValuesThatAreAllAlikeOrAllUnknown) {
  State const state = one_disk_per_cell(Edge::wall, 2, 2);
  constexpr double huge = 1e300;
  for (double const value : {0.0, 7.0, -7.0, huge, std::nan(""), std::numeric_limits<double>::infinity()}) {
    std::vector<double> const values(4, value);
    EXPECT_EQ(drawn(state, {.colouring = Colouring::values, .values = values}).count("circle"), 4U) << value;
  }
}

TEST(Picture, SurvivesValuesThatAreFarApartOrAlmostAlike) {
  State const state = one_disk_per_cell(Edge::wall, 2, 1);
  for (auto const& values : {std::vector{-1.7e308, 1.7e308}, {1.0, std::nextafter(1.0, 2.0)}, {0.0, 5e-324}}) {
    MarkupDocument const document = drawn(state, {.colouring = Colouring::values, .values = values});
    EXPECT_EQ(document.count("circle"), 2U);
    EXPECT_LT(document.count("text"), 15U);
  }
}

TEST(Picture, GivesEachKindOfDiskOfAMixtureItsColour) {
  State state;
  for (double const r : {0.1, 0.14, 0.1, 0.14}) state.agents.add(0.5, 0.5, 0, 0, r, 1, 0, 0);
  auto const colours = colours_of_disks(state, {});
  EXPECT_EQ(colours.at(0), colours.at(2));
  EXPECT_EQ(colours.at(1), colours.at(3));
  EXPECT_NE(colours.at(0), colours.at(1));
}

TEST(Picture, LeavesOutDisksThatAreNowhere) {
  State state = one_disk_per_cell(Edge::wall, 2, 2);
  state.agents.column<X>()[1] = std::nan("");
  state.agents.column<Y>()[2] = std::numeric_limits<double>::infinity();
  for (Colouring const colouring : {Colouring::radius, Colouring::neighbourhood, Colouring::speed}) {
    EXPECT_EQ(drawn(state, {.colouring = colouring, .columns = 2, .rows = 2}).count("circle"), 2U);
  }
}

TEST(Picture, DrawsTheGridOnlyWhereItsCellsCanBeSeen) {
  State const state = one_disk_per_cell(Edge::wall, 2, 2);
  EXPECT_EQ(drawn(state, {.columns = 10, .rows = 7}).count("line"), 9U + 6U);
  EXPECT_EQ(drawn(state, {.width = 720, .columns = 100'000, .rows = 100'000}).count("line"), 0U);
}

TEST(Picture, ShowsVelocitiesAsArrowsThatGrowWithSpeed) {
  State state = one_disk_per_cell(Edge::wall, 2, 1);
  state.agents.column<VelocityX>()[0] = 1.0;
  state.agents.column<VelocityX>()[1] = -2.0;
  auto const heads = drawn(state, {.shows_velocities = true}).named("path");
  auto const shafts = drawn(state, {.shows_velocities = true}).named("line");
  ASSERT_EQ(heads.size(), 2U);
  auto const run = [&](int i) {
    return std::stod(shafts.at(i).attributes.at("x2")) - std::stod(shafts.at(i).attributes.at("x1"));
  };
  EXPECT_GT(run(0), 0.0);
  EXPECT_LT(run(1), -run(0));
  EXPECT_EQ(drawn(state, {}).count("path"), 0U);
}

TEST(Picture, KeepsATitleOfAnyCharactersInOneLine) {
  State const state = one_disk_per_cell(Edge::wall, 1, 1);
  MarkupDocument const document = drawn(state, {.title = "<b>R&D</b>\n\"φ\" \x01\xFF"});
  EXPECT_EQ(document.named("text").at(0).text, "&lt;b&gt;R&amp;D&lt;/b&gt; &quot;φ&quot;  \xEF\xBF\xBD");
  EXPECT_NE(picture_png(state, {.title = "\xFF\nφ"}), picture_png(state, {}));
}

TEST(Picture, AsPngHasTheSizeAskedFor) {
  State const state = scattered(Box(2, 1, Edge::wall), 10, 0.05);
  std::string const given = picture_png(state, {.width = 640, .height = 480});
  EXPECT_EQ(given.substr(1, 3), "PNG");
  EXPECT_EQ(number_at(given, 16), 640U);
  EXPECT_EQ(number_at(given, 20), 480U);
  // Left out, the height follows the box: half as high as wide, but for the margins.
  std::string const following = picture_png(state, {.width = 640});
  EXPECT_EQ(number_at(following, 16), 640U);
  EXPECT_NEAR(number_at(following, 20), 320U, 20U);
  // A channel does not make a picture as tall as itself.
  EXPECT_EQ(number_at(picture_png(scattered(Box(0.01, 100, Edge::wall), 1, 0.001), {.width = 100}), 20), 200U);
}

/// How many pieces of line the edge of an empty box consists of: runs of coloured pixels in the row that has the most.
std::size_t pieces_of_edge(Edge edge) {
  PicturePixels const picture = picture_pixels(State{.box = Box(1.0, 1.0, edge)}, {.width = 400});
  std::size_t most = 0;
  std::size_t pieces = 0;
  for (std::uint32_t row = 0; row < picture.height; ++row) {
    std::size_t coloured = 0;
    std::size_t runs = 0;
    bool was_coloured = false;
    for (std::uint32_t column = 0; column < picture.width; ++column) {
      std::uint32_t pixel = 0;
      std::memcpy(&pixel, picture.bytes.data() + 4 * (std::size_t{row} * picture.width + column), 4);
      bool const is_coloured = (pixel & 0xFFFFFFU) != 0xFFFFFFU;
      coloured += is_coloured ? 1 : 0;
      runs += is_coloured && !was_coloured ? 1 : 0;
      was_coloured = is_coloured;
    }
    if (coloured > most) {
      most = coloured;
      pieces = runs;
    }
  }
  return pieces;
}

TEST(Picture, OfPixelsHasAWholeLineForWallsAndADashedOneForPeriodicEdges) {
  EXPECT_EQ(pieces_of_edge(Edge::wall), 1U);
  EXPECT_GT(pieces_of_edge(Edge::periodic), 10U);
}

TEST(Picture, IsTheSameEveryTime) {
  State const state = scattered(Box(1, 1, Edge::periodic), 100, 0.03);
  EXPECT_EQ(picture_svg(state, {}), picture_svg(state, {}));
  EXPECT_EQ(picture_png(state, {}), picture_png(state, {}));
}

TEST(Picture, OfManyDisksStaysSmallByHoldingAnImageOfThem) {
  State const state = scattered(Box(1, 1, Edge::wall), 5'000, 0.003);
  TemporaryDirectory const directory;
  EXPECT_EQ(draw_disks(state, {}, directory / "few.svg"), PictureKind::vector);
  EXPECT_EQ(draw_disks(state, {.most_vector_disks = 4'999}, directory / "many.svg"), PictureKind::raster);
  EXPECT_EQ(draw_disks(state, {}, directory / "any.png"), PictureKind::raster);
  MarkupDocument const few(read_file(directory / "few.svg"));
  MarkupDocument const many(read_file(directory / "many.svg"));
  EXPECT_EQ(few.count("circle"), 5'000U);
  EXPECT_EQ(few.count("image"), 0U);
  EXPECT_EQ(many.problem, "");
  EXPECT_EQ(many.count("circle"), 0U);
  ASSERT_EQ(many.count("image"), 1U);
  EXPECT_TRUE(many.named("image").at(0).attributes.at("xlink:href").starts_with("data:image/png;base64,iVBOR"));
}

TEST(Picture, SpendsAboutSixtyBytesOnADisk) {
  State const state = scattered(Box(1, 1, Edge::wall), 10'000, 0.003);
  State const empty{.box = state.box};
  double const bytes = static_cast<double>(picture_svg(state, {}).size() - picture_svg(empty, {}).size());
  EXPECT_LT(bytes / 10'000, 70.0);
}

TEST(Picture, RefusesWhatCannotBeDrawn) {
  State const state = one_disk_per_cell(Edge::wall, 2, 2);
  std::vector<double> const three{1, 2, 3};
  EXPECT_THROW(picture_svg(state, {.width = 0}), Error);
  EXPECT_THROW(picture_png(state, {.width = 15}), Error);
  EXPECT_THROW(picture_png(state, {.width = 16'385}), Error);
  EXPECT_THROW(picture_png(state, {.height = 4'000'000'000}), Error);
  EXPECT_THROW(picture_svg(state, {.colouring = Colouring::values, .values = three}), Error);
  TemporaryDirectory const directory;
  EXPECT_THROW(draw_disks(state, {}, directory / "picture.gif"), Error);
  EXPECT_THROW(draw_disks(state, {}, directory / "missing/picture.svg"), RunFailure);
  EXPECT_TRUE(std::filesystem::is_empty(directory.path()));
}

TEST(Picture, CanBeAsSmallAsAnyPictureAllowed) {
  State const state = one_disk_per_cell(Edge::wall, 2, 2);
  for (std::uint32_t const pixels : {16U, 17U, 40U}) {
    PictureSettings const settings{
        .width = pixels, .height = pixels, .colouring = Colouring::speed, .columns = 2, .rows = 2, .title = "t"};
    EXPECT_EQ(drawn(state, settings).count("circle"), 4U);
    EXPECT_EQ(number_at(picture_png(state, settings), 20), pixels);
  }
}

TEST(Viridis, RunsFromDarkToBrightWithoutTurningBack) {
  auto const brightness = [](Colour c) { return 0.2126 * c.red + 0.7152 * c.green + 0.0722 * c.blue; };
  for (int i = 0; i < 100; ++i) EXPECT_LT(brightness(viridis(i / 100.0)), brightness(viridis((i + 1) / 100.0)));
  EXPECT_EQ(to_hex(viridis(-1.0)), "#440154");
  EXPECT_EQ(to_hex(viridis(2.0)), "#fde725");
}

}  // namespace
}  // namespace gridlock
