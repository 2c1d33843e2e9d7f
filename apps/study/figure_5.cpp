#include "study/figure_5.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <iterator>
#include <numbers>
#include <optional>
#include <utility>

#include "gridlock/simulation/detail/rate_limiter.hpp"
#include "study/distance_checks.hpp"
#include "study/power_law.hpp"

namespace gridlock {

namespace {

/// With the most disks the square lattice is nearly close packed, so that the sizes run from a gas to a standstill.
constexpr double largest_packing_fraction = 0.78;
/// Sizes up to this packing fraction count as dilute: hardly a disk halts.
constexpr double dilute_packing_fraction = 0.32;
/// Above it the start is so nearly close packed that it stays a lattice in which nothing moves, a case of its own.
constexpr double liquid_packing_fraction = 0.72;

double timing_radius(PaperExtent const& extent) {
  double const most = static_cast<double>(std::ranges::max(extent.timing_counts));
  return std::sqrt(largest_packing_fraction / (most * std::numbers::pi));
}

Configuration timing_configuration(Study const& study, std::uint64_t disks, std::uint64_t k) {
  Configuration configuration;
  configuration.disks = {.count = disks, .radius = timing_radius(study.extent())};
  configuration.engine.cells = k;
  // The paper's own lists: the figure is about what they cost.
  configuration.engine.grid = GridKind::linked;
  configuration.engine.substeps = substeps_of_a_turn;
  configuration.run.steps = timing_steps;
  configuration.run.seed = study.seed(0);
  return configuration;
}

double median(std::vector<double> values) {
  std::ranges::sort(values);
  std::size_t const middle = values.size() / 2;
  return values.size() % 2 == 1 ? values[middle] : 0.5 * (values[middle - 1] + values[middle]);
}

/// One size of Figure 5, as far as it is measured.
struct Measurement {
  State start;
  EngineSettings engine;
  StepCost cost;
  bool is_counted = false;
  std::vector<double> seconds;
};

void serialize(Archive& archive, Measurement& measurement) {
  StepCost& cost = measurement.cost;
  archive.visit("is_counted", measurement.is_counted);
  archive.visit("packing_fraction", cost.packing_fraction);
  archive.visit("checks", cost.checks);
  archive.visit("free_checks", cost.free_checks);
  archive.visit("halted_fraction", cost.halted_fraction);
  archive.visit("seconds", measurement.seconds);
}

/// CPU time of one fresh run of the set-up; nothing where should_continue() says no, which is asked outside of that time.
std::optional<double> seconds_of(Measurement const& measurement, std::function<bool()> const& should_continue) {
  constexpr double seconds_between_looks = 0.1;
  State state = measurement.start;
  auto const engine = make_engine(measurement.engine, state);
  Counters counters;
  RateLimiter rate_limiter(seconds_between_looks);
  std::clock_t ticks = 0;
  while (state.clock.step < timing_steps) {
    std::clock_t const start = std::clock();
    engine->advance(state, counters, {.step = timing_steps, .should_continue = [&] { return !rate_limiter.is_due(); }});
    ticks += std::clock() - start;
    if (state.clock.step < timing_steps && !should_continue()) return std::nullopt;
  }
  return static_cast<double>(ticks) / CLOCKS_PER_SEC;
}

/// The counts of the same run, and what they would be without halting, step by step; false where should_continue() says no.
bool count_checks(Measurement& measurement, std::function<bool()> const& should_continue) {
  State state = measurement.start;
  auto const engine = make_engine(measurement.engine, state);
  Counters counters;
  StepCost& cost = measurement.cost;
  cost.packing_fraction = covered_area(state.agents) / state.box.area();
  cost.free_checks = 0.0;
  for (std::uint64_t step = 1; step <= timing_steps; ++step) {
    cost.free_checks += static_cast<double>(substeps_of_a_turn * checks_of_one_look(state, cost.k));
    engine->advance(state, counters, {.step = step});
    if (!should_continue()) return false;
  }
  cost.checks = static_cast<double>(counters.distance_checks);
  cost.halted_fraction = static_cast<double>(counters.halted_moves) / static_cast<double>(counters.moves);
  measurement.is_counted = true;
  return true;
}

/// All sizes of Figure 5, measured in rounds.
class MeasurementsInProgress {
 public:
  MeasurementsInProgress(Study& study, std::function<bool(double)> const& on_progress)
      : study_(study), on_progress_(on_progress), repeats_(study.extent().timing_repeats) {
    for (std::uint64_t const disks : study.extent().timing_counts) {
      for (std::uint64_t const k : timing_ks) {
        Configuration configuration = timing_configuration(study, disks, k);
        key_ += to_toml(describing(configuration));
        Setup const setup = set_up(configuration);
        measurements_.push_back(
            {.start = disks_of(setup), .engine = setup.configuration.engine, .cost = {.disks = disks, .k = k}});
      }
    }
    std::vector<Measurement> restored = measurements_;
    if (study_.partial_results.restore(key_, serializing(restored))) measurements_ = std::move(restored);
  }

