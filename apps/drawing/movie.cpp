#include "drawing/movie.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cctype>
#include <chrono>
#include <string>
#include <string_view>
#include <vector>

#include "drawing/frame_picture.hpp"
#include "drawing/process.hpp"
#include "gridlock/core/error.hpp"
#include "gridlock/io/settings_file.hpp"
#include "gridlock/simulation/configuration.hpp"
#include "io/file.hpp"
#include "workspace/result_files.hpp"

namespace gridlock {

namespace {

namespace fs = std::filesystem;

/// Name of this command in lists of results.
constexpr char const* maker = "movie";
/// Time limit for ffmpeg to accept a frame or to end.
constexpr std::chrono::minutes ffmpeg_timeout{10};

/// The options of ffmpeg for files with one extension.
struct Format {
  std::string_view extension;
  std::string_view muxer;
  std::vector<std::string> encoding;
  std::uint64_t max_rate = 240;
};

std::vector<Format> const& formats() {
  // Most players support H.264 only with halved colour resolution, which requires even sides.
  static std::string const even = "pad=ceil(iw/2)*2:ceil(ih/2)*2:color=white";
  static std::vector<std::string> const h264{"-vf", even, "-c:v", "libx264", "-crf", "18", "-pix_fmt", "yuv420p"};
  static std::vector<Format> const known{
      {".mp4", "mp4", h264},
      {".gif", "gif", {"-filter_complex", "split[a][b];[a]palettegen=stats_mode=single[p];[b][p]paletteuse=new=1"}, 50},
      {".webm",
       "webm",
       {"-vf", even, "-c:v", "libvpx-vp9", "-crf", "24", "-b:v", "0", "-cpu-used", "4", "-row-mt", "1", "-pix_fmt",
        "yuv420p"}},
      {".mov", "mov", h264},
      {".mkv", "matroska", h264}};
  return known;
}

/// Errors: Error if the extension is not one of a movie, or the file format does not allow the frame rate.
Format const& format_of(MovieSettings const& settings) {
  std::string extension = settings.file.extension().string();
  std::ranges::transform(extension, extension.begin(),
                         [](unsigned char letter) { return static_cast<char>(std::tolower(letter)); });
  auto const found = std::ranges::find(formats(), extension, &Format::extension);
  if (found == formats().end()) {
    throw Error(Problem{
        .what = extension.empty() ? fmt::format("the name {} does not say which kind of movie", settings.file.string())
                                  : fmt::format("a movie cannot be a {} file", extension),
        .hint = "end the name in .mp4, .gif, .webm, .mov or .mkv",
        .key = "--output"});
  }
  if (settings.rate > found->max_rate) {
    throw Error(Problem{.what = fmt::format("{} frames a second are too many for a {} file", settings.rate, extension),
                        .hint = fmt::format("use --rate {} or less, or another kind of file", found->max_rate),
                        .key = "--rate"});
  }
  return *found;
}

void require_place(fs::path const& file) {
  std::error_code ignored;
  if (!file.has_filename() || fs::is_directory(file, ignored)) {
    throw Error(Problem{.what = fmt::format("{} is the name of a directory", file.string()),
                        .hint = fmt::format("name a file in it: {}", (file / "movie.mp4").string()),
                        .key = "--output"});
  }
  fs::path const directory = file.parent_path();
  if (directory.empty() || fs::is_directory(directory)) return;
  throw Error(Problem{
      .what = fmt::format("there is no directory {} to write {} into", directory.string(), file.filename().string()),
      .hint = fmt::format("make it first: mkdir -p {}", directory.string()),
      .key = "--output"});
}

/// Returns ffmpeg's last error message, without the address of a component and without "Conversion failed".
std::string last_words(std::string_view errors) {
  std::string words = "it says no more";
  while (!errors.empty()) {
    std::string_view line = errors.substr(0, errors.find('\n'));
    errors.remove_prefix(std::min(line.size() + 1, errors.size()));
    if (line.starts_with('[') && line.find("] ") != std::string_view::npos) line.remove_prefix(line.find("] ") + 2);
    if (!line.empty() && !line.starts_with("Conversion failed")) words = line;
  }
  return words;
}

/// Runs ffmpeg, which receives frames of equal size and writes them into a file.
class Encoder {
 public:
  Encoder(PicturePixels const& first, MovieSettings const& settings, fs::path const& file)
      : process_(arguments(first, settings, fs::absolute(file)), fs::current_path(), ProcessInput::pipe) {}

  /// Sends a frame to ffmpeg. Errors: those of finish().
  void add(PicturePixels const& frame) {
    if (!process_.write(frame.bytes, ffmpeg_timeout)) finish();
  }

