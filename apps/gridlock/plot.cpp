#include <fmt/format.h>

#include <cstdio>
#include <memory>

#include "gridlock/run/pictures.hpp"
#include "verbs.hpp"

void add_plot(CLI::App& app, ExitCode& exit_code) {
  CLI::App* const verb = app.add_subcommand("plot", "Draw the pictures of a run or sweep again from its data");
  auto const directory = std::make_shared<std::string>();
  verb->add_option("DIR", *directory, "Directory of a run or sweep")->required();
  verb->callback([directory, &exit_code] {
    gridlock::Pictures const pictures = gridlock::draw_results(*directory);
    for (auto const& file : pictures.files) fmt::print("{}\n", file.string());
    for (auto const& note : pictures.notes) fmt::print(stderr, "note: {}\n", note);
    exit_code = ExitCode::good;
  });
}
