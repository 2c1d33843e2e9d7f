#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <cstdint>
#include <cstdio>
#include <map>
#include <memory>
#include <numbers>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "gridlock/analysis/bond_orientations.hpp"
#include "gridlock/analysis/spectral_density.hpp"
#include "gridlock/core/error.hpp"
#include "gridlock/grid/voronoi.hpp"
#include "gridlock/io/settings_file.hpp"
#include "gridlock/io/table.hpp"
#include "gridlock/io/xyz.hpp"
#include "io/file.hpp"
#include "pictures.hpp"
#include "simulation/packing_analysis.hpp"
#include "terminal.hpp"
#include "verbs.hpp"
#include "workspace/result_files.hpp"
#include "workspace/run_files.hpp"
#include "workspace/summary.hpp"

namespace gridlock::cli {

namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

struct Options {
  std::string path;
  std::optional<std::int64_t> frame;
  std::string potential;  ///< empty: that of the run, or harmonic
  PackingQuestions questions;
  std::optional<double> radius;
  std::optional<double> packing_fraction;
  bool prints_json = false;
  bool leaves_out_pictures = false;
  OutputOptions output;
};

Error problem_of(fs::path const& file, std::string_view what, std::string const& hint) {
  return Error({.what = fmt::format("{} {}", file.string(), what), .hint = hint, .file = file.string()});
}

/// Sets the radius of all disks, for a file without radii.
void set_radii(State& state, double radius) { std::ranges::fill(state.agents.column<Radius>(), radius); }

fs::path packing_file(Options const& options) {
  std::error_code ignored;
  return fs::is_directory(options.path, ignored) ? fs::path(options.path) / "final.xyz" : fs::path(options.path);
}

/// Returns the potential that is asked for, otherwise that of the protocol in the directory.
Potential potential_of(Options const& options) {
  if (!options.potential.empty()) return options.potential == "harmonic" ? Potential::harmonic : Potential::hertzian;
  fs::path const settings = fs::path(options.path) / "config.resolved.toml";
  std::error_code ignored;
  if (!fs::exists(settings, ignored)) return Potential::harmonic;
  try {
    return read_configuration(SettingsFile::from_path(settings)).soft.potential;
  } catch (Error const&) {
    return Potential::harmonic;  // the settings of another program
  }
}

State read_packing(Options const& options) {
  fs::path const file = packing_file(options);
  XyzFrame frame = read_xyz(file, options.frame, "--frame");
  std::size_t const disks = frame.state.agents.size();
  if (disks == 0) throw problem_of(file, "has no disks", "name a file with a packing");
  bool const gives_radii = options.radius || options.packing_fraction;
  if (frame.has_radii && gives_radii) {
    throw problem_of(file, "has radii of its own", "leave --radius and --packing-fraction out");
  }
  if (!frame.has_radii && !gives_radii) {
    throw problem_of(file, "has no radii",
                     "give --radius or --packing-fraction for equal disks, or add a column radius:R:1");
  }
  if (options.radius) set_radii(frame.state, *options.radius);
  if (options.packing_fraction) {
    double const area = *options.packing_fraction * frame.state.box.area() / static_cast<double>(disks);
    set_radii(frame.state, std::sqrt(area / std::numbers::pi));
  }
  // No note is needed on velocities and clocks, since an analysis does not use them.
  if (!frame.unused_columns.empty()) {
    fmt::print(stderr, "note: columns of {} that are not used: {}\n", file.string(),
               fmt::join(frame.unused_columns, ", "));
  }
  return std::move(frame.state);
}

PointsInMemory points_of(Packing const& packing) {
  return {.x = packing.x.data(), .y = packing.y.data(), .count = packing.size()};
}

/// Returns ⟨|ψ6|⟩ over Voronoi neighbours; null for fewer than three disks, whose neighbours are images of each other.
Json local_order(Packing const& packing) {
  if (packing.size() < 3) return nullptr;
  VoronoiCells const cells = find_voronoi_cells(packing.box, points_of(packing), 0);
  double sum = 0.0;
  for (auto const& order : bond_orientations(packing.box, points_of(packing), cells.neighbours)) sum += std::abs(order);
  return sum / static_cast<double>(packing.size());
}

/// Returns the spectral density up to wave number 4π/D, in rings of the width 2π/(longer side). For many disks the
/// largest wave number is reduced, so that the sum takes only seconds.
Table spectrum_of(Packing const& packing) {
  constexpr double max_terms = 5e9;
  double const longest = std::max(packing.box.width(), packing.box.height());
  double const bound =
      std::sqrt(8.0 * std::numbers::pi * max_terms / static_cast<double>(packing.size()) / packing.box.area());
  double const largest = std::min(4.0 * std::numbers::pi / smallest_diameter(packing), bound);
  double const ring = 2.0 * std::numbers::pi / longest;
  auto const rings = static_cast<std::size_t>(std::clamp(largest / ring, 1.0, 1e6));
  SpectralDensity found = find_spectral_density(packing.box, points_of(packing), packing.radius, largest, rings, 0);
  Table table;
  table.add_column("wave_number", std::move(found.wave_number));
  table.add_column("spectral_density", std::move(found.density));
  table.add_column("wave_vectors", std::move(found.vectors));
  return table;
}

/// Returns all files that write_results() may write. These names belong to a packing, even if it has no spectrum.
std::vector<fs::path> files_in(fs::path const& directory) {
  std::vector<fs::path> files;
  for (char const* name :
       {"contacts.csv", "gaps.csv", "forces.csv", "spectral_density.csv", "packing.xyz", summary_name}) {
    files.push_back(directory / name);
  }
  return files;
}

void write_results(fs::path const& directory, State const& state, PackingAnalysis const& analysis,
                   Json const& summary) {
  remove_results(directory);
  auto const write = [&](char const* name, Table const& table) {
    record_result(directory / name);
    write_csv(table, directory / name);
  };
  write("contacts.csv", contacts_table(analysis));
  write("gaps.csv", gaps_table(analysis));
  write("forces.csv", forces_table(analysis));
  if (analysis.packing.box.is_periodic()) write("spectral_density.csv", spectrum_of(analysis.packing));
  record_result(directory / "packing.xyz");
  write_xyz(state, directory / "packing.xyz");
  record_result(directory / summary_name);
  write_file(directory / summary_name, summary.dump(2) + "\n");
}

/// Returns the note on contacts with a tolerance, which depend only on distances.
std::string note_on_tolerance(ContactNetwork const& network) {
  auto const gaps = std::ranges::count(network.forces, 0.0);
  std::string const first =
      fmt::format("{} of {} contacts are gaps below the tolerance and carry no force", gaps, network.contacts.size());
  if (network.energy == 0.0) return first + ": whether hard disks are jammed is not known from them";
  return first +
         ": contact_number, rattler_share and excess_contacts count them, and is_jammed says nothing; soft disks, "
         "which overlap, need no --tolerance";
}

/// Prints notes that a user should read before using the results.
void print_notes(PackingAnalysis const& analysis) {
  ContactNetwork const& network = analysis.network;
  auto const note = [](std::string const& text) { fmt::print(stderr, "note: {}\n", text); };
  if (network.tolerance > 0.0) {
    note(note_on_tolerance(network));
  } else if (network.energy == 0.0) {
    note("no disks overlap; contacts of hard disks are those within a gap, such as --tolerance 1e-6");
  } else if (!network.is_converged(analysis.questions.largest_residual)) {
    note(
        fmt::format("not a minimum: the root mean square of the net forces is {:.3g} of the mean contact force and the "
                    "largest {:.3g}, with a bound of {:.3g}; moduli are of no meaning and left out",
                    network.rms_residual_force, network.residual_force, analysis.questions.largest_residual));
  } else if (analysis.softest_mode &&
             analysis.softest_mode->eigenvalue < min_eigenvalue_of_a_minimum(network.pressure)) {
    note("a saddle and not jammed: the forces balance, but the energy falls along the softest mode");
  } else if (network.backbone_disks > 0 && !analysis.moduli) {
    note("the backbone has loose parts, so that it has no moduli");
  }
}

void print_summary(State const& state, std::string const& path, Json const& summary) {
  fmt::print("{} disks in {}\n  {}\n", state.agents.size(), path, text_of(state.box));
  for (auto const& [name, value] : summary.items()) {
    std::string const text = value.is_number_float() ? fmt::format("{:.10g}", value.get<double>())
                             : value.is_string()     ? value.get<std::string>()
                             : value.is_null()       ? std::string("–")
                                                     : value.dump();
    fmt::print("  {:<32} {}\n", name, text);
  }
}

ExitCode contacts(Options const& options) {
  State const state = read_packing(options);
  PackingQuestions questions = options.questions;
  questions.potential = potential_of(options);
  PackingAnalysis const analysis = analyse_packing(state, questions);
  Json summary = summary_of(analysis);
  summary["local_bond_orientation_order"] = local_order(analysis.packing);
  summary["state_hash"] = fmt::format("{:016x}", hash(state));
  OutputOptions const& output = options.output;
  if (!output.directory.empty()) {
    open_result_directory(output.directory, files_in(output.directory), {packing_file(options)}, output.overwrites);
    write_results(output.directory, state, analysis, summary);
  }
  if (options.prints_json) {
    fmt::print("{}\n", summary.dump(2));
  } else {
    print_summary(state, options.path, summary);
  }
  print_notes(analysis);
  if (!output.directory.empty() && !options.leaves_out_pictures) draw_pictures(output.directory);
  return ExitCode::good;
}

/// Returns a validator for numbers in a range; CLI11 itself refuses words that are not numbers.
CLI::Validator number_that(std::string const& range, bool (*is_in_range)(double)) {
  return {[=](std::string const& text) {
            double value = 0.0;
            bool const is_number = CLI::detail::lexical_cast(text, value);
            return !is_number || is_in_range(value) ? std::string()
                                                    : fmt::format("must be a number {}, but is {}", range, text);
          },
          range};
}

}  // namespace

