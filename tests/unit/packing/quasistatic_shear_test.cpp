#include "gridlock/packing/quasistatic_shear.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "gridlock/core/error.hpp"
#include "gridlock/packing/contact_network.hpp"
#include "gridlock/packing/elasticity.hpp"
#include "io/checkpoint.hpp"
#include "reference/random_packing.hpp"
#include "unit/packing/packings.hpp"

namespace gridlock {
namespace {

struct Known {
  char const* name;
  double stress;   ///< dE/dγ/A
  double modulus;  ///< relaxed, under simple shear, for γ → 0
  double strain;   ///< at which the packing is still linear
};

// Packings in a box of side 1 and their moduli, by Newton's method to a residual of 1e-14 in an independent program.
TEST(QuasistaticShear, HasTheStressAndTheModulusOfKnownPackings) {
  for (Known const& known :
       {Known{"over", 6.87498704e-2, 5.18355425, 1e-6}, Known{"mid", 2.32624102e-3, 1.10812706, 1e-6},
        Known{"marginal", 2.19425315e-7, 1.18133438, 1e-9}}) {
    Packing const packing = harmonic64(known.name);
    double const diameter = smallest_diameter(packing);
    double const unit = diameter * diameter;
    std::vector<double> stress;
    for (double const sign : {-1.0, 1.0}) {
      QuasistaticShear shear(
          {.minimizer = {.residual = 1e-13}, .step = known.strain, .until_strain = sign * known.strain}, packing);
      ASSERT_TRUE(shear.advance());
      EXPECT_NEAR(shear.minima()[0].shear_stress, known.stress * unit, 1e-7 * known.stress * unit) << known.name;
      stress.push_back(shear.minima()[1].shear_stress);
    }
    double const modulus = (stress[1] - stress[0]) / (2.0 * known.strain * unit);
    EXPECT_NEAR(modulus, known.modulus, 1e-6 * known.modulus) << known.name;
  }
}

// The relations between the moduli of the Hessian, with symmetric strains, and those of finite shears.
TEST(QuasistaticShear, HasTheModuliOfTheHessianInBothDeformations) {
  Packing const packing = harmonic64("over");
  ContactNetwork const network = find_contact_network(packing, Potential::harmonic);
  ElasticModuli const moduli = find_elastic_moduli(packing, network).value();
  double const simple = moduli.shear_xy() - 0.5 * network.pressure + 0.5 * (network.stress.yy - network.stress.xx);
  double const pure = moduli.shear_xx_yy() - 0.5 * network.pressure;
  EXPECT_EQ(simple_shear_modulus(moduli, network), simple);
  EXPECT_EQ(pure_shear_modulus(moduli, network), pure);
  for (auto const& [deformation, expected] :
       {std::pair{Deformation::simple_shear, simple}, std::pair{Deformation::pure_shear, pure}}) {
    std::vector<double> stress;
    for (double const strain : {-1e-5, 1e-5}) {
      QuasistaticShear shear(
          {.minimizer = {.residual = 1e-13}, .deformation = deformation, .step = 1e-5, .until_strain = strain},
          packing);
      ASSERT_TRUE(shear.advance());
      stress.push_back(shear.minima()[1].shear_stress);
    }
    EXPECT_NEAR((stress[1] - stress[0]) / 2e-5, expected, 2e-6 * expected);
  }
}

Packing jammed(std::size_t disks, std::uint64_t seed, double width = 1.25) {
  Minimizer minimizer({}, reference::random_packing(disks, 0.86, seed, Edge::periodic, width));
  minimizer.advance();
  EXPECT_EQ(minimizer.status(), MinimumStatus::converged);
  return minimizer.packing();
}

TEST(QuasistaticShear, ShearOfAWholeBoxHasTheImagesOfTheBoxAtTheStart) {
  QuasistaticShear shear({.step = 0.01, .until_strain = 1.0, .min_drop = 1e-4}, jammed(32, 3, 1.0));
  ASSERT_TRUE(shear.advance());
  EXPECT_NEAR(shear.packing().box.shift(), 0.0, 1e-12);
  EXPECT_EQ(shear.widths_shifted_back(), 1);
  EXPECT_EQ(shear.minima().size(), 101U);
  EXPECT_GT(shear.events().size(), 1U);
}

TEST(QuasistaticShear, EventsAreDropsOfTheStressWithinTheAccuracy) {
  QuasistaticShear shear({.until_strain = 0.2, .accuracy = 1e-7}, jammed(64, 5));
  ASSERT_TRUE(shear.advance());
  ASSERT_GT(shear.events().size(), 1U);
  double last = -1.0;
  for (ShearEvent const& event : shear.events()) {
    EXPECT_GT(event.strain, last);
    EXPECT_LE(event.width, 1.0001e-7);
    EXPECT_GT(event.stress_drop, 2e-4);
    EXPECT_GT(event.energy_drop, 0.0);
    EXPECT_GE(event.moved_disks, 1.0);
    EXPECT_LE(event.participation, 64.0);
    last = event.strain;
  }
  EXPECT_EQ(shear.motions().back().event + 1, shear.events().size());
}

TEST(QuasistaticShear, InSmallCyclesEveryDiskComesBackAndInLargeOnesNot) {
  QuasistaticShear small({.step = 1e-4, .until_strain = 2e-4, .cycles = 3}, harmonic64("over"));
  ASSERT_TRUE(small.advance());
  ASSERT_EQ(small.cycles().size(), 3U);
  EXPECT_EQ(small.minima().size(), 25U);
  for (ShearCycle const& cycle : small.cycles()) EXPECT_TRUE(cycle.is_reversible) << cycle.largest_motion;
  QuasistaticShear large({.step = 5e-3, .until_strain = 0.3, .cycles = 2}, jammed(64, 7));
  ASSERT_TRUE(large.advance());
  EXPECT_FALSE(large.cycles().front().is_reversible);
  EXPECT_NEAR(large.minima()[60].strain, 0.3, 1e-12);
  EXPECT_NEAR(large.minima()[180].strain, -0.3, 1e-12);
  EXPECT_NEAR(large.minima().back().strain, 0.0, 1e-12);
}

TEST(QuasistaticShear, EndsAtAStress) {
  QuasistaticShear shear({.until_strain = 0.5, .until_stress = 2e-4}, jammed(128, 2));
  ASSERT_TRUE(shear.advance());
  EXPECT_GE(std::abs(shear.minima().back().shear_stress), 2e-4);
  for (std::size_t k = 1; k + 1 < shear.minima().size(); ++k) EXPECT_LT(std::abs(shear.minima()[k].shear_stress), 2e-4);
}

void copy_saved(QuasistaticShear& from, QuasistaticShear& to) {
  from_checkpoint(to_checkpoint([&](Archive& archive) { from.serialize(archive); }), "saved",
                  [&](Archive& archive) { to.serialize(archive); });
}

TEST(QuasistaticShear, HasTheSameBitsOnAnyThreadsAndWhereverItIsRestored) {
  Packing const packing = jammed(1100, 11);
  auto const sheared = [&](std::uint64_t threads, int looks) {
    QuasistaticShearSettings const settings{.minimizer = {.threads = threads}, .step = 2e-3, .until_strain = 0.006};
    QuasistaticShear shear(settings, packing);
    int left = looks;
    while (!shear.advance([&] { return looks == 0 || --left > 0; })) {
      QuasistaticShear restored(settings, packing);
      copy_saved(shear, restored);
      QuasistaticShear again(settings, packing);
      copy_saved(restored, again);
      left = looks;
      while (!again.advance([&] { return --left > 0; })) left = looks;
      return std::pair(again.packing().x, again.minima().back().energy);
    }
    return std::pair(shear.packing().x, shear.minima().back().energy);
  };
  auto const expected = sheared(1, 0);
  EXPECT_EQ(sheared(3, 0), expected);
  EXPECT_EQ(sheared(1, 40), expected);
  EXPECT_EQ(sheared(2, 7), expected);
}

TEST(QuasistaticShear, RefusesWhatItCannotShear) {
  Packing const packing = harmonic64("over");
  EXPECT_THROW(QuasistaticShear({.step = 0.2}, packing), Error);
  EXPECT_THROW(QuasistaticShear({.until_strain = 0.0}, packing), Error);
  EXPECT_THROW(QuasistaticShear({.deformation = Deformation::pure_shear, .until_strain = 2.0}, packing), Error);
  EXPECT_THROW(QuasistaticShear({.step = 1e-9, .until_strain = 1.0}, packing), Error);
  Packing walled = packing;
  walled.box = Box(1.0, 1.0, Edge::wall);
  EXPECT_THROW(QuasistaticShear({}, walled), Error);
}

}  // namespace
}  // namespace gridlock