  /// Errors: Error if ffmpeg is not installed, RunFailure if it fails.
  void finish() {
    ProcessResult const result = process_.wait(ffmpeg_timeout);
    if (!result.was_found) {
      throw Error(Problem{.what = "ffmpeg, which joins the pictures to a movie, is not installed",
                          .hint = "apt-get install ffmpeg"});
    }
    if (result.timed_out) throw RunFailure("ffmpeg did not end in time; there is no movie");
    if (!result.succeeded) throw RunFailure(fmt::format("ffmpeg made no movie: {}", last_words(result.errors)));
  }

 private:
  static std::vector<std::string> arguments(PicturePixels const& first, MovieSettings const& settings,
                                            fs::path const& file) {
    Format const& format = format_of(settings);
    std::vector<std::string> words{"ffmpeg",
                                   "-y",
                                   "-loglevel",
                                   "error",
                                   "-f",
                                   "rawvideo",
                                   "-pixel_format",
                                   std::endian::native == std::endian::little ? "bgr0" : "0rgb",
                                   "-video_size",
                                   fmt::format("{}x{}", first.width, first.height),
                                   "-framerate",
                                   std::to_string(settings.rate),
                                   "-i",
                                   "pipe:0"};
    words.insert(words.end(), format.encoding.begin(), format.encoding.end());
    words.insert(words.end(), {"-f", std::string(format.muxer), "file:" + file.string()});
    return words;
  }

  ChildProcess process_;
};

/// Returns the walls inside the box by the settings that a trajectory keeps; none by settings that this version cannot
/// read, for its disks can be drawn all the same.
std::vector<LineSegment> walls_of(H5mdReader const& trajectory) {
  std::vector<LineSegment> lines;
  try {
    SettingsFile const file = SettingsFile::from_text(trajectory.settings().configuration, "the trajectory");
    if (!file.is_given("walls")) return {};
    for (auto const& wall : read_configuration(file).engine.walls) {
      // No run has others, but a file may be damaged.
      if (wall.from.size() != 2 || wall.to.size() != 2) continue;
      lines.push_back({{wall.from[0], wall.from[1]}, {wall.to[0], wall.to[1]}});
    }
  } catch (Error const&) {
    return {};
  }
  return lines;
}

/// Makes a movie of a trajectory.
class Movie {
 public:
  Movie(H5mdReader const& trajectory, MovieSettings const& settings, OnMovieProgress const& on_progress)
      : trajectory_(trajectory),
        settings_(settings),
        on_progress_(on_progress),
        all_((trajectory.frame_count() + settings.every - 1) / settings.every),
        painter_(trajectory.frame(0).frame, settings.colour) {
    painter_.show_walls(walls_of(trajectory));
    auto const& named = trajectory.settings().value_names;
    if (auto const names = named.find(painter_.colour()); names != named.end()) painter_.name_kinds(names->second);
  }

  RunStatus make() {
    // A first pass finds the range of the colour bar, which must be the same in all frames.
    for (std::size_t n = 0; painter_.needs_ranges() && n < all_; ++n) {
      if (!should_continue(0)) return RunStatus::interrupted;
      painter_.widen_bar(frame(n));
    }
    record_further_result(settings_.file, maker);
    AtomicFile file(settings_.file);
    if (!should_continue(0)) return RunStatus::interrupted;
    PicturePixels const first = picture(0);
    Encoder encoder(first, settings_, file.location());
    encoder.add(first);
    for (std::size_t n = 1; n < all_; ++n) {
      if (!should_continue(n)) return RunStatus::interrupted;
      encoder.add(picture(n));
    }
    encoder.finish();
    file.commit();
    return RunStatus::finished;
  }

 private:
  [[nodiscard]] bool should_continue(std::size_t drawn) const {
    if (!on_progress_) return true;
    std::chrono::duration<double> const passed = std::chrono::steady_clock::now() - start_;
    return on_progress_({.drawn = drawn, .all = all_, .seconds = passed.count()});
  }
  [[nodiscard]] Frame frame(std::size_t n) const { return trajectory_.frame(n * settings_.every).frame; }
  [[nodiscard]] PicturePixels picture(std::size_t n) const {
    Frame const shown = frame(n);
    return painter_.pixels(shown, settings_.width,
                           fmt::format("step {}, t = {:.4g}", shown.clock.step, shown.clock.time));
  }

  H5mdReader const& trajectory_;
  MovieSettings const& settings_;
  OnMovieProgress const& on_progress_;
  std::size_t all_;
  FramePainter painter_;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

}  // namespace

RunStatus make_movie(H5mdReader const& trajectory, MovieSettings const& settings, OnMovieProgress const& on_progress) {
  assert(settings.every > 0);
  require_place(settings.file);
  format_of(settings);
  protect_files({.results = {settings.file},
                 .inputs = {settings.source},
                 .maker = maker,
                 .hint = "name another file, or replace it: --overwrite, in Python overwrite=True",
                 .overwrites = settings.overwrites});
  if (trajectory.frame_count() == 0) throw Error(Problem{.what = "the trajectory has no frames"});
  return Movie(trajectory, settings, on_progress).make();
}

}  // namespace gridlock
