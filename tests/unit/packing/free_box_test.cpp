// Minima over the shape of the box: their forces, stability, bits, and images.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "gridlock/core/error.hpp"
#include "gridlock/packing/elasticity.hpp"
#include "gridlock/packing/pressure_ramp.hpp"
#include "io/checkpoint.hpp"
#include "packing/site_forces.hpp"
#include "protocol/stage.hpp"
#include "reference/random_packing.hpp"

namespace gridlock {
namespace {

using reference::random_packing;

MinimizerSettings free_box(std::uint64_t threads = 1) { return {.box_shape = BoxShape::free, .threads = threads}; }

Packing minimum_of(MinimizerSettings const& settings, Packing const& start) {
  Minimizer minimizer(settings, start);
  minimizer.advance();
  EXPECT_EQ(minimizer.status(), MinimumStatus::converged);
  return minimizer.packing();
}

/// Returns the packing with one coordinate of a site changed: first those along x of all sites, then those along y.
Packing displaced(SiteForces const& forces, Packing packing, std::size_t coordinate, double by) {
  Columns step(forces.sites());
  (coordinate < forces.sites() ? step.x[coordinate] : step.y[coordinate - forces.sites()]) = by;
  forces.displace(packing, step, 1.0);
  return packing;
}

TEST(FreeBox, IsPushedByTheSlopeOfTheEnergy) {
  Packing packing = random_packing(32, 0.9, 4);
  packing.box = packing.box.tilted(0.2);
  SiteForces forces(packing, free_box());
  Columns const at_rest(forces.sites());
  Columns force(forces.sites());
  forces.evaluate(packing, at_rest, force);
  for (std::size_t const coordinate : std::array<std::size_t, 3>{5, 32, 65}) {
    std::size_t const site = coordinate % 33;
    double const expected = coordinate < 33 ? force.x[site] : force.y[site];
    double const step = 1e-6;
    double const up = energy_of(find_contacts(displaced(forces, packing, coordinate, step)), Potential::harmonic);
    double const down = energy_of(find_contacts(displaced(forces, packing, coordinate, -step)), Potential::harmonic);
    EXPECT_NEAR((down - up) / (2.0 * step), expected, 1e-6 * (1.0 + std::abs(expected))) << "coordinate " << coordinate;
    EXPECT_NE(expected, 0.0);
  }
}

TEST(FreeBox, HasTheHessianOfItsForces) {
  Packing const packing = minimum_of(free_box(), random_packing(32, 0.9, 4));
  SiteForces forces(packing, free_box());
  SparseMatrix const hessian = forces.hessian(packing);
  Columns const at_rest(forces.sites());
  Columns up(forces.sites());
  Columns down(forces.sites());
  double const step = 1e-7;
  for (std::size_t const coordinate : std::array<std::size_t, 3>{7, 32, 65}) {
    forces.evaluate(displaced(forces, packing, coordinate, step), at_rest, up);
    forces.evaluate(displaced(forces, packing, coordinate, -step), at_rest, down);
    auto const column = static_cast<int>(2 * (coordinate % 33) + coordinate / 33);
    for (std::size_t site = 0; site < forces.sites(); ++site) {
      auto const row = static_cast<int>(2 * site);
      double const x = (down.x[site] - up.x[site]) / (2.0 * step);
      double const y = (down.y[site] - up.y[site]) / (2.0 * step);
      // The matrix has its lower triangle only.
      EXPECT_NEAR(hessian.coeff(std::max(row, column), std::min(row, column)), x, 2e-4) << coordinate << ", " << site;
      EXPECT_NEAR(hessian.coeff(std::max(row + 1, column), std::min(row + 1, column)), y, 2e-4)
          << coordinate << ", " << site;
    }
  }
}

TEST(FreeBox, EndsWithoutShearStressAndStableAgainstEveryShear) {
  for (std::uint64_t const seed : {1, 5, 9}) {
    Packing const start = random_packing(64, 0.86, seed);
    ContactNetwork const kept = find_contact_network(minimum_of({}, start), Potential::harmonic);
    Packing const packing = minimum_of(free_box(), start);
    ContactNetwork const network = find_contact_network(packing, Potential::harmonic);
    EXPECT_GT(std::abs(kept.stress.xy) + std::abs(kept.stress.xx - kept.stress.yy), 1e-3 * kept.pressure);
    EXPECT_LT(std::abs(network.stress.xy), 1e-8 * network.pressure);
    EXPECT_LT(std::abs(network.stress.xx - network.stress.yy), 1e-8 * network.pressure);
    EXPECT_GT(find_elastic_moduli(packing, network)->min_shear(), 0.0);
    EXPECT_NEAR(packing.box.area(), start.box.area(), 1e-12);
    EXPECT_TRUE(packing.box.is_oblique());
  }
}

TEST(FreeBox, HasTwoContactsMoreAtJammingThanAGivenBox) {
  int with_two = 0;
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    Packing const start = minimum_of(free_box(), random_packing(64, 0.86, seed, Edge::periodic, 1.0));
    PressureRamp ramp({.minimizer = free_box(), .pressure = 1e-7}, start);
    ramp.advance();
    ASSERT_EQ(ramp.status(), RampStatus::reached) << "seed " << seed;
    PressureLevel const& last = ramp.levels().back();
    EXPECT_GE(last.excess_contacts, 2.0) << "seed " << seed;
    EXPECT_GT(last.least_shear_modulus, 0.0) << "seed " << seed;
    if (last.excess_contacts == 2.0) ++with_two;
  }
  EXPECT_GE(with_two, 10);
}

TEST(FreeBox, DeformsAsItsResponseToGrowthPredicts) {
  MinimizerSettings settings = free_box();
  settings.residual = 1e-12;
  Packing const packing = minimum_of(settings, random_packing(32, 0.95, 2));
  auto const response = find_growth_response(find_contact_network(packing, Potential::harmonic), BoxShape::free);
  ASSERT_TRUE(response.has_value());
  double const growth = 1e-6;
  Packing grown = packing;
  for (double& radius : grown.radius) radius *= 1.0 + growth;
  Minimizer minimizer(settings, grown);
  minimizer.restart_near_minimum(grown);
  minimizer.advance();
  Box const& box = minimizer.packing().box;
  EXPECT_NEAR(2.0 * (box.width() / packing.box.width() - 1.0) / growth, response->pure_shear, 1e-4);
  EXPECT_NEAR((box.tilt() - packing.box.tilt()) / growth - packing.box.tilt() * response->pure_shear,
              response->simple_shear, 1e-4);
  EXPECT_GT(std::abs(response->pure_shear) + std::abs(response->simple_shear), 1e-2);
}

TEST(FreeBox, HasTheSameBitsForAnyNumberOfThreads) {
  Packing const start = random_packing(1200, 0.86, 1);
  auto const after_some_steps = [&](std::uint64_t threads) {
    MinimizerSettings settings = free_box(threads);
    settings.descent_residual = 0.5;
    settings.residual = 1e-2;
    return minimum_of(settings, start);
  };
  Packing const one = after_some_steps(1);
  EXPECT_NE(one.box, start.box);
  for (std::uint64_t const threads : {2, 3}) {
    Packing const many = after_some_steps(threads);
    EXPECT_EQ(many.x, one.x) << threads;
    EXPECT_EQ(many.box, one.box) << threads;
  }
}

TEST(FreeBox, HasTheSameBitsWhenARampIsInterruptedAndRestored) {
  PressureRampSettings const settings{.minimizer = free_box(), .pressure = 1e-4};
  Packing const start = random_packing(64, 0.88, 5);
  PressureRamp whole(settings, start);
  whole.advance();
  PressureRamp current(settings, start);
  int pieces = 0;
  for (bool is_done = false; !is_done; ++pieces) {
    is_done = current.advance([] { return false; });
    if (pieces % 5 != 0) continue;
    std::string const saved = to_checkpoint([&](Archive& archive) { current.serialize(archive); });
    PressureRamp restored(settings, random_packing(64, 0.5, 99));
    from_checkpoint(saved, "saved", [&](Archive& archive) { restored.serialize(archive); });
    restored.advance();
    ASSERT_EQ(restored.packing().x, whole.packing().x) << "from piece " << pieces;
    ASSERT_EQ(restored.packing().box, whole.packing().box) << "from piece " << pieces;
  }
  EXPECT_GT(pieces, 20);
}

TEST(FreeBox, KeepsTheWayOfADiskWhereItsTiltIsShiftedBack) {
  State state{.box = Box(1.0, 1.0, Edge::periodic).tilted(0.49), .agents = {}};
  state.agents.add(0.25, 0.75, 0.0, 0.0, 0.1, 1.0, 0, 3);
  auto const place = [&] {
    Vector const offset = state.box.offset_of_image(state.agents.column<ImageX>()[0], state.agents.column<ImageY>()[0]);
    return Vector{state.agents.column<X>()[0] + offset.x, state.agents.column<Y>()[0] + offset.y};
  };
  Vector const before = place();
  Packing packing = packing_of(state);
  deform(packing, 0.0, 0.03);
  write_packing(packing, state);
  EXPECT_NEAR(state.box.tilt(), -0.48, 1e-12);
  EXPECT_NEAR(place().x, before.x + 0.03 * before.y, 1e-12);
  EXPECT_NEAR(place().y, before.y, 1e-12);
}

TEST(FreeBox, IsRefusedBetweenWalls) {
  EXPECT_THROW(Minimizer(free_box(), random_packing(16, 0.8, 1, Edge::wall)), Error);
}

}  // namespace
}  // namespace gridlock
