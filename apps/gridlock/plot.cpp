#include <fmt/format.h>

#include <cstdio>
#include <memory>

#include "drawing/pictures.hpp"
#include "verbs.hpp"

namespace gridlock::cli {

void add_plot(CLI::App& app, ExitCode& exit_code) {
  CLI::App* const verb = app.add_subcommand("plot", "Draw the pictures of a run or sweep again from its data");
  struct Options {
    std::string directory;
    std::string colour;
    bool makes_pdf = false;
  };
  auto const options = std::make_shared<Options>();
  verb->add_option("DIR", options->directory, "Directory of a run or sweep")->required();
  verb->add_option("--colour,--color", options->colour,
                   "Of the agents at the end: psi6, speed, direction, neighbourhood, radius, or a column");
  verb->add_flag("--pdf", options->makes_pdf, "Write PDF files too, for papers");
  verb->callback([options, &exit_code] {
    gridlock::Pictures const pictures = gridlock::draw_results(options->directory, options->colour, options->makes_pdf);
    for (auto const& file : pictures.files) fmt::print("{}\n", file.string());
    for (auto const& note : pictures.notes) fmt::print(stderr, "note: {}\n", note);
    if (pictures.files.empty() && pictures.notes.empty()) {
      throw gridlock::Error({.what = fmt::format("there is nothing to draw of {}", options->directory),
                             .hint =
                                 "a sweep is drawn against a number that has two values or more, from the runs that "
                                 "have finished"});
    }
    exit_code = ExitCode::good;
  });
}

}  // namespace gridlock::cli
