#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <map>
#include <memory>
#include <vector>

#include "gridlock/core/error.hpp"
#include "gridlock/io/h5md.hpp"
#include "gridlock/io/settings_file.hpp"
#include "gridlock/simulation/configuration.hpp"
#include "io/file.hpp"
#include "verbs.hpp"
#include "workspace/result_files.hpp"

namespace gridlock::cli {

namespace fs = std::filesystem;

namespace {

/// How many steps apart to keep about a hundred frames of a run like that of a settings file; every one of a run
/// without steps, such as a protocol alone, whose only frame is its end.
std::uint64_t steps_between_frames(fs::path const& settings) {
  constexpr std::uint64_t usual = 100;
  try {
    gridlock::Configuration const configuration =
        gridlock::read_configuration(gridlock::SettingsFile::from_path(settings));
    std::uint64_t const steps = configuration.run.steps.value_or(usual * usual);
    return std::max<std::uint64_t>(1, steps / usual);
  } catch (gridlock::Error const&) {
    return usual;  // the model is of another program
  }
}

/// Files of VTK lie in a directory beside the one that is named.
void require_name_of_file(fs::path const& file) {
  if (!descriptor_named(file)) return;
  throw Error({.what = fmt::format("{} takes one file, and VTK is one for each frame", file.string()),
               .hint = "name a file, such as -o frames.pvd",
               .key = "-o"});
}

}  // namespace

fs::path trajectory_file(std::string const& path) {
  std::error_code ignored;
  if (!fs::is_directory(path, ignored)) return path;
  fs::path file = fs::path(path) / "trajectory.h5";
  if (!fs::exists(file, ignored) && fs::exists(fs::path(path) / "config.resolved.toml", ignored)) {
    std::uint64_t const steps = steps_between_frames(fs::path(path) / "config.resolved.toml");
    throw gridlock::Error(
        {.what = fmt::format("the run in {} kept no frames", path),
         .hint = fmt::format("run it again with --set trajectory.every={}, or another number of steps", steps)});
  }
  return file;
}

void print_note_on_left_out(fs::path const& source, gridlock::H5mdReader const& trajectory) {
  std::string const note = gridlock::note_on_left_out(source, trajectory.settings());
  if (!note.empty()) fmt::print(stderr, "note: {}\n", note);
}

void add_export(CLI::App& app, ExitCode& exit_code) {
  struct Options {
    std::string path;
    std::string format;
    std::string output;
    std::size_t every = 1;
    bool overwrites = false;
  };
  CLI::App* const verb = app.add_subcommand("export", "Turn a trajectory into extended XYZ, VTK or CSV");
  auto const options = std::make_shared<Options>();
  verb->add_option("PATH", options->path, "Directory of a run, or a trajectory in H5MD (.h5, .h5md)")->required();
  verb->add_option("--to", options->format, "xyz (OVITO, ASE), vtk (ParaView) or csv")
      ->required()
      ->check(one_of({"xyz", "vtk", "csv"}));
  verb->add_option("-o,--output", options->output, "File to write; left out: beside the trajectory")->type_name("FILE");
  verb->add_option("--every", options->every, "Export every N-th frame")->check(whole_number(1));
  verb->add_flag("--overwrite", options->overwrites, "Replace a file that gridlock export has not made");
  verb->callback([options, &exit_code] {
    static std::map<std::string, std::pair<gridlock::ExportFormat, char const*>> const formats{
        {"xyz", {gridlock::ExportFormat::xyz, ".xyz"}},
        {"vtk", {gridlock::ExportFormat::vtk, ".pvd"}},
        {"csv", {gridlock::ExportFormat::csv, ".csv"}}};
    auto const [format, extension] = formats.at(options->format);
    fs::path const source = trajectory_file(options->path);
    fs::path const file =
        options->output.empty() ? fs::path(source).replace_extension(extension) : fs::path(options->output);
    if (format == gridlock::ExportFormat::vtk) require_name_of_file(file);
    gridlock::H5mdReader const trajectory(source);
    print_note_on_left_out(source, trajectory);
    gridlock::ExportSettings const settings{.format = format, .file = file, .every = options->every};
    std::vector<fs::path> const exported = gridlock::exported_files(trajectory, settings);
    gridlock::protect_files({.results = exported,
                             .inputs = {source},
                             .maker = "export",
                             .hint = "name another file with -o, or replace it: --overwrite",
                             .overwrites = options->overwrites});
    gridlock::remove_leftovers(fs::absolute(file).parent_path());
    gridlock::record_further_results(exported, "export");
    auto const files = gridlock::export_trajectory(trajectory, settings);
    if (!gridlock::descriptor_named(file)) fmt::print("{}\n", files.front().string());
    exit_code = ExitCode::good;
  });
}

}  // namespace gridlock::cli
