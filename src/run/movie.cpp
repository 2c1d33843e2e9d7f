#include "gridlock/run/movie.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "gridlock/core/error.hpp"
#include "gridlock/io/picture.hpp"
#include "gridlock/observe/bond_orientation.hpp"
#include "io/process.hpp"

namespace gridlock {

namespace {

namespace fs = std::filesystem;

std::vector<double> numbers_of(Frame const& frame, std::string const& name) {
  FrameColumn const* const column = frame.find(name);
  if (column == nullptr) {
    throw Error(Problem{.what = fmt::format("the trajectory has no column \"{}\"", name),
                        .hint = "keep it in trajectory.columns; the colours are displacement, psi6, speed, "
                                "neighbourhood, radius or a column",
                        .key = "--colour"});
  }
  return std::visit([](auto const& values) { return std::vector<double>(values.begin(), values.end()); },
                    column->values);
}

std::vector<double> numbers_or_zeros(Frame const& frame, std::string const& name) {
  return frame.find(name) == nullptr ? std::vector<double>(frame.size()) : numbers_of(frame, name);
}

/// The disks of a frame, row by row; their names are of no concern to a picture.
State disks_of(Frame const& frame) {
  State state{.box = frame.box, .disks = {}, .clock = frame.clock, .seed = frame.seed};
  auto const x = numbers_of(frame, "x"), y = numbers_of(frame, "y"), radius = numbers_of(frame, "radius");
  auto const vx = numbers_or_zeros(frame, "velocity_x"), vy = numbers_or_zeros(frame, "velocity_y");
  for (std::size_t i = 0; i < frame.size(); ++i) state.disks.add(x[i], y[i], vx[i], vy[i], radius[i], 1.0, 0, 0);
  return state;
}

/// How far each disk has come since the first frame; nan for one that was not there.
std::vector<double> displacements(Frame const& first, Frame const& frame) {
  auto const along = [&](char const* name, char const* image, double side) {
    std::vector<double> const then = numbers_of(first, name), now = numbers_of(frame, name);
    std::vector<double> const image_then = numbers_or_zeros(first, image), image_now = numbers_or_zeros(frame, image);
    std::vector<double> way(frame.size(), std::nan(""));
    for (std::size_t i = 0; i < frame.size(); ++i) {
      auto const found = std::ranges::lower_bound(first.ids, frame.ids[i]);
      if (found == first.ids.end() || *found != frame.ids[i]) continue;
      auto const j = static_cast<std::size_t>(found - first.ids.begin());
      way[i] = now[i] - then[j] + side * (image_now[i] - image_then[j]);
    }
    return way;
  };
  std::vector<double> result = along("x", "image_x", frame.box.width());
  std::vector<double> const y = along("y", "image_y", frame.box.height());
  for (std::size_t i = 0; i < result.size(); ++i) result[i] = std::sqrt(result[i] * result[i] + y[i] * y[i]);
  return result;
}

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

class Movie {
 public:
  Movie(H5mdReader const& trajectory, MovieSettings const& settings) : trajectory_(trajectory), settings_(settings) {
    if (trajectory.frame_count() == 0) throw Error(Problem{.what = "the trajectory has no frames"});
    first_ = trajectory.frame(0).frame;
    if (has_bar()) find_range();
  }

  void draw_into(fs::path const& directory) const {
    std::size_t number = 0;
    for (std::size_t k = 0; k < trajectory_.frame_count(); k += settings_.every) {
      draw(trajectory_.frame(k).frame, directory / fmt::format("{:07}.png", number++));
    }
  }

 private:
  [[nodiscard]] bool has_bar() const { return settings_.colour != "radius" && settings_.colour != "neighbourhood"; }

  [[nodiscard]] std::vector<double> values_of(Frame const& frame) const {
    if (settings_.colour == "displacement") return displacements(first_, frame);
    if (settings_.colour == "psi6") return local_bond_orientation_orders(disks_of(frame));
    if (settings_.colour != "speed") return numbers_of(frame, settings_.colour);
    std::vector<double> speeds = numbers_of(frame, "velocity_x");
    std::vector<double> const y = numbers_of(frame, "velocity_y");
    for (std::size_t i = 0; i < speeds.size(); ++i) speeds[i] = std::sqrt(speeds[i] * speeds[i] + y[i] * y[i]);
    return speeds;
  }

  void find_range() {
    if (settings_.colour == "psi6") {
      most_ = 1.0;
      return;
    }
    for (std::size_t k = 0; k < trajectory_.frame_count(); k += settings_.every) {
      for (double const value : values_of(trajectory_.frame(k).frame)) {
        if (!std::isfinite(value)) continue;
        least_ = std::min(least_, value);
        most_ = std::max(most_, value);
      }
    }
  }

  void draw(Frame const& frame, fs::path const& file) const {
    State const state = disks_of(frame);
    PictureSettings picture{.width = settings_.width,
                            .title = fmt::format("step {}, t = {:.4g}", frame.clock.step, frame.clock.time)};
    std::vector<double> values;
    if (has_bar()) {
      values = values_of(frame);
      picture.colouring = Colouring::values;
      picture.values = values;
      picture.least = least_;
      picture.most = most_;
      picture.bar_label = settings_.colour == "psi6" ? "|ψ6|" : settings_.colour;
    } else if (settings_.colour == "neighbourhood") {
      double const side = 2.0 * radius_range(state.disks).largest;
      auto const cells = [side](double length) { return static_cast<std::uint64_t>(std::max(1.0, length / side)); };
      picture.colouring = Colouring::neighbourhood;
      picture.columns = cells(state.box.width());
      picture.rows = cells(state.box.height());
    }
    draw_disks(state, picture, file);
  }

  H5mdReader const& trajectory_;
  MovieSettings const& settings_;
  Frame first_;
  double least_ = 0.0;
  double most_ = 0.0;
};

}  // namespace

void make_movie(H5mdReader const& trajectory, MovieSettings const& settings) {
  Movie const movie(trajectory, settings);
  fs::path const file = fs::absolute(settings.file);
  PictureDirectory const pictures(file);
  movie.draw_into(pictures.path());
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
