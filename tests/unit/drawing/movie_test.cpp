// What a movie shows.

#include "drawing/movie.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include "drawing/frame_picture.hpp"
#include "gridlock/core/disks.hpp"
#include "io/file.hpp"
#include "unit/io/temporary_directory.hpp"

namespace gridlock {
namespace {

namespace fs = std::filesystem;

struct Warmth {
  using type = double;
  static constexpr char const* name = "warmth";
};

Frame warm_at(std::uint64_t step, double warmest) {
  Population<X, Y, Warmth> agents;
  for (int n = 0; n < 5; ++n) agents.add(0.1 + 0.2 * n, 0.5, 0.25 * n * warmest);
  return frame_of(Box(1.0, 1.0, Edge::wall), {step, 0.5 * static_cast<double>(step)}, 1, agents);
}

/// Puts a program in front of those of its name while it lives.
class StandIn {
 public:
  StandIn(fs::path const& directory, std::string const& name, std::string const& script) : old_(std::getenv("PATH")) {
    write_file(directory / name, "#!/bin/sh\n" + script);
    fs::permissions(directory / name, fs::perms::owner_all);
    setenv("PATH", (directory.string() + ":" + old_).c_str(), 1);
  }
  ~StandIn() { setenv("PATH", old_.c_str(), 1); }
  StandIn(StandIn const&) = delete;
  StandIn& operator=(StandIn const&) = delete;

 private:
  std::string old_;
};

/// Returns the frames that ffmpeg is given by a movie of one frame with these settings.
std::string movie_of(std::string const& configuration) {
  TemporaryDirectory const directory;
  Frame const frame = warm_at(0, 1.0);
  H5mdWriter writer = H5mdWriter::create(directory / "t.h5", {.configuration = configuration}, frame);
  writer.write({.frame = frame, .observables = {}, .state_hash = 0});
  StandIn const ffmpeg(directory.path(), "ffmpeg", "cat > \"$0.frames\"\n");
  make_movie(H5mdReader(directory / "t.h5"), {.file = directory / "warm.mp4", .colour = "warmth", .width = 200});
  return read_file(directory / "ffmpeg.frames");
}

TEST(Movie, HasOneBarInAllFramesThatReachesOverTheValuesOfAll) {
  TemporaryDirectory const directory;
  std::vector<Frame> const frames{warm_at(0, 0.0), warm_at(1, 4.0), warm_at(2, 1.0)};
  H5mdWriter writer = H5mdWriter::create(directory / "t.h5", {}, frames[0]);
  FramePainter painter(frames[0], "warmth");
  for (Frame const& frame : frames) {
    writer.write({.frame = frame, .observables = {}, .state_hash = frame.clock.step});
    painter.widen_bar(frame);
  }
  StandIn const ffmpeg(directory.path(), "ffmpeg", "cat > \"$0.frames\"\n");
  make_movie(H5mdReader(directory / "t.h5"),
             {.file = directory / "warm.mp4", .colour = "warmth", .width = 200, .rate = 25, .every = 1});
  std::string expected;
  for (char const* title : {"step 0, t = 0", "step 1, t = 0.5", "step 2, t = 1"}) {
    expected += painter.pixels(frames[static_cast<std::size_t>(title[5] - '0')], 200, title).bytes;
  }
  EXPECT_TRUE(read_file(directory / "ffmpeg.frames") == expected);
}

TEST(Movie, HasTheWallsOfItsSettingsWhereTheyCanBeRead) {
  FramePainter painter(warm_at(0, 1.0), "warmth");
  painter.widen_bar(warm_at(0, 1.0));
  std::string const without = painter.pixels(warm_at(0, 1.0), 200, "step 0, t = 0").bytes;
  painter.show_walls({{.from = {0.25, 0.5}, .to = {0.75, 1.0}}});
  std::string const with = painter.pixels(warm_at(0, 1.0), 200, "step 0, t = 0").bytes;
  ASSERT_TRUE(with != without);
  EXPECT_TRUE(movie_of("walls = [{ from = [0.25, 0.5], to = [0.75, 1.0] }]\n") == with);
  for (char const* settings : {"", "run.seed = 2", "walls = []", "walls = [{ from = [0.25], to = [] }]", "walls = [[",
                               "walls = []\nof.the.future = 1"}) {
    EXPECT_TRUE(movie_of(settings) == without) << settings;
  }
}

}  // namespace
}  // namespace gridlock
