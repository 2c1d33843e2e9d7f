#include "drawing/plot.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <iterator>
#include <string_view>
#include <system_error>

#include "drawing/colour.hpp"
#include "drawing/process.hpp"
#include "gridlock/core/error.hpp"
#include "io/file.hpp"
#include "io/markup.hpp"

namespace gridlock {

namespace {

constexpr std::string_view text_colour = "#222222";
constexpr std::string_view faint = "#dddddd";
constexpr std::string_view grey = "#666666";
constexpr int png_magnification = 2;
constexpr double line_width = 2.0;

/// The edges of the area between the axes, in fractions of the picture; fixed only where an inset depends on them.
struct Margins {
  double left = 0.12;
  double right = 0.97;
  double bottom = 0.13;
  double top = 0.92;
};

/// Lines a key below the plot takes.
int rows_below(Plot const& plot) {
  auto const has_label = [](auto const& one) { return !one.label.empty(); };
  auto const entries = std::ranges::count_if(plot.curves, has_label) + std::ranges::count_if(plot.formulas, has_label);
  return static_cast<int>(entries);
}

Margins margins_of(Plot const& plot) {
  constexpr double line_height = 21.0;  // pixels
  Margins margins{.right = plot.key == PlotKey::outside ? 0.76 : 0.97, .top = plot.title.empty() ? 0.97 : 0.92};
  if (plot.key == PlotKey::below) margins.bottom += rows_below(plot) * line_height / plot.height;
  return margins;
}

/// A text as a gnuplot expression. Single quotes, because inside double ones gnuplot runs what is in backquotes.
/// Line breaks and single quotes are joined on: such a string cannot hold the first, and gnuplot 5.4 misreads several
/// of the second in a row, even doubled as its manual says.
std::string text_literal(std::string_view text) {
  std::string expression = "'";
  while (true) {
    std::size_t const end = text.find_first_of("\n'");
    expression += one_line(text.substr(0, end));
    if (end == std::string_view::npos) return expression + "'";
    expression += text[end] == '\n' ? "'.\"\\n\".'" : "'.\"'\".'";
    text.remove_prefix(end + 1);
  }
}

/// A file name as a gnuplot expression; the path keeps names such as "<command" and "-" from meaning something else.
std::string file_literal(std::string const& file) {
  return text_literal(std::filesystem::path(file).is_absolute() ? file : "./" + file);
}

bool is_number(std::string const& text) {
  double value = 0.0;
  auto const [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && end == text.data() + text.size() && std::isfinite(value);
}

std::string column(std::string const& name) { return fmt::format("column({})", text_literal(name)); }

std::string condition(PlotCondition const& where) {
  return is_number(where.equals)
             ? fmt::format("{} == {}", column(where.column), where.equals)
             : fmt::format("stringcolumn({}) eq ({})", text_literal(where.column), text_literal(where.equals));
}

std::string scaled(double factor, std::string const& name) {
  return factor == 1.0 ? column(name) : fmt::format("{}*{}", factor, column(name));
}

/// The x of a curve, undefined in the rows that are not its own.
std::string x_expression(PlotCurve const& curve) {
  std::string const x = scaled(curve.x_factor, curve.x);
  if (curve.where.empty()) return fmt::format("({})", x);
  std::string conditions;
  for (PlotCondition const& where : curve.where) {
    conditions += fmt::format("{}{}", conditions.empty() ? "" : " && ", condition(where));
  }
  return fmt::format("({} ? {} : NaN)", conditions, x);
}

std::string title_clause(std::string const& label) {
  return label.empty() ? "notitle" : fmt::format("title {} noenhanced", text_literal(label));
}

Colour colour_of(Plot const& plot, std::size_t place) {
  if (plot.colours == PlotColours::categorical) {
    constexpr std::size_t fit_for_lines = 7;  // yellow does not show on white
    return categorical_colours()[place % fit_for_lines];
  }
  std::size_t last = 1;
  for (std::size_t i = 0; i < plot.curves.size(); ++i) last = std::max(last, plot.curves[i].colour.value_or(i));
  constexpr double brightest = 0.9;  // beyond it a line does not show on white
  return viridis(brightest * static_cast<double>(place) / static_cast<double>(last));
}

/// Point shapes differ as colours do, so that a plot survives a black-and-white printer.
int point_type(std::size_t place, bool is_open) {
  static constexpr std::array filled{7, 5, 9, 13, 11, 15};
  return filled[place % filled.size()] - (is_open ? 1 : 0);  // gnuplot counts the outline of a shape before the shape
}

/// The entries of one curve in the plot command: its error below, then the curve itself.
void append_curve(std::vector<std::string>& entries, Plot const& plot, std::size_t index) {
  PlotCurve const& curve = plot.curves[index];
  std::size_t const place = curve.colour.value_or(index);
  std::string const colour = to_hex(colour_of(plot, place));
  std::string const x = x_expression(curve);
  std::string const y = scaled(curve.y_factor, curve.y);
  std::string const file = file_literal(curve.file);
  if (!curve.error.empty() && curve.style == PlotStyle::line) {
    std::string const error = scaled(curve.y_factor, curve.error);
    entries.push_back(
        fmt::format("{0} using {1}:({2} - {3}):({2} + {3}) with filledcurves linecolor rgb '{4}' "
                    "fillstyle transparent solid 0.2 noborder notitle",
                    file, x, y, error, colour));
  } else if (!curve.error.empty()) {
    entries.push_back(
        fmt::format("{} using {}:({}):({}) with yerrorbars linecolor rgb '{}' linewidth 1.3 pointtype -1 "
                    "notitle",
                    file, x, y, scaled(curve.y_factor, curve.error), colour));
  }
  static constexpr std::array<std::string_view, 4> words{"lines", "points", "linespoints", "histeps"};
  std::string entry = fmt::format("{} using {}:({}) with {} linecolor rgb '{}'", file, x, y,
                                  words[static_cast<std::size_t>(curve.style)], colour);
  if (curve.style != PlotStyle::points) {
    entry += fmt::format(" linewidth {}{}", line_width, curve.is_dashed ? " dashtype 2" : "");
  }
  if (curve.style == PlotStyle::points || curve.style == PlotStyle::line_and_points) {
    entry += fmt::format(" pointtype {} pointsize {}", point_type(curve.shape.value_or(place), curve.is_open),
                         curve.point_size);
    if (curve.is_open && curve.style == PlotStyle::points) entry += " linewidth 1.6";
  }
  entries.push_back(entry + " " + title_clause(curve.label));
}

void append_formula(std::vector<std::string>& entries, Plot const& plot, PlotFormula const& formula) {
  entries.push_back(fmt::format("{} with lines linecolor rgb '{}' linewidth {}{} {}", formula.formula,
                                formula.colour ? to_hex(colour_of(plot, *formula.colour)) : std::string(grey),
                                line_width, formula.is_dashed ? " dashtype 2" : "", title_clause(formula.label)));
}

std::string block_name(std::size_t index) { return fmt::format("$reference_{}", index + 1); }

/// References are drawn as curves, not as arrows, so that the axes make room for them.
void append_reference(std::vector<std::string>& entries, PlotReference const& reference, std::size_t index) {
  entries.push_back(
      reference.is_vertical
          ? fmt::format("{} using 1:2 axes x1y2 with lines linecolor rgb '{}' linewidth 1.3 dashtype 3 "
                        "notitle",
                        block_name(index), grey)
          : fmt::format("{} with lines linecolor rgb '{}' linewidth 1.3 dashtype 3 notitle", reference.at, grey));
}

struct PixelSize {
  std::uint32_t width = 1;
  std::uint32_t height = 1;
};

/// The size a PNG states in its first chunk (PNG specification, 3rd edition, section 11.2.1).
PixelSize png_size(std::filesystem::path const& file) {
  std::string const bytes = read_file(file);
  constexpr std::string_view signature = "\x89PNG\r\n\x1A\n";
  auto const number_at = [&](std::size_t place) {
    std::uint32_t number = 0;
    for (std::size_t i = place; i < place + 4; ++i) number = (number << 8) | static_cast<unsigned char>(bytes[i]);
    return number;
  };
  if (bytes.size() < 24 || std::string_view(bytes).substr(0, signature.size()) != signature || number_at(16) == 0 ||
      number_at(20) == 0) {
    throw RunFailure(fmt::format("{} cannot be put into a plot: it is not a PNG file", file.string()));
  }
  return {number_at(16), number_at(20)};
}

/// Where an inset lies, in fractions of the area between the axes.
struct Place {
  double x, y, width, height;
};

Place place_of(Plot const& plot, PlotInset const& inset, PixelSize size) {
  Margins const margins = margins_of(plot);
  double const shape = (margins.right - margins.left) * plot.width / ((margins.top - margins.bottom) * plot.height);
  return {inset.x, inset.y, inset.width, inset.width * shape * size.height / size.width};
}

void append_inset_label(std::string& script, PlotInset const& inset, Place const& at) {
  if (inset.label.empty()) return;
  fmt::format_to(std::back_inserter(script),
                 "set label {} at graph {:.6g}, graph {:.6g} center offset 0,0.5 front noenhanced font ',13'\n",
                 text_literal(inset.label), at.x + 0.5 * at.width, at.y + at.height);
}

/// The second axes of a plot with insets run from 0 to 1, which makes them fractions of the plot.
std::string inset_entry(PlotInset const& inset, Place const& at, PixelSize size) {
  return fmt::format(
      "{} binary filetype=png center=({:.6g},{:.6g}) dx={:.8g} dy={:.8g} axes x2y2 with rgbimage notitle",
      file_literal(inset.file), at.x + 0.5 * at.width, at.y + 0.5 * at.height, at.width / size.width,
      at.height / size.height);
}

std::string range(PlotAxis const& axis) {
  auto const end = [](std::optional<double> value) { return value ? fmt::format("{}", *value) : std::string("*"); };
  return fmt::format("[{}:{}]", end(axis.least), end(axis.most));
}

void append_axis(std::string& script, char name, PlotAxis const& axis) {
  auto out = std::back_inserter(script);
  fmt::format_to(out, "set {}label {} noenhanced\n", name, text_literal(axis.label));
  fmt::format_to(out, "set {}range {}\n", name, range(axis));
  if (axis.is_logarithmic) {
    fmt::format_to(out, "set logscale {0} 10\nset format {0} '10^{{%L}}'\nset m{0}tics 10\n", name);
  }
}

void append_key(std::string& script, Plot const& plot) {
  if (plot.key == PlotKey::none) {
    script += "unset key\n";
    return;
  }
  static constexpr std::array<std::string_view, 7> places{"",
                                                          "top left",
                                                          "top right",
                                                          "bottom left",
                                                          "bottom right",
                                                          "outside right top",
                                                          "at screen 0.5, screen 0.015 center bottom"};
  bool const is_inside = plot.key != PlotKey::outside && plot.key != PlotKey::below;
  fmt::format_to(std::back_inserter(script), "set key {} Left reverse samplen 2.5 spacing 1.2 font ',13'{}\n",
                 places[static_cast<std::size_t>(plot.key)], is_inside ? " opaque" : "");
  if (!plot.key_title.empty()) {
    fmt::format_to(std::back_inserter(script), "set key title {} noenhanced\n", text_literal(plot.key_title));
  }
}

void append_label(std::string& script, Plot const& plot, PlotLabel const& label) {
  fmt::format_to(std::back_inserter(script),
                 "set label {} at first {}, first {} left front noenhanced font ',13' textcolor rgb '{}'\n",
                 text_literal(label.text), label.x, label.y, to_hex(colour_of(plot, label.colour)));
}

void append_reference_label(std::string& script, PlotReference const& reference, std::size_t index) {
  auto out = std::back_inserter(script);
  if (reference.is_vertical) {
    fmt::format_to(out, "{0} << end\nx,y\n{1},0\n{1},1\nend\n", block_name(index), reference.at);
  }
  if (reference.label.empty()) return;
  double const place = 0.015 + 0.97 * reference.label_place;
  std::string_view const side = place < 0.34 ? "left" : place < 0.67 ? "center" : "right";
  std::string const label = text_literal(reference.label);
  if (reference.is_vertical) {
    fmt::format_to(out, "set label {} at first {}, graph {:.6g} {} rotate by 90 offset -0.7,0 ", label, reference.at,
                   place, side);
  } else {
    fmt::format_to(out, "set label {} at graph {:.6g}, first {} {} offset 0,0.55 ", label, place, reference.at, side);
  }
  fmt::format_to(out, "noenhanced font ',12' textcolor rgb '{}'\n", grey);
}

/// Points at the ends of the data stay clear of the frame; ends that are set, and logarithmic axes, are left as they are.
void append_offsets(std::string& script, Plot const& plot) {
  bool const has_points = std::ranges::any_of(plot.curves, [](PlotCurve const& curve) {
    return curve.style == PlotStyle::points || curve.style == PlotStyle::line_and_points;
  });
  if (!has_points) return;
  auto const offset = [](PlotAxis const& axis, std::optional<double> const& end) {
    return end || axis.is_logarithmic ? "0" : "graph 0.03";
  };
  fmt::format_to(std::back_inserter(script), "set offsets {}, {}, {}, {}\n", offset(plot.x, plot.x.least),
                 offset(plot.x, plot.x.most), offset(plot.y, plot.y.most), offset(plot.y, plot.y.least));
}

void append_preamble(std::string& script, Plot const& plot) {
  auto out = std::back_inserter(script);
  fmt::format_to(out,
                 "# Draws {0}.svg and {0}.png from the tables named below. After an edit, in this directory:\n"
                 "#   gnuplot {0}.gp\n"
                 "reset\n"
                 "set encoding utf8\n"
                 "set datafile separator ','\n"
                 "set datafile columnheaders\n"
                 "set datafile missing NaN\n\n",
                 one_line(plot.name));
  if (plot.title.empty()) {
    script += "unset title\n";
  } else {
    fmt::format_to(out, "set title {} noenhanced font ',17' offset 0,-0.3\n", text_literal(plot.title));
  }
  append_axis(script, 'x', plot.x);
  append_axis(script, 'y', plot.y);
  append_key(script, plot);
  fmt::format_to(out,
                 "set border linewidth 1 linecolor rgb '{}'\n"
                 "set grid back linetype 1 linecolor rgb '{}' linewidth 0.8\n"
                 "set tics front scale 0.7\n"
                 "set pointintervalbox 1e-6  # no white spots below points; 0 would mean 1\n"
                 "set samples 500\n",
                 text_colour, faint);
  append_offsets(script, plot);
}

/// The text of name.gp.
std::string script_of(Plot const& plot, std::filesystem::path const& directory) {
  std::string script;
  append_preamble(script, plot);
  auto out = std::back_inserter(script);
  std::vector<std::string> entries;
  bool const uses_fractions = !plot.insets.empty() || std::ranges::any_of(plot.references, &PlotReference::is_vertical);
  if (uses_fractions) script += "set x2range [0:1]\nset y2range [0:1]\n";
  if (!plot.insets.empty() || plot.key == PlotKey::below) {
    Margins const m = margins_of(plot);
    fmt::format_to(out, "set margins at screen {}, screen {}, screen {}, screen {}\n", m.left, m.right, m.bottom,
                   m.top);
  }
  for (std::size_t i = 0; i < plot.references.size(); ++i) {
    append_reference_label(script, plot.references[i], i);
    append_reference(entries, plot.references[i], i);
  }
  for (PlotLabel const& label : plot.labels) append_label(script, plot, label);
  for (PlotFormula const& formula : plot.formulas) append_formula(entries, plot, formula);
  for (std::size_t i = 0; i < plot.curves.size(); ++i) append_curve(entries, plot, i);
  for (PlotInset const& inset : plot.insets) {
    PixelSize const size = png_size(directory / inset.file);
    Place const at = place_of(plot, inset, size);
    append_inset_label(script, inset, at);
    entries.push_back(inset_entry(inset, at, size));
  }
  fmt::format_to(out,
                 "\nset terminal svg size {},{} enhanced font 'Helvetica,15' background '#ffffff'\n"
                 "set output {}\n"
                 "plot \\\n  {}\n",
                 plot.width, plot.height, file_literal(plot.name + ".svg"), fmt::join(entries, ", \\\n  "));
  fmt::format_to(out,
                 "\nset terminal pngcairo size {1},{2} enhanced font 'Helvetica,15' fontscale {0} linewidth {0} "
                 "pointscale {0} background '#ffffff'\n"
                 "set output {3}\nreplot\nset output\n",
                 png_magnification, png_magnification * plot.width, png_magnification * plot.height,
                 file_literal(plot.name + ".png"));
  if (plot.makes_pdf) {
    fmt::format_to(out,
                   "\nset terminal pdfcairo size {}in,{}in enhanced font 'Helvetica,11' fontscale 0.72 linewidth 0.75 "
                   "pointscale 0.6\nset output {}\nreplot\nset output\n",
                   0.01 * plot.width, 0.01 * plot.height, file_literal(plot.name + ".pdf"));
  }
  return script;
}

std::filesystem::path script_file(std::string const& name) { return "./" + name + ".gp"; }

void remove_pictures(std::filesystem::path const& script) {
  for (char const* const extension : {".svg", ".png", ".pdf"}) {
    std::error_code ignored;  // nothing there is as good as removed
    std::filesystem::remove(std::filesystem::path(script).replace_extension(extension), ignored);
  }
}

/// What went wrong, in gnuplot's words; empty for nothing. A missing table or column is only a warning to gnuplot
/// while another curve can be drawn, but the plot is not the one that was asked for.
std::string complaint(ProcessResult const& result, GnuplotSettings const& settings) {
  if (result.timed_out) {
    return fmt::format("{} did not finish within {} s", settings.program,
                       std::chrono::duration<double>(settings.time_limit).count());
  }
  bool const misses_data = result.errors.find("Cannot find or open file") != std::string::npos ||
                           result.errors.find("no column with header") != std::string::npos;
  if (result.succeeded && !misses_data) return {};
  std::size_t const begin = result.errors.find_first_not_of(" \n\r\t");
  if (begin == std::string::npos) return fmt::format("{} failed without a word", settings.program);
  return result.errors.substr(begin, result.errors.find_last_not_of(" \n\r\t") + 1 - begin);
}

ProcessResult run_gnuplot(std::span<std::filesystem::path const> scripts, std::filesystem::path const& directory,
                          GnuplotSettings const& settings) {
  // -d: the settings of the user's own ~/.gnuplot are not for these plots.
  std::vector<std::string> arguments{settings.program, "-d"};
  for (std::filesystem::path const& script : scripts) arguments.push_back(script.string());
  return run_process(arguments, directory, settings.time_limit);
}

/// One call for all scripts; where that fails, one call each, so that the good ones are drawn.
PlotOutcome run_scripts(std::span<std::filesystem::path const> scripts, std::filesystem::path const& directory,
                        GnuplotSettings const& settings) {
  if (scripts.empty()) return PlotOutcome::drawn;
  ProcessResult const all = run_gnuplot(scripts, directory, settings);
  if (!all.was_found) return PlotOutcome::gnuplot_is_missing;
  if (complaint(all, settings).empty()) return PlotOutcome::drawn;
  std::string complaints;
  for (std::filesystem::path const& script : scripts) {
    bool const is_known = scripts.size() == 1 || all.timed_out;
    std::string const words = complaint(is_known ? all : run_gnuplot({&script, 1}, directory, settings), settings);
    if (words.empty()) continue;
    remove_pictures(directory / script);
    complaints += fmt::format("\n{}: {}", script.filename().string(), words);
    if (all.timed_out) break;
  }
  if (complaints.empty()) return PlotOutcome::drawn;
  throw RunFailure(fmt::format("not every plot in {} could be drawn{}", directory.string(), complaints));
}

}  // namespace

bool is_gnuplot_available(GnuplotSettings const& settings) {
  ProcessResult const result =
      run_process({settings.program, "--version"}, std::filesystem::current_path(), settings.time_limit);
  return result.was_found && result.succeeded;
}

PlotOutcome draw_plot(Plot const& plot, std::filesystem::path const& directory, GnuplotSettings const& settings) {
  return draw_plots({&plot, 1}, directory, settings);
}

PlotOutcome draw_plots(std::span<Plot const> plots, std::filesystem::path const& directory,
                       GnuplotSettings const& settings) {
  std::vector<std::filesystem::path> scripts;
  for (Plot const& plot : plots) {
    scripts.push_back(script_file(plot.name));
    remove_pictures(directory / scripts.back());  // those of older data
    write_file(directory / scripts.back(), script_of(plot, directory));
  }
  return run_scripts(scripts, directory, settings);
}

PlotOutcome redraw_plots(std::filesystem::path const& directory, GnuplotSettings const& settings) {
  std::error_code error;
  std::vector<std::filesystem::path> scripts;
  for (auto const& entry : std::filesystem::directory_iterator(directory, error)) {
    if (entry.path().extension() == ".gp") scripts.push_back("." / entry.path().filename());
  }
  if (scripts.empty()) {
    throw Error({.what = fmt::format("{} holds no plot to draw again", directory.string()),
                 .hint = "name a directory with scripts of gnuplot (*.gp), as a run leaves it"});
  }
  std::ranges::sort(scripts);
  return run_scripts(scripts, directory, settings);
}

std::uint32_t inset_pixels(Plot const& plot, double inset_width) {
  Margins const margins = margins_of(plot);
  return static_cast<std::uint32_t>(
      std::lround(png_magnification * plot.width * (margins.right - margins.left) * inset_width));
}

}  // namespace gridlock
