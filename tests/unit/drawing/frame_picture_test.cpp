#include "drawing/frame_picture.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

#include "gridlock/core/disks.hpp"
#include "gridlock/core/error.hpp"
#include "unit/drawing/recording_canvas.hpp"

namespace gridlock {
namespace {

struct Health {
  using type = std::uint32_t;
  static constexpr char const* name = "health";
};
struct HeadingX {
  using type = double;
  static constexpr char const* name = "heading_x";
};
struct HeadingY {
  using type = double;
  static constexpr char const* name = "heading_y";
};

Box const box(1.0, 1.0, Edge::wall);

Frame walkers() {
  Population<X, Y, HeadingX, HeadingY> agents;
  for (int n = 1; n <= 7; ++n) agents.add(0.1 * n, 0.5, 1.0, 0.0);
  return frame_of(box, {}, 1, agents);
}

RecordingCanvas painted(FramePainter const& painter, Frame const& frame) {
  RecordingCanvas canvas;
  painter.draw(frame, 300, "title", canvas);
  return canvas;
}

TEST(FramePainter, AgentsWithoutARadiusGetAMarkEach) {
  Frame const frame = walkers();
  for (char const* colour : {"", "heading_y", "direction", "displacement", "radius", "neighbourhood", "psi6"}) {
    FramePainter painter(frame, colour);
    painter.widen_bar(frame);
    EXPECT_EQ(painted(painter, frame).circles.size(), 7U) << colour;
  }
}

TEST(FramePainter, ADisplacementGoesOnAcrossEitherEdgeOfABoxThatIsNoSquare) {
  Box const tall(1.0, 3.0, Edge::periodic);
  using Travellers = Population<X, Y, ImageX, ImageY>;
  Travellers start, end;
  // Two tenths along either axis, inside the box and across its edge, and no way at all.
  start.add(0.3, 1.0, 0, 0), end.add(0.5, 1.0, 0, 0);
  start.add(0.9, 1.5, 0, 0), end.add(0.1, 1.5, 1, 0);
  start.add(0.5, 2.9, 0, 0), end.add(0.5, 0.1, 0, 1);
  start.add(0.2, 0.1, 0, 0), end.add(0.2, 2.9, 0, -1);
  start.add(0.7, 2.0, 0, 0), end.add(0.7, 2.0, 0, 0);
  Frame const first = frame_of(tall, {}, 1, start);
  Frame const last = frame_of(tall, {}, 1, end);
  FramePainter painter(first, "displacement");
  painter.widen_bar(last);
  auto const colours = painted(painter, last).colours_of_circles();
  ASSERT_EQ(colours.size(), 5U);
  for (std::size_t i = 1; i < 4; ++i) EXPECT_EQ(colours[i], colours[0]) << i;
  EXPECT_NE(colours[4], colours[0]);
}

TEST(FramePainter, ADirectionIsTheAngleFromTheXAxis) {
  Population<X, Y, HeadingX, HeadingY> agents;
  State state{.box = box};
  std::vector<double> angles;
  for (double const angle : {0.0, 0.4, 2.0, 3.0, -0.4, -1.5, -3.0}) {
    double const x = 0.5 + 0.1 * angle;
    agents.add(x, 0.5, 2.0 * std::cos(angle), 2.0 * std::sin(angle));
    state.agents.add(x, 0.5, 0.0, 0.0, 0.02, 1.0, 0, 0);
    angles.push_back(angle);
  }
  Frame const frame = frame_of(box, {}, 1, agents);
  RecordingCanvas expected;
  draw_picture(state, {.width = 300, .colouring = Colouring::directions, .values = angles}, expected);
  EXPECT_EQ(painted(FramePainter(frame, "direction"), frame).colours_of_circles(), expected.colours_of_circles());
}

TEST(FramePainter, AColumnThatIsNotThereIsAnErrorThatNamesItAndThoseThereAre) {
  try {
    FramePainter const painter(walkers(), "health");
    FAIL() << "accepted";
  } catch (Error const& error) {
    EXPECT_NE(std::string(error.what()).find("\"health\""), std::string::npos) << error.what();
    EXPECT_NE(std::string(error.what()).find("direction, x, y, heading_x, heading_y"), std::string::npos)
        << error.what();
  }
}

TEST(FramePainter, AgentsWithoutPositionsAreRefused) {
  EXPECT_THROW(FramePainter(frame_of(box, {}, 1, Population<Radius>{}), ""), Error);
}

TEST(FramePainter, PixelsAreWhiteButForTheAgents) {
  FramePainter const painter(walkers(), "radius");
  PicturePixels const pixels = painter.pixels(walkers(), 101, "");
  EXPECT_EQ(pixels.width, 101U);
  ASSERT_EQ(pixels.bytes.size(), std::size_t{4} * pixels.width * pixels.height);
  auto const pixel = [&](std::uint32_t column, std::uint32_t row) {
    std::uint32_t number = 0;
    std::memcpy(&number, pixels.bytes.data() + 4 * (std::size_t{row} * pixels.width + column), 4);
    return number & 0xFFFFFFU;
  };
  EXPECT_EQ(pixel(0, 0), 0xFFFFFFU) << "the margin is white";
  // The middle of the fourth agent, at (0.4, 0.5).
  auto const in_disk = pixel(static_cast<std::uint32_t>(0.4 * 101), pixels.height / 2);
  EXPECT_NE(in_disk, 0xFFFFFFU);
  EXPECT_GT(in_disk & 0xFFU, in_disk >> 16) << "blue, as the first of the colours";
}

TEST(FramePainter, KindsAreListedByTheirNamesAndManyNumbersStandOnABar) {
  Population<X, Y, Health> agents;
  for (std::uint32_t n = 0; n < 3; ++n) agents.add(0.2 + 0.2 * n, 0.5, n);
  auto const texts_of = [](Frame const& frame) {
    FramePainter painter(frame, "health");
    painter.name_kinds({"well", "ill"});
    painter.widen_bar(frame);
    return painted(painter, frame).texts;
  };
  EXPECT_EQ(texts_of(frame_of(box, {}, 1, agents)), (std::vector<std::string>{"title", "health", "well", "ill", "2"}));
  agents.add(0.8, 0.5, 40U);
  EXPECT_EQ(texts_of(frame_of(box, {}, 1, agents)),
            (std::vector<std::string>{"title", "0", "10", "20", "30", "40", "health"}));
}

TEST(FramePainter, TheUsualColourIsWhatTellsMostOfTheAgents) {
  EXPECT_EQ(usual_colour(walkers()), "direction");
  EXPECT_EQ(usual_colour(frame_of(State{.box = box})), "displacement");
  EXPECT_EQ(usual_colour(frame_of(box, {}, 1, Population<X, Y, VelocityX, VelocityY, Health>{})), "health");
  EXPECT_EQ(usual_colour(frame_of(box, {}, 1, Population<X, Y, Radius, Health>{})), "health");
  EXPECT_EQ(usual_colour(frame_of(box, {}, 1, Population<X, Y, Radius>{})), "radius");
  EXPECT_EQ(usual_colour(frame_of(box, {}, 1, Population<X, Y>{})), "radius");
}

}  // namespace
}  // namespace gridlock
