// The exact engine against numbers with a source: exact small systems, virial coefficients, published pressures.

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "gridlock/core/random.hpp"
#include "gridlock/engine/engine.hpp"
#include "reference/mean_and_error.hpp"
#include "reference/random_scene.hpp"
#include "reference/unwrapped.hpp"

namespace gridlock {
namespace {

using reference::Estimate;
using reference::mean_of;
using reference::mean_squared_displacement;
using reference::unwrapped;

constexpr double pi = std::numbers::pi;

/// Equal disks of diameter 1 on a stretched triangular lattice of rows × columns sites in a periodic square, with
/// Maxwell velocities of zero sum.
State fluid(std::uint64_t columns, std::uint64_t rows, double packing_fraction, std::uint64_t seed) {
  std::uint64_t const count = columns * rows;
  double const side = std::sqrt(static_cast<double>(count) * pi / 4.0 / packing_fraction);
  State state{.box = Box(side, side, Edge::periodic), .seed = seed};
  Vector sum;
  for (std::uint64_t i = 0; i < count; ++i) {
    std::uint64_t const row = i / columns;
    double const x =
        (static_cast<double>(i % columns) + (row % 2 == 0 ? 0.25 : 0.75)) * side / static_cast<double>(columns);
    double const y = (static_cast<double>(row) + 0.5) * side / static_cast<double>(rows);
    RandomStream random(seed, 0, i, Purpose::start_velocity);
    Vector const v{random.normal(), random.normal()};
    sum = sum + v;
    state.agents.add(x, y, v.x, v.y, 0.5, 1.0, 0, 0);
  }
  for (std::uint64_t i = 0; i < count; ++i) {
    state.agents.column<VelocityX>()[i] -= sum.x / static_cast<double>(count);
    state.agents.column<VelocityY>()[i] -= sum.y / static_cast<double>(count);
  }
  return state;
}

/// Equal disks of diameter 1 on a square lattice of a spacing between walls, with Maxwell velocities.
State maxwellian_between_walls(std::uint64_t columns, std::uint64_t rows, double spacing) {
  State state{.box = Box(static_cast<double>(columns) * spacing, static_cast<double>(rows) * spacing, Edge::wall)};
  for (std::uint64_t i = 0; i < columns * rows; ++i) {
    RandomStream random(13, 0, i, Purpose::start_velocity);
    state.agents.add((static_cast<double>(i % columns) + 0.5) * spacing,
                     (static_cast<double>(i / columns) + 0.5) * spacing, random.normal(), random.normal(), 0.5, 1.0, 0,
                     0);
  }
  return state;
}

/// kT of a periodic system at rest as a whole: K/(N − 1) in two dimensions with the momentum taken out.
double temperature(State const& state) {
  return kinetic_energy(state.agents) / static_cast<double>(state.agents.size() - 1);
}

struct Pressures {
  Estimate from_impulses;  ///< Z = 1 + Σ σ m|v_n| / (2 N kT t)
  Estimate from_rate;      ///< Z = 1 + (σ/4) √(π m/kT) Γ, Γ collisions per disk and time
};

Pressures measure(State& state, double equilibration, double block, int blocks) {
  auto const engine = make_engine({.kind = "exact"}, state);
  Counters counters;
  engine->advance(state, counters, {.time = equilibration});
  auto const n = static_cast<double>(state.agents.size());
  double const kt = temperature(state);
  std::vector<double> impulses;
  std::vector<double> rates;
  for (int b = 1; b <= blocks; ++b) {
    Counters const before = counters;
    engine->advance(state, counters, {.time = equilibration + b * block});
    impulses.push_back(1.0 + (counters.pair_virial - before.pair_virial) / (2.0 * n * kt * block));
    double const rate = 2.0 * static_cast<double>(counters.pair_collisions - before.pair_collisions) / (n * block);
    // Of velocities with fixed energy and momentum the mean relative speed is that of Maxwell's to order 1/N².
    rates.push_back(1.0 + 0.25 * std::sqrt(pi / kt) * rate);
  }
  return {mean_of(impulses), mean_of(rates)};
}

struct FluidCase {
  double packing_fraction;
  double compressibility;  // Kolafa & Rottner 2006, Mol. Phys. 104, 3435: good to 1e-5 here
};

class Fluid : public testing::TestWithParam<FluidCase> {};

INSTANTIATE_TEST_SUITE_P(Densities, Fluid,
                         testing::Values(FluidCase{0.05, 1.108388}, FluidCase{0.10, 1.236144},
                                         FluidCase{0.20, 1.570366}, FluidCase{0.30, 2.063261},
                                         FluidCase{0.40, 2.829331}, FluidCase{0.50, 4.106364},
                                         FluidCase{0.60, 6.455337}, FluidCase{0.65, 8.408044}));

TEST_P(Fluid, HasThePublishedPressureFromImpulsesAndFromTheCollisionRate) {
  auto const [packing_fraction, expected] = GetParam();
  State state = fluid(44, 46, packing_fraction, 7);
  Pressures const z = measure(state, 20.0 + 1.0 / packing_fraction, 8.0, 25);
  // A box of 2024 disks is not infinite: what is left is of the order Z/N, far below the error wanted here.
  double const finite_size = 2.0 * expected / 2024.0;
  EXPECT_LT(z.from_impulses.error, 2e-3 * expected);
  EXPECT_NEAR(z.from_impulses.value, expected, 3.5 * z.from_impulses.error + finite_size);
  EXPECT_NEAR(z.from_rate.value, expected, 3.5 * z.from_rate.error + finite_size);
}

// The pressure of a fluid knows nothing of where the images above lie.
TEST(ExactPhysics, AFluidInAnObliqueBoxHasThePressureOfTheRectangle) {
  for (double const packing_fraction : {0.3, 0.6}) {
    State rectangle = fluid(16, 16, packing_fraction, 3);
    State oblique = fluid(16, 16, packing_fraction, 4);
    Pressures const expected = measure(rectangle, 10.0, 8.0, 25);
    // The rows of the start are farther apart than a diameter, so that shifted ones do not overlap.
    oblique.box = oblique.box.tilted(0.37);
    Pressures const found = measure(oblique, 10.0, 8.0, 25);
    double const error = std::hypot(expected.from_impulses.error, found.from_impulses.error);
    EXPECT_LT(error, 5e-3 * expected.from_impulses.value);
    EXPECT_NEAR(found.from_impulses.value, expected.from_impulses.value, 3.5 * error);
    EXPECT_NEAR(found.from_rate.value, expected.from_rate.value,
                3.5 * std::hypot(expected.from_rate.error, found.from_rate.error));
  }
}

// N = 72, periodic square box, Li et al. 2022: P* = βPσ² = Z · 4η/π. A longer run of the same is in the validation.
TEST(ExactPhysics, SeventyTwoDisksHaveThePublishedPressure) {
  struct Published {
    double packing_fraction;
    double pressure;
  };
  for (auto const& [packing_fraction, pressure] : {Published{0.65, 6.901074}, Published{0.68, 8.23631}}) {
    State state = fluid(8, 9, packing_fraction, 3);
    Pressures const z = measure(state, 200.0, 150.0, 40);
    double const to_pressure = 4.0 * packing_fraction / pi;
    EXPECT_LT(z.from_impulses.error * to_pressure, 3e-3 * pressure);
    EXPECT_NEAR(z.from_impulses.value * to_pressure, pressure, 3.0 * z.from_impulses.error * to_pressure);
  }
}

// Two centres in a hard square box have the configuration integral, with a = L − 2R, d = 2R and R ≤ L/4,
//   Q = a⁴ − π d² a² + (8/3) a d³ − d⁴/2,   and   P = (K/N) (∂Q/∂a)/(2 L Q),   ∂Q/∂a = 4a³ − 2πd²a + (8/3)d³.
TEST(ExactPhysics, TwoDisksInAHardSquareBoxPressOnItsWallsAsTheirFreeAreaSays) {
  for (double const r : {0.05, 0.10, 0.15, 0.20}) {
    double const a = 1.0 - 2.0 * r;
    double const d = 2.0 * r;
    double const q = a * a * a * a - pi * d * d * a * a + 8.0 / 3.0 * a * d * d * d - d * d * d * d / 2.0;
    double const expected = (4.0 * a * a * a - 2.0 * pi * d * d * a + 8.0 / 3.0 * d * d * d) / (2.0 * q);
    State state{.box = Box(1.0, 1.0, Edge::wall)};
    // K/N = 1: ½ Σ v² = 2.
    state.agents.add(0.3, 0.31, 1.3, 0.4, r, 1.0, 0, 0);
    double const rest = std::sqrt(4.0 - 1.3 * 1.3 - 0.4 * 0.4);
    state.agents.add(0.72, 0.7, 0.6 * rest, -0.8 * rest, r, 1.0, 0, 0);
    auto const engine = make_engine({.kind = "exact"}, state);
    Counters counters;
    std::vector<double> pressures;
    double const block = 1000.0;
    for (int b = 1; b <= 100; ++b) {
      Counters const before = counters;
      engine->advance(state, counters, {.time = b * block});
      double impulse = 0.0;
      for (std::size_t wall = 0; wall < 4; ++wall) impulse += counters.wall_impulse[wall] - before.wall_impulse[wall];
      pressures.push_back(impulse / (4.0 * block));  // kT = K/N = 1
    }
    Estimate const pressure = mean_of(pressures);
    EXPECT_LT(pressure.error, 0.003 * expected);
    EXPECT_NEAR(pressure.value, expected, 3.5 * pressure.error) << "R = " << r;
    if (r == 0.15) {
      double const time = 100 * block;
      EXPECT_NEAR(static_cast<double>(counters.all_wall_hits()) / time, 6.0154, 0.03);
      EXPECT_NEAR(static_cast<double>(counters.pair_collisions) / time, 1.9220, 0.02);
    }
  }
}

// Clausius: the change of Σ m r·v over a run is 2K t plus the virial of all impulses. With r from the centre of the box
// a wall gives −(side/2 − R) |Δp|, a pair +Σ σ m|v_n|, on one and the same trajectory and for any number of disks:
//   Σ m r·v |end − start = 2 K t − Σ_walls (side/2 − R)|Δp| + Σ_pairs.
TEST(ExactPhysics, WallsAndPairsBalanceTheKineticEnergyInTheVirial) {
  for (std::uint64_t const seed : {1, 2, 3}) {
    State state = reference::random_scene(
        {.width = 1.5, .height = 0.8, .count = 60, .packing_fraction = 0.5, .heaviest_mass = 4.0, .seed = seed});
    auto const virial = [&] {
      double sum = 0.0;
      for (std::size_t i = 0; i < state.agents.size(); ++i) {
        Vector const r = position(state.agents, i) - Vector{0.75, 0.4};
        sum += state.agents.column<Mass>()[i] * dot(r, velocity(state.agents, i));
      }
      return sum;
    };
    double const start = virial();
    double const radius = radius_range(state.agents).largest;  // all are equal
    Counters counters;
    make_engine({.kind = "exact"}, state)->advance(state, counters, {.time = 20.0});
    double const flight = 2.0 * kinetic_energy(state.agents) * state.clock.time;
    double const walls =
        (0.75 - radius) * (counters.wall_impulse[Counters::left] + counters.wall_impulse[Counters::right]) +
        (0.4 - radius) * (counters.wall_impulse[Counters::bottom] + counters.wall_impulse[Counters::top]);
    EXPECT_NEAR((virial() - start + walls - counters.pair_virial) / flight, 1.0, 1e-10);
    EXPECT_GT(counters.pair_virial, 0.1 * flight);
    EXPECT_GT(walls, 0.1 * flight);
  }
}

// The start of the paper, uniform in a disk of radius v₀: ⟨v²⟩ = v₀²/2 stays, and the rest becomes Maxwell's,
// ⟨|v|⟩ = √(π kT/2m) with kT/m = v₀²/4, ⟨v⁴⟩/⟨v²⟩² = 2.
TEST(ExactPhysics, TheStartOfThePaperRelaxesToMaxwellsMoments) {
  State state = fluid(44, 46, 0.5, 5);
  for (std::size_t i = 0; i < state.agents.size(); ++i) {
    RandomStream random(5, 0, i, Purpose::start_velocity);
    Vector const v = random.in_unit_disk();
    state.agents.column<VelocityX>()[i] = v.x;
    state.agents.column<VelocityY>()[i] = v.y;
  }
  auto const engine = make_engine({.kind = "exact"}, state);
  Counters counters;
  std::vector<double> speeds;
  std::vector<double> fourths;
  auto const n = static_cast<double>(state.agents.size());
  double const mean_square = 2.0 * kinetic_energy(state.agents) / n;
  for (int b = 1; b <= 60; ++b) {
    engine->advance(state, counters, {.time = 20.0 + b});
    double speed = 0.0;
    double fourth = 0.0;
    for (std::size_t i = 0; i < state.agents.size(); ++i) {
      double const square = squared_length(velocity(state.agents, i));
      speed += std::sqrt(square) / n;
      fourth += square * square / n;
    }
    speeds.push_back(speed);
    fourths.push_back(fourth / (mean_square * mean_square));
  }
  Estimate const speed = mean_of(speeds);
  Estimate const fourth = mean_of(fourths);
  EXPECT_NEAR(speed.value, std::sqrt(pi / 4.0 * mean_square), 3.5 * speed.error);
  // At a fixed sum of squares the ratio is 2 N/(N + 1).
  EXPECT_NEAR(fourth.value, 2.0 * n / (n + 1.0), 3.5 * fourth.error);
  EXPECT_LT(fourth.error, 0.01);
}

// Each halt costs the stepped rule up to one time step of flight: a difference of first order in the time step, as long
// as chaos has not multiplied it.
TEST(ExactPhysics, TheSteppedRuleConvergesToItWithTheFirstPowerOfTheTimeStep) {
  State const start = fluid(20, 20, 0.4, 1);
  State exact = start;
  Counters counters;
  make_engine({.kind = "exact"}, exact)->advance(exact, counters, {.time = 0.2});
  EXPECT_GT(counters.pair_collisions, 30U);
  auto const difference = [&](double time_step) {
    State stepped = start;
    Counters unused;
    EngineSettings const settings{
        .kind = "stepped", .time_step = time_step, .speed = 1.0, .contact = CollisionRule::approaching};
    auto const steps = static_cast<std::uint64_t>(std::llround(0.2 / time_step));
    make_engine(settings, stepped)->advance(stepped, unused, {.step = steps});
    double sum = 0.0;
    for (std::size_t i = 0; i < start.agents.size(); ++i) {
      sum += squared_length(start.box.displacement(position(exact.agents, i), position(stepped.agents, i)));
    }
    return std::sqrt(sum / static_cast<double>(start.agents.size()));
  };
  double const order = std::log2(difference(0.0125) / difference(0.0125 / 64.0)) / 6.0;
  EXPECT_NEAR(order, 1.0, 0.1);
}

// A wall keeps the centres away and orders the disks beside it. To first order in the diameter over the side, at the
// mean density N/A of the box, scaled particle theory gives  β P_wall = ρ [Z + (2R/L) (1 + η)/(1 − η)²].
TEST(ExactPhysics, WallsArePressedByTheBulkAndByWhatTheyKeepOut) {
  struct Case {
    double packing_fraction;
    double compressibility;  // as in Fluid
  };
  for (auto const& [packing_fraction, compressibility] :
       {Case{0.10, 1.236144}, Case{0.30, 2.063261}, Case{0.50, 4.106364}}) {
    std::uint64_t const count = 256;
    State state = maxwellian_between_walls(16, 16, std::sqrt(pi / 4.0 / packing_fraction));
    double const side = state.box.width();
    auto const engine = make_engine({.kind = "exact"}, state);
    Counters counters;
    std::vector<double> pressures;
    double const kt = kinetic_energy(state.agents) / static_cast<double>(count);
    double const block = 30.0 / packing_fraction;
    for (int b = 0; b <= 40; ++b) {
      Counters const before = counters;
      engine->advance(state, counters, {.time = block * (b + 1)});
      double impulse = 0.0;
      for (std::size_t wall = 0; wall < 4; ++wall) impulse += counters.wall_impulse[wall] - before.wall_impulse[wall];
      if (b > 0) pressures.push_back(impulse / (4.0 * side * block * kt));
    }
    Estimate const pressure = mean_of(pressures);
    double const density = static_cast<double>(count) / (side * side);
    double const kept_out = (1.0 + packing_fraction) / ((1.0 - packing_fraction) * (1.0 - packing_fraction)) / side;
    double const next_order = kept_out * kept_out;
    EXPECT_LT(pressure.error, 0.2 * density * kept_out) << "cannot tell the wall from the bulk";
    EXPECT_NEAR(pressure.value, density * (compressibility + kept_out), 3.5 * pressure.error + density * next_order)
        << "η = " << packing_fraction;
  }
}

// Disks of diameter 1 in a channel their centres are free over a width ε < √3/2 of: they cannot pass one another, and
// the length for each at a longitudinal force F is that of a chain of neighbours, from the largest eigenvalue of its
// transfer operator (D. A. Kofke & A. J. Post 1993, doi:10.1063/1.464967), computed once. The ends change F by a part
// in N.
struct ChannelCase {
  double width;
  double force;  // β F
  double length;
};

class Channel : public testing::TestWithParam<ChannelCase> {};

INSTANTIATE_TEST_SUITE_P(WidthsAndForces, Channel,
                         testing::Values(ChannelCase{0.3, 1.0, 1.99232529}, ChannelCase{0.5, 1.0, 1.97772573},
                                         ChannelCase{0.8, 1.0, 1.93511282}, ChannelCase{0.3, 5.0, 1.19187848},
                                         ChannelCase{0.5, 5.0, 1.17354423}, ChannelCase{0.8, 5.0, 1.08429674}));

TEST_P(Channel, OfDisksInASingleFilePressesOnItsEndsAsTheTransferOperatorSays) {
  auto const [width, force, length] = GetParam();
  std::uint64_t const count = 200;
  State state{.box = Box(static_cast<double>(count) * length, 1.0 + width, Edge::wall)};
  for (std::uint64_t i = 0; i < count; ++i) {
    RandomStream random(11, 0, i, Purpose::start_velocity);
    double const y = 0.5 + (i % 2 == 0 ? 0.001 : 0.999) * width;
    state.agents.add((static_cast<double>(i) + 0.5) * length, y, random.normal(), random.normal(), 0.5, 1.0, 0, 0);
  }
  double const kt = kinetic_energy(state.agents) / static_cast<double>(count);
  auto const engine = make_engine({.kind = "exact"}, state);
  Counters counters;
  std::vector<double> forces;
  double const block = 300.0;
  for (int b = 0; b <= 30; ++b) {
    Counters const before = counters;
    engine->advance(state, counters, {.time = 400.0 + b * block});
    double const impulse = counters.wall_impulse[Counters::left] + counters.wall_impulse[Counters::right] -
                           before.wall_impulse[Counters::left] - before.wall_impulse[Counters::right];
    if (b > 0) forces.push_back(impulse / (2.0 * block * kt));
  }
  Estimate const measured = mean_of(forces);
  EXPECT_LT(measured.error, 0.015 * force);
  EXPECT_NEAR(measured.value, force, 3.5 * measured.error + force / static_cast<double>(count));
}

// Dilute disks: D = 1.0274(8) kT/(m Γ) with Γ the collisions per disk and time. From the mean-squared displacement
// between 10 and 20 mean free times, where the velocities have long forgotten their start.
TEST(ExactPhysics, DiluteDisksDiffuseAsKineticTheorySays) {
  State state = fluid(64, 64, 0.005, 9);
  auto const engine = make_engine({.kind = "exact"}, state);
  Counters counters;
  double const free_time = 1.0 / (2.0 * 4.0 * 0.005 / pi * std::sqrt(pi) * 1.0079);  // 1/Γ, g(σ) to first order in η
  engine->advance(state, counters, {.time = 20.0 * free_time});
  auto const n = static_cast<double>(state.agents.size());
  std::vector<double> constants;
  for (int b = 0; b < 20; ++b) {
    double const begin = state.clock.time;
    std::uint64_t const before = counters.pair_collisions;
    std::vector<Vector> const origin = unwrapped(state);
    engine->advance(state, counters, {.time = begin + 10.0 * free_time});
    double const early = mean_squared_displacement(origin, unwrapped(state));
    engine->advance(state, counters, {.time = begin + 20.0 * free_time});
    double const diffusion = (mean_squared_displacement(origin, unwrapped(state)) - early) / (4.0 * 10.0 * free_time);
    double const rate = 2.0 * static_cast<double>(counters.pair_collisions - before) / (n * 20.0 * free_time);
    constants.push_back(diffusion * rate / temperature(state));
  }
  Estimate const constant = mean_of(constants);
  EXPECT_LT(constant.error, 0.02);
  EXPECT_NEAR(constant.value, 1.0274, 3.0 * constant.error);
}

}  // namespace
}  // namespace gridlock
