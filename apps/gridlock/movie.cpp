#include "drawing/movie.hpp"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <cstdio>
#include <memory>

#include "terminal.hpp"
#include "verbs.hpp"

namespace gridlock::cli {

namespace {

struct MovieOptions {
  std::string path;
  std::string output;
  bool is_quiet = false;
  gridlock::MovieSettings movie;
};

ExitCode make_movie(MovieOptions const& options) {
  std::filesystem::path const source = trajectory_file(options.path);
  gridlock::MovieSettings settings = options.movie;
  settings.file = options.output.empty() ? std::filesystem::path(source).replace_extension(".mp4")
                                         : std::filesystem::path(options.output);
  settings.source = source;
  gridlock::H5mdReader const trajectory(source);
  print_note_on_left_out(source, trajectory);
  StopSignals const signals;
  gridlock::RunStatus status = gridlock::RunStatus::finished;
  {
    ProgressLine line;
    status = gridlock::make_movie(trajectory, settings, [&](gridlock::MovieProgress const& progress) {
      if (!options.is_quiet && progress.drawn > 0) {
        line.show(static_cast<double>(progress.drawn) / static_cast<double>(progress.all), progress.seconds,
                  fmt::format("{} of {} frames", progress.drawn, progress.all));
      }
      return !StopSignals::is_stop_asked();
    });
  }
  if (status == gridlock::RunStatus::finished) {
    fmt::print("{}\n", settings.file.string());
    return ExitCode::good;
  }
  fmt::print(stderr, "interrupted: {} was not written\n", settings.file.string());
  return ExitCode::run_failed;
}

}  // namespace

void add_movie(CLI::App& app, ExitCode& exit_code) {
  CLI::App* const verb = app.add_subcommand("movie", "Turn a trajectory into a movie (.mp4, .gif, .webm, .mov, .mkv)");
  auto const options = std::make_shared<MovieOptions>();
  verb->add_option("PATH", options->path, "Directory of a run, or a trajectory in H5MD (.h5, .h5md)")->required();
  verb->add_option("-o,--output", options->output, "File to write; left out: an MP4 beside the trajectory")
      ->type_name("FILE");
  verb->add_option("--colour,--color", options->movie.colour,
                   "displacement, psi6, speed, direction, neighbourhood, radius, or the name of a column");
  verb->add_option("--width", options->movie.width, "Pixels");
  verb->add_option("--rate", options->movie.rate, "Frames a second")->check(whole_number(1, 240));
  verb->add_option("--every", options->movie.every, "Show every N-th frame")->check(whole_number(1));
  verb->add_flag("--overwrite", options->movie.overwrites, "Replace a file that gridlock movie has not made");
  verb->add_flag("-q,--quiet", options->is_quiet, "Print errors only");
  verb->callback([options, &exit_code] { exit_code = make_movie(*options); });
}

}  // namespace gridlock::cli
