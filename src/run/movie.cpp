#include "gridlock/run/movie.hpp"

#include <fmt/format.h>

#include <chrono>
#include <string>
#include <vector>

#include "gridlock/core/error.hpp"
#include "io/process.hpp"
#include "run/frame_picture.hpp"

namespace gridlock {

namespace {

namespace fs = std::filesystem;

/// A directory beside the movie, gone in the end.
class PictureDirectory {
 public:
  explicit PictureDirectory(fs::path const& movie) : path_(movie) {
    path_ += ".frames";
    fs::create_directories(path_);
  }
  ~PictureDirectory() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  PictureDirectory(PictureDirectory const&) = delete;
  PictureDirectory& operator=(PictureDirectory const&) = delete;
  [[nodiscard]] fs::path const& path() const { return path_; }

 private:
  fs::path path_;
};

void draw_frames(H5mdReader const& trajectory, MovieSettings const& settings, fs::path const& directory) {
  if (trajectory.frame_count() == 0) throw Error(Problem{.what = "the trajectory has no frames"});
  FramePainter painter(trajectory.frame(0).frame, settings.colour);
  // The same bar in all frames.
  for (std::size_t k = 0; painter.has_bar() && k < trajectory.frame_count(); k += settings.every) {
    painter.widen_bar(trajectory.frame(k).frame);
  }
  std::size_t number = 0;
  for (std::size_t k = 0; k < trajectory.frame_count(); k += settings.every) {
    Frame const frame = trajectory.frame(k).frame;
    painter.draw(frame, settings.width, fmt::format("step {}, t = {:.4g}", frame.clock.step, frame.clock.time),
                 directory / fmt::format("{:07}.png", number++));
  }
}

}  // namespace

void make_movie(H5mdReader const& trajectory, MovieSettings const& settings) {
  fs::path const file = fs::absolute(settings.file);
  PictureDirectory const pictures(file);
  draw_frames(trajectory, settings, pictures.path());
  // Most players know H.264 with halved colours only, and that needs even sides.
  std::vector<std::string> const arguments{"ffmpeg",     "-y",
                                           "-loglevel",  "error",
                                           "-framerate", std::to_string(settings.rate),
                                           "-i",         "%07d.png",
                                           "-vf",        "pad=ceil(iw/2)*2:ceil(ih/2)*2:color=white",
                                           "-c:v",       "libx264",
                                           "-crf",       "18",
                                           "-pix_fmt",   "yuv420p",
                                           file.string()};
  ProcessResult const result = run_process(arguments, pictures.path(), std::chrono::hours(2));
  if (!result.was_found) {
    throw Error(Problem{.what = "ffmpeg, which joins the pictures to a movie, is not installed",
                        .hint = "apt-get install ffmpeg"});
  }
  if (!result.succeeded) throw RunFailure(fmt::format("ffmpeg failed: {}", result.errors));
}

}  // namespace gridlock
