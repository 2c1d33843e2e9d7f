#include "engine/exact/near_places.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "gridlock/core/random.hpp"

namespace gridlock::exact {
namespace {

/// Room for what a kernel may write.
std::vector<Index> with_room(std::vector<Index> names) {
  names.resize(names.size() + names_per_batch, no_disk);
  return names;
}

TEST(NearPlaces, CollectsTheNamesInSlotsWithEveryTarget) {
  RandomStream random(11, 0, 0, Purpose::start_position);
  for (std::size_t count = 0; count <= 70; ++count) {
    std::vector<Index> slots;
    for (std::size_t k = 0; k < count + names_per_batch; ++k) {
      slots.push_back(random.below(2) == 0 ? no_disk : static_cast<Index>(random.below(9)));
    }
    std::vector<Index> expected(slots.begin(), slots.begin() + static_cast<std::ptrdiff_t>(count));
    std::erase_if(expected, [](Index name) { return name == no_disk || name == 5; });
    for (Target const target : available_targets()) {
      std::vector<Index> names = with_room(std::vector<Index>(count));
      names.resize(near_places_for(target).collect(slots.data(), count, 5, names.data()));
      EXPECT_EQ(names, expected) << to_text(target) << ", " << count << " slots";
    }
  }
}

/// One by one, with the branches that kernels do without.
std::vector<Index> near_ones(PlacesAround const& around, std::vector<Index> names) {
  std::erase_if(names, [&](Index name) {
    auto const gap = [&](double d, double period) {
      double const direct = std::abs(d);
      double const distance = std::min(direct, std::abs(period - direct));
      return distance > around.rooms ? distance - around.rooms : 0.0;
    };
    double const x = gap(around.places[name].x - around.place.x, around.period_x);
    double const y = gap(around.places[name].y - around.place.y, around.period_y);
    double const radius = around.radius != nullptr ? around.radius[name] : around.own_radius;
    double const contact = (around.own_radius + radius) * around.scale;
    return !(x * x + y * y <= contact * contact);
  });
  return names;
}

TEST(NearPlaces, KeepsThoseThatAreNearWithEveryTarget) {
  RandomStream random(12, 0, 0, Purpose::start_position);
  constexpr double infinite = std::numeric_limits<double>::infinity();  // between walls
  std::size_t kept = 0;
  for (std::size_t count = 0; count <= 40; ++count) {
    for (int scene = 0; scene < 8; ++scene) {
      std::vector<Place> places;
      std::vector<double> radii;
      std::vector<Index> names;
      for (Index i = 0; i < 50; ++i) {
        // Some in lines, where distances tie.
        bool const is_in_line = random.below(4) == 0;
        double const x = 2.0 * random.uniform();
        places.push_back({is_in_line ? 0.25 * std::floor(4.0 * x) : x, random.uniform()});
        radii.push_back(0.02 + 0.1 * random.uniform());
      }
      for (std::size_t k = 0; k < count; ++k) names.push_back(static_cast<Index>(random.below(50)));
      PlacesAround const around{.places = places.data(),
                                .radius = scene % 2 == 0 ? radii.data() : nullptr,
                                .place = {0.25, 0.1 + 0.01 * scene},
                                .own_radius = 0.125,
                                .rooms = scene % 3 == 0 ? 0.0 : 0.05,
                                .scale = 1.0 + 1e-9,
                                .period_x = scene >= 4 && scene != 6 ? 2.0 : infinite,
                                .period_y = scene >= 4 && scene != 7 ? 1.0 : infinite,
                                .has_images = scene >= 4};
      std::vector<Index> const expected = near_ones(around, names);
      kept += expected.size();
      for (Target const target : available_targets()) {
        std::vector<Index> found = with_room(names);
        found.resize(near_places_for(target).keep(around, found.data(), count));
        EXPECT_EQ(found, expected) << to_text(target) << ", " << count << " names, scene " << scene;
      }
    }
  }
  EXPECT_GT(kept, 500U);
}

}  // namespace
}  // namespace gridlock::exact
