#include "lattice/random_insertion.hpp"

#include <algorithm>
#include <functional>
#include <numbers>
#include <numeric>
#include <utility>

namespace gridlock {

RandomInsertion::RandomInsertion(Box const& box, std::vector<double> radii, std::uint64_t seed)
    : box_(box),
      seed_(seed),
      radii_(std::move(radii)),
      sites_(radii_.size()),
      largest_(*std::ranges::max_element(radii_)),
      grid_(layout_for_cutoff(box, 2.0 * largest_, radii_.size())),
      attempts_left_(max_attempts_for(radii_.size())) {}

std::size_t RandomInsertion::place_all() {
  std::vector<std::size_t> order(sites_.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, std::ranges::greater{}, [&](std::size_t i) { return radii_[i]; });
  std::size_t placed = 0;
  for (std::size_t const i : order) {
    if (!place(i)) break;
    ++placed;
    covered_ += std::numbers::pi * radii_[i] * radii_[i];
  }
  return placed;
}

bool RandomInsertion::place(std::size_t i) {
  RandomStream random = places_of(seed_, i);
  AllowedCentres const centres(box_, radii_[i]);
  if (centres.are_none()) return false;
  for (; attempts_left_ > 0; --attempts_left_) {
    Vector const p = centres.draw(random);
    if (!is_free(i, p)) continue;
    sites_[i] = p;
    grid_.insert(i, p);
    return true;
  }
  return false;
}

bool RandomInsertion::is_free(std::size_t i, Vector p) const {
  bool is_free = true;
  auto const look_around = [&](Vector place) {
    grid_.for_each_candidate(place, radii_[i] + largest_, [&](std::size_t j) {
      double const contact = radii_[i] + radii_[j];
      if (squared_length(box_.displacement(p, sites_[j])) < contact * contact) is_free = false;
    });
  };
  look_around(p);
  if (!box_.is_oblique()) return is_free;
  // The grid is that of a rectangle: across its lower and its upper edge lies what is xy farther to the left or right.
  for (double const lean : {-box_.shift(), box_.shift()}) look_around({p.x + lean, p.y});
  return is_free;
}

}  // namespace gridlock
