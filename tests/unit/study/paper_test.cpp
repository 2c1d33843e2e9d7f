#include "study/paper.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <string>

#include "drawing/plot.hpp"
#include "gridlock/core/error.hpp"
#include "gridlock/engine/engine.hpp"
#include "gridlock/io/table.hpp"
#include "io/file.hpp"
#include "unit/io/markup_document.hpp"
#include "unit/io/temporary_directory.hpp"

namespace gridlock {
namespace {

/// The whole study on a toy: a few disks, a few steps.
PaperExtent tiny_paper() {
  PaperExtent extent = quick_paper();
  extent.disks = 49;
  extent.figure_6 = {.steps = 40, .sample_every = 4, .seeds = 2};
  extent.figure_7 = {.steps = 60, .sample_every = 6, .seeds = 1};
  extent.square_densities = {0.2, 0.6, 0.7};
  extent.triangular_densities = {0.2, 0.6, 0.75};
  extent.fan_densities = {0.2, 0.7};
  extent.timing_counts = {225, 400, 625, 900};
  extent.timing_repeats = 1;
  extent.plateau_densities = {0.2};
  extent.plateau_seeds = 2;
  extent.plateau_relaxations = 0.5;
  extent.choice_time_steps = {0.1, 0.2};
  extent.choice_diameters = 40.0;
  extent.choice_seeds = 2;
  extent.choice_square_densities = {0.6};
  extent.choice_triangular_densities = {0.7};
  extent.order_diameters = 25.6;
  extent.order_time_steps = {0.1};
  extent.order_seeds = 4;
  extent.order_square_densities = {0.6};
  extent.order_triangular_densities = {0.7};
  extent.order_periodic_densities = {0.6};
  // A curve for every engine there is: each is one more entry.
  extent.engines.clear();
  for (std::string const& kind : engine_kinds()) extent.engines.push_back({kind, kind});
  return extent;
}

/// The files of a directory, but for hidden ones such as the list of what --overwrite may remove.
std::set<std::string> names_in(std::filesystem::path const& directory) {
  std::set<std::string> names;
  for (auto const& entry : std::filesystem::directory_iterator(directory)) {
    std::string const name = entry.path().filename().string();
    if (!name.starts_with('.')) names.insert(name);
  }
  return names;
}

TEST(Paper, MakesEveryFigureWithItsDataAndAReportThatStandsAlone) {
  TemporaryDirectory const directory;
  double last = 0.0;
  PaperResult const result =
      run_paper({.extent = tiny_paper(), .output = directory / "paper"}, [&](PaperProgress const& p) {
        EXPECT_GE(p.fraction, last - 1e-12);
        EXPECT_FALSE(p.what.empty());
        last = p.fraction;
        return true;
      });
  EXPECT_EQ(result.status, RunStatus::finished);
  EXPECT_NEAR(last, 1.0, 1e-9);

  std::set<std::string> expected{"report.html",
                                 "runs.csv",
                                 "figure_4.csv",
                                 "figure_5.csv",
                                 "figure_6.csv",
                                 "figure_7.csv",
                                 "figure_7_theory.csv",
                                 "figure_7_plateau.csv",
                                 "open_choices.csv",
                                 "turn_order.csv",
                                 "turn_order_comparisons.csv"};
  for (std::string const picture : {"figure_4_start", "figure_4_after", "figure_7_square", "figure_7_triangular"}) {
    expected.insert({picture + ".svg", picture + ".png"});
  }
  bool const draws = is_gnuplot_available();
  for (std::string const plot :
       {"figure_5", "figure_5_checks", "figure_6", "figure_6_logarithmic", "figure_7", "open_choices", "turn_order"}) {
    expected.insert(plot + ".gp");
    if (draws) expected.insert({plot + ".svg", plot + ".png"});
  }
  EXPECT_EQ(names_in(directory / "paper"), expected);
  std::set<std::string> named;
  for (auto const& file : result.files) named.insert(file.filename().string());
  EXPECT_EQ(named, expected);
  EXPECT_EQ(result.files.back().filename(), "report.html");
  if (draws) {
    EXPECT_TRUE(result.notes.empty()) << result.notes.front();
  }

  MarkupDocument const report(read_file(directory / "paper" / "report.html"));
  EXPECT_EQ(report.problem, "");
  for (std::string const& target : report.values_of("src")) EXPECT_TRUE(target.starts_with("data:")) << target;
  ASSERT_GE(result.claims.size(), 7U);
  std::string const text = read_file(directory / "paper" / "report.html");
  for (PaperClaim const& claim : result.claims) {
    EXPECT_FALSE(claim.statement.empty());
    EXPECT_FALSE(claim.measured.empty());
    EXPECT_NE(text.find(claim.statement), std::string::npos) << claim.statement;
    // Quotation marks become entities in HTML.
    std::string const measured = claim.measured.substr(0, claim.measured.find_first_of("\"'&<>"));
    EXPECT_NE(text.find(measured), std::string::npos) << measured;
  }
}

TEST(Paper, MakesTheSameNumbersAgainOnAnyNumberOfThreads) {
  auto const hashes = [](unsigned threads) {
    TemporaryDirectory const directory;
    run_paper({.extent = tiny_paper(), .figure = 6, .output = directory.path(), .threads = threads, .seed = 9});
    Table const runs = read_csv(directory / "runs.csv");
    return std::get<std::vector<std::string>>(runs.column("state_hash"));
  };
  auto const once = hashes(1);
  EXPECT_EQ(once.size(), 4 * engine_kinds().size());  // two densities, two seeds
  EXPECT_EQ(once, hashes(2));
}

TEST(Paper, MakesOneFigureAlone) {
  TemporaryDirectory const directory;
  PaperResult const result = run_paper({.extent = tiny_paper(), .figure = 5, .output = directory.path()});
  for (std::string const& name : names_in(directory.path())) {
    EXPECT_TRUE(name.starts_with("figure_5") || name == "report.html") << name;
  }
  for (PaperClaim const& claim : result.claims) EXPECT_EQ(claim.where, "Figure 5");
}

TEST(Paper, SaysOfFigure7HowLongItsRunsAreAndHowManyThereAre) {
  TemporaryDirectory const directory;
  PaperExtent extent = tiny_paper();
  extent.figure_7.densest_of_others = 0.65;
  run_paper({.extent = extent, .figure = 7, .output = directory.path()});
  std::string const report = read_file(directory / "report.html");
  for (std::string const part : {"after 4 steps, 2 seeds", "after 40 steps, 2 seeds", "after 60 steps, 1 seed<",
                                 "each point is one run, which has no error over seeds", "Above φ = 0.65",
                                 "The errors are those of the interpolation alone"}) {
    EXPECT_NE(report.find(part), std::string::npos) << part;
  }
  Table const points = read_csv(directory / "figure_7.csv");
  auto const& engine = std::get<std::vector<std::string>>(points.column("engine"));
  std::vector<double> const steps = points.numbers("steps");
  std::vector<double> const density = points.numbers("packing_fraction");
  ASSERT_EQ(steps.size(), 6 + 4 * (engine_kinds().size() - 1));
  for (std::size_t row = 0; row < steps.size(); ++row) {
    EXPECT_EQ(steps[row], 60.0);
    EXPECT_TRUE(engine[row] == extent.engines.front().kind || density[row] <= 0.65) << engine[row];
  }
}

TEST(Paper, CountsTheSameDistancesOnEveryMachine) {
  TemporaryDirectory const directory;
  run_paper({.extent = tiny_paper(), .figure = 5, .output = directory.path()});
  Table const table = read_csv(directory / "figure_5.csv");
  std::vector<double> const made = table.numbers("distance_checks");
  std::vector<double> const free = table.numbers("free_distance_checks");
  std::vector<double> const halted = table.numbers("halted_fraction");
  ASSERT_EQ(made.size(), 12U);
  for (std::size_t row = 0; row < made.size(); ++row) {
    // Whatever halts a disk only takes checks away; the counts without halting are of the disks at the start of each step.
    EXPECT_LT(made[row], 1.01 * free[row]);
    EXPECT_GT(made[row], 0.0);
    EXPECT_GE(halted[row], 0.0);
    EXPECT_LE(halted[row], 1.0);
  }
}

TEST(Paper, ComparesTheOrdersOfTurnsFromTheSameStarts) {
  TemporaryDirectory const directory;
  run_paper({.extent = tiny_paper(), .output = directory.path()});
  Table const table = read_csv(directory / "turn_order_comparisons.csv");
  auto const& quantity = std::get<std::vector<std::string>>(table.column("quantity"));
  std::set<std::string> const compared(quantity.begin(), quantity.end());
  EXPECT_EQ(compared, (std::set<std::string>{"centre_displacement", "collision_rate", "compressibility_factor",
                                             "displacement_about_centre", "mean_displacement", "wall_pressure"}));
  std::vector<double> const stepped = table.numbers("stepped");
  std::vector<double> const tiled = table.numbers("tiled");
  std::vector<double> const exact = table.numbers("exact");
  std::vector<double> const deviation = table.numbers("deviation");
  std::vector<double> const difference = table.numbers("difference");
  // Two starts between walls: five moments of 256 samples (1, 4, 16, 64, 256) and three quantities each. One in a
  // periodic box: five moments, about the centre and of it, and two quantities.
  ASSERT_EQ(deviation.size(), 28U);
  auto const& edge = std::get<std::vector<std::string>>(table.column("edge"));
  EXPECT_EQ(std::ranges::count(edge, "periodic"), 12);
  double largest = 0.0;
  for (std::size_t row = 0; row < deviation.size(); ++row) {
    EXPECT_GT(stepped[row], 0.0) << quantity[row];
    if (quantity[row] == "centre_displacement") {
      // Exact disks keep their centre as long as their momentum is zero; halted ones do not.
      EXPECT_LT(exact[row], 1e-9);
    } else {
      EXPECT_GT(exact[row], 0.0) << quantity[row];
    }
    EXPECT_NEAR(difference[row], tiled[row] - stepped[row], 1e-9 * stepped[row]) << quantity[row];
    double const error = std::hypot(table.numbers("stepped_error")[row], table.numbers("tiled_error")[row]);
    EXPECT_NEAR(deviation[row] * error, tiled[row] - stepped[row], 1e-9 * stepped[row]) << quantity[row];
    largest = std::max(largest, std::abs(deviation[row]));
  }
  // Another order of turns is another trajectory.
  EXPECT_GT(largest, 0.0);
}

/// Every table of a study, without the timings.
std::map<std::string, std::string> tables_in(std::filesystem::path const& directory) {
  std::map<std::string, std::string> tables;
  for (std::string const& name : names_in(directory)) {
    if (!name.ends_with(".csv")) continue;
    Table const table = read_csv(directory / name);
    Table kept;
    for (std::size_t k = 0; k < table.column_count(); ++k) {
      if (!table.names()[k].starts_with("seconds")) kept.add_column(table.names()[k], table.column(k));
    }
    tables[name] = to_csv(kept);
  }
  return tables;
}

/// The first number of "3 of 40 simulations"; nothing for other work.
std::optional<std::size_t> simulations_in(std::string const& what) {
  if (!what.ends_with(" simulations")) return std::nullopt;
  return std::stoul(what);
}

std::size_t files_in(std::filesystem::path const& directory) {
  return std::filesystem::exists(directory) ? names_in(directory).size() : 0;
}

TEST(Paper, StoppedInEveryPartAndCalledAgainMakesTheTablesOfAnUninterruptedStudy) {
  TemporaryDirectory const directory;
  PaperSettings const settings{.extent = tiny_paper(), .output = directory / "parts", .threads = 2};
  std::size_t finished = 0;
  int calls = 0;
  // Stopped at the first report of a part, or after two more simulations.
  std::set<std::string> stopped_in;
  PaperResult result;
  do {
    std::optional<std::size_t> first;
    result = run_paper(settings, [&](PaperProgress const& progress) {
      auto const simulations = simulations_in(progress.what);
      if (!simulations) return !stopped_in.insert(progress.what.substr(0, 9)).second;
      if (!first) first = simulations;
      EXPECT_GE(*simulations, finished) << "a finished simulation is made again";
      return *simulations < *first + 40;
    });
    if (result.status == RunStatus::finished) break;
    EXPECT_FALSE(std::filesystem::exists(settings.output / "report.html"));
    EXPECT_GE(result.finished_simulations, finished);
    EXPECT_TRUE(result.claims.empty());
    finished = result.finished_simulations;
  } while (++calls < 100);
  EXPECT_EQ(result.status, RunStatus::finished);
  EXPECT_GE(calls, 4);
  EXPECT_EQ(stopped_in, (std::set<std::string>{"Figure 5:", "drawing", "drawing f", "drawing o", "drawing t"}));
  PaperSettings whole = settings;
  whole.output = directory / "whole";
  run_paper(whole);
  EXPECT_EQ(names_in(settings.output), names_in(whole.output));
  EXPECT_EQ(tables_in(settings.output), tables_in(whole.output));
}

TEST(Paper, KeepsEachSimulationAsSoonAsItIsFinished) {
  TemporaryDirectory const directory;
  PaperSettings settings{.extent = tiny_paper(), .figure = 6, .output = directory.path(), .threads = 1};
  std::filesystem::path const kept = directory / "partial_results";
  std::size_t most = 0;
  // Whatever kills the process at this moment, the files are there.
  auto const stop_after_three = [&](PaperProgress const& progress) {
    std::size_t const finished = simulations_in(progress.what).value_or(0);
    EXPECT_GE(files_in(kept), finished);
    most = std::max(most, finished);
    return finished < 3;
  };
  EXPECT_EQ(run_paper(settings, stop_after_three).finished_simulations, 3U);
  EXPECT_EQ(files_in(kept), 3U);

  // Neither a damaged result nor one of other settings is taken for one of these.
  auto const first = std::filesystem::directory_iterator(kept)->path();
  write_file(first, "GRIDLOCK, damaged");
  EXPECT_EQ(run_paper(settings, [](PaperProgress const&) { return false; }).finished_simulations, 2U);
  PaperSettings other = settings;
  other.seed = 1000;
  EXPECT_EQ(run_paper(other, [](PaperProgress const&) { return false; }).finished_simulations, 0U);

  settings.overwrites = true;
  EXPECT_EQ(run_paper(settings, [](PaperProgress const&) { return false; }).finished_simulations, 0U);
  EXPECT_FALSE(std::filesystem::exists(kept));
}

TEST(Paper, RemovesOfItsPartialResultsWhatItHasMade) {
  TemporaryDirectory const directory;
  std::filesystem::create_directories(directory / "partial_results");
  write_file(directory / "partial_results" / "notes.txt", "mine");
  write_file(directory / "partial_results" / ".0123456789abcdef.gridlock.77-0.part", "of a killed process");
  run_paper({.extent = tiny_paper(), .figure = 4, .output = directory.path()});
  EXPECT_EQ(names_in(directory / "partial_results"), std::set<std::string>{"notes.txt"});
}

TEST(Paper, MeasuresNoSizeOfFigure5AgainThatItHasMeasured) {
  TemporaryDirectory const directory;
  PaperSettings const settings{.extent = tiny_paper(), .figure = 5, .output = directory.path()};
  double done = 0.0;
  run_paper(settings, [&](PaperProgress const& progress) {
    done = progress.fraction;
    return progress.fraction < 0.1;
  });
  ASSERT_GE(done, 0.1);
  EXPECT_EQ(files_in(directory / "partial_results"), 1U);
  std::optional<double> first;
  PaperResult const result = run_paper(settings, [&](PaperProgress const& progress) {
    if (!first) first = progress.fraction;
    return true;
  });
  EXPECT_GE(*first, done - 1e-12);
  EXPECT_EQ(result.status, RunStatus::finished);
}

TEST(Paper, RefusesWhatItCannotMake) {
  TemporaryDirectory const directory;
  EXPECT_THROW(run_paper({.extent = tiny_paper(), .figure = 3, .output = directory.path()}), Error);
  PaperExtent empty = tiny_paper();
  empty.engines.clear();
  EXPECT_THROW(run_paper({.extent = empty, .output = directory.path()}), Error);
  PaperExtent unsorted = tiny_paper();
  unsorted.square_densities = {0.5, 0.3};
  EXPECT_THROW(run_paper({.extent = unsorted, .output = directory.path()}), Error);
  PaperExtent without_steps = tiny_paper();
  without_steps.order_time_steps.clear();
  EXPECT_THROW(run_paper({.extent = without_steps, .output = directory.path()}), Error);
  write_file(directory / "file", "");
  EXPECT_THROW(run_paper({.extent = tiny_paper(), .output = directory / "file" / "below"}), Error);
}

TEST(PaperExtent, OfTheFullStudyIsThePapersLength) {
  PaperExtent const full = full_paper();
  EXPECT_EQ(full.disks, 841U);
  EXPECT_EQ(full.figure_6.steps, 100'000U);
  EXPECT_GE(full.figure_6.seeds, 4U);
  EXPECT_EQ(full.figure_7.steps, 100'000U);
  EXPECT_GE(full.figure_7.seeds, 4U);
  EXPECT_GE(full.square_densities.size(), 20U);
  EXPECT_GE(full.triangular_densities.size(), 20U);
}

TEST(PaperExtent, OfTheQuickStudyIsThePapersLengthInFigure7AndHasErrorsWherePointsAreCompared) {
  PaperExtent const quick = quick_paper();
  EXPECT_EQ(quick.disks, 841U);
  EXPECT_EQ(quick.figure_7.steps, 100'000U);
  EXPECT_EQ(quick.figure_6.steps, 10'000U);
  EXPECT_GE(quick.figure_6.seeds, 3U);
}

TEST(PaperExtent, SharesTheRunsOfTheFanWithFigure7) {
  for (PaperExtent const& extent : {quick_paper(), full_paper()}) {
    for (double const density : extent.fan_densities) {
      auto const& densities = density < 0.785 ? extent.square_densities : extent.triangular_densities;
      EXPECT_NE(std::ranges::find(densities, density), densities.end()) << density;
    }
  }
}

}  // namespace
}  // namespace gridlock
