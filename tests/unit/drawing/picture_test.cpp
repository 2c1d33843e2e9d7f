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
#include "unit/drawing/recording_canvas.hpp"

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

RecordingCanvas drawn(State const& state, PictureSettings const& settings) {
  RecordingCanvas canvas;
  draw_picture(state, settings, canvas);
  return canvas;
}

std::vector<std::string> colours_of_disks(State const& state, PictureSettings const& settings) {
  return drawn(state, settings).colours_of_circles();
}

std::string to_hex(Colour colour) { return RecordingCanvas::hex(colour); }

TEST(Picture, OfAWalledBoxHoldsOneCircleForEachDisk) {
  EXPECT_EQ(drawn(scattered(Box(1, 1, Edge::wall), 321, 0.02), {}).circles.size(), 321U);
}

TEST(Picture, OfNoDisksIsAnEmptyBox) {
  State state;
  for (Colouring const colouring : {Colouring::radius, Colouring::neighbourhood, Colouring::values}) {
    EXPECT_EQ(drawn(state, {.colouring = colouring, .columns = 3, .rows = 3}).circles.size(), 0U);
    EXPECT_EQ(picture_pixels(state, {.colouring = colouring}).width, 720U);
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
  RC_ASSERT(drawn(state, {}).circles.size() == images);
}

TEST(Picture, PutsDisksWhereTheyAreWithTheOriginAtTheLowerLeft) {
  State state;
  state.agents.add(0.25, 0.25, 0, 0, 0.2, 1, 0, 0);
  state.agents.add(0.75, 0.5, 0, 0, 0.2, 1, 0, 0);
  auto const circles = drawn(state, {.width = 720}).circles;
  double const pixels = 2.0 * (circles.at(1).centre.x - circles.at(0).centre.x);  // the side of the box
  EXPECT_GT(pixels, 0.9 * 720);
  EXPECT_NEAR(circles.at(0).centre.y - circles.at(1).centre.y, 0.25 * pixels, 1e-2);
  EXPECT_NEAR(circles.at(0).radius, 0.2 * pixels, 1e-2);
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
  // So small that none of them reaches across an edge, where it would be drawn twice.
  double const radius = 1e-13;
  State state = scattered(Box(1.3, 0.7, edge), 30, radius, *rc::gen::arbitrary<std::uint64_t>());
  // Points on the lines between cells are where two ways of counting would part.
  for (int i = 1; i < k; ++i) state.agents.add(1.3 * i / k, 0.7 * i / k, 0, 0, radius, 1, 0, 0);
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

TEST(Picture, ColoursValuesFromDarkToBrightAndSaysSo) {
  State const state = one_disk_per_cell(Edge::wall, 5, 1);
  std::vector<double> const values{0.0, 0.5, 1.0, 1.5, 2.0};
  RecordingCanvas const canvas = drawn(state, {.colouring = Colouring::values, .values = values, .bar_label = "speed"});
  EXPECT_EQ(canvas.circles.front().colour, to_hex(viridis(0.0)));
  EXPECT_EQ(canvas.circles.at(2).colour, to_hex(viridis(0.5)));
  EXPECT_EQ(canvas.circles.back().colour, to_hex(viridis(1.0)));
  EXPECT_EQ(canvas.texts, (std::vector<std::string>{"0", "0.5", "1", "1.5", "2", "speed"}));
}

TEST(Picture, ColoursGivenValuesWithinTheGivenRangeAndUnknownOnesGrey) {
  State const state = one_disk_per_cell(Edge::wall, 4, 1);
  std::vector<double> const values{-1.0, 3.0, std::nan(""), 100.0};
  auto const colours = colours_of_disks(
      state, {.colouring = Colouring::values, .values = values, .min = 1.0, .max = 5.0, .bar_label = "x"});
  EXPECT_EQ(colours,
            (std::vector<std::string>{to_hex(viridis(0.0)), to_hex(viridis(0.5)), "#bfbfbf", to_hex(viridis(1.0))}));
}

TEST(Picture, NamesEachKindBesideItsColour) {
  State const state = one_disk_per_cell(Edge::wall, 4, 1);
  std::vector<double> const kinds{0.0, 2.0, 0.0, 1.0};
  PictureSettings settings{.colouring = Colouring::kinds, .values = kinds, .bar_label = "health"};
  settings.kind_names = {"susceptible", "infected"};
  RecordingCanvas const canvas = drawn(state, settings);
  EXPECT_EQ(canvas.texts, (std::vector<std::string>{"health", "susceptible", "infected", "2"}));
  std::vector<std::string> const colours = canvas.colours_of_circles();
  EXPECT_EQ(colours.at(0), colours.at(2));
  std::vector<std::string> listed;
  for (auto const& square : canvas.filled) {
    if (square.place.width == 13.0) listed.push_back(square.colour);
  }
  EXPECT_EQ(listed, (std::vector<std::string>{colours.at(0), colours.at(3), colours.at(1)}));
}

TEST(Picture, ListsTheRadiiOfAMixtureAndOfNothingElse) {
  State state;
  for (double const r : {0.1, 0.14, 0.1}) state.agents.add(0.5, 0.5, 0, 0, r, 1, 0, 0);
  EXPECT_EQ(drawn(state, {}).texts, (std::vector<std::string>{"R = 0.1", "R = 0.14"}));
  EXPECT_TRUE(drawn(one_disk_per_cell(Edge::wall, 2, 2), {}).texts.empty());
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
  EXPECT_EQ(drawn(state, settings).texts, (std::vector<std::string>{"−π", "−π/2", "0", "π/2", "π", "direction"}));
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

TEST(Picture, SurvivesValuesThatAreAllAlikeOrAllUnknown) {
  State const state = one_disk_per_cell(Edge::wall, 2, 2);
  constexpr double huge = 1e300;
  for (double const value : {0.0, 7.0, -7.0, huge, std::nan(""), std::numeric_limits<double>::infinity()}) {
    std::vector<double> const values(4, value);
    EXPECT_EQ(drawn(state, {.colouring = Colouring::values, .values = values}).circles.size(), 4U) << value;
  }
}

TEST(Picture, SurvivesValuesThatAreFarApartOrAlmostAlike) {
  State const state = one_disk_per_cell(Edge::wall, 2, 1);
  for (auto const& values : {std::vector{-1.7e308, 1.7e308}, {1.0, std::nextafter(1.0, 2.0)}, {0.0, 5e-324}}) {
    RecordingCanvas const canvas = drawn(state, {.colouring = Colouring::values, .values = values});
    EXPECT_EQ(canvas.circles.size(), 2U);
    EXPECT_LT(canvas.texts.size(), 15U);
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
  for (Colouring const colouring : {Colouring::radius, Colouring::neighbourhood}) {
    EXPECT_EQ(drawn(state, {.colouring = colouring, .columns = 2, .rows = 2}).circles.size(), 2U);
  }
}

TEST(Picture, DrawsTheGridOnlyWhereItsCellsCanBeSeen) {
  State const state = one_disk_per_cell(Edge::wall, 2, 2);
  EXPECT_EQ(drawn(state, {.columns = 10, .rows = 7}).lines.size(), 9U + 6U);
  EXPECT_EQ(drawn(state, {.width = 720, .columns = 100'000, .rows = 100'000}).lines.size(), 0U);
}

TEST(Picture, HasTheWallsInsideTheBoxWhereTheirDisksTouchThem) {
  // A disk at each end of each wall, of which one is upright.
  State state;
  state.box = Box(2.0, 1.0, Edge::wall);
  for (auto const& [x, y] : {std::pair{0.2, 0.9}, {1.5, 0.3}, {1.9, 0.0}, {1.9, 0.8}})
    state.agents.add(x, y, 0, 0, 0.01, 1, 0, 0);
  std::vector<LineSegment> const walls{{.from = {0.2, 0.9}, .to = {1.5, 0.3}}, {.from = {1.9, 0.0}, .to = {1.9, 0.8}}};
  RecordingCanvas const canvas = drawn(state, {.walls = walls});
  ASSERT_EQ(canvas.lines.size(), 2U);
  for (std::size_t k = 0; k < 2; ++k) {
    EXPECT_EQ(canvas.lines[k].from, canvas.circles[2 * k].centre);
    EXPECT_EQ(canvas.lines[k].to, canvas.circles[2 * k + 1].centre);
  }
}

TEST(Picture, KeepsATitleOfAnyCharacters) {
  State const state = one_disk_per_cell(Edge::wall, 1, 1);
  PicturePixels const odd = picture_pixels(state, {.title = "<b>\n\"φ\" \x01\xFF"});
  PicturePixels const other = picture_pixels(state, {.title = "<b>"});
  EXPECT_EQ(odd.height, other.height);
  EXPECT_TRUE(odd.bytes != other.bytes);
}

TEST(Picture, IsAsHighAsTheBoxButForTheMargins) {
  auto const height = [](double width, double box_height) {
    return picture_pixels(scattered(Box(width, box_height, Edge::wall), 10, 0.001), {.width = 640}).height;
  };
  EXPECT_NEAR(height(2.0, 1.0), 320U, 20U);
  // A channel does not make a picture as tall as itself.
  EXPECT_EQ(height(0.01, 100.0), 1280U);
}

/// How many pieces of line the edge of an empty box consists of: runs of coloured pixels in the row that has the most.
std::size_t pieces_of_edge(Edge edge_x, Edge edge_y) {
  PicturePixels const picture = picture_pixels(State{.box = Box(1.0, 1.0, edge_x, edge_y)}, {.width = 400});
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
  EXPECT_EQ(pieces_of_edge(Edge::wall, Edge::wall), 1U);
  EXPECT_GT(pieces_of_edge(Edge::periodic, Edge::periodic), 10U);
  EXPECT_EQ(pieces_of_edge(Edge::periodic, Edge::wall), 1U) << "the floor and the lid of a channel";
  EXPECT_GT(pieces_of_edge(Edge::wall, Edge::periodic), 10U);
}

TEST(Picture, OfPixelsHasDisksWithoutOutlines) {
  State state;
  state.box = Box(1.5, 0.6, Edge::wall);
  state.agents.add(0.75, 0.3, 0, 0, 0.2, 1, 0, 0);
  auto const circle = drawn(state, {.width = 400}).circles.at(0);
  PicturePixels const picture = picture_pixels(state, {.width = 400});
  auto const brightness = [&](double x) {
    std::uint32_t pixel = 0;
    auto const place = std::size_t(circle.centre.y) * picture.width + std::size_t(x);
    std::memcpy(&pixel, picture.bytes.data() + 4 * place, 4);
    return (pixel >> 16U & 0xFFU) + (pixel >> 8U & 0xFFU) + (pixel & 0xFFU);
  };
  // From the middle to the outside nothing is darker than the disk itself.
  for (double from_middle = 0.0; from_middle < 1.1 * circle.radius; from_middle += 0.5) {
    EXPECT_GE(brightness(circle.centre.x + from_middle), brightness(circle.centre.x)) << from_middle;
  }
  EXPECT_GT(brightness(circle.centre.x + 1.1 * circle.radius), brightness(circle.centre.x));
}

TEST(Picture, IsTheSameEveryTime) {
  State const state = scattered(Box(1, 1, Edge::periodic), 100, 0.03);
  EXPECT_TRUE(picture_pixels(state, {}).bytes == picture_pixels(state, {}).bytes);
}

TEST(Picture, RefusesWhatCannotBeDrawn) {
  State const state = one_disk_per_cell(Edge::wall, 2, 2);
  std::vector<double> const three{1, 2, 3};
  EXPECT_THROW(drawn(state, {.width = 0}), Error);
  EXPECT_THROW(picture_pixels(state, {.width = 15}), Error);
  EXPECT_THROW(picture_pixels(state, {.width = 16'385}), Error);
  EXPECT_THROW(drawn(state, {.colouring = Colouring::values, .values = three}), Error);
}

TEST(Picture, CanBeAsSmallAsAnyPictureAllowed) {
  State const state = one_disk_per_cell(Edge::wall, 2, 2);
  for (std::uint32_t const pixels : {16U, 17U, 40U}) {
    PictureSettings const settings{
        .width = pixels, .colouring = Colouring::neighbourhood, .columns = 2, .rows = 2, .title = "t"};
    EXPECT_EQ(drawn(state, settings).circles.size(), 4U);
    EXPECT_EQ(picture_pixels(state, settings).width, pixels);
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
