// Packings at random: contacts against all pairs, forces against differences of the energy, the Hessian against
// differences of the forces, the backbone against its definition.

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "gridlock/packing/contact_network.hpp"
#include "gridlock/packing/elasticity.hpp"
#include "reference/soft_minimum.hpp"

namespace gridlock {
namespace {

/// 20 to 40 disks, many of which overlap or nearly touch; fewer could touch two images of another.
Packing any_packing() {
  auto const count = *rc::gen::inRange<std::size_t>(20, 41);
  Box const box(1.0, *rc::gen::element(0.8, 1.0, 1.5), *rc::gen::element(Edge::wall, Edge::periodic));
  double const packing_fraction = *rc::gen::element(0.3, 0.6, 0.8);
  return reference::random_packing(count, packing_fraction, box, *rc::gen::arbitrary<std::uint64_t>());
}

Potential any_potential() { return *rc::gen::element(Potential::harmonic, Potential::hertzian); }

std::size_t pairs_within(Packing const& packing, double largest_gap) {
  std::size_t found = 0;
  for (std::size_t i = 0; i < packing.size(); ++i) {
    double const factor = 1.0 + largest_gap;
    for (std::size_t j = i + 1; j < packing.size(); ++j) {
      Vector const d = packing.box.displacement({packing.x[i], packing.y[i]}, {packing.x[j], packing.y[j]});
      if (std::sqrt(squared_length(d)) < (packing.radius[i] + packing.radius[j]) * factor) ++found;
    }
    if (packing.box.is_periodic()) continue;
    for (double const distance :
         {packing.x[i], packing.box.width() - packing.x[i], packing.y[i], packing.box.height() - packing.y[i]}) {
      if (distance < packing.radius[i] * factor) ++found;
    }
  }
  return found;
}

RC_GTEST_PROP(Contacts, AreThoseOfAllPairsAndWallsInTheOrderOfTheirNumbers, ()) {
  Packing const packing = any_packing();
  double const largest_gap = *rc::gen::element(0.0, 1e-3, 0.3);
  std::vector<Contact> const contacts = find_contacts(packing, largest_gap);
  RC_ASSERT(contacts.size() == pairs_within(packing, largest_gap));
  for (std::size_t k = 0; k < contacts.size(); ++k) {
    Contact const& contact = contacts[k];
    RC_ASSERT(contact.first < contact.second);
    RC_ASSERT(contact.overlap() > -largest_gap - 1e-15);
    RC_ASSERT(std::abs(squared_length(contact.normal) - 1.0) < 1e-12);
    if (k == 0) continue;
    RC_ASSERT(std::pair(contacts[k - 1].first, contacts[k - 1].second) < std::pair(contact.first, contact.second));
  }
}

RC_GTEST_PROP(Forces, AreTheSlopeOfTheEnergy, ()) {
  Packing const packing = any_packing();
  Potential const potential = any_potential();
  Eigen::VectorXd const forces = reference::force_vector(packing, potential);
  double const step = 1e-6 * smallest_diameter(packing);
  for (Eigen::Index row = 0; row < forces.size(); row += 5) {
    Eigen::VectorXd displacement = Eigen::VectorXd::Zero(forces.size());
    displacement(row) = step;
    double const after = reference::energy_of(reference::moved(packing, displacement), potential);
    double const before = reference::energy_of(reference::moved(packing, -displacement), potential);
    // A contact that opens or closes within the step bends the slope by its stiffness.
    RC_ASSERT(std::abs((before - after) / (2.0 * step) - forces(row)) < 1e-5 / smallest_diameter(packing));
  }
}

RC_GTEST_PROP(Hessian, IsTheSlopeOfTheForces, ()) {
  Packing const packing = any_packing();
  Potential const potential = any_potential();
  std::vector<Contact> const contacts = find_contacts(packing);
  // Where centres meet, and where a contact opens or closes, forces have no slope.
  double const step = 1e-7 * smallest_diameter(packing);
  for (Contact const& contact : find_contacts(packing, 0.01)) {
    RC_PRE(contact.distance > 0.1 * contact.contact_distance && std::abs(contact.overlap()) > 1e-4);
  }
  Eigen::MatrixXd const hessian =
      Eigen::MatrixXd(hessian_of(contacts, potential, Unknowns(packing.size()))).selfadjointView<Eigen::Lower>();
  Eigen::Index const size = hessian.rows();
  auto const column = *rc::gen::inRange<Eigen::Index>(0, size);
  Eigen::VectorXd displacement = Eigen::VectorXd::Zero(size);
  displacement(column) = step;
  Eigen::VectorXd const slope = (reference::force_vector(reference::moved(packing, -displacement), potential) -
                                 reference::force_vector(reference::moved(packing, displacement), potential)) /
                                (2.0 * step);
  RC_ASSERT((slope - hessian.col(column)).cwiseAbs().maxCoeff() < 1e-4 * (1.0 + hessian.cwiseAbs().maxCoeff()));
}

RC_GTEST_PROP(Hessian, OfSomeDisksIsThatOfAllWithoutTheRowsOfTheOthers, ()) {
  Packing const packing = any_packing();
  Potential const potential = any_potential();
  std::vector<Contact> const contacts = find_contacts(packing);
  std::vector<bool> takes_part(packing.size());
  std::vector<Eigen::Index> rows;
  for (std::size_t i = 0; i < packing.size(); ++i) {
    takes_part[i] = *rc::gen::arbitrary<bool>();
    if (!takes_part[i]) continue;
    rows.push_back(static_cast<Eigen::Index>(2 * i));
    rows.push_back(static_cast<Eigen::Index>(2 * i + 1));
  }
  Eigen::MatrixXd const all = Eigen::MatrixXd(hessian_of(contacts, potential, Unknowns(packing.size())));
  Eigen::MatrixXd const some = Eigen::MatrixXd(hessian_of(contacts, potential, Unknowns(takes_part)));
  RC_ASSERT((some - all(rows, rows)).norm() <= 1e-12 * (1.0 + all.norm()));
}

/// Takes one disk at a time, whichever is first.
std::vector<bool> rattlers_of(std::vector<Contact> const& contacts, std::size_t disks) {
  std::vector<bool> is_rattler(disks);
  for (bool is_done = false; !is_done;) {
    is_done = true;
    std::vector<int> counts(disks);
    for (Contact const& contact : contacts) {
      bool const is_at_wall = contact.second >= disks;
      if (is_rattler[contact.first] || (!is_at_wall && is_rattler[contact.second])) continue;
      ++counts[contact.first];
      if (!is_at_wall) ++counts[contact.second];
    }
    for (std::size_t i = 0; i < disks && is_done; ++i) {
      if (is_rattler[i] || counts[i] >= 3) continue;
      is_rattler[i] = true;
      is_done = false;
    }
  }
  return is_rattler;
}

RC_GTEST_PROP(ContactNetwork, HasTheRattlersOfTheDefinition, ()) {
  Box const box(1.0, *rc::gen::element(0.8, 1.3), *rc::gen::element(Edge::wall, Edge::periodic));
  Packing const packing = reference::minimum_near(
      reference::random_packing(30, 0.86, box, *rc::gen::arbitrary<std::uint64_t>()), Potential::harmonic);
  double const tolerance = *rc::gen::element(0.0, 1e-3, 0.05);
  auto const contacts = find_contacts(packing, tolerance);
  ContactNetwork const network = find_contact_network(packing, Potential::harmonic, tolerance);
  RC_ASSERT(network.is_rattler == rattlers_of(contacts, packing.size()));
  auto const rattlers = static_cast<std::size_t>(std::ranges::count(network.is_rattler, true));
  RC_ASSERT(network.backbone_disks + rattlers == packing.size());
  for (std::size_t k = 0; k < contacts.size(); ++k) {
    bool const is_held = !network.is_rattler[contacts[k].first] &&
                         (contacts[k].second >= packing.size() || !network.is_rattler[contacts[k].second]);
    RC_ASSERT(network.is_of_backbone[k] == is_held);
  }
}

RC_GTEST_PROP(ContactNetwork, OfAMinimumBalancesAndIsNotUnstable, ()) {
  Potential const potential = any_potential();
  Edge const edge = *rc::gen::element(Edge::wall, Edge::periodic);
  Packing const packing = reference::minimum_near(
      reference::random_packing(20, 1.0, Box(1.0, 1.2, edge), *rc::gen::arbitrary<std::uint64_t>()), potential);
  ContactNetwork const network = find_contact_network(packing, potential);
  RC_ASSERT(network.is_converged(1e-7));
  RC_ASSERT(network.is_jammed(1e-7, find_softest_mode(network).value().eigenvalue) == true);
  double const unit = smallest_diameter(packing) * smallest_diameter(packing);
  RC_ASSERT(std::abs(network.pressure - unit * pressure_of(network.contacts, potential, packing.box)) <=
            1e-12 * network.pressure);
  RC_ASSERT(find_softest_mode(network).value().eigenvalue > -1e-9);
  // Moduli may be negative, for the box was not free to change its shape.
  RC_ASSERT(find_elastic_moduli(packing, network).has_value());
}

}  // namespace
}  // namespace gridlock
