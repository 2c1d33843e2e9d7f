#include "drawing/pictures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numeric>
#include <set>
#include <span>
#include <utility>
#include <vector>

#include "core/unwrapped.hpp"
#include "drawing/frame_picture.hpp"
#include "drawing/labels.hpp"
#include "drawing/picture.hpp"
#include "drawing/plot.hpp"
#include "gridlock/core/error.hpp"
#include "gridlock/io/settings_file.hpp"
#include "gridlock/io/table.hpp"
#include "gridlock/io/xyz.hpp"
#include "gridlock/observe/observable.hpp"
#include "gridlock/simulation/setup.hpp"
#include "simulation/kind_names.hpp"
#include "workspace/result_files.hpp"

namespace gridlock {

namespace {

namespace fs = std::filesystem;

/// Draws what can be drawn; a failure becomes a note.
class Artist {
 public:
  Artist(fs::path directory, bool makes_pdf) : directory_(std::move(directory)), makes_pdf_(makes_pdf) {}

  void disks(std::string const& name, State const& state, PictureSettings const& settings) {
    picture(name, [&](fs::path const& file) { draw_disks(state, settings, file); });
  }

  void picture(std::string const& name, std::function<void(fs::path const&)> const& draw) {
    for (char const* extension : {".svg", ".png", ".pdf"}) {
      if (!makes_pdf_ && std::string_view(extension) == ".pdf") continue;
      fs::path const file = directory_ / (name + extension);
      attempt(name, [&] { draw(file); }, {file});
    }
  }

  void plot(Plot plot) {
    plot.makes_pdf = makes_pdf_;
    std::vector<fs::path> files;
    for (char const* extension : {".gp", ".svg", ".png", ".pdf"}) {
      if (makes_pdf_ || std::string_view(extension) != ".pdf") files.push_back(directory_ / (plot.name + extension));
    }
    attempt(
        plot.name,
        [&] {
          if (draw_plot(plot, directory_) == PlotOutcome::gnuplot_is_missing) {
            pictures_.notes.push_back(plot.name + ": gnuplot is not installed; the script is there to be drawn later");
          }
        },
        files);
  }

  void note(std::string text) { pictures_.notes.push_back(std::move(text)); }

  [[nodiscard]] bool has(std::string const& file) const {
    std::error_code ignored;
    return fs::exists(directory_ / file, ignored);
  }
  [[nodiscard]] fs::path path_of(std::string const& file) const { return directory_ / file; }
  [[nodiscard]] Pictures take() { return std::move(pictures_); }

 private:
  void attempt(std::string const& name, std::function<void()> const& draw, std::vector<fs::path> const& files) {
    for (fs::path const& file : files) record_result(file);
    try {
      draw();
      for (fs::path const& file : files) {
        if (fs::exists(file)) pictures_.files.push_back(file);
      }
    } catch (std::exception const& error) {
      // What keeps a picture from being drawn keeps it from every kind of file.
      if (std::string const text = name + ": " + error.what();
          std::ranges::find(pictures_.notes, text) == pictures_.notes.end())
        note(text);
    }
  }

