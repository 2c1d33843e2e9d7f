#include "gridlock/run/movie.hpp"

#include <fmt/format.h>

#include <memory>

#include "verbs.hpp"

namespace gridlock::cli {

void add_movie(CLI::App& app, ExitCode& exit_code) {
  struct Options {
    std::string path;
    std::string output;
    gridlock::MovieSettings movie;
  };
  CLI::App* const verb = app.add_subcommand("movie", "Turn a trajectory into an MP4 movie");
  auto const options = std::make_shared<Options>();
  verb->add_option("PATH", options->path, "Directory of a run, or a trajectory (.h5)")->required();
  verb->add_option("-o,--output", options->output, "File to write; left out: beside the trajectory")->type_name("FILE");
  verb->add_option("--colour", options->movie.colour,
                   "displacement, psi6, speed, direction, neighbourhood, radius, or the name of a column");
  verb->add_option("--width", options->movie.width, "Pixels");
  verb->add_option("--rate", options->movie.rate, "Frames a second")->check(CLI::Range(1, 240));
  verb->add_option("--every", options->movie.every, "Show one of so many frames")->check(CLI::PositiveNumber);
  verb->callback([options, &exit_code] {
    std::filesystem::path const source = trajectory_file(options->path);
    options->movie.file = options->output.empty() ? std::filesystem::path(source).replace_extension(".mp4")
                                                  : std::filesystem::path(options->output);
    gridlock::make_movie(gridlock::H5mdReader(source), options->movie);
    fmt::print("{}\n", options->movie.file.string());
    exit_code = ExitCode::good;
  });
}

}  // namespace gridlock::cli
