#include "gridlock/packing/minimizer.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>

#include "gridlock/core/error.hpp"
#include "io/checkpoint.hpp"
#include "packing/soft_forces.hpp"
#include "reference/random_packing.hpp"

namespace gridlock {
namespace {

using reference::random_packing;

constexpr double infinity = std::numeric_limits<double>::infinity();

MinimizerSettings settings_of(Potential potential, double newton_residual = 1e-3, std::uint64_t threads = 1) {
  return {.potential = potential, .newton_residual = newton_residual, .threads = threads};
}

TEST(Minimizer, FindsAPlaceWithoutForces) {
  for (Potential const potential : {Potential::harmonic, Potential::hertzian}) {
    for (Edge const edge : {Edge::periodic, Edge::wall}) {
      Minimizer minimizer(settings_of(potential), random_packing(64, 0.9, 3, edge));
      ASSERT_TRUE(minimizer.advance());
      ASSERT_EQ(minimizer.status(), MinimumStatus::converged);
      // By the definitions, not by the list of the minimizer.
      std::vector<Contact> const contacts = find_contacts(minimizer.packing());
      double mean_force = 0.0;
      for (Contact const& contact : contacts) mean_force += force_of(contact, potential);
      mean_force /= static_cast<double>(contacts.size());
      double largest = 0.0;
      for (Vector const force : forces_of(contacts, potential, 64))
        largest = std::max(largest, std::sqrt(squared_length(force)));
      EXPECT_LT(largest, 2e-8 * mean_force);
      EXPECT_NEAR(energy_of(contacts, potential), minimizer.energy(), 1e-12 * minimizer.energy());
      EXPECT_GT(minimizer.energy(), 0.0);
    }
  }
}

TEST(Minimizer, FindsTheSameMinimumWithAndWithoutNewtonsMethod) {
  Minimizer with(settings_of(Potential::harmonic), random_packing(64, 0.86, 1));
  Minimizer without(settings_of(Potential::harmonic, 0.0), random_packing(64, 0.86, 1));
  with.advance();
  without.advance();
  EXPECT_GT(with.newton_iterations(), 0U);
  EXPECT_EQ(without.newton_iterations(), 0U);
  EXPECT_LT(with.iterations(), without.iterations());
  EXPECT_NEAR(with.energy(), without.energy(), 1e-12 * with.energy());
  EXPECT_NEAR(with.pressure(), without.pressure(), 1e-8 * with.pressure());
}

TEST(Minimizer, NeedsFewerForcesWithTheQuasiNewtonMethodThanWithFireAlone) {
  Minimizer with({.descent_residual = infinity, .newton_residual = 0.0}, random_packing(256, 0.86, 2));
  Minimizer fire_alone({.descent_residual = infinity, .quasi_newton_residual = 0.0, .newton_residual = 0.0},
                       random_packing(256, 0.86, 2));
  with.advance();
  fire_alone.advance();
  ASSERT_EQ(with.status(), MinimumStatus::converged);
  ASSERT_EQ(fire_alone.status(), MinimumStatus::converged);
  EXPECT_EQ(fire_alone.iterations(), fire_alone.fire_iterations());
  EXPECT_GT(with.quasi_newton_iterations(), with.fire_iterations());
  EXPECT_LT(with.iterations(), fire_alone.iterations());
  // Two minima of one landscape.
  EXPECT_NEAR(with.energy(), fire_alone.energy(), 0.5 * with.energy());
}

TEST(Minimizer, FollowsTheSteepestWayDownUntilForcesBalanceToOnePercent) {
  for (Edge const edge : {Edge::periodic, Edge::wall}) {
    Minimizer to_one_percent({.residual = 0.01}, random_packing(64, 0.9, 1, edge));
    to_one_percent.advance();
    EXPECT_EQ(to_one_percent.status(), MinimumStatus::converged);
    EXPECT_EQ(to_one_percent.iterations(), to_one_percent.descent_iterations());
    Minimizer whole({}, random_packing(64, 0.9, 1, edge));
    whole.advance();
    EXPECT_EQ(whole.descent_iterations(), to_one_percent.iterations());
    EXPECT_GT(whole.quasi_newton_iterations(), 0U);
    Minimizer without({.descent_residual = infinity}, random_packing(64, 0.9, 1, edge));
    without.advance();
    EXPECT_EQ(without.descent_iterations(), 0U);
  }
}

/// After short steps against the gradient.
Packing rolled_down(Packing packing) {
  std::size_t const disks = packing.size();
  double const step = 0.02 * 4.0 * packing.radius[0] * packing.radius[0];
  SoftForces forces(packing, Potential::harmonic, 1);
  Columns const rest(disks);
  Columns force(disks);
  ForceSums sums = forces.evaluate(packing, rest, force);
  while (sums.residual() > 0.01 && sums.energy > 1e-8 * static_cast<double>(disks)) {
    for (std::size_t i = 0; i < disks; ++i) {
      packing.x[i] += step * force.x[i];
      packing.y[i] += step * force.y[i];
    }
    sums = forces.evaluate(packing, rest, force);
  }
  return packing;
}

/// 0 where the disks move apart.
double energy_at_minimum(MinimizerSettings const& settings, Packing const& packing) {
  Minimizer minimizer(settings, packing);
  minimizer.advance();
  return minimizer.status() == MinimumStatus::converged ? minimizer.energy() : 0.0;
}

TEST(Minimizer, EndsInTheMinimumToWhichShortStepsAgainstTheGradientLead) {
  // Basins are so fine that a few starts end elsewhere. Of FIRE and L-BFGS alone 42 of 100 starts end there.
  int as_steps = 0;
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    Packing const start = random_packing(16, 0.95, seed);
    double const expected = energy_at_minimum({.descent_residual = infinity}, rolled_down(start));
    double const found = energy_at_minimum({}, start);
    if (std::abs(found - expected) <= 1e-6 * std::max(found, expected)) ++as_steps;
  }
  EXPECT_GE(as_steps, 90);
}

TEST(Minimizer, HasTheSameBitsForAnyNumberOfThreads) {
  // More disks than are left to one thread.
  Minimizer one(settings_of(Potential::harmonic), random_packing(1200, 0.86, 1));
  one.advance();
  ASSERT_EQ(one.status(), MinimumStatus::converged);
  for (std::uint64_t const threads : {2U, 3U, 8U}) {
    Minimizer many(settings_of(Potential::harmonic, 1e-3, threads), random_packing(1200, 0.86, 1));
    many.advance();
    EXPECT_EQ(many.packing().x, one.packing().x) << threads;
    EXPECT_EQ(many.packing().y, one.packing().y) << threads;
    EXPECT_EQ(many.energy(), one.energy()) << threads;
  }
}

TEST(Minimizer, HasTheSameBitsWhenItIsInterruptedAndRestored) {
  for (Potential const potential : {Potential::harmonic, Potential::hertzian}) {
    Packing const start = random_packing(64, 0.88, 5);
    Minimizer whole(settings_of(potential), start);
    whole.advance();
    Minimizer current(settings_of(potential), start);
    std::string saved;
    int pieces = 0;
    for (bool is_done = false; !is_done; ++pieces) {
      is_done = current.advance([] { return false; });
      saved = to_checkpoint([&](Archive& archive) { current.serialize(archive); });
      // Another start, all of which is restored.
      Minimizer restored(settings_of(potential), random_packing(64, 0.5, 99));
      from_checkpoint(saved, "saved", [&](Archive& archive) { restored.serialize(archive); });
      if (pieces % 7 != 0 || is_done) continue;
      restored.advance();
      ASSERT_EQ(restored.packing().x, whole.packing().x) << "from piece " << pieces;
      ASSERT_EQ(restored.energy(), whole.energy());
    }
    EXPECT_GT(pieces, 20);
    EXPECT_EQ(current.packing().x, whole.packing().x);
    EXPECT_GT(whole.quasi_newton_iterations(), 0U);
    EXPECT_EQ(current.iterations(), whole.iterations());
  }
}

TEST(Minimizer, KnowsTheLargestNetForceOfManyDisks) {
  // More disks than are summed as one block, at a moment when forces do not balance.
  Minimizer minimizer({.iterations = 5}, random_packing(1200, 0.9, 1));
  ASSERT_TRUE(minimizer.advance());
  ASSERT_EQ(minimizer.status(), MinimumStatus::unconverged);
  std::vector<Contact> const contacts = find_contacts(minimizer.packing());
  double mean_force = 0.0;
  for (Contact const& contact : contacts) mean_force += force_of(contact, Potential::harmonic);
  mean_force /= static_cast<double>(contacts.size());
  double largest = 0.0;
  for (Vector const force : forces_of(contacts, Potential::harmonic, 1200))
    largest = std::max(largest, std::sqrt(squared_length(force)));
  EXPECT_NEAR(minimizer.residual(), largest / mean_force, 1e-9 * largest / mean_force);
}

TEST(Minimizer, EndsWhereThePositionsOfATallBoxHaveNoMoreDigits) {
  // Equal disks one above the other, the overlap of which is hardly more than the last digits of the highest.
  for (bool const is_tall : {false, true}) {
    std::size_t const disks = 48;
    double const overlap = 1e-7;
    Packing packing{.box = is_tall ? Box(4.0, 48.0, Edge::periodic) : Box(48.0, 4.0, Edge::periodic),
                    .x = {},
                    .y = {},
                    .radius = std::vector<double>(disks, 0.5 / (1.0 - overlap))};
    std::vector<double>& along = is_tall ? packing.y : packing.x;
    for (std::size_t k = 0; k < disks; ++k) along.push_back(static_cast<double>(k) + 0.5);
    (is_tall ? packing.x : packing.y).assign(disks, 2.0);
    // The residual that is left is 2 · shift/overlap: below 2⁻⁵⁰ · 48/overlap, and above what a side of 4 allows.
    along[7] += 0x1p-47;
    Minimizer minimizer({.newton_residual = 0.0}, packing);
    ASSERT_TRUE(minimizer.advance());
    EXPECT_EQ(minimizer.status(), MinimumStatus::converged);
    EXPECT_GT(minimizer.residual(), 1e-8);
    EXPECT_EQ(minimizer.iterations(), 0U) << is_tall;
  }
}

TEST(Minimizer, LeavesASaddleWhoseOnlyWayDownIsAlongXOrY) {
  for (bool const is_tall : {false, true}) {
    // A straight row through a periodic box: it can only buckle.
    Packing packing{.box = is_tall ? Box(12.0, 6.0, Edge::periodic) : Box(6.0, 12.0, Edge::periodic),
                    .x = {},
                    .y = {},
                    .radius = std::vector<double>(6, 0.51)};
    for (std::size_t k = 0; k < 6; ++k) {
      packing.x.push_back(is_tall ? 6.0 : static_cast<double>(k));
      packing.y.push_back(is_tall ? static_cast<double>(k) : 6.0);
    }
    Minimizer minimizer({.iterations = 20'000}, packing);
    ASSERT_TRUE(minimizer.advance());
    EXPECT_EQ(minimizer.status(), MinimumStatus::unjammed) << is_tall;
  }
}

TEST(SoftForces, SeeADiskThatComesFromAnyDirection) {
  // Of the three disks one moves, a little at a time, from far away onto each of the others.
  for (Vector const way : {Vector{0.5, 0.0}, Vector{0.0, 0.5}}) {
    Packing packing{.box = Box(12.0, 9.0, Edge::periodic),
                    .x = {6.0, 6.0 + 4.0 * way.x, 2.0},
                    .y = {4.0, 4.0 + 4.0 * way.y, 4.0},
                    .radius = {0.5, 0.5, 0.6}};
    SoftForces forces(packing, Potential::harmonic, 1);
    Columns const rest(3);
    Columns found(3);
    double most = 0.0;
    for (int step = 0; step < 40; ++step) {
      packing.x[1] -= 0.1 * way.x;
      packing.y[1] -= 0.1 * way.y;
      double const expected = energy_of(find_contacts(packing), Potential::harmonic);
      EXPECT_NEAR(forces.evaluate(packing, rest, found).energy, expected, 1e-15) << step;
      most = std::max(most, expected);
    }
    EXPECT_GT(most, 0.1);
  }
}

TEST(Minimizer, TellsDisksThatHaveMovedApart) {
  Minimizer minimizer({}, random_packing(64, 0.5, 1));
  minimizer.advance();
  EXPECT_EQ(minimizer.status(), MinimumStatus::unjammed);
  EXPECT_LT(minimizer.energy(), 64 * 1e-16);
}

TEST(Minimizer, GivesUpAfterSoManyIterations) {
  Minimizer minimizer({.iterations = 50}, random_packing(64, 0.9, 1));
  minimizer.advance();
  EXPECT_EQ(minimizer.status(), MinimumStatus::unconverged);
  EXPECT_EQ(minimizer.iterations(), 50U);
}

TEST(Minimizer, EndsAtAnyResidualThatItTakes) {
  for (double const residual : {0.99, 0.5, 0.3, 0.1, 0.03}) {
    for (std::uint64_t seed = 1; seed <= 3; ++seed) {
      Minimizer minimizer({.residual = residual}, random_packing(64, 0.9, seed));
      ASSERT_TRUE(minimizer.advance());
      EXPECT_EQ(minimizer.status(), MinimumStatus::converged) << residual;
      EXPECT_LE(minimizer.residual(), residual);
      EXPECT_LT(minimizer.iterations(), 2000U);
    }
  }
}

TEST(Minimizer, PushesDisksAtOnePlaceApart) {
  Packing packing{.box = Box(1.0, 1.0, Edge::periodic), .x = {0.5, 0.5}, .y = {0.5, 0.5}, .radius = {0.1, 0.1}};
  Minimizer minimizer({}, packing);
  minimizer.advance();
  EXPECT_EQ(minimizer.status(), MinimumStatus::unjammed);
  EXPECT_GT(std::abs(minimizer.packing().x[1] - minimizer.packing().x[0]), 0.2 - 1e-7);
}

TEST(Minimizer, TakesNoneAndOneDisk) {
  for (std::size_t const disks : {0U, 1U}) {
    Minimizer minimizer({}, random_packing(disks, 0.1, 1));
    EXPECT_TRUE(minimizer.advance());
    EXPECT_NE(minimizer.status(), MinimumStatus::converged);
  }
}

TEST(Minimizer, RefusesDisksTooLargeForThePeriodicBox) {
  for (Box const& box : {Box(1.0, 1.0, Edge::periodic), Box(4.0, 1.0, Edge::periodic), Box(1.0, 4.0, Edge::periodic)}) {
    Packing packing{.box = box, .x = {0.2, 0.7}, .y = {0.5, 0.5}, .radius = {0.3, 0.3}};
    Minimizer minimizer({}, packing);
    EXPECT_THROW(minimizer.advance(), Error) << box.width();
    try {
      find_contacts(packing);
      ADD_FAILURE() << box.width();
    } catch (Error const& error) {
      EXPECT_NE(error.problems().front().what.find("two images of the same partner"), std::string::npos);
    }
  }
}

TEST(Minimizer, TakesBoxesHardlyAsFlatAsItsDisksAllow) {
  for (bool const is_tall : {false, true}) {
    // The list of pairs has less room than it would like: half the shorter side is hardly more than a contact.
    std::vector<double> const along{0.2, 1.0, 1.7, 2.9};
    std::vector<double> const across{0.1, 0.5, 0.9, 0.4};
    Packing const packing{.box = is_tall ? Box(1.0, 4.0, Edge::periodic) : Box(4.0, 1.0, Edge::periodic),
                          .x = is_tall ? across : along,
                          .y = is_tall ? along : across,
                          .radius = {0.23, 0.23, 0.23, 0.23}};
    Minimizer minimizer({}, packing);
    ASSERT_TRUE(minimizer.advance());
    EXPECT_EQ(minimizer.status(), MinimumStatus::unjammed) << is_tall;
  }
}

TEST(Minimizer, RefusesAResidualThatIsNone) {
  EXPECT_THROW(Minimizer({.residual = 0.0}, random_packing(4, 0.1, 1)), Error);
  EXPECT_THROW(Minimizer({.residual = std::nan("")}, random_packing(4, 0.1, 1)), Error);
}

TEST(SoftDisks, HaveForcesThatAreTheSlopeOfTheirEnergy) {
  constexpr double h = 1e-6;
  for (Potential const potential : {Potential::harmonic, Potential::hertzian}) {
    for (Edge const edge : {Edge::periodic, Edge::wall}) {
      Packing packing = random_packing(24, 0.9, 11, edge);
      std::vector<Vector> const forces = forces_of(find_contacts(packing), potential, packing.size());
      for (std::size_t i = 0; i < packing.size(); ++i) {
        auto const energy_at = [&](Vector shift) {
          Packing moved = packing;
          moved.x[i] += shift.x;
          moved.y[i] += shift.y;
          return energy_of(find_contacts(moved), potential);
        };
        EXPECT_NEAR(forces[i].x, (energy_at({-h, 0.0}) - energy_at({h, 0.0})) / (2.0 * h), 1e-4) << i;
        EXPECT_NEAR(forces[i].y, (energy_at({0.0, -h}) - energy_at({0.0, h})) / (2.0 * h), 1e-4) << i;
      }
    }
  }
}

TEST(SoftDisks, RefuseWhatIsNoPacking) {
  Packing const good = random_packing(4, 0.1, 1);
  auto const expect_refused = [](Packing const& packing) { EXPECT_THROW(find_contacts(packing), Error); };
  Packing bad = good;
  bad.radius.pop_back();
  expect_refused(bad);
  bad = good;
  bad.x[2] = std::nan("");
  expect_refused(bad);
  bad = good;
  bad.radius[1] = 0.0;
  expect_refused(bad);
  bad = good;
  bad.box = Box(1.0, 1.0, Edge::wall);
  bad.y[0] = -0.1;
  expect_refused(bad);
}

TEST(SoftDisks, TouchTheWallsByTheirNumbers) {
  // A disk at each wall, and one in a corner.
  Packing const packing{.box = Box(4.0, 3.0, Edge::wall),
                        .x = {0.4, 3.6, 2.0, 2.2, 3.7},
                        .y = {1.5, 1.5, 0.4, 2.6, 2.7},
                        .radius = {0.5, 0.5, 0.5, 0.5, 0.35}};
  struct Touch {
    std::uint32_t first;
    std::uint32_t second;
    Vector normal;
  };
  std::vector<Touch> const expected{{0, 5, {-1.0, 0.0}}, {1, 6, {1.0, 0.0}}, {2, 7, {0.0, -1.0}},
                                    {3, 8, {0.0, 1.0}},  {4, 6, {1.0, 0.0}}, {4, 8, {0.0, 1.0}}};
  std::vector<Contact> const contacts = find_contacts(packing);
  ASSERT_EQ(contacts.size(), expected.size());
  for (std::size_t k = 0; k < expected.size(); ++k) {
    EXPECT_EQ(contacts[k].first, expected[k].first);
    EXPECT_EQ(contacts[k].second, expected[k].second) << "left, right, bottom, top behind the disks";
    EXPECT_EQ(contacts[k].normal, expected[k].normal);
  }
}

TEST(SoftDisks, RefuseADiskThatTouchesItsOwnImages) {
  EXPECT_THROW(find_contacts({.box = Box(1.0, 1.0, Edge::periodic), .x = {0.5}, .y = {0.5}, .radius = {0.6}}), Error);
  EXPECT_TRUE(find_contacts({.box = Box(1.0, 1.0, Edge::periodic), .x = {0.5}, .y = {0.5}, .radius = {0.4}}).empty());
  EXPECT_EQ(find_contacts({.box = Box(1.0, 1.0, Edge::wall), .x = {0.5}, .y = {0.5}, .radius = {0.6}}).size(), 4U);
}

}  // namespace
}  // namespace gridlock
