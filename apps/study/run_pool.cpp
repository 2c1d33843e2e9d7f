#include "study/run_pool.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>
#include <numeric>
#include <utility>

#include "gridlock/core/error.hpp"
#include "gridlock/engine/engine.hpp"
#include "gridlock/grid/validate.hpp"
#include "workspace/job_pool.hpp"

namespace gridlock {

namespace {

/// The settings that tell two runs apart: equal keys, equal bits.
std::string key_of(StudyRun const& run) {
  Configuration configuration = run.configuration;
  return fmt::format("{}\nsites = {}\n", to_toml(describing(configuration)), static_cast<int>(run.sites));
}

char const* to_text(Sites sites) {
  switch (sites) {
    case Sites::fitted:
      return "fitted";
    case Sites::to_walls:
      return "to walls";
    case Sites::perfect:
      break;
  }
  return "perfect";
}

char const* to_text(StartKind start) { return start == StartKind::square ? "square" : "triangular"; }

/// What a step of an engine costs beside one of the paper's rule. Exact disks cost by the collision, of which there are
/// φ g(σ) times as many, g at contact by Enskog's theory; the two numbers are measured, to a third of the cost.
double relative_cost(Configuration const& configuration) {
  if (engine_record(configuration.engine.kind).has_time_step) return 1.0;
  double const density = configuration.disks.packing_fraction.value_or(0.0);
  double const empty = 1.0 - density;
  double const collisions = density * (1.0 - 7.0 / 16.0 * density) / (empty * empty);
  return 0.17 + 0.36 * collisions;
}

/// In disk-steps of the paper's rule; only for the order and the progress.
double work_of(Configuration const& configuration) {
  return relative_cost(configuration) * static_cast<double>(configuration.disks.count.value_or(841)) *
         static_cast<double>(configuration.run.steps.value_or(0));
}

/// √(⟨u²⟩ − |⟨u⟩|²) of each sample, in sides of the box.
std::vector<double> about_centre(RunResult const& result) {
  std::vector<double> lengths = result.series.numbers("mean_squared_displacement");
  std::vector<double> const centres = result.series.numbers("centre_displacement");
  double const side = result.world.box.side();
  for (std::size_t sample = 0; sample < lengths.size(); ++sample) {
    // Rounding may leave less than nothing where all disks move together.
    lengths[sample] = std::sqrt(std::max(0.0, lengths[sample] / (side * side) - centres[sample] * centres[sample]));
  }
  return lengths;
}

StudyOutcome outcome_from(RunResult const& result) {
  bool const has_walls = !result.world.box.is_periodic();
  return {.is_finished = result.status == RunStatus::finished,
          .failure = result.failure,
          .steps = result.series.numbers("step"),
          .times = result.series.numbers("time"),
          .displacements = result.series.numbers("mean_displacement"),
          .centre_displacements = result.series.numbers("centre_displacement"),
          .displacements_about_centre = about_centre(result),
          .halted_fractions = result.series.numbers("halted_fraction"),
          .collision_rates = result.series.numbers("collision_rate"),
          .compressibility_factors = result.series.numbers("compressibility_factor"),
          .wall_pressures = has_walls ? result.series.numbers("wall_pressure") : std::vector<double>{},
          .state_hash = hash(result.world),
          .seconds = result.seconds};
}

void put_on(std::vector<Vector> const& sites, State& state) {
  auto const x = state.agents.column<X>();
  auto const y = state.agents.column<Y>();
  assert(sites.size() == x.size());
  for (std::size_t i = 0; i < sites.size(); ++i) {
    x[i] = sites[i].x;
    y[i] = sites[i].y;
  }
}

}  // namespace

void serialize(Archive& archive, StudyOutcome& outcome) {
  archive.visit("steps", outcome.steps);
  archive.visit("times", outcome.times);
  archive.visit("displacements", outcome.displacements);
  archive.visit("centre_displacements", outcome.centre_displacements);
  archive.visit("displacements_about_centre", outcome.displacements_about_centre);
  archive.visit("halted_fractions", outcome.halted_fractions);
  archive.visit("collision_rates", outcome.collision_rates);
  archive.visit("compressibility_factors", outcome.compressibility_factors);
  archive.visit("wall_pressures", outcome.wall_pressures);
  archive.visit("state_hash", outcome.state_hash);
  archive.visit("seconds", outcome.seconds);
  for (auto const* series :
       {&outcome.times, &outcome.displacements, &outcome.centre_displacements, &outcome.displacements_about_centre,
        &outcome.halted_fractions, &outcome.collision_rates, &outcome.compressibility_factors}) {
    archive.require(series->size() == outcome.steps.size(), "the series differ in length");
  }
  archive.require(outcome.wall_pressures.empty() || outcome.wall_pressures.size() == outcome.steps.size(),
                  "the series differ in length");
  archive.require(!outcome.steps.empty(), "there are no samples");
  if (archive.is_restoring()) outcome.is_finished = true;
}

SiteList square_sites_to_walls(double side, std::uint64_t count, double radius) {
  auto const rows = static_cast<std::uint64_t>(std::llround(std::sqrt(static_cast<double>(count))));
  if (rows * rows != count || rows < 2) {
    throw Error({.what = fmt::format("{} is not the square of a number of rows, at least 2", count),
                 .hint = "use a square number, such as the paper's 841",
                 .key = "disks.count"});
  }
  double const spacing = (side - 2.0 * radius) / static_cast<double>(rows - 1);
  SiteList list{.radius = 0.5 * side / static_cast<double>(rows)};
  for (std::uint64_t row = 0; row < rows; ++row) {
    for (std::uint64_t column = 0; column < rows; ++column) {
      // The last disk touches the wall exactly, whatever the rounding of the spacing.
      auto const along = [&](std::uint64_t n) {
        return n + 1 == rows ? side - radius : radius + static_cast<double>(n) * spacing;
      };
      list.sites.push_back({along(column), along(row)});
    }
  }
  return list;
}

SiteList perfect_triangular_sites(double side, std::uint64_t count) {
  SiteList best;
  double const row_height = 0.5 * std::numbers::sqrt3;
  for (std::uint64_t rows = 2; rows <= count; ++rows) {
    std::uint64_t const longest = (count + rows / 2 + rows - 1) / rows;
    if (longest < 2) break;
    // Spacing and diameter are one: p spacings across, (rows − 1)·√3/2 + 1 up.
    double const spacing =
        side / std::max(static_cast<double>(longest), static_cast<double>(rows - 1) * row_height + 1.0);
    // As lattice/start.hpp: rounding must not make disks in contact overlap.
    double const radius = 0.5 * spacing - 1e-15 * side;
    if (radius <= best.radius) continue;
    std::vector<Vector> all;
    double const left = 0.5 * (side - static_cast<double>(longest - 1) * spacing);
    double const bottom = 0.5 * (side - static_cast<double>(rows - 1) * row_height * spacing);
    for (std::uint64_t row = 0; row < rows; ++row) {
      double const shift = row % 2 == 1 ? 0.5 : 0.0;
      std::uint64_t const length = row % 2 == 1 ? longest - 1 : longest;
      for (std::uint64_t n = 0; n < length; ++n) {
        all.push_back({left + (static_cast<double>(n) + shift) * spacing,
                       bottom + static_cast<double>(row) * row_height * spacing});
      }
    }
    best.radius = radius;
    best.sites.clear();
    for (std::uint64_t n = 0; n < count; ++n) best.sites.push_back(all[n * all.size() / count]);
  }
  return best;
}

Setup set_up(StudyRun const& run) {
  Setup setup = set_up(run.configuration);
  if (run.sites == Sites::fitted) return setup;
  State state = disks_of(setup);
  std::uint64_t const count = state.agents.size();
  double const radius = radius_range(state.agents).largest;
  double const side = state.box.width();
  SiteList const list =
      run.sites == Sites::to_walls ? square_sites_to_walls(side, count, radius) : perfect_triangular_sites(side, count);
  if (radius > list.radius) {
    throw Error({.what = fmt::format("disks of radius {:.6g} do not fit on these sites; the largest is {:.6g}", radius,
                                     list.radius),
                 .hint = "use a smaller packing fraction",
                 .key = "disks.packing_fraction"});
  }
  put_on(list.sites, state);
  validate(state);
  return set_up(run.configuration, {.start = std::move(state)});
}

void RunPool::add(StudyRun const& run) {
  auto const [place, is_new] = by_settings_.try_emplace(key_of(run), entries_.size());
  if (is_new) entries_.push_back({.run = run, .work = work_of(run.configuration)});
}

void RunPool::keep_in(PartialResults& partial_results) {
  partial_results_ = &partial_results;
  for (Entry& entry : entries_) {
    StudyOutcome outcome;
    if (partial_results.restore(key_of(entry.run), [&](Archive& archive) { serialize(archive, outcome); })) {
      entry.outcome = std::move(outcome);
    }
  }
}

std::size_t RunPool::finished() const {
  return static_cast<std::size_t>(
      std::ranges::count_if(entries_, [](Entry const& entry) { return entry.outcome.is_finished; }));
}

double RunPool::work() const {
  return std::accumulate(entries_.begin(), entries_.end(), 0.0, [](double sum, Entry const& entry) {
    return entry.outcome.is_finished ? sum : sum + entry.work;
  });
}

void RunPool::run_all(unsigned threads, std::function<bool(double, std::size_t)> const& on_progress) {
  std::vector<Entry*> open;
  std::vector<double> work;
  for (Entry& entry : entries_) {
    if (entry.outcome.is_finished) continue;
    open.push_back(&entry);
    work.push_back(entry.work);
  }
  std::size_t const finished_before = entries_.size() - open.size();
  JobPool job_pool(std::move(work), [&](double fraction, std::size_t finished) {
    return !on_progress || on_progress(fraction, finished_before + finished);
  });
  job_pool.run_all(threads, [&](std::size_t k) {
    Entry& entry = *open[k];
    try {
      entry.outcome = outcome_from(
          simulate(set_up(entry.run), [&](Progress const& progress) { return job_pool.report(k, progress.fraction); }));
    } catch (std::exception const& error) {
      entry.outcome.failure = error.what();
    }
    if (entry.outcome.is_finished && partial_results_ != nullptr) {
      partial_results_->keep(key_of(entry.run), [&](Archive& archive) { serialize(archive, entry.outcome); });
    }
  });
}

StudyOutcome const& RunPool::outcome_of(StudyRun const& run) const {
  auto const place = by_settings_.find(key_of(run));
  assert(place != by_settings_.end());
  return entries_[place->second].outcome;
}

Table RunPool::rows() const {
  Table table;
  for (char const* name : {"start", "sites", "edge", "engine", "contact", "state_hash"}) {
    table.add_column(name, std::vector<std::string>{});
  }
  for (char const* name : {"disks", "steps", "seed"}) table.add_column(name, std::vector<std::uint64_t>{});
  for (char const* name :
       {"packing_fraction", "time_step", "time", "mean_displacement", "halted_fraction", "collision_rate", "seconds"}) {
    table.add_column(name, std::vector<double>{});
  }
  for (Entry const& entry : entries_) {
    StudyOutcome const& outcome = entry.outcome;
    if (!outcome.is_finished) continue;
    Configuration const& configuration = entry.run.configuration;
    table.add_row(std::vector<Cell>{to_text(configuration.disks.start), to_text(entry.run.sites),
                                    configuration.box.edge == Edge::wall ? "wall" : "periodic",
                                    configuration.engine.kind,
                                    configuration.engine.contact == Contact::always ? "always" : "approaching",
                                    fmt::format("{:016x}", outcome.state_hash), configuration.disks.count.value_or(841),
                                    static_cast<std::uint64_t>(outcome.steps.back()), configuration.run.seed,
                                    configuration.disks.packing_fraction.value_or(0.0), configuration.engine.time_step,
                                    outcome.times.back(), outcome.displacements.back(), outcome.halted_fractions.back(),
                                    outcome.collision_rates.back(), outcome.seconds});
  }
  return table;
}

std::vector<std::string> RunPool::failures() const {
  std::vector<std::string> failures;
  for (Entry const& entry : entries_) {
    if (entry.outcome.failure.empty()) continue;
    failures.push_back(fmt::format("{} start, packing fraction {}, seed {}: {}",
                                   to_text(entry.run.configuration.disks.start),
                                   entry.run.configuration.disks.packing_fraction.value_or(0.0),
                                   entry.run.configuration.run.seed, entry.outcome.failure));
  }
  return failures;
}

}  // namespace gridlock