  fs::path directory_;
  bool makes_pdf_;
  Pictures pictures_;
};

/// How far each disk of `state` has come from where it stood in `start`, in units of the side of the box.
std::vector<double> displacements(State const& start, State const& state) {
  std::vector<double> values(state.agents.size(), std::nan(""));
  auto const image = [](Disks const& disks, std::size_t i) {
    return Vector{static_cast<double>(disks.column<ImageX>()[i]), static_cast<double>(disks.column<ImageY>()[i])};
  };
  for (std::size_t i = 0; i < values.size(); ++i) {
    std::size_t const then = start.agents.index_of(state.agents.ids()[i]);
    if (then == Disks::not_found) continue;
    Vector const edges = image(state.agents, i) - image(start.agents, then);
    Vector const u = unwrapped_displacement(state.box, position(start.agents, then), position(state.agents, i), edges);
    values[i] = std::sqrt(squared_length(u)) / state.box.side();
  }
  return values;
}

/// The last state of a run, with every column that its file has.
Frame last_frame(fs::path const& file) {
  XyzFrame const last = read_xyz(file);
  Frame frame = frame_of(last.state);
  std::erase_if(frame.columns, [&](FrameColumn const& column) {
    // One frame does not say which agents have crossed an edge since when.
    if (column.name == "mass" || column.name.starts_with("image_")) return true;
    return (column.name.starts_with("velocity_") && !last.has_velocities) ||
           (column.name == "radius" && !last.has_radii);
  });
  for (FrameColumn const& column : last.others) {
    auto const& values = std::get<std::vector<double>>(column.values);
    bool const are_kinds =
        std::ranges::all_of(values, [](double v) { return v >= 0.0 && v < 1e9 && v == std::floor(v); });
    if (are_kinds) {
      frame.columns.push_back({column.name, std::vector<std::uint32_t>(values.begin(), values.end())});
    } else {
      frame.columns.push_back(column);
    }
  }
  return frame;
}

/// The agents where they are at the end.
void draw_last(Artist& artist, std::string const& colour) {
  Frame const last = last_frame(artist.path_of("final.xyz"));
  FramePainter painter(last, colour);
  painter.name_kinds(kind_names(SettingsFile::from_path(artist.path_of("config.resolved.toml")), painter.colour()));
  painter.widen_bar(last);
  artist.picture("final", [&](fs::path const& file) {
    painter.draw(last, PictureSettings{}.width, fmt::format("step {}, t = {:.4g}", last.clock.step, last.clock.time),
                 file);
  });
}

void draw_start(Artist& artist, Setup const& setup) {
  std::uint64_t const cells = setup.configuration.engine.cells.value_or(0);
  // A grid finer than the disks would hide them.
  bool const shows_grid = cells > 0 && cells <= 40;
  artist.disks(
      "start", disks_of(setup),
      {.colouring = shows_grid ? Colouring::neighbourhood : Colouring::radius,
       .columns = shows_grid ? cells : 0,
       .rows = shows_grid ? cells : 0,
       .title = fmt::format("start, φ = {:.4g}", covered_area(disks_of(setup).agents) / disks_of(setup).box.area())});
}

/// The disks at the end, coloured by how far they have come.
void draw_displacements(Artist& artist, Setup const& setup) {
  State const last = read_xyz(artist.path_of("final.xyz")).state;
  std::vector<double> const values = displacements(disks_of(setup), last);
  artist.disks("final", last,
               {.colouring = Colouring::values,
                .values = values,
                .least = 0.0,
                .bar_label = "displacement / side",
                .title = fmt::format("after {} steps", last.clock.step - disks_of(setup).clock.step)});
}

/// g(r), over the distance in mean diameters for agents with radii.
void draw_pair_correlation(Artist& artist, std::span<double const> radii) {
  double diameter = 1.0;
  char const* label = "distance r";
  if (!radii.empty()) {
    auto const [least, most] = std::ranges::minmax(radii);
    diameter = 2.0 * std::accumulate(radii.begin(), radii.end(), 0.0) / static_cast<double>(radii.size());
    label = least == most ? "distance r / diameter σ" : "distance r / mean diameter";
  }
  artist.plot({.name = "pair_correlation",
               .title = "Pair correlation",
               .x = {.label = label},
               .y = {.label = "pair correlation g(r)", .least = 0.0},
               .curves = {{.file = "pair_correlation.csv",
                           .x = "distance",
                           .y = "pair_correlation",
                           .error = "error",
                           .x_factor = 1.0 / diameter}},
               .references = {{.at = 1.0}},
               .key = PlotKey::none});
}

/// The curves that a run has measured, of whatever model.
void draw_curves(Artist& artist, std::span<double const> radii) {
  if (artist.has("pair_correlation.csv")) draw_pair_correlation(artist, radii);
  if (!artist.has("speed_distribution.csv")) return;
  artist.plot({.name = "speed_distribution",
               .title = "Distribution of speed",
               .x = {.label = "speed v / (length / time)", .least = 0.0},
               .y = {.label = "density of agents / (time / length)", .least = 0.0},
               .curves = {{.label = "measured",
                           .file = "speed_distribution.csv",
                           .x = "speed",
                           .y = "density",
                           .error = "error",
                           .style = PlotStyle::points},
                          {.label = "Maxwell", .file = "speed_distribution.csv", .x = "speed", .y = "maxwell"}},
               .key = PlotKey::top_right});
}

/// A run of a model: its agents at the end, every column of its series against time, and its curves.
void draw_model_run(Artist& artist, std::string const& colour) {
  if (colour == "displacement") {
    throw Error({.what = "final.xyz does not tell how far the agents of a model have come",
                 .hint = "gridlock movie DIR --colour displacement shows it, where the run keeps frames",
                 .key = "--colour"});
  }
  draw_last(artist, colour);
  Table const series = read_csv(artist.path_of("series.csv"));
  for (std::string const& name : series.names()) {
    if (name == "step" || name == "time") continue;
    artist.plot({.name = name,
                 .x = {.label = axis_label("time")},
                 .y = {.label = axis_label(name), .least = 0.0},
                 .curves = {{.file = "series.csv", .x = "time", .y = name}},
                 .key = PlotKey::none});
  }
  Frame const last = last_frame(artist.path_of("final.xyz"));
  FrameColumn const* const radii = last.find(Radius::name);
  draw_curves(artist, radii == nullptr ? std::span<double const>() : std::get<std::vector<double>>(radii->values));
}

/// Whether a run is one of disks that collide; not where its model is that of another program.
bool is_of_disks(SettingsFile const& file) {
  try {
    return read_configuration(file).kind().counts_collisions();
  } catch (Error const&) {
    return false;
  }
}

void draw_run(Artist& artist, std::string const& colour) {
  auto const file = SettingsFile::from_path(artist.path_of("config.resolved.toml"));
  if (!is_of_disks(file)) {
    draw_model_run(artist, colour);
    return;
  }
  Setup const setup = set_up(file, {.threads = 1});
  if (colour.empty() || colour == "displacement") {
    draw_displacements(artist, setup);
  } else {
    draw_last(artist, colour);
  }
  draw_start(artist, setup);
  // The paper's mark of jamming, of its rule between its walls.
  bool const is_as_in_paper =
      disks_of(setup).box.edge() == Edge::wall && !setup.configuration.kind().ends_within_steps(setup.configuration);
  Plot displacement{.name = "displacement",
                    .title = "Mean displacement from the start",
                    .x = {.label = axis_label("time")},
                    .y = {.label = axis_label("mean_displacement"), .least = 0.0},
                    .curves = {{.file = "series.csv", .x = "time", .y = "mean_displacement"}},
                    .key = PlotKey::none};
  if (is_as_in_paper) displacement.references.push_back({.at = 0.1, .label = "10 % of the box"});
  artist.plot(displacement);
  draw_curves(artist, disks_of(setup).agents.column<Radius>());
}

/// An entry of a table as a condition of a plot names it.
std::string entry_of(Table const& table, std::string const& column, std::size_t row) {
  return std::visit(
      [&](auto const& values) {
        if constexpr (std::is_same_v<std::decay_t<decltype(values)>, std::vector<std::string>>) {
          return values[row];
        } else {
          return fmt::format("{}", values[row]);
        }
      },
      table.column(column));
}

/// The swept settings are the columns in front of "runs".
std::vector<std::string> swept_keys(Table const& means) {
  auto const end = std::ranges::find(means.names(), "runs");
  return {means.names().begin(), end};
}

/// The swept number with the most different values; empty where none has two.
std::string axis_of(Table const& means, std::vector<std::string> const& keys) {
  std::string axis;
  std::size_t most = 1;
  for (std::string const& key : keys) {
    std::vector<double> const numbers = means.numbers(key);
    std::size_t const different = std::set<double>(numbers.begin(), numbers.end()).size();
    if (different > most) {
      most = different;
      axis = key;
    }
  }
  return axis;
}

std::vector<PlotCurve> curves_against(std::string const& axis, std::string const& observable, Table const& means,
                                      std::vector<std::string> const& keys) {
  std::vector<PlotCurve> curves;
  std::set<std::string> labels;
  std::vector<double> const values = means.numbers(observable);
  for (std::size_t row = 0; row < means.row_count(); ++row) {
    // Not every run of a sweep has every observable.
    if (!std::isfinite(values[row])) continue;
    PlotCurve curve{.file = "means.csv",
                    .x = axis,
                    .y = observable,
                    .error = observable + "_error",
                    .style = PlotStyle::line_and_points};
    for (std::string const& key : keys) {
      if (key == axis) continue;
      std::string const entry = entry_of(means, key, row);
      curve.where.push_back({.column = key, .equals = entry});
      curve.label += fmt::format("{}{} = {}", curve.label.empty() ? "" : ", ", axis_label(key), entry);
    }
    if (labels.insert(curve.label).second) curves.push_back(std::move(curve));
  }
  return curves;
}

/// What a sweep is drawn for: what the model itself observes, and a few observables that every model can have.
std::vector<std::string> drawn_observables(Table const& means) {
  constexpr std::array headlines{"mean_displacement", "compressibility_factor", "wall_pressure", "collision_rate",
                                 "halted_fraction"};
  std::vector<std::string> drawn;
  for (std::string const& name : means.names()) {
    if (!means.contains(name + "_error")) continue;
    if (is_of_model(name) || std::ranges::find(headlines, name) != headlines.end()) drawn.push_back(name);
  }
  return drawn;
}

/// How many runs stand behind a point.
std::string sweep_title(Table const& means) {
  std::vector<double> const runs = means.numbers("runs");
  auto const [least, most] = std::ranges::minmax(runs);
  if (most == 1.0) return "One run a point";
  return least == most ? fmt::format("Means over {} runs", most) : fmt::format("Means over {} to {} runs", least, most);
}

void draw_sweep(Artist& artist) {
  constexpr std::size_t most_curves = 12;
  Table const means = read_csv(artist.path_of("means.csv"));
  std::vector<std::string> const keys = swept_keys(means);
  std::string const axis = axis_of(means, keys);
  if (axis.empty()) return;
  std::string const title = sweep_title(means);
  for (std::string const& observable : drawn_observables(means)) {
    std::vector<PlotCurve> const curves = curves_against(axis, observable, means, keys);
    if (curves.empty()) continue;
    if (curves.size() > most_curves) {
      artist.note(
          fmt::format("{}: {} curves are too many for one picture; means.csv has them", observable, curves.size()));
      continue;
    }
    artist.plot({.name = observable,
                 .title = title,
                 .x = {.label = axis_label(axis)},
                 .y = {.label = axis_label(observable)},
                 .curves = curves,
                 .key = curves.size() > 1 ? PlotKey::outside : PlotKey::none});
  }
}

}  // namespace

Pictures draw_results(fs::path const& directory, std::string const& colour, bool makes_pdf) {
  Artist artist(directory, makes_pdf);
  if (artist.has("config.resolved.toml") && artist.has("final.xyz")) {
    draw_run(artist, colour);
  } else if (artist.has("config.resolved.toml") && artist.has("summary.json")) {
    throw Error({.what = fmt::format("{} holds a run without its last state", directory.string()),
                 .hint = "pictures need final.xyz: leave run.final_state = false out",
                 .key = "DIR"});
  } else if (artist.has("means.csv")) {
    if (!colour.empty()) {
      throw Error({.what = "a sweep has no agents to colour",
                   .hint = "name the directory of one of its runs, below runs/",
                   .key = "--colour"});
    }
    draw_sweep(artist);
  } else {
    throw Error({.what = fmt::format("{} holds neither a run nor a sweep", directory.string()),
                 .hint = "name a directory that gridlock run or gridlock sweep has written",
                 .key = "DIR"});
  }
  return artist.take();
}

}  // namespace gridlock
