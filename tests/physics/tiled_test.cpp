// `tiled` takes the turns of `stepped` in another order: single trajectories differ, what is measured of them must not.

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "gridlock/run/simulate.hpp"

namespace gridlock {
namespace {

struct Measured {
  double mean = 0.0;
  double squared_error = 0.0;
};

/// Mean over seeds with its error from their scatter.
Measured measure(std::string const& engine, std::string const& observable, double packing_fraction, Edge edge) {
  constexpr int seeds = 12;
  std::vector<double> values;
  for (int seed = 1; seed <= seeds; ++seed) {
    Configuration configuration;
    configuration.box.edge = edge;
    configuration.disks = {.count = 841, .packing_fraction = packing_fraction};
    configuration.engine.kind = engine;
    configuration.run = {.steps = 600, .seed = static_cast<std::uint64_t>(seed)};
    configuration.observe.every = 20;
    configuration.observe.structure_every = 0;
    RunResult const result = simulate(set_up(configuration));
    for (NamedEstimate const& named : result.results) {
      if (named.name == observable) values.push_back(named.estimate.value);
    }
  }
  EXPECT_EQ(values.size(), std::size_t{seeds}) << observable;
  Measured measured;
  for (double const value : values) measured.mean += value / seeds;
  for (double const value : values) {
    measured.squared_error += (value - measured.mean) * (value - measured.mean) / (seeds * (seeds - 1.0));
  }
  return measured;
}

/// Four standard errors of the difference: two engines that agree fail in one of 16,000 comparisons.
void expect_agreement(std::string const& observable, double packing_fraction, Edge edge) {
  Measured const tiled = measure("tiled", observable, packing_fraction, edge);
  Measured const stepped = measure("stepped", observable, packing_fraction, edge);
  double const error = std::sqrt(tiled.squared_error + stepped.squared_error);
  EXPECT_GT(error, 0.0);
  EXPECT_LT(std::abs(tiled.mean - stepped.mean), 4.0 * error)
      << observable << " at " << packing_fraction << ": tiled " << tiled.mean << ", stepped " << stepped.mean << " ± "
      << error;
  EXPECT_LT(error, 0.05 * std::abs(stepped.mean)) << "too uncertain to tell anything";
}

TEST(TiledPhysics, DisplacesTheDisksAsFarAsStepped) {
  expect_agreement("mean_displacement", 0.3, Edge::wall);
  expect_agreement("mean_displacement", 0.6, Edge::wall);
  expect_agreement("mean_squared_displacement", 0.5, Edge::periodic);
}

TEST(TiledPhysics, HasThePressureOfStepped) {
  expect_agreement("compressibility_factor", 0.3, Edge::periodic);
  expect_agreement("wall_pressure", 0.6, Edge::wall);
}

TEST(TiledPhysics, HaltsAsManyDisksAsStepped) {
  expect_agreement("blocked_share", 0.3, Edge::wall);
  expect_agreement("blocked_share", 0.6, Edge::periodic);
  expect_agreement("collision_rate", 0.6, Edge::wall);
}

}  // namespace
}  // namespace gridlock
