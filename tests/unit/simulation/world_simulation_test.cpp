#include "gridlock/simulation/world_simulation.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "gridlock/simulation/model_simulation.hpp"
#include "gridlock/simulation/simulate.hpp"
#include "io/checkpoint.hpp"
#include "models/epidemic.hpp"

namespace gridlock {
namespace {

/// What a run writes to its series, by name, and its curves.
RunRecord record_of(std::string const& text) {
  gridlock::Setup const setup = set_up(
      SettingsFile::from_text(text + "\nrun.steps = 60\nobserve = { every = 10, structure_every = 2 }", "run.toml"));
  gridlock::Run run(*setup.simulation, plan_of(setup));
  run.advance();
  return run.record();
}

TEST(WorldSimulation, MeasuresTheSameRatesAndPressuresOfTheColloidAsOfTheDisksOfAnEngine) {
  // So dense and fast that with tiles some turns wait for the end of the step.
  std::string const disks = "disks = { count = 2000, packing_fraction = 0.6 }";
  std::string const fast = "velocities = { kind = \"maxwell\" }";
  for (auto const& [engine, model] : {std::pair("stepped", "colloid"), std::pair("tiled", "colloid_tiled")}) {
    for (std::string const edge : {"wall", "periodic"}) {
      SCOPED_TRACE(std::string(model) + " " + edge);
      std::string const box = "box.edge = \"" + edge + "\"\nengine.threads = 2\n";
      RunRecord const of_engine = record_of(box + "engine.kind = \"" + engine + "\"\n" + disks + "\n" + fast);
      RunRecord const of_model =
          record_of(box + "model.kind = \"" + model + "\"\n" + model + "." + disks + "\n" + model + "." + fast);
      ASSERT_EQ(of_engine.state_hash, of_model.state_hash);
      std::vector<std::string> names{"collision_rate", "mean_free_time", "halted_fraction", "virial_pressure",
                                     "compressibility_factor"};
      if (edge == "wall") {
        for (char const* name : {"wall_hit_rate", "wall_pressure", "wall_pressure_left", "wall_pressure_right",
                                 "wall_pressure_bottom", "wall_pressure_top"}) {
          names.emplace_back(name);
        }
      }
      for (std::string const& name : names) {
        std::vector<double> const expected = of_engine.series.numbers(name);
        std::vector<double> const measured = of_model.series.numbers(name);
        ASSERT_EQ(expected.size(), measured.size()) << name;
        // The first sample has no interval before it. The engine tiled takes eight turns at a time and adds what they
        // leave behind in another order than one by one.
        for (std::size_t k = 1; k < expected.size(); ++k) {
          EXPECT_GT(expected[k], 0.0) << name;
          if (std::string(engine) == "stepped") {
            EXPECT_EQ(expected[k], measured[k]) << name;
          } else {
            EXPECT_NEAR(expected[k], measured[k], 1e-12 * expected[k]) << name;
          }
        }
      }
    }
  }
}

TEST(WorldSimulation, MeasuresTheSameOfTheColloidAsOfTheDisksOfAnEngine) {
  std::string const disks = "disks = { count = 100, packing_fraction = 0.6 }";
  RunRecord const of_engine = record_of("box.edge = \"periodic\"\n" + disks);
  RunRecord const of_model = record_of("box.edge = \"periodic\"\nmodel.kind = \"colloid\"\ncolloid." + disks);
  ASSERT_EQ(of_engine.state_hash, of_model.state_hash);
  for (char const* name :
       {"mean_displacement", "mean_squared_displacement", "centre_displacement", "kinetic_energy", "mean_speed"}) {
    EXPECT_EQ(of_engine.series.numbers(name), of_model.series.numbers(name)) << name;
  }
  EXPECT_EQ(of_engine.series.numbers("velocity_autocorrelation").back(),
            of_model.series.numbers("velocity_autocorrelation").back());
  ASSERT_EQ(of_model.series.numbers("global_bond_orientation_order").size(), 7U);
  EXPECT_NEAR(of_engine.series.numbers("global_bond_orientation_order").back(),
              of_model.series.numbers("global_bond_orientation_order").back(), 1e-12);
  auto const correlation = [](RunRecord const& record) {
    auto const found = std::ranges::find(record.distributions, "pair_correlation", &Distribution::name);
    return found == record.distributions.end() ? std::vector<double>() : found->columns_of_values[1];
  };
  EXPECT_FALSE(correlation(of_engine).empty());
  EXPECT_EQ(correlation(of_engine), correlation(of_model)) << "pairs are counted, so their order does not matter";
}

bool has_column(Simulation const& simulation, std::string const& name) {
  auto const columns = simulation.columns();
  return std::ranges::find(columns, name, &ColumnInfo::name) != columns.end();
}

TEST(WorldSimulation, MeasuresWhatTheColumnsOfTheAgentsAllow) {
  ModelSimulation<Epidemic> const walled({}, Box(1.0, 1.0, Edge::wall), 1);
  EXPECT_TRUE(has_column(walled, "mean_displacement"));
  EXPECT_TRUE(has_column(walled, "velocity_autocorrelation"));
  EXPECT_FALSE(has_column(walled, "kinetic_energy")) << "walkers have no mass";
  EXPECT_FALSE(has_column(walled, "collision_rate")) << "nobody counts collisions";
  ModelSimulation<Epidemic> const periodic({}, Box(1.0, 1.0, Edge::periodic), 1);
  EXPECT_FALSE(has_column(periodic, "mean_displacement")) << "nobody knows how often a walker has gone around";
}

/// Walkers to the right that call something else by the name of an observable.
struct Namesake {
  static constexpr std::string_view name = "namesake";
  static constexpr Schedule schedule = Schedule::synchronous;
  using Agents = Population<X, Y>;
  [[nodiscard]] double cutoff() const { return 0.1; }
  [[nodiscard]] double time_step() const { return 1.0; }
  void start(World<Namesake>& world) const { world.agents.add(1.0, 0.5); }
  void turn(Turn<Namesake>& self) const { self.move_by({0.5, 0.0}); }
  void observe(World<Namesake> const&, Observations& seen) const { seen.add("mean_displacement", 42.0); }
};

TEST(WorldSimulation, KeepsWhatAModelObservesWhereAnObservableHasTheSameName) {
  ModelSimulation<Namesake> simulation({}, Box(20.0, 1.0, Edge::wall), 1);
  gridlock::Run run(simulation, {.stop_condition = {.step = 4}, .sample_every = 1});
  run.advance();
  EXPECT_EQ(run.record().series.numbers("mean_displacement"), std::vector<double>(5, 42.0));
  EXPECT_TRUE(has_column(simulation, "local_bond_orientation_order"));
}

/// Agents that have a child in every step.
struct Growing {
  static constexpr std::string_view name = "growing";
  static constexpr Schedule schedule = Schedule::synchronous;
  using Agents = Population<X, Y>;
  [[nodiscard]] double cutoff() const { return 0.1; }
  [[nodiscard]] double time_step() const { return 1.0; }
  void start(World<Growing>& world) const { world.agents.add(1.0, 0.5); }
  void turn(Turn<Growing>& self) const { self.give_birth(self.position().x, self.position().y); }
};

TEST(WorldSimulation, HasTheAgentsAndTheHashOfTheTimeToWhichItGoesBack) {
  ModelSimulation<Growing> simulation({}, Box(20.0, 1.0, Edge::wall), 1);
  simulation.advance({.step = 3});
  std::uint64_t const hash = simulation.state_hash();
  std::string const saved = to_checkpoint([&](Archive& archive) { simulation.serialize(archive); });
  simulation.advance({.step = 6});
  EXPECT_EQ(simulation.agents(), 64U);
  from_checkpoint(saved, "saved", [&](Archive& archive) { simulation.serialize(archive); });
  EXPECT_EQ(simulation.agents(), 8U);
  EXPECT_EQ(simulation.state_hash(), hash);
}

}  // namespace
}  // namespace gridlock
