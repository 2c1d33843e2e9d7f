// Disks that cannot pass one another in a channel, periodic along x and with walls along y, against the transfer
// matrix. Units: σ = m = kT = 1.
//
// Neighbours at heights y, y' in [0, h] are at least s = √(1 − (y − y')²) apart along x. With the force F along the
// channel the kernel e^(−F s) on [0, h] has the largest eigenvalue λ and the eigenvector ψ, normalised in the square;
// the length for each disk is L/N = 1/F + ⟨s⟩ = 1/F − d ln λ/dF, and the force of the disks on one wall N ψ(h)².
// Source: D. A. Kofke, A. J. Post, J. Chem. Phys. 98, 4853 (1993). A ring of N disks has N − 1 excess terms.

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <vector>

#include "gridlock/engine/engine.hpp"
#include "gridlock/grid/validate.hpp"
#include "gridlock/lattice/start.hpp"
#include "observe/pressure.hpp"
#include "reference/mean_and_error.hpp"
#include "unit/observe/hand_built.hpp"

namespace gridlock {
namespace {

using reference::Estimate;
using reference::mean_of;

constexpr double width_of_motion = 0.5;  // h

/// The eigenvector of the kernel at the wall, squared, and −d ln λ/dF: by the power method on a midpoint rule.
struct TransferMatrix {
  double mean_separation;
  double square_at_wall;
};
TransferMatrix transfer_matrix(double force) {
  // Two rules and their extrapolation: the midpoint rule errs by the square of its step.
  auto const with = [&](int points) {
    double const step = width_of_motion / points;
    auto const separation = [&](double a, double b) { return std::sqrt(1.0 - (a - b) * (a - b)); };
    std::vector<double> psi(static_cast<std::size_t>(points), 1.0);
    auto const applied_at = [&](double y, auto weight) {
      double sum = 0.0;
      for (int k = 0; k < points; ++k) {
        double const s = separation(y, (k + 0.5) * step);
        sum += weight(s) * std::exp(-force * s) * psi[static_cast<std::size_t>(k)] * step;
      }
      return sum;
    };
    auto const one = [](double) { return 1.0; };
    double eigenvalue = 0.0;
    for (int round = 0; round < 40; ++round) {
      std::vector<double> next;
      double square = 0.0;
      for (int k = 0; k < points; ++k) {
        next.push_back(applied_at((k + 0.5) * step, one));
        square += next.back() * next.back() * step;
      }
      eigenvalue = std::sqrt(square);
      for (double& value : next) value /= eigenvalue;
      psi = next;
    }
    double mean = 0.0;
    for (int k = 0; k < points; ++k) {
      mean += psi[static_cast<std::size_t>(k)] * applied_at((k + 0.5) * step, [](double s) { return s; }) * step;
    }
    double const at_wall = applied_at(width_of_motion, one) / eigenvalue;
    return TransferMatrix{mean / eigenvalue, at_wall * at_wall};
  };
  TransferMatrix const coarse = with(40);
  TransferMatrix const fine = with(80);
  auto const extrapolated = [](double at_step, double at_half) { return (4.0 * at_half - at_step) / 3.0; };
  return {extrapolated(coarse.mean_separation, fine.mean_separation),
          extrapolated(coarse.square_at_wall, fine.square_at_wall)};
}

TEST(TransferMatrix, HasTheNumbersOfAnIndependentQuadrature) {
  TransferMatrix const found = transfer_matrix(5.0);
  EXPECT_NEAR(1.0 / 5.0 + found.mean_separation, 1.1735442348, 1e-7);
  EXPECT_NEAR(found.square_at_wall, 2.54617162, 1e-5);
}

class SingleFile : public testing::TestWithParam<bool> {};
INSTANTIATE_TEST_SUITE_P(Channels, SingleFile, testing::Values(false, true), [](auto const& is_upright) {
  return is_upright.param ? std::string("upright") : std::string("lying");
});

TEST_P(SingleFile, PressesOnItsEndsAndWallsAsTheTransferMatrixHasIt) {
  constexpr std::size_t count = 200;
  constexpr double length = 1.17354423 * count;
  bool const is_upright = GetParam();
  State state{.box = is_upright ? Box(1.0 + width_of_motion, length, Edge::wall, Edge::periodic)
                                : Box(length, 1.0 + width_of_motion, Edge::periodic, Edge::wall),
              .seed = 3};
  for (std::size_t i = 0; i < count; ++i) {
    double const along = (static_cast<double>(i) + 0.5) * length / count;
    double const across = 0.5 + width_of_motion * (i % 2 == 0 ? 0.4 : 0.6);
    state.agents.add(is_upright ? across : along, is_upright ? along : across, 0.0, 0.0, 0.5, 1.0, 0, 0);
  }
  draw_velocities(state, {.kind = VelocityKind::maxwell, .max = 2.0});
  Vector const drift = momentum(state.agents);
  EXPECT_NEAR(is_upright ? drift.y : drift.x, 0.0, 1e-9) << "an automatic start has no drift along the channel";
  EXPECT_GT(std::abs(is_upright ? drift.x : drift.y), 0.1) << "and keeps that across, which walls reflect";
  // Momentum along the channel is conserved: K = (N − ½) kT.
  double const factor = std::sqrt((count - 0.5) / kinetic_energy(state.agents));
  for (double& v : state.agents.column<VelocityX>()) v *= factor;
  for (double& v : state.agents.column<VelocityY>()) v *= factor;

  auto const engine = make_engine({.kind = "exact", .threads = 1}, state);
  Counters counters;
  engine->advance(state, counters, {.time = 500.0});
  std::vector<double> force;
  std::vector<double> wall_force;
  std::vector<double> pressure_by_observable;
  Pressure pressure;
  pressure.begin({state, counters});
  for (int block = 0; block < 24; ++block) {
    Counters const before = counters;
    double const start = state.clock.time;
    engine->advance(state, counters, {.time = start + 250.0});
    double const time = state.clock.time - start;
    std::size_t const low = is_upright ? Counters::left : Counters::bottom;
    std::size_t const high = is_upright ? Counters::right : Counters::top;
    double const on_wall = 0.5 *
                           (counters.wall_impulse[low] - before.wall_impulse[low] + counters.wall_impulse[high] -
                            before.wall_impulse[high]) /
                           time;
    // The virial of both directions is L F − N kT along the channel and h F_wall − N kT across it.
    double const virial = (counters.pair_virial - before.pair_virial) / time;
    force.push_back((virial + 2.0 * count - width_of_motion * on_wall) / length);
    wall_force.push_back(on_wall / count);
    auto const row = hand_built::sample(pressure, state, counters);
    pressure_by_observable.push_back(hand_built::cell(pressure, row, "virial_pressure"));
    EXPECT_NEAR(hand_built::cell(pressure, row, "wall_pressure"), on_wall / length, 1e-9 * on_wall);
  }
  EXPECT_NO_THROW(validate(state));
  double const expected_force = 5.0 * (1.0 - 1.0 / count);
  double const expected_wall = 2.543;  // of this ring by an independent program; 2.5462 in the limit of many disks
  Estimate const found = mean_of(force);
  EXPECT_NEAR(found.value, expected_force, 0.02) << "± " << found.error;
  EXPECT_LT(found.error, 0.01) << "a bound of 0.02 must tell something";
  Estimate const walls = mean_of(wall_force);
  EXPECT_NEAR(walls.value, expected_wall, 4.0 * walls.error);
  EXPECT_LT(walls.error, 0.003);
  Estimate const observed = mean_of(pressure_by_observable);
  double const area = length * (1.0 + width_of_motion);
  EXPECT_NEAR(observed.value, (expected_force * length + width_of_motion * expected_wall * count) / (2.0 * area), 0.02);
}

}  // namespace
}  // namespace gridlock
