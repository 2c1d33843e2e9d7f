#include "packing/site_forces.hpp"

#include <array>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace gridlock {

namespace {

/// Returns how a separation changes with the strain of a pure and of a simple shear.
std::array<Vector, 2> stretches_of(Vector r) { return {{{0.5 * r.x, -0.5 * r.y}, {r.y, 0.0}}}; }

/// Adds the two rows of the box below those of the disks.
void add_box(std::vector<HessianEntry>& entries, std::span<Contact const> contacts, Potential potential,
             std::size_t disks, double length) {
  std::vector<double> rows(4 * disks);  // for each disk the entries pure x, pure y, simple x, simple y
  std::array<double, 3> box{};          // pure pure, simple pure, simple simple
  for (Contact const& contact : contacts) {
    if (contact.overlap() <= 0.0) continue;
    HessianBlock const block = block_of(contact, potential, false);
    auto const stretches = stretches_of(contact.distance * contact.normal);
    Vector const pure = block * stretches[0];
    Vector const simple = block * stretches[1];
    for (auto const& [disk, sign] : {std::pair{contact.first, -1.0}, std::pair{contact.second, 1.0}}) {
      double* const row = &rows[std::size_t{4} * disk];
      row[0] += sign * pure.x;
      row[1] += sign * pure.y;
      row[2] += sign * simple.x;
      row[3] += sign * simple.y;
    }
    // A pure shear stretches by e^(±γ/2), whose second derivative adds ¼ r·dV/dr.
    box[0] += dot(stretches[0], pure) - 0.25 * force_of(contact, potential) * contact.distance;
    box[1] += dot(stretches[1], pure);
    box[2] += dot(stretches[1], simple);
  }
  auto const first = static_cast<int>(2 * disks);
  for (std::size_t k = 0; k < 2 * disks; ++k) {
    double const* const row = &rows[4 * (k / 2)];
    entries.emplace_back(first, static_cast<int>(k), row[k % 2] / length);
    entries.emplace_back(first + 1, static_cast<int>(k), row[2 + k % 2] / length);
  }
  double const square = length * length;
  entries.emplace_back(first, first, box[0] / square);
  entries.emplace_back(first + 1, first, box[1] / square);
  entries.emplace_back(first + 1, first + 1, box[2] / square);
}

}  // namespace

void deform(Packing& packing, double pure_shear, double simple_shear) {
  double const stretch = (1.0 + 0.25 * pure_shear) / (1.0 - 0.25 * pure_shear);
  Box const& before = packing.box;
  double const height = before.height() / stretch;
  double const shift = stretch * before.shift() + simple_shear * height;
  Box const box(stretch * before.width(), height, Edge::periodic);
  packing.widths_shifted_back += static_cast<std::int32_t>(box.widths_in(shift));
  packing.box = box.shifted(shift);
  for (std::size_t i = 0; i < packing.size(); ++i) {
    double const y = packing.y[i] / stretch;
    packing.x[i] = stretch * packing.x[i] + simple_shear * y;
    packing.y[i] = y;
  }
}

SiteForces::SiteForces(Packing const& packing, MinimizerSettings const& settings)
    : disks_(packing.size()),
      potential_(settings.potential),
      is_box_free_(settings.box_shape == BoxShape::free),
      of_disks_(packing, settings.potential, settings.threads) {
  if (is_box_free_) of_disks_.add_up_shear();
}

ForceSums SiteForces::with_box(Packing const& packing, ForceSums sums, Columns const& velocities,
                               Columns& forces) const {
  if (!is_box_free_) return sums;
  double const length = packing.box.side();
  Vector const force{sums.pure_shear / length, sums.simple_shear / length};
  Vector const velocity{velocities.x[disks_], velocities.y[disks_]};
  forces.x[disks_] = force.x;
  forces.y[disks_] = force.y;
  sums.box_square = squared_length(force);
  sums.force_squares += sums.box_square;
  sums.power += dot(force, velocity);
  sums.speed_squares += squared_length(velocity);
  return sums;
}

void SiteForces::displace(Packing& packing, Columns const& step, double factor) const {
  for (std::size_t i = 0; i < disks_; ++i) {
    packing.x[i] += factor * step.x[i];
    packing.y[i] += factor * step.y[i];
  }
  if (!is_box_free_) return;
  double const length = packing.box.side();
  deform(packing, factor * step.x[disks_] / length, factor * step.y[disks_] / length);
}

SparseMatrix SiteForces::hessian(Packing const& packing) {
  std::vector<Contact> const contacts = of_disks_.contacts(packing);
  std::vector<HessianEntry> entries = hessian_entries(contacts, potential_, Unknowns(disks_));
  if (is_box_free_) add_box(entries, contacts, potential_, disks_, packing.box.side());
  return hessian_of(entries, sites());
}

void serialize_places(Archive& archive, Packing& packing, BoxShape shape) {
  archive.visit("x", packing.x);
  archive.visit("y", packing.y);
  if (shape == BoxShape::fixed) return;
  double width = packing.box.width();
  double height = packing.box.height();
  double shift = packing.box.shift();
  archive.visit("box_width", width);
  archive.visit("box_height", height);
  archive.visit("box_shift", shift);
  double widths = packing.widths_shifted_back;
  archive.visit("widths_shifted_back", widths);
  if (!archive.is_restoring()) return;
  packing.box = Box(width, height, Edge::periodic).shifted(shift);
  packing.widths_shifted_back = static_cast<std::int32_t>(widths);
}

}  // namespace gridlock
