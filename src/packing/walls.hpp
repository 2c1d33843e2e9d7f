#pragma once

#include <cstdint>
#include <vector>

#include "gridlock/engine/engine.hpp"
#include "gridlock/packing/soft_disks.hpp"

namespace gridlock {

/// Calls visit(wall, distance, direction to the wall) for every wall nearer to a point than the cutoff.
template <class Visit>
void for_each_wall(Box const& box, Vector p, double cutoff, Visit visit) {
  if (p.x < cutoff) visit(Counters::left, p.x, Vector{-1.0, 0.0});
  if (box.width() - p.x < cutoff) visit(Counters::right, box.width() - p.x, Vector{1.0, 0.0});
  if (p.y < cutoff) visit(Counters::bottom, p.y, Vector{0.0, -1.0});
  if (box.height() - p.y < cutoff) visit(Counters::top, box.height() - p.y, Vector{0.0, 1.0});
}

/// Adds the contacts of a disk with walls nearer than `factor` radii.
inline void add_wall_contacts(Packing const& packing, std::uint32_t disk, double factor,
                              std::vector<Contact>& contacts) {
  auto const disks = static_cast<std::uint32_t>(packing.size());
  double const radius = packing.radius[disk];
  for_each_wall(packing.box, {packing.x[disk], packing.y[disk]}, radius * factor,
                [&](Counters::Wall wall, double distance, Vector normal) {
                  contacts.push_back({.first = disk,
                                      .second = disks + static_cast<std::uint32_t>(wall),
                                      .normal = normal,
                                      .distance = distance,
                                      .contact_distance = radius});
                });
}

}  // namespace gridlock
