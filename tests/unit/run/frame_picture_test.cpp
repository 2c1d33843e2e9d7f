#include "run/frame_picture.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <filesystem>
#include <string>

#include "gridlock/core/disks.hpp"
#include "gridlock/core/error.hpp"
#include "gridlock/io/file.hpp"
#include "unit/io/temporary_directory.hpp"

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

std::size_t circles_in(std::filesystem::path const& file) {
  std::string const text = read_file(file);
  std::size_t circles = 0;
  for (std::size_t at = text.find("<circle"); at != std::string::npos; at = text.find("<circle", at + 1)) ++circles;
  return circles;
}

TEST(FramePainter, AgentsWithoutARadiusGetAMarkEach) {
  TemporaryDirectory const directory;
  Frame const frame = walkers();
  for (char const* colour : {"", "heading_y", "direction", "displacement", "radius", "neighbourhood", "psi6"}) {
    FramePainter painter(frame, colour);
    painter.widen_bar(frame);
    painter.draw(frame, 300, "title", directory / "marks.svg");
    EXPECT_EQ(circles_in(directory / "marks.svg"), 7U) << colour;
  }
}

TEST(FramePainter, AColumnThatIsNotThereIsAnErrorThatNamesIt) {
  FramePainter painter(walkers(), "health");
  EXPECT_THROW(painter.widen_bar(walkers()), Error);
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
