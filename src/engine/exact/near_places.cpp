#include "engine/exact/near_places.hpp"

#include <algorithm>
#include <cmath>

namespace gridlock::exact {

namespace {

// There are no branches, because no processor can guess which slots are empty and which disks are neighbours.

std::size_t collect(Index const* slots, std::size_t count, Index apart, Index* names) {
  std::size_t found = 0;
  for (std::size_t k = 0; k < count; ++k) {
    names[found] = slots[k];
    found += static_cast<std::size_t>((slots[k] != no_disk) & (slots[k] != apart));
  }
  return found;
}

double positive_part(double number) { return 0.5 * (number + std::abs(number)); }

std::size_t keep(PlacesAround const& around, Index* names, std::size_t count) {
  std::size_t near = 0;
  for (std::size_t k = 0; k < count; ++k) {
    Index const other = names[k];
    double d_x = std::abs(around.places[other].x - around.place.x);
    double d_y = std::abs(around.places[other].y - around.place.y);
    if (around.has_images) {
      d_x = std::min(d_x, std::abs(around.period_x - d_x));
      d_y = std::min(d_y, std::abs(around.period_y - d_y));
    }
    double const gap_x = positive_part(d_x - around.rooms);
    double const gap_y = positive_part(d_y - around.rooms);
    double const radius = around.radius != nullptr ? around.radius[other] : around.own_radius;
    double const contact = (around.own_radius + radius) * around.scale;
    names[near] = other;
    near += static_cast<std::size_t>(gap_x * gap_x + gap_y * gap_y <= contact * contact);
  }
  return near;
}

/// Returns the square of the distance of two places minus the rooms of both, for the image that is up to a height above
/// or below.
double squared_gap(PlacesAround const& around, Place const& other, double image) {
  double const d_y = other.y - around.place.y + image * around.period_y;
  double const d_x = other.x - around.place.x + image * around.lean;
  double const nearest_x = d_x - std::round(d_x / around.period_x) * around.period_x;
  double const gap_x = positive_part(std::abs(nearest_x) - around.rooms);
  double const gap_y = positive_part(std::abs(d_y) - around.rooms);
  return gap_x * gap_x + gap_y * gap_y;
}

}  // namespace

NearPlaces near_places_for(Target target) {
  if (target == Target::avx512) {
    if (auto const kernels = near_places_with_avx512()) return *kernels;
  }
  return {collect, keep};
}

std::size_t keep_in_oblique_box(PlacesAround const& around, Index* names, std::size_t count) {
  std::size_t near = 0;
  for (std::size_t k = 0; k < count; ++k) {
    Index const other = names[k];
    double gap = squared_gap(around, around.places[other], 0.0);
    for (double const image : {-1.0, 1.0}) gap = std::min(gap, squared_gap(around, around.places[other], image));
    double const radius = around.radius != nullptr ? around.radius[other] : around.own_radius;
    double const contact = (around.own_radius + radius) * around.scale;
    names[near] = other;
    near += static_cast<std::size_t>(gap <= contact * contact);
  }
  return near;
}

}  // namespace gridlock::exact
