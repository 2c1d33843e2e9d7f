#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "gridlock/core/error.hpp"
#include "gridlock/io/h5md.hpp"
#include "gridlock/io/settings_file.hpp"
#include "gridlock/simulation/configuration.hpp"
#include "io/file.hpp"
#include "io/frame_format.hpp"
#include "verbs.hpp"
#include "workspace/result_files.hpp"

namespace gridlock::cli {

namespace fs = std::filesystem;

namespace {

/// Returns the number of steps between frames that gives about a hundred frames for a run with these settings; 100 if
/// the run has no length in steps.
std::uint64_t steps_between_frames(fs::path const& settings) {
  constexpr std::uint64_t usual = 100;
  try {
    gridlock::Configuration const configuration =
        gridlock::read_configuration(gridlock::SettingsFile::from_path(settings));
    std::uint64_t const steps = configuration.run.steps.value_or(usual * usual);
    return std::max<std::uint64_t>(1, steps / usual);
  } catch (gridlock::Error const&) {
    return usual;  // the model belongs to another program
  }
}

/// Throws an Error for a format with a file for each frame if the output is a descriptor such as /dev/stdout.
void require_name_of_file(fs::path const& file, FrameFormat const& format) {
  if (format.file_of_step == nullptr || !descriptor_named(file)) return;
  std::string name(format.name);
  std::ranges::transform(name, name.begin(), [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
  throw Error({.what = fmt::format("{} takes one file, and {} is one for each frame", file.string(), name),
               .hint = fmt::format("name a file, such as -o frames{}", format.extension),
               .key = "-o"});
}

std::vector<std::string> exported_formats() {
  std::vector<std::string> names;
  for (FrameFormat const& format : frame_formats()) {
    if (format.is_exported) names.emplace_back(format.name);
  }
  return names;
}

/// Returns the help on formats: "xyz (OVITO, ASE), vtk (ParaView) or csv".
std::string help_on_formats() {
  std::string text;
  std::vector<std::string> const names = exported_formats();
  for (std::string const& name : names) {
    std::string_view const readers = frame_format(name).readers;
    text += text.empty() ? "" : name == names.back() ? " or " : ", ";
    text += readers.empty() ? name : fmt::format("{} ({})", name, readers);
  }
  return text;
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
  verb->add_option("--to", options->format, help_on_formats())->required()->check(one_of(exported_formats()));
  verb->add_option("-o,--output", options->output, "File to write; left out: beside the trajectory")->type_name("FILE");
  verb->add_option("--every", options->every, "Export every N-th frame")->check(whole_number(1));
  verb->add_flag("--overwrite", options->overwrites, "Replace a file that gridlock export has not made");
  verb->callback([options, &exit_code] {
    FrameFormat const& format = frame_format(options->format);
    fs::path const source = trajectory_file(options->path);
    fs::path const file =
        options->output.empty() ? fs::path(source).replace_extension(format.extension) : fs::path(options->output);
    require_name_of_file(file, format);
    gridlock::H5mdReader const trajectory(source);
    print_note_on_left_out(source, trajectory);
    gridlock::ExportSettings const settings{.format = options->format, .file = file, .every = options->every};
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
