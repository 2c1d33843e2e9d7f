#include "gridlock/observe/observable.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

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
                                             "blocked_share",
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

/// A run of `samples` samples in which disks fly freely and the tally grows; every number that comes out is checked.
void expect_only_numbers(State state, int samples, bool passes_time) {
  Tally tally;
  auto const observables = make_observables({.structure_every = 1, .pair_correlation_bins = 5}, {state, tally});
  for (int n = 0; n < samples; ++n) {
    for (auto const& observable : observables) {
      for (double const value : sample(*observable, state, tally)) EXPECT_FALSE(std::isinf(value));
    }
    if (!passes_time) continue;
    state.clock.step += 1;
    state.clock.time += 0.1;
    tally.turns += state.disks.size();
    tally.pair_collisions += state.disks.size() / 2;
    tally.pair_virial += 0.01 * static_cast<double>(state.disks.size() / 2);
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

TEST(Observables, BeginForgetsWhatCameBefore) {
  State const state = ideal_gas(Box(1, 1, Edge::wall), 30, 0.01, 1);
  for (auto const& observable : make_observables({}, {state, {}})) {
    State moved = ideal_gas(Box(1, 1, Edge::wall), 30, 0.01, 2);
    moved.clock.time = 1.0;
    draw_maxwell(moved, 1.0, 2);
    sample(*observable, moved, {.turns = 10, .pair_collisions = 3});
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
    EXPECT_GE(value, info.least) << info.key;
    EXPECT_LE(value, info.most) << info.key;
  }
};

TEST(ObserveSettings, DescribeEverySettingWithADefaultInItsBounds) {
  ObserveSettings settings;
  Collector collector;
  describe(settings, collector);
  EXPECT_EQ(collector.keys,
            (std::set<std::string>{"every", "discard", "structure_every", "pair_correlation_range",
                                   "pair_correlation_bins", "speed_range", "speed_bins", "velocity_origin_every"}));
}

}  // namespace
}  // namespace gridlock