  /// False where on_progress has stopped it. What is measured is kept in both cases.
  bool measure_all() {
    bool const is_complete = measure_in_rounds();
    keep();
    return is_complete;
  }

  [[nodiscard]] std::vector<StepCost> costs() const {
    std::vector<StepCost> costs;
    for (Measurement const& measurement : measurements_) {
      auto const [least, most] = std::ranges::minmax(measurement.seconds);
      costs.push_back(measurement.cost);
      costs.back().spread = most - least;
      costs.back().seconds = median(measurement.seconds);
    }
    return costs;
  }

 private:
  static std::function<void(Archive&)> serializing(std::vector<Measurement>& measurements) {
    return [&measurements](Archive& archive) {
      for (std::size_t m = 0; m < measurements.size(); ++m) {
        serialize_inside(archive, fmt::format("measurement_{}", m), [&] { serialize(archive, measurements[m]); });
      }
    };
  }
  void keep() { study_.partial_results.keep(key_, serializing(measurements_)); }

  [[nodiscard]] bool should_continue() const {
    std::size_t done = 0;
    for (Measurement const& m : measurements_) {
      done += (m.is_counted ? 1 : 0) + std::min<std::size_t>(m.seconds.size(), repeats_);
    }
    return on_progress_(static_cast<double>(done) / static_cast<double>(measurements_.size() * (repeats_ + 1)));
  }

  bool measure_in_rounds() {
    auto const asks = [this] { return should_continue(); };
    for (Measurement& measurement : measurements_) {
      if (!measurement.is_counted && !count_checks(measurement, asks)) return false;
    }
    // All sizes once, then all again: a machine that slows down for a while then spoils one repeat, not one size.
    for (std::uint64_t repeat = 0; repeat < repeats_; ++repeat) {
      keep();
      for (Measurement& measurement : measurements_) {
        if (measurement.seconds.size() > repeat) continue;
        auto const seconds = seconds_of(measurement, asks);
        if (!seconds) return false;
        measurement.seconds.push_back(*seconds);
        if (!should_continue()) return false;
      }
    }
    return true;
  }

