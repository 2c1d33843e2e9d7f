#include "gridlock/packing/contact_network.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <span>
#include <string>
#include <string_view>

#include "gridlock/core/error.hpp"

namespace gridlock {

namespace {

constexpr std::uint32_t fewest_contacts = 3;
constexpr double largest_overlap = 0.5;
constexpr double largest_rounding_residual = 1e-3;
constexpr double max_over_rms = 100.0;

void require_share(double value, std::string_view name) {
  if (value >= 0.0 && value <= 1.0) return;
  throw Error({.what = fmt::format("the {} is {}", name, value),
               .hint = "it is a gap over the contact distance: use a number from 0 to 1",
               .key = "disks"});
}

/// Throws Error for overlaps so deep that no minimum is near; where two centres meet, a contact has no direction.
void require_small_overlaps(std::span<Contact const> contacts, std::size_t disks) {
  auto const deepest = std::ranges::max_element(contacts, {}, &Contact::overlap);
  if (deepest == contacts.end() || deepest->overlap() <= largest_overlap) return;
  bool const is_at_wall = deepest->second >= disks;
  throw Error({.what = fmt::format(
                   "disk {} and {} are {:.6g} apart and should be {:.6g}: an overlap of {:.3g}, which is no packing",
                   deepest->first, is_at_wall ? std::string("a wall") : fmt::format("disk {}", deepest->second),
                   deepest->distance, deepest->contact_distance, deepest->overlap()),
               .hint = fmt::format("contacts are found up to overlaps of {}; are these radii, and not diameters?",
                                   largest_overlap),
               .key = "disks"});
}

/// Returns for every disk the indices of its contacts.
std::vector<std::vector<std::uint32_t>> contacts_of_disks(std::span<Contact const> contacts, std::size_t disks) {
  std::vector<std::vector<std::uint32_t>> of_disk(disks);
  for (std::uint32_t k = 0; k < contacts.size(); ++k) {
    of_disk[contacts[k].first].push_back(k);
    if (contacts[k].second < disks) of_disk[contacts[k].second].push_back(k);
  }
  return of_disk;
}

/// Removes rattlers until none is left.
void find_backbone(ContactNetwork& network) {
  std::size_t const disks = network.size();
  auto const of_disk = contacts_of_disks(network.contacts, disks);
  std::vector<std::uint32_t> to_look_at(disks);
  for (std::uint32_t i = 0; i < disks; ++i) {
    network.coordination[i] = static_cast<std::uint32_t>(of_disk[i].size());
    to_look_at[i] = i;
  }
  while (!to_look_at.empty()) {
    std::uint32_t const disk = to_look_at.back();
    to_look_at.pop_back();
    if (network.is_rattler[disk] || network.coordination[disk] >= fewest_contacts) continue;
    network.is_rattler[disk] = true;
    for (std::uint32_t const k : of_disk[disk]) {
      if (!network.is_of_backbone[k]) continue;
      network.is_of_backbone[k] = false;
      Contact const& contact = network.contacts[k];
      if (contact.second >= disks) continue;
      std::uint32_t const other = contact.first == disk ? contact.second : contact.first;
      --network.coordination[other];
      to_look_at.push_back(other);
    }
    network.coordination[disk] = 0;
  }
  network.backbone_disks = static_cast<std::size_t>(std::ranges::count(network.is_rattler, false));
  network.backbone_contacts = static_cast<std::size_t>(std::ranges::count(network.is_of_backbone, true));
}

void add_up_forces(ContactNetwork& network, Box const& box) {
  std::size_t overlaps = 0;
  double sum = 0.0;
  double sum_of_overlaps = 0.0;
  double const unit = network.smallest_diameter * network.smallest_diameter / box.area();
  for (std::size_t k = 0; k < network.contacts.size(); ++k) {
    Contact const& contact = network.contacts[k];
    double const force = network.forces[k];
    if (force > 0.0) {
      ++overlaps;
      sum_of_overlaps += contact.overlap();
    }
    sum += force;
    network.stress.add(contact, unit * force);
  }
  network.pressure = 0.5 * (0.0 - network.stress.xx - network.stress.yy);  // the 0.0 keeps −0 away
  if (overlaps == 0) return;
  network.mean_force = sum / static_cast<double>(overlaps);
  double largest = 0.0;
  double squares = 0.0;
  for (Vector const net : forces_of(network.contacts, network.potential, network.size())) {
    largest = std::max(largest, std::sqrt(squared_length(net)));
    squares += squared_length(net);
  }
  network.residual_force = largest / network.mean_force;
  network.rms_residual_force = std::sqrt(squares / static_cast<double>(network.size())) / network.mean_force;
  // Rounding of coordinates over the mean overlap: twice the limit of Minimizer, because files round once more.
  double const rounding = 0x1p-49 * std::max(box.width(), box.height());
  double const mean_overlap = network.smallest_diameter * sum_of_overlaps / static_cast<double>(overlaps);
  network.rounding_residual = std::min(largest_rounding_residual, rounding / mean_overlap);
}

}  // namespace

double ContactNetwork::contact_number() const {
  if (backbone_disks == 0) return std::numeric_limits<double>::quiet_NaN();
  return 2.0 * static_cast<double>(backbone_contacts) / static_cast<double>(backbone_disks);
}

double ContactNetwork::mean_coordination() const {
  double sum = 0.0;
  for (std::uint32_t const contacts_of_disk : coordination) sum += contacts_of_disk;
  return size() == 0 ? std::numeric_limits<double>::quiet_NaN() : sum / static_cast<double>(size());
}

std::int64_t ContactNetwork::excess_contacts() const {
  if (backbone_disks == 0) return 0;
  auto const disks = static_cast<std::int64_t>(backbone_disks);
  // A periodic packing has two motions that only shift it; a packing between walls has none.
  std::int64_t const motions = is_periodic ? 2 * (disks - 1) : 2 * disks;
  return static_cast<std::int64_t>(backbone_contacts) - (motions + 1);
}

std::vector<Contact> ContactNetwork::backbone() const {
  std::vector<Contact> found;
  for (std::size_t k = 0; k < contacts.size(); ++k) {
    if (is_of_backbone[k]) found.push_back(contacts[k]);
  }
  return found;
}

bool ContactNetwork::is_converged(double largest_residual) const {
  double const bound = std::max(largest_residual, rounding_residual);
  return rms_residual_force <= bound && residual_force <= max_over_rms * bound;
}

std::optional<bool> ContactNetwork::is_jammed(double largest_residual, std::optional<double> softest_mode) const {
  if (tolerance > 0.0) return std::nullopt;
  bool const is_held = pressure > 0.0 && backbone_disks > 0 && excess_contacts() >= 0 && is_converged(largest_residual);
  if (!is_held) return false;
  if (!softest_mode) return std::nullopt;
  return *softest_mode >= min_eigenvalue_of_a_minimum(pressure);
}

ContactNetwork find_contact_network(Packing const& packing, Potential potential, double tolerance) {
  require_share(tolerance, "tolerance");
  ContactNetwork network{.potential = potential,
                         .is_periodic = packing.box.is_periodic(),
                         .tolerance = tolerance,
                         .contacts = find_contacts(packing, tolerance)};
  require_small_overlaps(network.contacts, packing.size());
  for (Contact const& contact : network.contacts) network.forces.push_back(force_of(contact, potential));
  network.is_of_backbone.assign(network.contacts.size(), true);
  network.is_rattler.assign(packing.size(), false);
  network.coordination.assign(packing.size(), 0);
  network.energy = energy_of(network.contacts, potential);
  network.smallest_diameter = smallest_diameter(packing);
  find_backbone(network);
  add_up_forces(network, packing.box);
  return network;
}

std::vector<Contact> find_gaps(Packing const& packing, ContactNetwork const& network, double largest_gap) {
  require_share(largest_gap, "largest gap");
  std::vector<Contact> gaps;
  auto next = network.contacts.begin();
  for (Contact const& pair : find_contacts(packing, std::max(largest_gap, network.tolerance))) {
    // Both lists are sorted, and one of them contains the other.
    bool const touches = next != network.contacts.end() && next->first == pair.first && next->second == pair.second;
    if (touches) {
      ++next;
    } else if (pair.overlap() > -largest_gap) {
      gaps.push_back(pair);
    }
  }
  std::ranges::stable_sort(gaps, std::greater<>(), &Contact::overlap);
  return gaps;
}

std::vector<RelativeForce> relative_forces_of(ContactNetwork const& network) {
  std::vector<RelativeForce> found;
  auto const has_three = [&](std::uint32_t disk) {
    return disk < network.size() && network.coordination[disk] == fewest_contacts;
  };
  double sum = 0.0;
  for (std::size_t k = 0; k < network.contacts.size(); ++k) {
    if (!network.is_of_backbone[k] || !(network.forces[k] > 0.0)) continue;
    Contact const& contact = network.contacts[k];
    bool const is_of_buckler = has_three(contact.first) || has_three(contact.second);
    found.push_back({.contact = k, .force = network.forces[k], .is_of_buckler = is_of_buckler});
    sum += network.forces[k];
  }
  double const mean = sum / static_cast<double>(found.size());
  for (RelativeForce& force : found) force.force /= mean;
  std::ranges::stable_sort(found, {}, &RelativeForce::force);
  return found;
}

}  // namespace gridlock
