#include "gridlock/observe/observable.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "gridlock/core/error.hpp"
#include "io/checkpoint.hpp"
#include "observe/unused_settings.hpp"
#include "unit/observe/hand_built.hpp"

namespace gridlock {
namespace {

using namespace hand_built;

std::set<std::string> names_of_columns(std::vector<std::unique_ptr<Observable>> const& observables) {
  std::set<std::string> names;
  for (auto const& observable : observables) {
    for (ColumnInfo const& column : observable->columns()) {
      EXPECT_TRUE(names.insert(column.name).second) << column.name << " twice";
      EXPECT_FALSE(column.documentation.empty()) << column.name;
    }
  }
  return names;
}

std::set<std::string> const names_everywhere{"mean_displacement",
                                             "mean_squared_displacement",
                                             "centre_displacement",
                                             "kinetic_energy",
                                             "kinetic_energy_drift",
                                             "mean_speed",
                                             "speed_moment_ratio",
                                             "collision_rate",
                                             "mean_free_time",
                                             "halted_fraction",
                                             "virial_pressure",
                                             "compressibility_factor",
                                             "velocity_autocorrelation",
                                             "global_bond_orientation_order",
                                             "local_bond_orientation_order"};
std::set<std::string> const names_of_walls{"wall_hit_rate",       "wall_pressure",        "wall_pressure_left",
                                           "wall_pressure_right", "wall_pressure_bottom", "wall_pressure_top"};

TEST(MakeObservables, GivesEveryObservableOnceAndThoseOfWallsBetweenWallsOnly) {
  State const periodic = ideal_gas(Box(1, 1, Edge::periodic), 10, 0.01, 1);
  EXPECT_EQ(names_of_columns(make_observables({}, {periodic, {}})), names_everywhere);
  State const walled = ideal_gas(Box(1, 1, Edge::wall), 10, 0.01, 1);
  std::set<std::string> all = names_everywhere;
  all.insert(names_of_walls.begin(), names_of_walls.end());
  EXPECT_EQ(names_of_columns(make_observables({}, {walled, {}})), all);
}

TEST(MakeObservables, LeavesOutStructureWhereItIsNotAskedFor) {
  State const state = ideal_gas(Box(1, 1, Edge::periodic), 10, 0.01, 1);
  auto const names = names_of_columns(make_observables({.structure_every = 0}, {state, {}}));
  EXPECT_FALSE(names.contains("global_bond_orientation_order"));
  EXPECT_TRUE(names.contains("mean_displacement"));
}

/// A run of `samples` samples in which disks fly freely and the counters grow; every number that comes out is checked.
void expect_only_numbers(State state, int samples, bool passes_time) {
  Counters counters;
  ObserveSettings settings = settings_of_all_observables();
  settings.pair_correlation_bins = 5;
  auto const observables = make_observables(settings, {state, counters});
  for (int n = 0; n < samples; ++n) {
    for (auto const& observable : observables) {
      for (double const value : sample(*observable, state, counters)) EXPECT_FALSE(std::isinf(value));
    }
    if (!passes_time) continue;
    state.clock.step += 1;
    state.clock.time += 0.1;
    counters.moves += state.agents.size();
    counters.pair_collisions += state.agents.size() / 2;
    counters.pair_virial += 0.01 * static_cast<double>(state.agents.size() / 2);
  }
  for (auto const& observable : observables) {
    for (NamedEstimate const& named : observable->results()) {
      EXPECT_TRUE(std::isfinite(named.estimate.value)) << named.name;
      if (named.estimate.error) {
        EXPECT_TRUE(std::isfinite(*named.estimate.error)) << named.name;
        EXPECT_GE(*named.estimate.error, 0.0) << named.name;
      }
    }
    for (Distribution const& distribution : observable->distributions()) {
      EXPECT_EQ(distribution.columns.size(), distribution.columns_of_values.size()) << distribution.name;
      for (auto const& values : distribution.columns_of_values) {
        EXPECT_EQ(values.size(), distribution.columns_of_values.front().size()) << distribution.name;
        for (double const value : values) EXPECT_FALSE(std::isinf(value)) << distribution.name;
      }
      // Values are numbers; only errors may be missing.
      for (double const value : distribution.columns_of_values[1]) EXPECT_FALSE(std::isnan(value)) << distribution.name;
    }
  }
}

TEST(Observables, GiveOnlyNumbersForTheSmallestSystemsAndTheShortestRuns) {
  for (Edge const edge : {Edge::wall, Edge::periodic}) {
    for (std::size_t const count : {0U, 1U, 2U, 3U}) {
      for (double const kt : {0.0, 1.0}) {
        for (int const samples : {0, 1, 2, 3}) {
          for (bool const passes_time : {false, true}) {
            SCOPED_TRACE(std::to_string(count) + " disks, kT = " + std::to_string(kt) + ", " + std::to_string(samples) +
                         (edge == Edge::wall ? " samples, walls" : " samples, periodic"));
            State state = ideal_gas(Box(1, 1, edge), count, 0.1, 7);
            draw_maxwell(state, kt, 7);
            expect_only_numbers(state, samples, passes_time);
          }
        }
      }
    }
  }
}

TEST(MakeObservables, OfAnEngineWithoutTurnsLeavesOutTheirShare) {
  State state = ideal_gas(Box(1, 1, Edge::periodic), 10, 0.01, 1);
  for (bool const has_turns : {true, false}) {
    auto const observables = make_observables({}, {state, {}}, {.halts_moves = has_turns});
    bool has_share = false;
    State later = state;
    later.clock.time = 1.0;
    for (auto const& observable : observables) {
      sample(*observable, later, {.moves = 100, .halted_moves = 10});
      has_share = has_share || result(*observable, "halted_fraction");
    }
    EXPECT_EQ(has_share, has_turns);
  }
}

TEST(MakeObservables, TheStructureIsMeasuredAtEveryStructureEverySampleWhateverTheStepsBetweenSamples) {
  // Every third sample counts a triangular lattice, all others an ideal gas.
  State const lattice = triangular_lattice(8, 8);
  State const gas = ideal_gas(lattice.box, 64, 0.4, 3);
  ObserveSettings const settings{.every = 1, .structure_every = 3, .pair_correlation_bins = 20};
  auto const all = make_observables(settings, {lattice, {}});
  auto const of_lattice =
      make_observables({.every = 1, .structure_every = 1, .pair_correlation_bins = 20}, {lattice, {}});
  for (std::size_t k = 0; k < all.size(); ++k) {
    for (int n = 0; n < 7; ++n) sample(*all[k], n % 3 == 0 ? lattice : gas);
    sample(*of_lattice[k], lattice);
    if (auto const order = result(*all[k], "global_bond_orientation_order")) {
      EXPECT_NEAR(order->value, 1.0, 1e-12);
    }
    for (Distribution const& distribution : all[k]->distributions()) {
      if (distribution.name != "pair_correlation") continue;
      auto const expected = of_lattice[k]->distributions()[0].columns_of_values[1];
      for (std::size_t b = 0; b < expected.size(); ++b) {
        EXPECT_NEAR(distribution.columns_of_values[1][b], expected[b], 1e-12 * (1.0 + expected[b])) << b;
      }
    }
  }
}

/// Everything, with few bins.
ObserveSettings run_settings() {
  ObserveSettings settings = settings_of_all_observables();
  settings.structure_every = 2;
  settings.pair_correlation_bins = 4;
  settings.speed_bins = 6;
  settings.velocity_origin_every = 3;
  settings.displacement_lag = 7;
  settings.displacement_origin_every = 2;
  return settings;
}

TEST(MakeObservables, RefusesAnObservableOnRequestThatAgentsCannotHave) {
  struct Points {
    using Agents = Population<X, Y>;
  };
  World<Points> const world{.box = Box(2.0, 1.0, Edge::periodic), .agents = {}, .clock = {}, .seed = 0};
  Counters const counters;
  EXPECT_NO_THROW(
      make_observables({.density_profile = ProfileAxes::both, .local_density_every = 1}, {world, counters}));
  auto const refusal = [&](ObserveSettings const& settings) -> std::string {
    try {
      make_observables(settings, {world, counters});
    } catch (Error const& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_NE(refusal({.clusters_every = 1}).find("observe.clusters_every measures what needs the column radius"),
            std::string::npos);
  EXPECT_NE(refusal({.displacement_lag = 1}).find("column image_x"), std::string::npos);
  EXPECT_NE(refusal({.temperature_by_kind = true}).find("column velocity_x"), std::string::npos);
  EXPECT_NE(refusal({.flux_line = FluxLine::vertical}).find("column image_x"), std::string::npos);
}

TEST(NamesOfCurves, AreThoseOfAllCurvesThatAreMeasuredInAnyBox) {
  State state = ideal_gas(Box(3, 2, Edge::wall), 40, 0.1, 5);
  draw_maxwell(state, 1.0, 1);
  std::set<std::string> found;
  for (auto const& observable : make_observables(settings_of_all_observables(), {state, {}})) {
    for (int n = 0; n < 3; ++n) {
      state.clock.time = 0.1 * n;
      sample(*observable, state);
    }
    for (Distribution const& distribution : observable->distributions()) found.insert(distribution.name);
  }
  // Those of the engine exact, which need every collision, have a test of their own.
  found.insert({"stress_growth", "free_time_distribution", "free_path_distribution"});
  auto const names = names_of_curves();
  EXPECT_EQ(found, std::set<std::string>(names.begin(), names.end()));
}

TEST(UnusedSettings, OfObservablesAreThoseOfWhatIsNotAskedFor) {
  ObserveSettings none;
  none.structure_every = 0;
  for (char const* setting :
       {"pair_correlation_range", "pair_correlation_bins", "orientation_correlation", "density_profile_bins",
        "cluster_cutoff", "local_density_side", "displacement_origin_every", "flux_position"}) {
    EXPECT_NE(unused_because_of(none, setting), "") << setting;
    EXPECT_EQ(unused_because_of(settings_of_all_observables(), setting), "") << setting;
  }
  EXPECT_EQ(unused_because_of(none, "cluster_cutoff"), "observe.clusters_every = 0");
  EXPECT_EQ(unused_because_of(none, "every"), "");
}

/// A run of 45 samples of a gas that is stirred anew between them.
class StirredRun {
 public:
  static constexpr int samples = 45;

  explicit StirredRun(Edge edge) : state_(ideal_gas(Box(3, 2, edge), 40, 0.1, 5)) { stir(0); }

  [[nodiscard]] std::vector<std::unique_ptr<Observable>> begin() const {
    return make_observables(run_settings(), {state_, counters_});
  }
  void go_to(int n) {
    stir(static_cast<std::uint64_t>(n));
    state_.clock.time = 0.5 * n;
    state_.agents.column<ImageX>()[3] = n;
    auto const count = static_cast<std::uint64_t>(n);
    counters_ = {.moves = 40 * count,
                 .halted_moves = count * count / 9,
                 .pair_collisions = 7 * count + count * count / 5,
                 .wall_hits = {count, 2 * count, 3 * count, count * count},
                 .pair_virial = 0.1 * n * n};
    counters_.wall_impulse = {1.0 * n, 0.5 * n * n, 2.0 * n, 1.5 * n};
  }
  [[nodiscard]] std::vector<double> sample_of(Observable& observable, int n) const {
    return sample(observable, state_, counters_, n > 4);
  }

 private:
  void stir(std::uint64_t seed) {
    State const drawn = ideal_gas(state_.box, 40, 0.1, 5 + seed);
    std::ranges::copy(drawn.agents.column<X>(), state_.agents.column<X>().begin());
    std::ranges::copy(drawn.agents.column<Y>(), state_.agents.column<Y>().begin());
    draw_maxwell(state_, 1.0 + 0.1 * static_cast<double>(seed), seed);
  }
  State state_;
  Counters counters_;
};

/// Every number that an observable gives, as text that tells every bit.
std::string everything_of(Observable const& observable) {
  std::string text;
  auto const add = [&](double value) { text += std::to_string(std::bit_cast<std::uint64_t>(value)) + " "; };
  for (NamedEstimate const& named : observable.results()) {
    text += named.name + " ";
    add(named.estimate.value);
    add(named.estimate.error.value_or(no_value));
  }
  for (Distribution const& distribution : observable.distributions()) {
    for (auto const& values : distribution.columns_of_values) std::ranges::for_each(values, add);
  }
  return text;
}

TEST(Observables, SavedAndRestoredAtAnySampleTheyGiveTheSameBits) {
  for (Edge const edge : {Edge::wall, Edge::periodic}) {
    for (int const stop : {0, 1, 3, 6, 17, 33, 39}) {
      StirredRun run(edge);
      auto const whole = run.begin();
      auto const begun = run.begin();  // saved, since saving must not change what goes on either
      auto const resumed = run.begin();
      for (int n = 1; n <= StirredRun::samples; ++n) {
        run.go_to(n);
        for (std::size_t k = 0; k < whole.size(); ++k) {
          auto const row = run.sample_of(*whole[k], n);
          if (n <= stop) static_cast<void>(run.sample_of(*begun[k], n));
          if (n == stop) {
            std::string const saved = to_checkpoint([&](Archive& archive) { begun[k]->serialize(archive); });
            from_checkpoint(saved, "saved", [&](Archive& archive) { resumed[k]->serialize(archive); });
            EXPECT_EQ(everything_of(*resumed[k]), everything_of(*whole[k])) << "restored after " << n;
          } else if (n > stop) {
            auto const resumed_row = run.sample_of(*resumed[k], n);
            for (std::size_t c = 0; c < row.size(); ++c) {
              EXPECT_EQ(std::bit_cast<std::uint64_t>(resumed_row[c]), std::bit_cast<std::uint64_t>(row[c]))
                  << whole[k]->columns()[c].name << ", sample " << n << " after " << stop;
            }
          }
        }
      }
      for (std::size_t k = 0; k < whole.size(); ++k) {
        EXPECT_EQ(everything_of(*resumed[k]), everything_of(*whole[k])) << "stopped after " << stop;
      }
    }
  }
}

TEST(Observables, EveryResultHasTheUnitOfItsColumn) {
  StirredRun run(Edge::wall);
  auto const observables = run.begin();
  for (int n = 1; n < 12; ++n) {
    run.go_to(n);
    for (auto const& observable : observables) static_cast<void>(run.sample_of(*observable, n));
  }
  for (auto const& observable : observables) {
    auto const columns = observable->columns();
    for (NamedEstimate const& named : observable->results()) {
      auto const column = std::ranges::find(columns, named.name, &ColumnInfo::name);
      ASSERT_NE(column, columns.end()) << named.name;
      EXPECT_EQ(named.unit, column->unit) << named.name;
    }
  }
}

TEST(Observables, BeginForgetsWhatCameBefore) {
  State const state = ideal_gas(Box(1, 1, Edge::wall), 30, 0.01, 1);
  for (auto const& observable : make_observables({}, {state, {}})) {
    State moved = ideal_gas(Box(1, 1, Edge::wall), 30, 0.01, 2);
    moved.clock.time = 1.0;
    draw_maxwell(moved, 1.0, 2);
    sample(*observable, moved, {.moves = 10, .pair_collisions = 3});
    observable->begin({state, {}});
    auto const fresh = make_observables({}, {state, {}});
    EXPECT_TRUE(observable->distributions().empty());
    for (NamedEstimate const& named : observable->results()) EXPECT_EQ(named.estimate.value, 0.0) << named.name;
  }
}

/// Collects what describe() says and holds it against the defaults.
class Collector final : public SettingVisitor {
 public:
  void enter(std::string_view, std::string_view) override {}
  void leave() override {}
  void visit(SettingInfo const& info, double& value) override { check(info, value); }
  void visit(SettingInfo const& info, std::optional<double>&) override { note(info); }
  void visit(SettingInfo const& info, std::uint64_t& value) override { check(info, static_cast<double>(value)); }
  void visit(SettingInfo const& info, std::optional<std::uint64_t>&) override { note(info); }
  void visit(SettingInfo const& info, bool&) override { note(info); }
  void visit(SettingInfo const& info, std::string&) override { note(info); }
  void visit(SettingInfo const& info, std::vector<double>&) override { note(info); }
  void visit_choice(SettingInfo const& info, std::span<std::string_view const>, std::size_t&) override { note(info); }
  void visit_tables(SettingInfo const& info, std::size_t, std::function<void(std::size_t)> const&,
                    std::function<void(std::size_t, SettingVisitor&)> const&) override {
    note(info);
  }
  std::set<std::string> keys;

 private:
  void note(SettingInfo const& info) {
    EXPECT_TRUE(keys.emplace(info.key).second) << info.key;
    EXPECT_FALSE(info.documentation.empty()) << info.key;
  }
  void check(SettingInfo const& info, double value) {
    note(info);
    EXPECT_GE(value, info.min) << info.key;
    EXPECT_LE(value, info.max) << info.key;
  }
};

TEST(ObserveSettings, DescribeEverySettingWithADefaultInItsBounds) {
  ObserveSettings settings;
  Collector collector;
  describe(settings, collector);
  EXPECT_EQ(collector.keys, (std::set<std::string>{"every",
                                                   "per_decade",
                                                   "viscosity_lag",
                                                   "free_flights",
                                                   "equilibration",
                                                   "structure_every",
                                                   "pair_correlation_range",
                                                   "pair_correlation_bins",
                                                   "orientation_correlation",
                                                   "defects_every",
                                                   "speed_range",
                                                   "speed_bins",
                                                   "velocity_origin_every",
                                                   "density_profile",
                                                   "density_profile_bins",
                                                   "clusters_every",
                                                   "cluster_cutoff",
                                                   "local_density_every",
                                                   "local_density_side",
                                                   "displacement_lag",
                                                   "displacement_origin_every",
                                                   "temperature_by_kind",
                                                   "flux_line",
                                                   "flux_position"}));
}

}  // namespace
}  // namespace gridlock
