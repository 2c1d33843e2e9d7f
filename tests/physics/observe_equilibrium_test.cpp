// What is known exactly of hard disks in equilibrium, measured with the observables on the engine "stepped".

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "gridlock/lattice/start.hpp"
#include "gridlock/observe/estimate.hpp"
#include "gridlock/observe/observable.hpp"
#include "unit/observe/hand_built.hpp"

namespace gridlock {
namespace {

using hand_built::cell;
using hand_built::result;
using hand_built::sample;

struct Fluid {
  Edge edge = Edge::wall;
  std::uint64_t count = 400;
  double packing_fraction = 0.3;
  EngineSettings engine;
  ObserveSettings observe;
};

/// A fluid under its observables from the paper's start: a square lattice, velocities uniform in a disk of radius 1.
class MeasuredFluid {
 public:
  MeasuredFluid(Fluid const& fluid, std::uint64_t seed)
      : state(make_start(Box(1, 1, fluid.edge), {.count = fluid.count, .packing_fraction = fluid.packing_fraction},
                         seed)) {
    draw_velocities(state, {});
    engine_ = make_engine(fluid.engine, state);
    observables = make_observables(fluid.observe, {state, counters});
  }

  void advance(std::uint64_t steps) { engine_->advance(state, counters, {.step = state.clock.step + steps}); }
  void measure(bool counts_for_average = true) {
    for (auto const& observable : observables) sample(*observable, state, counters, counts_for_average);
  }
  [[nodiscard]] Estimate estimate(std::string const& name) const {
    for (auto const& observable : observables) {
      if (auto const found = result(*observable, name)) return *found;
    }
    ADD_FAILURE() << name << " was not measured";
    return {};
  }
  [[nodiscard]] double diameter() const { return 2.0 * state.agents.column<Radius>()[0]; }

  State state;
  Counters counters;
  std::vector<std::unique_ptr<Observable>> observables;

