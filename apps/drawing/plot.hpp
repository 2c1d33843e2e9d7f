#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace gridlock {

/// One axis of a plot. Text is plain text: nothing in it is markup.
struct PlotAxis {
  std::string label;
  bool is_logarithmic = false;
  std::optional<double> least;  ///< left out: what the data need
  std::optional<double> most;   ///< left out: what the data need
};

/// How the points of a curve are shown.
enum class PlotStyle {
  line,             ///< the error, where there is one, is a shaded band
  points,           ///< the error is a bar
  line_and_points,  ///< the error is a bar
  steps,            ///< a histogram: each x is the middle of its bin; the error is a bar
};

/// Keeps the rows of a table that hold a given entry in a column; one that reads as a number is compared as a number.
struct PlotCondition {
  std::string column;
  std::string equals;
};

/// One column of a table against another. Rows with an empty entry or nan are skipped, and lines go on across them.
struct PlotCurve {
  std::string label;  ///< in the key; empty: not in it
  std::string file;   ///< CSV whose first line names the columns; relative to the directory of the plot
  std::string x;      ///< name of the column
  std::string y;
  std::string error;                 ///< column with the standard error of y; empty: none
  std::vector<PlotCondition> where;  ///< the rows that belong to the curve: those that fulfil all; empty: all rows
  PlotStyle style = PlotStyle::line;
  bool is_dashed = false;
  bool is_open = false;  ///< points are drawn as outlines
  double point_size = 0.9;
  std::optional<std::size_t> shape;   ///< of the points; left out: the one that goes with the colour
  std::optional<std::size_t> colour;  ///< place in the order of colours; left out: the place of the curve in the plot
  double x_factor = 1.0;              ///< what is drawn is x_factor · x
  double y_factor = 1.0;              ///< and y_factor · y
};

/// A formula of x in gnuplot's language, such as "2*x**0.5"; never text of the user.
struct PlotFormula {
  std::string label;
  std::string formula;
  bool is_dashed = true;
  std::optional<std::size_t> colour;  ///< left out: grey
};

/// A straight thin line across the plot, such as a threshold, with a label along it.
struct PlotReference {
  double at = 0.0;  ///< the y it runs at, or the x where it is vertical
  std::string label;
  bool is_vertical = false;
  double label_place = 1.0;  ///< where along the line the label ends up: 0 at its beginning, 1 at its end
};

/// A text to the right of a point, in the colour of a curve.
struct PlotLabel {
  std::string text;
  double x = 0.0;
  double y = 0.0;
  std::size_t colour = 0;
};

/// A PNG laid into the plot: position and width in fractions of the area between the axes, height as its shape demands.
struct PlotInset {
  std::string file;  ///< relative to the directory of the plot
  double x = 0.0;    ///< of the lower left corner
  double y = 0.0;
  double width = 0.3;
  std::string label;  ///< above it
};

/// `outside` is to the right of the plot, `below` under it.
enum class PlotKey { none, top_left, top_right, bottom_left, bottom_right, outside, below };

/// The order of colours: `categorical` has seven that people with colour blindness tell apart, for curves that differ
/// in kind; `sequential` runs from dark blue to yellow, over all colours in use, for curves that differ in one number.
enum class PlotColours { categorical, sequential };

/// A plot of tables that lie beside it.
struct Plot {
  std::string name;  ///< of the files: name.gp, name.svg, name.png
  std::string title;
  PlotAxis x;
  PlotAxis y;
  std::vector<PlotCurve> curves;
  std::vector<PlotFormula> formulas;
  std::vector<PlotReference> references;
  std::vector<PlotLabel> labels;
  std::vector<PlotInset> insets;
  PlotKey key = PlotKey::top_left;
  std::string key_title;
  PlotColours colours = PlotColours::categorical;
  std::uint32_t width = 800;  ///< of the SVG, in pixels; the PNG is twice as fine
  std::uint32_t height = 600;
  bool makes_pdf = false;  ///< name.pdf too, an inch for 100 pixels
};

/// How gnuplot is called.
struct GnuplotSettings {
  std::string program = "gnuplot";
  std::chrono::milliseconds time_limit{60'000};  ///< for all plots of one call; then gnuplot is ended
};

enum class PlotOutcome { drawn, gnuplot_is_missing };

/// Whether `program --version` runs. Cost: one process.
bool is_gnuplot_available(GnuplotSettings const& settings = {});

/// Writes directory/name.gp and lets gnuplot make name.svg and name.png beside it.
///
/// The script names all files relative to itself, so that the directory can be moved and `gnuplot name.gp` draws the
/// plot again after an edit. Where gnuplot is not installed the script is written all the same.
/// Errors: RunFailure with gnuplot's own words, for a missing table or column, for a plot none of whose curves has a
/// point, or when the time limit has passed. Contract: plot.name is a file name without separators.
PlotOutcome draw_plot(Plot const& plot, std::filesystem::path const& directory, GnuplotSettings const& settings = {});

/// draw_plot() for several plots with one call of gnuplot; one that fails does not keep the others from being drawn.
PlotOutcome draw_plots(std::span<Plot const> plots, std::filesystem::path const& directory,
                       GnuplotSettings const& settings = {});

/// Lets gnuplot draw again every script of the directory (*.gp), as the user may have edited them.
/// Errors: as draw_plots(); Error for a directory without scripts.
PlotOutcome redraw_plots(std::filesystem::path const& directory, GnuplotSettings const& settings = {});

/// The width in pixels a PNG should have to fill an inset of the plot dot for dot.
std::uint32_t inset_pixels(Plot const& plot, double inset_width);

}  // namespace gridlock
