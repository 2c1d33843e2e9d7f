#include "gridlock/packing/soft_disks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string_view>

#include "gridlock/core/detail/rows_in_order.hpp"
#include "gridlock/core/error.hpp"
#include "gridlock/grid/neighbour_lists.hpp"
#include "packing/potential.hpp"
#include "packing/walls.hpp"

namespace gridlock {

namespace {

void require_room_for_images(Box const& box, double cutoff) {
  double const side = std::min(box.width(), box.height());
  if (!box.is_periodic() || side > 2.0 * cutoff) return;
  throw Error({.what = fmt::format(
                   "in a periodic box of {} × {} a disk could touch two images of the same partner; distances of "
                   "{:.6g} need sides above {:.6g}",
                   box.width(), box.height(), cutoff, 2.0 * cutoff),
               .hint = "use more disks, smaller disks or a larger box",
               .key = "disks"});
}

}  // namespace

char const* to_text(Potential potential) { return potential == Potential::harmonic ? "harmonic" : "hertzian"; }

Packing packing_of(State const& state) {
  Disks const& disks = state.agents;
  Packing packing{.box = state.box, .x = {}, .y = {}, .radius = {}};
  for (std::uint32_t const row : rows_in_order(disks.ids())) {
    packing.x.push_back(disks.column<X>()[row]);
    packing.y.push_back(disks.column<Y>()[row]);
    packing.radius.push_back(disks.column<Radius>()[row]);
  }
  return packing;
}

double smallest_diameter(Packing const& packing) {
  return packing.radius.empty() ? 0.0 : 2.0 * *std::ranges::min_element(packing.radius);
}

double packing_fraction(Packing const& packing) {
  double sum = 0.0;
  for (double const radius : packing.radius) sum += radius * radius;
  return std::numbers::pi * sum / packing.box.area();
}

double energy_of(Contact const& contact, Potential potential) { return Law(potential).energy(contact.overlap()); }
double force_of(Contact const& contact, Potential potential) {
  return Law(potential).force(contact.overlap(), contact.contact_distance);
}
double stiffness_of(Contact const& contact, Potential potential) {
  return Law(potential).stiffness(contact.overlap(), contact.contact_distance);
}

std::vector<Contact> find_contacts(Packing const& packing, double largest_gap) {
  require_valid(packing);
  double const factor = 1.0 + largest_gap;
  double const cutoff = largest_contact_distance(packing.radius) * factor;
  std::vector<Contact> contacts;
  // A single disk can touch its own images.
  if (packing.size() == 1 && 2.0 * cutoff > std::min(packing.box.width(), packing.box.height())) {
    require_room_for_images(packing.box, cutoff);
  }
  if (packing.size() > 1) {
    require_room_for_images(packing.box, cutoff);
    PointPairs const pairs =
        find_pairs_of_disks(packing.box, {.factor = factor},
                            {.x = packing.x.data(), .y = packing.y.data(), .count = packing.size()}, packing.radius);
    for (std::size_t k = 0; k < pairs.size(); ++k) {
      auto const [i, j] = std::minmax(pairs.first()[k], pairs.second()[k]);
      Vector const d = packing.box.displacement({packing.x[i], packing.y[i]}, {packing.x[j], packing.y[j]});
      double const sigma = packing.radius[i] + packing.radius[j];
      double const distance = std::sqrt(squared_length(d));
      if (distance >= sigma * factor) continue;
      // Two centres at one point have no direction; any will do.
      Vector const normal = distance > 0.0 ? Vector{d.x / distance, d.y / distance} : Vector{1.0, 0.0};
      contacts.push_back({.first = i, .second = j, .normal = normal, .distance = distance, .contact_distance = sigma});
    }
  }
  if (!packing.box.is_periodic()) {
    for (std::uint32_t i = 0; i < packing.size(); ++i) add_wall_contacts(packing, i, factor, contacts);
  }
  std::ranges::sort(contacts, [](Contact const& a, Contact const& b) {
    return a.first != b.first ? a.first < b.first : a.second < b.second;
  });
  return contacts;
}

double energy_of(std::span<Contact const> contacts, Potential potential) {
  double sum = 0.0;
  for (Contact const& contact : contacts) sum += energy_of(contact, potential);
  return sum;
}

std::vector<Vector> forces_of(std::span<Contact const> contacts, Potential potential, std::size_t disks) {
  std::vector<Vector> forces(disks);
  for (Contact const& contact : contacts) {
    Vector const push = force_of(contact, potential) * contact.normal;
    forces[contact.first] = forces[contact.first] - push;
    if (contact.second < disks) forces[contact.second] = forces[contact.second] + push;
  }
  return forces;
}

double pressure_of(std::span<Contact const> contacts, Potential potential, Box const& box) {
  double virial = 0.0;
  for (Contact const& contact : contacts) virial += force_of(contact, potential) * contact.distance;
  return virial / (2.0 * box.area());
}

void require_equal_edges(Box const& box) {
  if (box.edge_x() == box.edge_y()) return;
  throw Error({.what = fmt::format("soft disks and contacts in a box that is {}", edges_in_words(box)),
               .hint = "they need walls on all four sides, or periodic edges in x and y: box.edge",
               .key = "box"});
}

void require_valid(Packing const& packing) {
  require_equal_edges(packing.box);
  std::size_t const disks = packing.size();
  if (packing.y.size() != disks || packing.radius.size() != disks) {
    throw Error(
        {.what = fmt::format("a packing of {} x, {} y and {} radii", disks, packing.y.size(), packing.radius.size()),
         .hint = "give one of each for every disk",
         .key = "disks"});
  }
  for (std::size_t i = 0; i < disks; ++i) {
    double const x = packing.x[i];
    double const y = packing.y[i];
    double const radius = packing.radius[i];
    auto const refuse = [&](std::string_view what) {
      throw Error({.what = fmt::format("disk {} at ({}, {}) of radius {}: {}", i, x, y, radius, what),
                   .hint = {},
                   .key = "disks"});
    };
    if (!std::isfinite(x) || !std::isfinite(y)) refuse("a position must be finite");
    if (!(radius > 0.0) || !std::isfinite(radius)) refuse("a radius must be a number above 0");
    bool const is_inside = x >= 0.0 && y >= 0.0 && x <= packing.box.width() && y <= packing.box.height();
    if (!packing.box.is_periodic() && !is_inside) refuse("its centre is outside the walls");
  }
}

}  // namespace gridlock