  Study& study_;
  std::function<bool(double)> const& on_progress_;
  std::uint64_t repeats_;
  std::string key_ = "Figure 5\n";
  std::vector<Measurement> measurements_;
};

constexpr std::size_t ring_colour = 1;  // red
constexpr std::size_t circle = 0;       // the shape that goes with the first colour

/// Looks at all neighbours in a whole run: every disk, every sub-step of every step.
constexpr double looks = static_cast<double>(timing_steps * substeps_of_a_turn);

Table cost_table(std::vector<StepCost> const& costs) {
  Table table;
  table.add_column("disks", std::vector<std::uint64_t>{});
  table.add_column("k", std::vector<std::uint64_t>{});
  for (char const* name : {"packing_fraction", "seconds", "seconds_spread", "distance_checks", "free_distance_checks",
                           "uniform_distance_checks", "paper_distance_checks", "checks_over_paper", "free_over_paper",
                           "halted_fraction"}) {
    table.add_column(name, std::vector<double>{});
  }
  for (StepCost const& cost : costs) {
    double const paper = looks * paper_checks(cost.disks, cost.k);
    table.add_row(std::vector<Cell>{cost.disks, cost.k, cost.packing_fraction, cost.seconds, cost.spread, cost.checks,
                                    cost.free_checks, looks * uniform_checks(cost.disks, cost.k), paper,
                                    cost.checks / paper, cost.free_checks / paper, cost.halted_fraction});
  }
  return table;
}

/// y(cost) ∝ N^a k^b over the costs that `is_in` selects.
template <class Measure, class IsIn>
std::optional<PowerLaw> law_of(std::vector<StepCost> const& costs, Measure measure, IsIn is_in) {
  std::vector<PowerLawPoint> points;
  for (StepCost const& cost : costs) {
    double const y = measure(cost);
    if (is_in(cost) && y > 0.0) points.push_back({{static_cast<double>(cost.disks), static_cast<double>(cost.k)}, y});
  }
  return fit_power_law(points);
}

bool is_liquid(StepCost const& cost) { return cost.packing_fraction <= liquid_packing_fraction; }
bool is_dilute(StepCost const& cost) { return cost.packing_fraction <= dilute_packing_fraction; }
bool is_dense(StepCost const& cost) { return is_liquid(cost) && !is_dilute(cost); }

struct Laws {
  std::optional<PowerLaw> all;
  std::optional<PowerLaw> dilute;
  std::optional<PowerLaw> dense;
};

template <class Measure>
Laws laws_of(std::vector<StepCost> const& costs, Measure measure) {
  return {law_of(costs, measure, is_liquid), law_of(costs, measure, is_dilute), law_of(costs, measure, is_dense)};
}

std::string exponent_text(std::optional<PowerLaw> const& law, std::size_t which) {
  return law ? to_text(law->exponents[which]) : "–";
}

PageTable law_table(Laws const& free, Laws const& made, Laws const& time) {
  PageTable table{
      .header = {"", "a", "a, dilute", "a, dense", "b"},
      .caption = fmt::format("Exponents of cost ∝ N^a k^b by least squares in the logarithms up to φ = {}; dilute: φ ≤ "
                             "{}, dense: above. The errors measure how far the points are from a power law.",
                             liquid_packing_fraction, dilute_packing_fraction)};
  auto const add = [&](char const* what, Laws const& laws) {
    table.rows.push_back({what, exponent_text(laws.all, 0), exponent_text(laws.dilute, 0), exponent_text(laws.dense, 0),
                          exponent_text(laws.all, 1)});
  };
  add("distance checks if no disk halted", free);
  add("distance checks made", made);
  add("CPU time", time);
  table.rows.push_back({"9N²/k²", "2", "2", "2", "−2"});
  return table;
}

PaperClaim cost_claim(std::vector<StepCost> const& costs, Laws const& free) {
  PaperClaim claim{.where = "Figure 5",
                   .statement =
                       "The cost of a step is proportional to 9N²/k²: N disks, nine neighbourhoods each, N/k² disks in "
                       "a neighbourhood."};
  std::vector<double> ratios;
  std::vector<double> misfits;
  for (StepCost const& cost : costs) {
    ratios.push_back(cost.free_checks / (looks * paper_checks(cost.disks, cost.k)));
    misfits.push_back(std::abs(cost.free_checks / (looks * uniform_checks(cost.disks, cost.k)) - 1.0));
  }
  claim.measured = fmt::format(
      "The distances that would be checked if no disk halted are {:.2f} to {:.2f} of 9N²/k² and grow as N^({}) k^({}). "
      "The shortfall is the walls': a 3×3 block there is cut, which leaves (3k−2)²/k² cells on average, {:.2f} for k = "
      "10 and {:.2f} for k = 20. For disks anywhere with equal chance that makes N(N−1)(3k−2)²/k⁴, exactly; the counts "
      "differ from it by {:.1f} % (median) to {:.1f} % (few disks, which the start keeps apart). What is actually "
      "checked is less, see the next claim. Agreement means exponents within 0.1 of 2 and of −2.",
      std::ranges::min(ratios), std::ranges::max(ratios), exponent_text(free.all, 0), exponent_text(free.all, 1),
      mean_block_size(10), mean_block_size(20), 100.0 * median(misfits), 100.0 * std::ranges::max(misfits));
  if (!free.all) return claim;
  bool const is_law =
      std::abs(free.all->exponents[0].value - 2.0) < 0.1 && std::abs(free.all->exponents[1].value + 2.0) < 0.1;
  claim.verdict = is_law ? Verdict::agrees : Verdict::differs;
  return claim;
}

PaperClaim growth_claim(std::vector<StepCost> const& costs, Laws const& free, Laws const& made, Laws const& time) {
  PaperClaim claim{.where = "Figure 5",
                   .statement =
                       "With disks of constant size the time grows more slowly than N², because disks in dense systems "
                       "halt early."};
  auto const by_density = [](StepCost const& a, StepCost const& b) { return a.packing_fraction < b.packing_fraction; };
  auto const [first, last] = std::ranges::minmax_element(costs, by_density);
  claim.measured = fmt::format(
      "Above φ = {} the CPU time grows as N^({}) and the distances checked as N^({}); without halting they would grow "
      "as N^({}). Below, where few halt, the distances grow as N^({}); the time as N^({}), since handling a disk costs "
      "too, however few neighbours it has. From φ = {:.2f} to {:.2f} the share of the checks that is made falls from "
      "{:.3f} to {:.3f}, while the share of halted moves rises from {:.3f} to {:.3f}.",
      dilute_packing_fraction, exponent_text(time.dense, 0), exponent_text(made.dense, 0), exponent_text(free.dense, 0),
      exponent_text(made.dilute, 0), exponent_text(time.dilute, 0), first->packing_fraction, last->packing_fraction,
      first->checks / first->free_checks, last->checks / last->free_checks, first->halted_fraction,
      last->halted_fraction);
  if (!made.dense || !free.dense || !time.dense) return claim;
  bool const is_slower =
      made.dense->exponents[0].value < free.dense->exponents[0].value - 0.1 && time.dense->exponents[0].value < 2.0;
  claim.verdict = is_slower ? Verdict::agrees : Verdict::differs;
  return claim;
}

/// The claims about 1000 and 2000 disks, where both were measured.
std::vector<PaperClaim> equal_cost_claims(std::vector<StepCost> const& costs) {
  auto const find = [&](std::uint64_t disks, std::uint64_t k) {
    return std::ranges::find_if(costs, [=](StepCost const& cost) { return cost.disks == disks && cost.k == k; });
  };
  auto const small = find(1000, 10);
  auto const large = find(2000, 20);
  if (small == costs.end() || large == costs.end()) return {};
  constexpr double allowed = 0.1;
  double const checks = large->checks / small->checks;
  double const free = large->free_checks / small->free_checks;
  double const seconds = large->seconds / small->seconds;
  std::string const measured_checks = fmt::format(
      "Distance checks in 100 steps: {:.0f} and {:.0f}, a ratio of {:.3f}. Without halting it would be {:.3f}, since "
      "the finer grid loses less at the walls ({:.3f} for disks anywhere with equal chance); halting takes away {:.0f} "
      "% of it, since the 2000 disks fill φ = {:.2f} instead of {:.2f}. Agreement means within 10 %.",
      small->checks, large->checks, checks, free, uniform_checks(2000, 20) / uniform_checks(1000, 10),
      100.0 * (1.0 - checks / free), large->packing_fraction, small->packing_fraction);
  std::string const measured_time = fmt::format(
      "CPU time of 100 steps: {:.1f} ms and {:.1f} ms, a ratio of {:.2f}. A disk costs something besides its "
      "distances, and there are twice as many. Agreement means within 10 %.",
      1e3 * small->seconds, 1e3 * large->seconds, seconds);
  auto const verdict_on = [](double ratio) {
    return std::abs(ratio - 1.0) < allowed ? Verdict::agrees : Verdict::differs;
  };
  return {{.where = "Figure 5",
           .statement = "1000 disks on 10×10 neighbourhoods need as many distance checks as 2000 disks on 20×20.",
           .measured = measured_checks,
           .verdict = verdict_on(checks)},
          {.where = "Figure 5",
           .statement = "1000 disks on 10×10 neighbourhoods cost the same time as 2000 disks on 20×20.",
           .measured = measured_time,
           .verdict = verdict_on(seconds)}};
}

/// Time of a look at all neighbours without halting, seconds = per_disk · N + per_check · 9N²/k².
struct LookCost {
  double per_disk = 0.0;
  double per_check = 0.0;
};

/// The look cost nearest to the dilute sizes, where hardly a disk halts; least squares of the relative misfit.
LookCost fit_look_cost(std::vector<StepCost> const& costs) {
  double aa = 0.0;
  double ab = 0.0;
  double bb = 0.0;
  double a1 = 0.0;
  double b1 = 0.0;
  for (StepCost const& cost : costs) {
    if (!is_dilute(cost) || !(cost.seconds > 0.0)) continue;
    double const a = looks * static_cast<double>(cost.disks) / cost.seconds;
    double const b = looks * paper_checks(cost.disks, cost.k) / cost.seconds;
    aa += a * a;
    ab += a * b;
    bb += b * b;
    a1 += a;
    b1 += b;
  }
  double const determinant = aa * bb - ab * ab;
  if (!(determinant > 0.0)) return {};
  return {(a1 * bb - b1 * ab) / determinant, (b1 * aa - a1 * ab) / determinant};
}

/// The paper's red circles: 1000 disks at k = 10 cost as much as 2000 at k = 20.
void mark_equal_costs(Plot& plot, std::vector<StepCost> const& costs) {
  std::string label = "of equal cost, says the paper";
  for (auto const& [disks, k] : {std::pair{1000U, 10U}, {2000U, 20U}}) {
    auto const is_marked = [size = std::pair(disks, k)](StepCost const& cost) {
      return cost.disks == size.first && cost.k == size.second;
    };
    if (std::ranges::none_of(costs, is_marked)) continue;
    plot.curves.push_back(
        {.label = label,
         .file = "figure_5.csv",
         .x = "disks",
         .y = "seconds",
         .where = {{.column = "k", .equals = std::to_string(k)}, {.column = "disks", .equals = std::to_string(disks)}},
         .style = PlotStyle::points,
         .is_open = true,
         .point_size = 2.8,
         .shape = circle,
         .colour = ring_colour,
         .y_factor = 1e3});
    label.clear();
  }
}

void draw_times(Study& study, std::vector<StepCost> const& costs) {
  Plot plot{.name = "figure_5",
            .title = "Figure 5: 100 steps of N disks on k × k neighbourhoods",
            .x = {.label = "number of disks N", .least = 0.0},
            .y = {.label = "CPU time of 100 steps / ms", .least = 0.0},
            .key = PlotKey::top_left};
  LookCost const look = fit_look_cost(costs);
  std::size_t colour = 0;
  for (std::uint64_t const k : timing_ks) {
    plot.curves.push_back({.label = fmt::format("k = {}", k),
                           .file = "figure_5.csv",
                           .x = "disks",
                           .y = "seconds",
                           .where = {{.column = "k", .equals = std::to_string(k)}},
                           .style = PlotStyle::line_and_points,
                           .colour = colour,
                           .y_factor = 1e3});
    plot.formulas.push_back({.label = "",
                             .formula = fmt::format("{:.6e}*x+{:.6e}*9*x**2/{}", 1e3 * looks * look.per_disk,
                                                    1e3 * looks * look.per_check, k * k),
                             .colour = colour});
    ++colour;
  }
  plot.formulas.push_back({.label = "if no disk halted", .formula = "NaN"});
  mark_equal_costs(plot, costs);
  double largest = 0.0;
  for (StepCost const& cost : costs) largest = std::max(largest, 1e3 * cost.seconds);
  plot.y.most = 1.25 * largest;
  study.draw(plot);
}

void draw_checks(Study& study) {
  Plot plot{.name = "figure_5_checks",
            .title = "Distance checks in units of the paper's 9N²/k²",
            .x = {.label = "number of disks N", .least = 0.0},
            .y = {.label = "distance checks / (9N²/k²)", .least = 0.0, .most = 1.15},
            .references = {{.at = 1.0, .label = "9N²/k²"}},
            .key = PlotKey::bottom_left};
  for (bool const is_free : {true, false}) {
    std::size_t colour = 0;
    for (std::uint64_t const k : timing_ks) {
      plot.curves.push_back({.label = fmt::format("k = {}, {}", k, is_free ? "if no disk halted" : "made"),
                             .file = "figure_5.csv",
                             .x = "disks",
                             .y = is_free ? "free_over_paper" : "checks_over_paper",
                             .where = {{.column = "k", .equals = std::to_string(k)}},
                             .style = is_free ? PlotStyle::line : PlotStyle::line_and_points,
                             .is_dashed = is_free,
                             .colour = colour++});
    }
  }
  study.draw(plot);
}

}  // namespace

bool fits_neighbourhoods(PaperExtent const& extent) {
  // A step of 0.1 diameters per v_max, and no disk is likely to become three times as fast as v_max.
  double const cutoff = 2.0 * timing_radius(extent) * 1.3;
  return cutoff * static_cast<double>(std::ranges::max(timing_ks)) <= 1.0;
}

double seconds_to_measure(PaperExtent const& extent) {
  constexpr double seconds_per_check = 2e-9;
  constexpr double seconds_per_look = 4e-8;
  double seconds = 0.0;
  for (std::uint64_t const disks : extent.timing_counts) {
    for (std::uint64_t const k : timing_ks) {
      double const run =
          looks * (seconds_per_check * uniform_checks(disks, k) + seconds_per_look * static_cast<double>(disks));
      seconds += static_cast<double>(extent.timing_repeats + 1) * run;
    }
  }
  return seconds;
}

std::vector<StepCost> measure_step_costs(Study& study, std::function<bool(double)> const& on_progress) {
  MeasurementsInProgress measurements(study, on_progress);
  return measurements.measure_all() ? measurements.costs() : std::vector<StepCost>{};
}

Chapter figure_5(Study& study, std::vector<StepCost> const& costs) {
  study.write(cost_table(costs), "figure_5.csv");
  draw_times(study, costs);
  draw_checks(study);

  Laws const free = laws_of(costs, [](StepCost const& cost) { return cost.free_checks; });
  Laws const made = laws_of(costs, [](StepCost const& cost) { return cost.checks; });
  Laws const time = laws_of(costs, [](StepCost const& cost) { return cost.seconds; });

  Chapter chapter{.title = "Figure 5: what the grid saves"};
  chapter.introduction.push_back(fmt::format(
      "Disks of constant size, so large that {} of them just fit the square lattice (φ = {}); fewer disks are a "
      "thinner gas. Times are the CPU time of the process with nothing else running in it, the median of {} repeats on "
      "this machine; distance checks are counted exactly and are the same on every machine.",
      std::ranges::max(study.extent().timing_counts), largest_packing_fraction, study.extent().timing_repeats));
  LookCost const look = fit_look_cost(costs);
  chapter.drawings.push_back(
      {{"figure_5.svg"},
       fmt::format(
           "CPU time of 100 steps against the number of disks. Dashed: {:.0f} ns for each disk and {:.2f} ns for each "
           "of 9N²/k² distances in every sub-step, two numbers taken from the dilute sizes of all k together. "
           "Towards the largest N the box is full, most disks halt at once, and a step costs less than without "
           "halting. "
           "Rings: the two set-ups that the paper circles as equally costly.",
           1e9 * look.per_disk, 1e9 * look.per_check)});
  chapter.drawings.push_back({{"figure_5_checks.svg"},
                              "The distances checked in 100 steps over 500 · 9N²/k² (five sub-steps a step). Dashed: "
                              "if no disk halted, from counting the disks of every block at every step."});
  chapter.claims.push_back(cost_claim(costs, free));
  chapter.claims.push_back(growth_claim(costs, free, made, time));
  std::ranges::copy(equal_cost_claims(costs), std::back_inserter(chapter.claims));
  chapter.tables.push_back(law_table(free, made, time));
  return chapter;
}

}  // namespace gridlock
