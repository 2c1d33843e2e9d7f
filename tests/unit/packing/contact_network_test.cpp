#include "gridlock/packing/contact_network.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "gridlock/core/error.hpp"
#include "gridlock/packing/elasticity.hpp"
#include "reference/soft_minimum.hpp"
#include "unit/packing/packings.hpp"

namespace gridlock {
namespace {

struct Known {
  char const* name;
  std::size_t backbone_disks;
  std::size_t backbone_contacts;
  std::size_t contacts;
  double energy_per_disk;
  double pressure;
  double relative_error;
};

// By an independent program.
std::vector<Known> const known{{"over", 64, 145, 145, 1.047687498e-4, 0.5642768998, 1e-9},
                               {"mid", 60, 119, 120, 3.606745549e-8, 9.354789970e-3, 1e-9},
                               {"marginal", 60, 119, 119, 3.18411e-16, 8.87107e-7, 2e-6}};

TEST(ContactNetwork, OfKnownPackingsHasTheirBackboneEnergyAndPressure) {
  for (Known const& expected : known) {
    ContactNetwork const network = find_contact_network(harmonic64(expected.name), Potential::harmonic);
    EXPECT_EQ(network.backbone_disks, expected.backbone_disks) << expected.name;
    EXPECT_EQ(network.backbone_contacts, expected.backbone_contacts) << expected.name;
    EXPECT_EQ(network.contacts.size(), expected.contacts) << expected.name << ": one rattler of mid touches";
    EXPECT_NEAR(network.energy / 64.0, expected.energy_per_disk, expected.relative_error * expected.energy_per_disk);
    double const pressure = network.pressure / (network.smallest_diameter * network.smallest_diameter);
    EXPECT_NEAR(pressure, expected.pressure, expected.relative_error * expected.pressure);
    EXPECT_NEAR(pressure_of(network.contacts, Potential::harmonic, Box(1.0, 1.0, Edge::periodic)), pressure,
                1e-12 * pressure);
    EXPECT_LT(network.rounding_residual, 2e-6);
    EXPECT_TRUE(network.is_converged()) << network.residual_force;
    EXPECT_EQ(network.is_jammed(usual_largest_residual, find_softest_mode(network)->eigenvalue), true) << expected.name;
  }
  EXPECT_EQ(find_contact_network(harmonic64("marginal"), Potential::harmonic).excess_contacts(), 0);
  EXPECT_EQ(find_contact_network(harmonic64("over"), Potential::harmonic).excess_contacts(), 145 - 127);
}

TEST(ContactNetwork, TakesRattlersAwayAgainAndAgain) {
  // A lattice with a hole: six disks have five contacts. A chain of two disks leads nowhere.
  Packing packing = triangular_lattice(4, 4, 0.01);
  ContactNetwork const whole = find_contact_network(packing, Potential::harmonic);
  EXPECT_EQ(whole.backbone_contacts, 48U);
  EXPECT_DOUBLE_EQ(whole.contact_number(), 6.0);
  EXPECT_DOUBLE_EQ(whole.mean_coordination(), 6.0);
  packing.box = Box(8.0, packing.box.height(), Edge::periodic);  // a strip with two free edges
  packing.x.insert(packing.x.end(), {4.75, 5.74});
  packing.y.insert(packing.y.end(), {packing.y[4], packing.y[4]});
  packing.radius.insert(packing.radius.end(), 2, packing.radius[0]);
  ContactNetwork const strip = find_contact_network(packing, Potential::harmonic);
  EXPECT_EQ(strip.backbone_disks, 16U);
  EXPECT_TRUE(strip.is_rattler[16] && strip.is_rattler[17]);
  EXPECT_EQ(strip.coordination[17], 0U);
  EXPECT_DOUBLE_EQ(strip.mean_coordination(), 2.0 * static_cast<double>(strip.backbone_contacts) / 18.0)
      << "over all disks, rattlers too";
  EXPECT_GT(strip.contacts.size(), strip.backbone_contacts) << "contacts of rattlers are contacts";
}

TEST(ContactNetwork, CountsWallsAsContacts) {
  // One disk that three walls hold: N_c = 3 = 2 N₀ + 1.
  Packing const packing{.box = Box(2.0, 0.99, Edge::wall), .x = {0.499}, .y = {0.495}, .radius = {0.5}};
  ContactNetwork const network = find_contact_network(packing, Potential::harmonic);
  EXPECT_EQ(network.backbone_disks, 1U);
  EXPECT_EQ(network.backbone_contacts, 3U);
  EXPECT_EQ(network.excess_contacts(), 0);
  EXPECT_DOUBLE_EQ(network.contact_number(), 6.0);
  EXPECT_FALSE(network.is_converged()) << "only one of left and right pushes";
  EXPECT_EQ(network.is_jammed(usual_largest_residual, {}), false);
}

TEST(ContactNetwork, OfHardDisksHasContactsWithinTheTolerance) {
  Packing const packing = triangular_lattice(4, 4, -1e-6);
  ContactNetwork const strict = find_contact_network(packing, Potential::harmonic);
  EXPECT_TRUE(strict.contacts.empty());
  EXPECT_EQ(strict.backbone_disks, 0U);
  EXPECT_TRUE(std::isnan(strict.contact_number()));
  EXPECT_EQ(strict.excess_contacts(), 0);
  EXPECT_EQ(strict.residual_force, 0.0);
  EXPECT_EQ(strict.is_jammed(usual_largest_residual, {}), false);
  ContactNetwork const geometric = find_contact_network(packing, Potential::harmonic, 1e-5);
  EXPECT_DOUBLE_EQ(geometric.contact_number(), 6.0);
  EXPECT_EQ(geometric.pressure, 0.0);
  EXPECT_EQ(geometric.is_jammed(usual_largest_residual, {}), std::nullopt) << "nothing pushes";
  EXPECT_TRUE(relative_forces_of(geometric).empty());
}

TEST(ContactNetwork, OfASolidIsJammedWhateverItsEnergy) {
  for (double const overlap : {1e-4, 1e-8, 3e-9}) {
    ContactNetwork const network = find_contact_network(triangular_lattice(6, 6, overlap), Potential::harmonic);
    double const mode = find_softest_mode(network)->eigenvalue;
    EXPECT_EQ(network.is_jammed(usual_largest_residual, mode), true) << overlap << ": " << network.residual_force;
  }
  ContactNetwork const soft = find_contact_network(triangular_lattice(6, 6, 3e-9), Potential::harmonic);
  EXPECT_LT(soft.energy, min_energy_of_a_disk * 36.0);
}

TEST(ContactNetwork, AtASaddleIsNotJammed) {
  // All forces of a square lattice balance, and its rows slide past each other, at any pressure.
  for (Potential const potential : {Potential::harmonic, Potential::hertzian}) {
    for (double const overlap : {2e-2, 1e-6, 2e-8, 1e-10}) {
      Packing packing{.box = Box(6.0, 8.0, Edge::periodic),
                      .x = {},
                      .y = {},
                      .radius = std::vector<double>(48, 0.5 / (1.0 - overlap))};
      for (int k = 0; k < 48; ++k) {
        packing.x.push_back(k % 6 + 0.5);
        packing.y.push_back(k / 6 + 0.5);
      }
      ContactNetwork const network = find_contact_network(packing, potential);
      if (network.pressure < 1e-12) continue;  // its way down is as flat as rounding
      ASSERT_TRUE(network.is_converged());
      ASSERT_GE(network.excess_contacts(), 0);
      double const mode = find_softest_mode(network)->eigenvalue;
      EXPECT_LT(mode, -network.pressure);
      EXPECT_EQ(network.is_jammed(usual_largest_residual, mode), false) << overlap;
      EXPECT_EQ(network.is_jammed(usual_largest_residual, {}), std::nullopt) << "nobody knows without the mode";
      EXPECT_EQ(network.is_jammed(usual_largest_residual, -1e-15), true) << "rounding";
    }
  }
}

TEST(ContactNetwork, IsConvergedByTheRootMeanSquareOfItsForces) {
  // One disk of a lattice is displaced: the others carry on.
  Packing packing = triangular_lattice(24, 10, 1e-3);
  packing.x[7] += 3e-11;
  ContactNetwork const network = find_contact_network(packing, Potential::harmonic);
  EXPECT_GT(network.residual_force, 3.0 * network.rms_residual_force);
  double const between = 0.5 * (network.residual_force + network.rms_residual_force);
  EXPECT_TRUE(network.is_converged(between)) << "by what most programs bound";
  EXPECT_FALSE(network.is_converged(0.9 * network.rms_residual_force));
  // One disk among very many has to balance too.
  Packing many = triangular_lattice(300, 100, 1e-3);
  many.x[7] += 1e-7;
  ContactNetwork const network_of_many = find_contact_network(many, Potential::harmonic);
  double const above_rms = 1.1 * network_of_many.rms_residual_force;
  ASSERT_GT(network_of_many.residual_force, 101.0 * above_rms);
  EXPECT_FALSE(network_of_many.is_converged(above_rms));
  EXPECT_TRUE(network_of_many.is_converged(0.01 * network_of_many.residual_force));
}

TEST(ContactNetwork, HasTheStressAndTheNetForcesOfTheDefinitions) {
  for (Edge const edge : {Edge::periodic, Edge::wall}) {
    // A minimum, from which every disk is displaced, so that the forces do not balance.
    Packing packing =
        reference::minimum_near(reference::random_packing(24, 0.95, Box(1.0, 1.3, edge), 3), Potential::hertzian);
    for (std::size_t i = 0; i < packing.size(); ++i) {
      packing.x[i] += 0.01 * std::sin(1.0 + static_cast<double>(i));
      packing.y[i] += 0.01 * std::sin(2.0 + 3.0 * static_cast<double>(i));
    }
    ContactNetwork const network = find_contact_network(packing, Potential::hertzian);
    double const unit = network.smallest_diameter * network.smallest_diameter / packing.box.area();
    double xx = 0.0;
    double yy = 0.0;
    double xy = 0.0;
    double mean = 0.0;
    for (Contact const& contact : network.contacts) {
      Vector const force = force_of(contact, Potential::hertzian) * contact.normal;
      Vector const separation = contact.distance * contact.normal;
      xx -= unit * force.x * separation.x;
      yy -= unit * force.y * separation.y;
      xy -= unit * force.x * separation.y;
      mean += std::sqrt(squared_length(force)) / static_cast<double>(network.contacts.size());
    }
    ASSERT_GT(std::abs(xy), 1e-3 * std::abs(xx));
    EXPECT_NEAR(network.stress.xx, xx, 1e-12 * std::abs(xx));
    EXPECT_NEAR(network.stress.yy, yy, 1e-12 * std::abs(xx));
    EXPECT_NEAR(network.stress.xy, xy, 1e-12 * std::abs(xx));
    double squares = 0.0;
    double largest = 0.0;
    for (Vector const net : forces_of(network.contacts, Potential::hertzian, packing.size())) {
      squares += squared_length(net) / static_cast<double>(packing.size());
      largest = std::max(largest, std::sqrt(squared_length(net)));
    }
    EXPECT_NEAR(network.rms_residual_force, std::sqrt(squares) / mean, 1e-12);
    EXPECT_NEAR(network.residual_force, largest / mean, 1e-12);
  }
}

TEST(ContactNetwork, RoundingIsThatOfTheLongerSide) {
  for (bool const is_tall : {false, true}) {
    Packing packing = triangular_lattice(24, 4, 1e-9);
    double const longer = packing.box.width();
    if (is_tall) {
      packing.box = Box(packing.box.height(), packing.box.width(), Edge::periodic);
      std::swap(packing.x, packing.y);
    }
    ContactNetwork const network = find_contact_network(packing, Potential::harmonic);
    double const diameter = 2.0 * packing.radius[0];
    EXPECT_NEAR(network.rounding_residual / (0x1p-49 * longer / (diameter * 1e-9)), 1.0, 1e-4);
  }
}

TEST(ContactNetwork, WithAToleranceSaysNothingOfJamming) {
  Packing const packing = harmonic64("mid");
  ContactNetwork const network = find_contact_network(packing, Potential::harmonic, 1e-2);
  EXPECT_GT(network.backbone_contacts, 119U);
  EXPECT_EQ(network.pressure, find_contact_network(packing, Potential::harmonic).pressure) << "gaps carry no force";
  EXPECT_EQ(network.mean_force, find_contact_network(packing, Potential::harmonic).mean_force);
  EXPECT_EQ(network.is_jammed(usual_largest_residual, 1.0), std::nullopt);
}

TEST(ContactNetwork, OfNothingIsEmpty) {
  ContactNetwork const network = find_contact_network(Packing{}, Potential::hertzian);
  EXPECT_EQ(network.size(), 0U);
  EXPECT_TRUE(std::isnan(network.mean_coordination()));
  EXPECT_EQ(network.is_jammed(usual_largest_residual, {}), false);
}

std::string error_of(auto const& call) {
  try {
    call();
  } catch (Error const& error) {
    return error.problems().front().what;
  }
  return "";
}

TEST(ContactNetwork, RefusesWhatIsNoPacking) {
  Packing const deep{.box = Box(9.0, 9.0, Edge::periodic), .x = {1.0, 1.5}, .y = {1.0, 1.0}, .radius = {1.0, 1.0}};
  EXPECT_EQ(error_of([&] { find_contact_network(deep, Potential::harmonic); }),
            "disk 0 and disk 1 are 0.5 apart and should be 2: an overlap of 0.75, which is no packing");
  Packing const in_wall{.box = Box(9.0, 9.0, Edge::wall), .x = {0.1}, .y = {1.5}, .radius = {1.0}};
  EXPECT_EQ(error_of([&] { find_contact_network(in_wall, Potential::harmonic); }),
            "disk 0 and a wall are 0.1 apart and should be 1: an overlap of 0.9, which is no packing");
  EXPECT_EQ(error_of([] { find_contact_network(Packing{}, Potential::harmonic, -0.1); }), "the tolerance is -0.1");
  EXPECT_EQ(error_of([] { find_gaps(Packing{}, {}, std::nan("")); }), "the largest gap is nan");
}

TEST(Gaps, AreThePairsThatDoNotTouchTheClosestFirst) {
  Packing const packing = harmonic64("mid");
  ContactNetwork const network = find_contact_network(packing, Potential::harmonic);
  std::vector<Contact> const gaps = find_gaps(packing, network, 0.1);
  EXPECT_EQ(gaps.size() + network.contacts.size(), find_contacts(packing, 0.1).size());
  EXPECT_TRUE(std::ranges::is_sorted(gaps, std::greater<>(), &Contact::overlap));
  EXPECT_LE(gaps.front().overlap(), 0.0);
  EXPECT_GT(gaps.back().overlap(), -0.1);
  EXPECT_TRUE(find_gaps(packing, network, 0.0).empty());
}

TEST(RelativeForces, HaveTheMeanOneAndTellBucklersApart) {
  ContactNetwork const network = find_contact_network(harmonic64("marginal"), Potential::harmonic);
  std::vector<RelativeForce> const forces = relative_forces_of(network);
  ASSERT_EQ(forces.size(), network.backbone_contacts);
  double sum = 0.0;
  for (RelativeForce const& force : forces) {
    sum += force.force;
    Contact const& contact = network.contacts[force.contact];
    EXPECT_EQ(force.is_of_buckler,
              network.coordination[contact.first] == 3 || network.coordination[contact.second] == 3);
  }
  EXPECT_NEAR(sum / static_cast<double>(forces.size()), 1.0, 1e-12);
  EXPECT_TRUE(std::ranges::is_sorted(forces, {}, &RelativeForce::force));
}

}  // namespace
}  // namespace gridlock
