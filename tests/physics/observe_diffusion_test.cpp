// The mean squared displacement from many origins, and its slope, of Brownian disks: against exact statements, and
// against an independent program. Units: σ = m = kT = 1.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include "gridlock/engine/engine.hpp"
#include "gridlock/lattice/start.hpp"
#include "gridlock/observe/observable.hpp"

namespace gridlock {
namespace {

constexpr double kick_interval = 0.1;
constexpr double free_diffusion = 0.5 * kick_interval;  // D₀ = kT Δt / 2m

State maxwell_start(Box const& box, std::size_t count, double radius, std::uint64_t seed) {
  State state = make_start(box, {.count = count, .radius = radius}, seed);
  draw_velocities(state, {.kind = VelocityKind::maxwell, .max = 2.0});
  return state;
}

/// The observables that give a curve of displacements, and the run that they measure.
class DiffusionRun {
 public:
  /// `lag` and `origin_every` in samples, which are `sample_time` apart and begin with a kick.
  DiffusionRun(State start, std::uint64_t lag, std::uint64_t origin_every, double sample_time)
      : state_(std::move(start)), sample_time_(sample_time) {
    engine_ =
        make_engine({.kind = "exact",
                     .time_step = 1e6,
                     .threads = 1,
                     .thermostat = {.kind = ThermostatKind::brownian, .temperature = 1.0, .interval = kick_interval}},
                    state_);
    observables_ =
        make_observables({.structure_every = 0, .displacement_lag = lag, .displacement_origin_every = origin_every},
                         {state_, counters_});
    std::erase_if(observables_, [](auto const& observable) {
      auto const columns = observable->columns();
      return std::ranges::find(columns, "diffusion_coefficient", &ColumnInfo::name) == columns.end();
    });
  }
  void advance(std::size_t samples) {
    for (std::size_t k = 0; k < samples; ++k, ++sampled_) {
      engine_->advance(state_, counters_, {.time = static_cast<double>(sampled_) * sample_time_});
      std::vector<double> row(1);
      observables_.at(0)->sample({state_, counters_}, row, true);
    }
  }
  [[nodiscard]] Distribution curve() const { return observables_.at(0)->distributions().at(0); }
  [[nodiscard]] Estimate coefficient() const { return observables_.at(0)->results().at(0).estimate; }
  [[nodiscard]] Counters const& counters() const { return counters_; }

 private:
  State state_;
  double sample_time_;
  Counters counters_;
  std::unique_ptr<Engine> engine_;
  std::vector<std::unique_ptr<Observable>> observables_;
  std::size_t sampled_ = 0;
};

TEST(DisplacementCurveOfFreeBrownianDisks, IsFourTimesD0TimesTheLagAtMultiplesOfTheInterval) {
  constexpr std::size_t count = 2000;
  // Disks so small that none meets another.
  DiffusionRun run(maxwell_start(Box(120.0, 100.0, Edge::periodic), count, 1e-7, 4), 30, 10, kick_interval);
  run.advance(1201);
  EXPECT_EQ(run.counters().pair_collisions, 0U);
  auto const columns = run.curve().columns_of_values;
  ASSERT_GT(columns[0].size(), 15U);
  for (std::size_t k = 0; k < columns[0].size(); ++k) {
    double const expected = 4.0 * free_diffusion * columns[0][k];
    EXPECT_NEAR(columns[1][k], expected, 4.0 * columns[2][k]) << "lag " << columns[0][k];
    // Squared displacements are exponential: N disks and one origin in every longest lag bound the error from above.
    EXPECT_LT(columns[2][k], 2.0 * expected / std::sqrt(count * 1200.0 / 30.0)) << "lag " << columns[0][k];
  }
  Estimate const found = run.coefficient();
  EXPECT_NEAR(found.value, free_diffusion, 4.0 * *found.error);
  EXPECT_LT(*found.error, 0.01 * free_diffusion);
}

struct DiffusingFluid {
  double packing_fraction;
  double diffusion;  ///< D(2 … 6)/D₀ at an interval of 0.1, computed by an independent program
  double error;
};

class DiffusionCoefficient : public testing::TestWithParam<DiffusingFluid> {};

/// The window of the coefficient is that of lags from 2 to 6 σ²/D₀ where the longest lag is 6.
TEST_P(DiffusionCoefficient, OfBrownianDisksIsThatOfAnIndependentProgram) {
  DiffusingFluid const expected = GetParam();
  constexpr std::size_t count = 256;
  double const area = static_cast<double>(count) * std::numbers::pi / 4.0 / expected.packing_fraction;
  State start = maxwell_start(Box(std::sqrt(area), std::sqrt(area), Edge::periodic), count, 0.5, 7);
  Counters equilibration;
  make_engine({.kind = "exact", .threads = 1}, start)->advance(start, equilibration, {.pair_collisions = 40 * count});
  start.clock = {};
  double const unit = 1.0 / free_diffusion;  // σ²/D₀
  DiffusionRun run(std::move(start), 24, 4, unit / 4.0);
  run.advance(4 * 150 + 1);
  Estimate const found = run.coefficient();
  double const value = found.value / free_diffusion;
  double const error = *found.error / free_diffusion;
  EXPECT_LT(error, 0.025);
  EXPECT_NEAR(value, expected.diffusion, 4.0 * std::hypot(error, expected.error));
}

INSTANTIATE_TEST_SUITE_P(PackingFractions, DiffusionCoefficient,
                         testing::Values(DiffusingFluid{0.1, 0.8136, 0.0042}, DiffusingFluid{0.3, 0.5474, 0.0027},
                                         DiffusingFluid{0.5, 0.3294, 0.0023}),
                         [](auto const& fluid) {
                           return "phi" + std::to_string(std::lround(100.0 * fluid.param.packing_fraction));
                         });

}  // namespace
}  // namespace gridlock
