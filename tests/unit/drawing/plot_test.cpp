#include "drawing/plot.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <string>
#include <thread>
#include <vector>

#include "drawing/colour.hpp"
#include "drawing/picture.hpp"
#include "gridlock/core/error.hpp"
#include "io/file.hpp"
#include "unit/drawing/number_in_png.hpp"
#include "unit/io/markup_document.hpp"
#include "unit/io/temporary_directory.hpp"

namespace gridlock {
namespace {

namespace fs = std::filesystem;

void write_series(TemporaryDirectory const& directory) {
  write_file(directory / "series.csv",
             "time,mean displacement,error,lattice,seed\n"
             "0,0.1,0.01,\"square\",1\n"
             "1,nan,0.01,\"square\",1\n"
             "2,0.4,,\"triangular\",2\n"
             "3,,0.01,\"square\",2\n"
             "4,0.9,0.02,\"triangular\",1\n"
             "5,1.1,0.01,\"square\",1\n");
}

PlotCurve displacement_curve() {
  return {.label = "displacement", .file = "series.csv", .x = "time", .y = "mean displacement"};
}

/// Small, since it is the pixels of the PNG that take the time.
Plot simple_plot(std::string const& name = "plot") {
  return {.name = name, .curves = {displacement_curve()}, .width = 240, .height = 180};
}

std::string failure_of(auto const& action) {
  try {
    action();
  } catch (RunFailure const& failure) {
    return failure.what();
  }
  return "";
}

MarkupDocument drawn(Plot const& plot, TemporaryDirectory const& directory) {
  EXPECT_EQ(draw_plot(plot, directory.path()), PlotOutcome::drawn);
  MarkupDocument document(read_file(directory / (plot.name + ".svg")));
  EXPECT_EQ(document.problem, "");
  return document;
}

/// All text of a plot as a reader sees it, one piece per line.
std::string words_of(MarkupDocument const& document) {
  std::string words;
  for (char const* const name : {"tspan", "text"}) {
    for (auto const& element : document.named(name)) words += element.text + "\n";
  }
  return words;
}

/// How many point symbols of one shape can be seen in a plot.
std::size_t symbols(MarkupDocument const& document, std::string const& shape) {
  std::size_t count = 0;
  for (auto const& use : document.named("use")) {
    count += use.attributes.at("xlink:href") == shape && use.attributes.contains("transform") &&
             use.attributes.at("transform").find("scale(0.00)") == std::string::npos;
  }
  return count;
}

/// A program that does what `script` says, in place of gnuplot.
GnuplotSettings stand_in(TemporaryDirectory const& directory, std::string const& script) {
  fs::path const program = directory / "stand-in";
  write_file(program, "#!/bin/sh\n" + script);
  fs::permissions(program, fs::perms::owner_all);
  return {.program = program.string(), .time_limit = std::chrono::seconds(20)};
}

TEST(Plot, LeavesAScriptAndTwoPicturesOfTheSizeAskedFor) {
  TemporaryDirectory const directory;
  write_series(directory);
  Plot plot = simple_plot();
  plot.width = 500;
  plot.height = 400;
  MarkupDocument const document = drawn(plot, directory);
  EXPECT_EQ(document.elements.at(0).attributes.at("viewBox"), "0 0 500 400");
  std::string const png = read_file(directory / "plot.png");
  EXPECT_EQ(number_at(png, 16), 1000U);
  EXPECT_EQ(number_at(png, 20), 800U);
  EXPECT_TRUE(fs::exists(directory / "plot.gp"));
}

TEST(Plot, IsAPdfTooWhereThatIsAskedFor) {
  TemporaryDirectory const directory;
  write_series(directory);
  Plot plot = simple_plot();
  drawn(plot, directory);
  EXPECT_FALSE(fs::exists(directory / "plot.pdf"));
  plot.makes_pdf = true;
  drawn(plot, directory);
  EXPECT_TRUE(read_file(directory / "plot.pdf").starts_with("%PDF-"));
}

TEST(Plot, LabelsPointsInTheColourOfTheirCurveAndUsesTheWholeMapForThem) {
  TemporaryDirectory const directory;
  write_series(directory);
  Plot plot = simple_plot();
  plot.key = PlotKey::none;
  plot.colours = PlotColours::sequential;
  // Two engines, two densities: four curves of two colours.
  plot.curves.assign(4, displacement_curve());
  for (std::size_t k = 0; k < 4; ++k) plot.curves[k].colour = k % 2;
  plot.labels = {{.text = "end", .x = 1.0, .y = 0.5, .colour = 1}};
  MarkupDocument const document = drawn(plot, directory);
  EXPECT_NE(words_of(document).find("end\n"), std::string::npos);
  std::string const script = read_file(directory / "plot.gp");
  EXPECT_NE(script.find("set label 'end' at first 1, first 0.5 left front noenhanced font ',13' textcolor rgb '" +
                        to_hex(viridis(0.9)) + "'"),
            std::string::npos)
      << script;
}

TEST(Plot, KeepsAnyTextAsItStands) {
  TemporaryDirectory const directory;
  write_series(directory);
  std::string const text = "a_b^c {d} \"e\" 'f' ''g'' \\n \\t \\ @h %i `touch hacked` $(touch hacked) <i>&j φ ψ₆ ~k";
  std::string const shown =
      "a_b^c {d} \"e\" 'f' ''g'' \\n \\t \\ @h %i `touch hacked` $(touch hacked) &lt;i>&amp;j φ ψ₆ ~k";
  Plot plot = simple_plot();
  plot.width = 800;  // a key that does not fit is left out
  plot.height = 600;
  plot.title = text;
  plot.x.label = "x" + text;
  plot.y.label = "y" + text;
  plot.key_title = "k" + text;
  plot.curves.at(0).label = "c" + text;
  plot.formulas = {{.label = "f" + text, .formula = "x/10"}};
  plot.references = {{.at = 0.3, .label = "r" + text}, {.at = 2.0, .label = "v" + text, .is_vertical = true}};
  std::string const words = "\n" + words_of(drawn(plot, directory));
  for (std::string const start : {"", "x", "y", "k", "c", "f", "r", "v"}) {
    EXPECT_NE(words.find("\n" + start + shown + "\n"), std::string::npos) << start << " not in" << words;
  }
  EXPECT_FALSE(fs::exists(directory / "hacked"));
}

TEST(Plot, SurvivesLineBreaksAndBrokenBytesInText) {
  TemporaryDirectory const directory;
  write_series(directory);
  Plot plot = simple_plot();
  plot.title = "first'\n'second\n\nthird\x01\xFF";
  std::string const words = words_of(drawn(plot, directory));
  for (char const* const line : {"first'\n", "'second\n", "third \xEF\xBF\xBD\n"}) {
    EXPECT_NE(words.find(line), std::string::npos) << line;
  }
}

TEST(Plot, DrawsOnlyTheRowsThatHoldNumbersAndFulfilAllConditions) {
  TemporaryDirectory const directory;
  write_series(directory);
  auto const points = [&](std::vector<PlotCondition> where) {
    Plot plot = simple_plot();
    plot.key = PlotKey::none;
    plot.curves.at(0).style = PlotStyle::points;
    plot.curves.at(0).where = std::move(where);
    return symbols(drawn(plot, directory), "#gpPt6");
  };
  EXPECT_EQ(points({}), 4U);
  EXPECT_EQ(points({{"lattice", "square"}}), 2U);
  EXPECT_EQ(points({{"lattice", "triangular"}}), 2U);
  EXPECT_EQ(points({{"seed", "1.0"}}), 3U);  // a number, however it is written
  EXPECT_EQ(points({{"lattice", "triangular"}, {"seed", "2"}}), 1U);
}

TEST(Plot, CarriesALineAcrossRowsWithoutNumbersAndRowsOfOthers) {
  TemporaryDirectory const directory;
  write_series(directory);
  // A line that breaks off starts again with another "move to" of its path.
  auto const strokes = [&](std::vector<PlotCondition> where) {
    Plot plot = simple_plot();
    plot.key = PlotKey::none;
    plot.curves.at(0).where = std::move(where);
    std::ptrdiff_t blue = 0;
    for (auto const& path : drawn(plot, directory).named("path")) {
      auto const stroke = path.attributes.find("stroke");
      if (stroke == path.attributes.end() || stroke->second != "rgb(  0, 114, 178)") continue;
      blue += std::ranges::count(path.attributes.at("d"), 'M');
    }
    return blue;
  };
  EXPECT_EQ(strokes({}), 1);
  EXPECT_EQ(strokes({{"lattice", "square"}}), 1);
}

TEST(Plot, ShowsAPointWhoseErrorIsMissing) {
  TemporaryDirectory const directory;
  write_series(directory);
  Plot plot = simple_plot();
  plot.key = PlotKey::none;
  plot.curves.at(0).error = "error";
  plot.curves.at(0).style = PlotStyle::points;
  EXPECT_EQ(symbols(drawn(plot, directory), "#gpPt6"), 4U);
}

TEST(Plot, DrawsEveryStyleKeyColourOrderAndAxis) {
  TemporaryDirectory const directory;
  write_series(directory);
  int count = 0;
  std::vector<Plot> plots;
  for (PlotStyle const style : {PlotStyle::line, PlotStyle::points, PlotStyle::line_and_points, PlotStyle::steps}) {
    for (char const* const error : {"", "error"}) {
      PlotCurve curve = displacement_curve();
      curve.style = style;
      curve.error = error;
      curve.is_dashed = true;
      curve.x_factor = 0.5;
      curve.y_factor = 1e-3;
      Plot plot = simple_plot("plot" + std::to_string(++count));
      plot.curves = {curve, curve};
      plot.key = static_cast<PlotKey>(count % 7);
      plot.colours = static_cast<PlotColours>(count % 2);
      plot.x = {.label = "x", .is_logarithmic = count % 2 == 0, .least = 0.1, .most = {}};
      plot.y = {.label = "y", .is_logarithmic = count % 3 == 0, .least = {}, .most = 1.0};
      plots.push_back(plot);
    }
  }
  EXPECT_EQ(draw_plots(plots, directory.path()), PlotOutcome::drawn);
}

TEST(Plot, MakesRoomForItsReferenceLines) {
  TemporaryDirectory const directory;
  write_series(directory);
  Plot plot = simple_plot();
  plot.width = 800;  // wide enough for the ticks looked for
  plot.height = 600;
  plot.references = {{.at = 3.0, .label = "high"}, {.at = 11.0, .label = "late", .is_vertical = true}};
  std::string const words = "\n" + words_of(drawn(plot, directory));
  EXPECT_NE(words.find("\n 3\n"), std::string::npos) << words;   // the y axis goes up to 3, the data to 1.1
  EXPECT_NE(words.find("\n 12\n"), std::string::npos) << words;  // the x axis beyond 11, the data to 5
}

TEST(Plot, LaysAPngIntoThePictureWithItsShapeKept) {
  TemporaryDirectory const directory;
  write_series(directory);
  State state;
  state.box = Box(2, 1, Edge::wall);
  state.agents.add(1, 0.5, 0, 0, 0.4, 1, 0, 0);
  Plot plot = simple_plot();
  plot.insets = {{.file = "start.png", .x = 0.5, .y = 0.1, .width = 0.4, .label = "start"}};
  draw_disks(state, {.width = inset_pixels(plot, 0.4)}, directory / "start.png");
  MarkupDocument const document = drawn(plot, directory);
  std::string const png = read_file(directory / "start.png");
  auto const images = document.named("image");
  ASSERT_EQ(images.size(), 1U);
  double const width = std::stod(images[0].attributes.at("width"));
  double const height = std::stod(images[0].attributes.at("height"));
  // The PNG of the plot is twice as fine as the SVG: there one pixel of the inset is one pixel of the plot.
  EXPECT_NEAR(width, number_at(png, 16) / 2.0, 1.0);
  EXPECT_NEAR(height, number_at(png, 20) / 2.0, 1.0);
  EXPECT_NE(words_of(document).find("start\n"), std::string::npos);
  EXPECT_TRUE(failure_of([&] {
                plot.insets.at(0).file = "series.csv";
                draw_plot(plot, directory.path());
              }).find("not a PNG") != std::string::npos);
}

TEST(Plot, CanBeDrawnAgainFromItsScriptWhereverTheDirectoryGoes) {
  TemporaryDirectory const directory;
  fs::create_directory(directory / "here");
  write_file(directory / "here/series.csv", "time,mean displacement\n0,0\n1,1\n");
  draw_plot(simple_plot(), directory / "here");
  fs::rename(directory / "here", directory / "a 'new' place");
  fs::remove(directory / "a 'new' place/plot.svg");
  EXPECT_EQ(redraw_plots(directory / "a 'new' place"), PlotOutcome::drawn);
  EXPECT_EQ(MarkupDocument(read_file(directory / "a 'new' place/plot.svg")).problem, "");
  EXPECT_THROW(redraw_plots(directory.path()), Error);
  EXPECT_THROW(redraw_plots(directory / "nowhere"), Error);
}

TEST(Plot, RedrawKeepsWhatTheUserChangedInTheScript) {
  TemporaryDirectory const directory;
  write_series(directory);
  draw_plot(simple_plot(), directory.path());
  write_file(directory / "plot.gp", "set title 'by hand'\n" + read_file(directory / "plot.gp") +
                                        "set terminal svg\nset output 'mine.svg'\nset title 'by hand'\nreplot\n");
  redraw_plots(directory.path());
  EXPECT_NE(read_file(directory / "mine.svg").find("by hand"), std::string::npos);
}

TEST(Plot, OfAMissingTableFailsInGnuplotsWordsAndLeavesNoPicture) {
  TemporaryDirectory const directory;
  write_series(directory);
  Plot plot = simple_plot();
  plot.curves.push_back(displacement_curve());
  plot.curves.back().file = "missing.csv";
  std::string const failure = failure_of([&] { draw_plot(plot, directory.path()); });
  EXPECT_NE(failure.find("plot.gp"), std::string::npos) << failure;
  EXPECT_NE(failure.find("Cannot find or open file \"./missing.csv\""), std::string::npos) << failure;
  EXPECT_FALSE(fs::exists(directory / "plot.svg"));
  EXPECT_FALSE(fs::exists(directory / "plot.png"));
  EXPECT_TRUE(fs::exists(directory / "plot.gp"));
}

TEST(Plot, OfAMissingColumnFailsNamingIt) {
  TemporaryDirectory const directory;
  write_series(directory);
  Plot plot = simple_plot();
  plot.curves.push_back(displacement_curve());
  plot.curves.back().y = "no_such_column";
  std::string const failure = failure_of([&] { draw_plot(plot, directory.path()); });
  EXPECT_NE(failure.find("no_such_column"), std::string::npos) << failure;
}

TEST(Plot, WithoutASinglePointFails) {
  TemporaryDirectory const directory;
  write_file(directory / "series.csv", "time,mean displacement\n0,nan\n");
  EXPECT_NE(failure_of([&] { draw_plot(simple_plot(), directory.path()); }), "");
}

TEST(Plot, FileNamesNeverBecomeCommands) {
  TemporaryDirectory const directory;
  for (std::string const name : {"< touch hacked", "| touch hacked", "-", "+", "'`touch hacked`'", "a b\"c"}) {
    write_file(directory.path() / name, "time,mean displacement\n0,0\n1,1\n");
    Plot plot = simple_plot();
    plot.curves.at(0).file = name;
    EXPECT_EQ(draw_plot(plot, directory.path()), PlotOutcome::drawn) << name;
  }
  EXPECT_FALSE(fs::exists(directory / "hacked"));
}

TEST(Plots, ThatFailDoNotKeepTheOthersFromBeingDrawn) {
  TemporaryDirectory const directory;
  write_series(directory);
  std::vector<Plot> plots{simple_plot("first"), simple_plot("bad"), simple_plot("last")};
  plots.at(1).curves.at(0).file = "missing.csv";
  std::string const failure = failure_of([&] { draw_plots(plots, directory.path()); });
  EXPECT_NE(failure.find("bad.gp"), std::string::npos) << failure;
  EXPECT_EQ(failure.find("first.gp"), std::string::npos) << failure;
  EXPECT_EQ(failure.find("last.gp"), std::string::npos) << failure;
  for (char const* const file : {"first.svg", "first.png", "last.svg", "last.png"}) {
    EXPECT_TRUE(fs::exists(directory / file)) << file;
  }
}

TEST(Plots, OfOneCallDoNotInheritEachOthersSettings) {
  TemporaryDirectory const directory;
  write_series(directory);
  Plot loud = simple_plot("loud");
  loud.title = "loud title";
  loud.x = {.label = "loud x", .is_logarithmic = true, .least = 0.001, .most = 1000.0};
  loud.references = {{.at = 0.5, .label = "loud line"}};
  std::vector<Plot> const plots{loud, simple_plot("quiet")};
  draw_plots(plots, directory.path());
  std::string const together = read_file(directory / "quiet.svg");
  draw_plot(simple_plot("quiet"), directory.path());
  EXPECT_EQ(read_file(directory / "quiet.svg"), together);
  EXPECT_EQ(together.find("loud"), std::string::npos);
}

TEST(Plot, WithoutGnuplotLeavesTheScriptAndSaysSo) {
  TemporaryDirectory const directory;
  write_series(directory);
  write_file(directory / "plot.svg", "of older data");
  GnuplotSettings const missing{.program = "gnuplot-that-is-not-installed"};
  EXPECT_FALSE(is_gnuplot_available(missing));
  EXPECT_TRUE(is_gnuplot_available());
  EXPECT_EQ(draw_plot(simple_plot(), directory.path(), missing), PlotOutcome::gnuplot_is_missing);
  EXPECT_TRUE(fs::exists(directory / "plot.gp"));
  EXPECT_FALSE(fs::exists(directory / "plot.svg"));
}

TEST(Plot, EndsAGnuplotThatHangsAtTheTimeLimit) {
  TemporaryDirectory const directory;
  write_series(directory);
  // A child of the child keeps the pipe open and lives on: the whole group has to go.
  GnuplotSettings settings = stand_in(directory, "(sleep 0.5; touch late) & sleep 60\n");
  settings.time_limit = std::chrono::milliseconds(200);
  auto const start = std::chrono::steady_clock::now();
  std::string const failure = failure_of([&] { draw_plot(simple_plot(), directory.path(), settings); });
  EXPECT_NE(failure.find("within 0.2 s"), std::string::npos) << failure;
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(10));
  std::this_thread::sleep_for(std::chrono::milliseconds(500));
  EXPECT_FALSE(fs::exists(directory / "late"));
}

TEST(Plot, ReportsAProgramThatFailsHoweverMuchItSays) {
  TemporaryDirectory const directory;
  write_series(directory);
  std::string const silent =
      failure_of([&] { draw_plot(simple_plot(), directory.path(), stand_in(directory, "exit 3\n")); });
  EXPECT_NE(silent.find("failed without a word"), std::string::npos) << silent;
  // More than a pipe holds: a writer nobody reads would hang.
  GnuplotSettings const loud =
      stand_in(directory, "i=0; while [ $i -lt 20000 ]; do echo 'much to say' >&2; i=$((i+1)); done; exit 1\n");
  std::string const much = failure_of([&] { draw_plot(simple_plot(), directory.path(), loud); });
  EXPECT_NE(much.find("much to say"), std::string::npos);
  EXPECT_LT(much.size(), 80'000U);
}

TEST(Plot, RunsInItsDirectoryWithoutTheUsersOwnGnuplotSettings) {
  TemporaryDirectory const directory;
  write_series(directory);
  draw_plot(simple_plot("my plot"), directory.path(), stand_in(directory, "pwd -P > where; echo \"$@\" > arguments\n"));
  EXPECT_EQ(read_file(directory / "where"), fs::canonical(directory.path()).string() + "\n");
  EXPECT_EQ(read_file(directory / "arguments"), "-d ./my plot.gp\n");
}

TEST(Plot, InADirectoryThatIsMissingFails) {
  TemporaryDirectory const directory;
  EXPECT_NE(failure_of([&] { draw_plot(simple_plot(), directory / "missing"); }), "");
}

}  // namespace
}  // namespace gridlock