 private:
  std::unique_ptr<Engine> engine_;
};

void expect_within_errors(Estimate const& estimate, double expected, std::string const& what) {
  ASSERT_TRUE(estimate.error) << what;
  EXPECT_NEAR(estimate.value, expected, 4.0 * *estimate.error) << what;
}

TEST(PaperStart, HasTheMomentsOfVelocitiesUniformInADisk) {
  // With s = v²/v₀² uniform on [0, 1]: ⟨v⟩ = 2/3 with variance 1/18, kT/m = ⟨v²⟩/2 = 1/4 with ⟨v²⟩ of variance 1/12,
  // and ⟨v⁴⟩/⟨v²⟩² = 4/3. The ratio's relative variance per disk: s² and 2s together, var(s²/(1/3) − 2 s/(1/2)) =
  // 9·(4/45) + 16/12 − 24·(1/12) = 2/15.
  constexpr double n = 2500;
  MeasuredFluid run({.count = 2500}, 1);
  run.measure();
  EXPECT_NEAR(run.estimate("mean_speed").value, 2.0 / 3.0, 4.0 * std::sqrt(1.0 / 18.0 / n));
  EXPECT_NEAR(run.estimate("kinetic_energy").value / n, 0.25, 4.0 * std::sqrt(1.0 / 12.0 / n) / 2.0);
  EXPECT_NEAR(run.estimate("speed_moment_ratio").value, 4.0 / 3.0, 4.0 * 4.0 / 3.0 * std::sqrt(2.0 / 15.0 / n));
}

TEST(PaperStart, RelaxesToMaxwellsMomentsAtTheSameEnergy) {
  // N disks between walls that share an energy K fill the sphere Σv² = 2K in 2N dimensions evenly: the energy of one is
  // K times a Beta(1, N − 1) number, so ⟨v⟩ = √(2K) (√π/2) Γ(N)/Γ(N + ½) and ⟨v⁴⟩/⟨v²⟩² = 2N/(N + 1); for N → ∞
  // √(π/8) v₀ and 2. A short time step, since the rule itself shifts the moments by a fraction of a percent at 0.1.
  constexpr double n = 400;
  MeasuredFluid run({.engine = {.time_step = 0.02}}, 1);
  run.advance(2000);
  for (int k = 0; k < 160; ++k) {
    run.advance(50);
    run.measure();
  }
  double const energy = kinetic_energy(run.state.agents);
  EXPECT_NEAR(energy / n, 0.25, 4.0 * std::sqrt(1.0 / 12.0 / n) / 2.0);
  double const mean_speed =
      std::sqrt(2.0 * energy) * 0.5 * std::sqrt(std::numbers::pi) * std::exp(std::lgamma(n) - std::lgamma(n + 0.5));
  expect_within_errors(run.estimate("mean_speed"), mean_speed, "mean speed");
  expect_within_errors(run.estimate("speed_moment_ratio"), 2.0 * n / (n + 1.0), "moment ratio");
  // The errors are small enough to tell Maxwell from the start: 2/3 against 0.6267 and 4/3 against 2.
  EXPECT_LT(*run.estimate("mean_speed").error, 0.002);
  EXPECT_LT(*run.estimate("speed_moment_ratio").error, 0.03);
  EXPECT_LT(std::abs(run.estimate("kinetic_energy_drift").value), 1e-12);
}

TEST(HardDiskFluid, PressureFromVirialAndFromCollisionRateAreThatOfTheVirialSeries) {
  // η = 0.3: Z = 2.063261 and Γσ/√(kT/m) = 2.399523 (Kolafa & Rottner 2006 and Z = 1 + (σ/4)√(πm/kT) Γ), for disks
  // that approach and a short time step. Three seeds, each within its own errors.
  for (std::uint64_t const seed : {1U, 2U, 3U}) {
    MeasuredFluid run({.edge = Edge::periodic, .engine = {.time_step = 0.02, .contact = CollisionRule::approaching}},
                      seed);
    run.advance(1000);
    for (int k = 0; k < 64; ++k) {
      run.advance(100);
      run.measure();
    }
    double const kt = kinetic_energy(run.state.agents) / 399.0;  // at rest as a whole
    Estimate const z = run.estimate("compressibility_factor");
    Estimate rate = run.estimate("collision_rate");
    expect_within_errors(z, 2.063261, "Z");
    rate.value *= run.diameter() / std::sqrt(kt);
    *rate.error *= run.diameter() / std::sqrt(kt);
    expect_within_errors(rate, 2.399523, "collision rate");
    EXPECT_LT(*z.error, 0.015);
    EXPECT_NEAR(run.estimate("virial_pressure").value, z.value * 400.0 * kt, 1e-9 * z.value * 400.0 * kt);
  }
}

/// Σ w x^p over the points of a weighted fit.
double moment(std::vector<Vector> const& points, std::vector<double> const& weights, int power, bool of_y = false) {
  double sum = 0.0;
  for (std::size_t k = 0; k < points.size(); ++k) {
    sum += weights[k] * std::pow(points[k].x, power) * (of_y ? points[k].y : 1.0);
  }
  return sum;
}

/// The value at x = 0 of the parabola fitted to points by weighted least squares, weights 1/error².
Estimate parabola_at_zero(std::vector<Vector> const& points, std::vector<double> const& weights) {
  double m[5];
  double s[3];
  for (int power = 0; power < 5; ++power) m[power] = moment(points, weights, power);
  for (int power = 0; power < 3; ++power) s[power] = moment(points, weights, power, true);
  // Cramer's rule for the first coefficient; its variance is the first element of the inverse matrix.
  double const minor = m[2] * m[4] - m[3] * m[3];
  double const determinant = m[0] * minor - m[1] * (m[1] * m[4] - m[2] * m[3]) + m[2] * (m[1] * m[3] - m[2] * m[2]);
  double const numerator = s[0] * minor - m[1] * (s[1] * m[4] - m[3] * s[2]) + m[2] * (s[1] * m[3] - m[2] * s[2]);
  return {numerator / determinant, std::sqrt(minor / determinant)};
}

TEST(HardDiskFluid, PairCorrelationVanishesInsideTheDiameterAndGivesThePressureAtContact) {
  // g(σ) = (Z − 1)/2η = 1.772101 at η = 0.3, by extrapolation from 1.06 σ to 1.44 σ. Nearer than the way of one step
  // the stepped rule keeps disks apart: a disk that halts stays where it is until its next turn.
  Fluid const fluid{.edge = Edge::periodic,
                    .engine = {.time_step = 0.02, .contact = CollisionRule::approaching},
                    .observe = {.structure_every = 1, .pair_correlation_range = 2.0, .pair_correlation_bins = 100}};
  MeasuredFluid run(fluid, 1);
  run.advance(1000);
  for (int k = 0; k < 400; ++k) {
    run.advance(30);
    run.measure();
  }
  std::vector<Vector> points;
  std::vector<double> weights;
  for (auto const& observable : run.observables) {
    for (Distribution const& distribution : observable->distributions()) {
      if (distribution.name != "pair_correlation") continue;
      auto const& values = distribution.columns_of_values;
      for (std::size_t b = 0; b < values[0].size(); ++b) {
        double const x = values[0][b] / run.diameter() - 1.0;
        EXPECT_TRUE(x > 0.0 || values[1][b] == 0.0) << "a pair nearer than its diameter";
        if (x < 0.06 || x > 0.44) continue;
        points.push_back({x, values[1][b]});
        weights.push_back(1.0 / (values[2][b] * values[2][b]));
      }
    }
  }
  ASSERT_EQ(points.size(), 19U);
  Estimate const contact = parabola_at_zero(points, weights);
  expect_within_errors(contact, 1.772101, "contact value");
  EXPECT_LT(*contact.error, 0.03);
}

/// The mean distance of a point of the lattice to a point uniform in [R, 1 − R]², by the midpoint rule.
double mean_distance_from(std::vector<Vector> const& sites, double radius) {
  constexpr int points = 100;
  double sum = 0.0;
  for (Vector const site : sites) {
    for (int i = 0; i < points; ++i) {
      for (int j = 0; j < points; ++j) {
        double const x = radius + (1.0 - 2.0 * radius) * (i + 0.5) / points;
        double const y = radius + (1.0 - 2.0 * radius) * (j + 0.5) / points;
        sum += std::hypot(x - site.x, y - site.y);
      }
    }
  }
  return sum / (points * points * static_cast<double>(sites.size()));
}

TEST(MeanDisplacement, OfAGasBetweenWallsEndsAtTheMeanDistanceFromTheLatticeToARandomPoint) {
  // φ = 0.05: the density is uniform but for a layer of one diameter at the walls, which moves the mean by less than
  // 0.001. The whole box is forgotten after L²/(π²D) = 1.6 time units or 500 steps, so 20,000 steps are left out.
  Fluid const fluid{.count = 64, .packing_fraction = 0.05, .observe = {.structure_every = 0}};
  MeasuredFluid run(fluid, 1);
  std::vector<Vector> sites;
  for (std::size_t i = 0; i < 64; ++i) sites.push_back(position(run.state.agents, i));
  double const expected = mean_distance_from(sites, 0.5 * run.diameter());
  EXPECT_NEAR(expected, 0.52, 0.01) << "near the mean distance of two random points, 0.5214";
  run.advance(20'000);
  BlockAverage plateau;
  for (int k = 0; k < 1600; ++k) {
    run.advance(50);
    plateau.add(cell(*run.observables[0], sample(*run.observables[0], run.state, run.counters), "mean_displacement"));
  }
  expect_within_errors(*plateau.estimate(), expected, "plateau");
  EXPECT_LT(*plateau.estimate()->error, 0.005);
}

}  // namespace
}  // namespace gridlock