void add_contacts(CLI::App& app, ExitCode& exit_code) {
  CLI::App* const verb =
      app.add_subcommand("contacts", "Analyse a packing: contacts, rattlers, pressure, elastic moduli");
  auto const options = std::make_shared<Options>();
  CLI::Validator const share = number_that("from 0 to 1", [](double value) { return value >= 0.0 && value <= 1.0; });
  CLI::Validator const positive =
      number_that("above 0", [](double value) { return value > 0.0 && std::isfinite(value); });
  verb->add_option("FILE", options->path, "Extended XYZ with radii, or the directory of a run")->required();
  verb->add_option("--frame", options->frame, "Of a file with several: from 0, or from -1 for the last");
  verb->add_option("--potential", options->potential,
                   "What overlaps cost: harmonic δ²/2, hertzian 2 δ^(5/2)/5; by default as in the run")
      ->check(one_of({"harmonic", "hertzian"}));
  verb->add_option("--tolerance", options->questions.tolerance,
                   "Gaps below this share of the distance are contacts, for hard disks")
      ->check(share);
  verb->add_option("--largest-gap", options->questions.largest_gap, "List gaps up to this share of the distance")
      ->check(share);
  verb->add_option("--residual", options->questions.largest_residual,
                   "Root mean square net force of a minimum over the mean force")
      ->check(positive);
  verb->add_option("--radius", options->radius, "Of all disks, for a file without radii")->check(positive);
  verb->add_option("--packing-fraction", options->packing_fraction, "Of equal disks, for a file without radii")
      ->check(positive)
      ->excludes("--radius");
  verb->add_flag("--json", options->prints_json, "Print JSON");
  verb->add_option("-o,--output", options->output.directory, "Directory for tables and pictures; left out: none")
      ->type_name("DIR");
  verb->add_flag("--overwrite", options->output.overwrites, "Replace existing results");
  verb->add_flag("--no-pictures", options->leaves_out_pictures, "Leave the pictures out");
  verb->callback([options, &exit_code] { exit_code = contacts(*options); });
}

}  // namespace gridlock::cli
