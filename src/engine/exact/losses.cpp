#include "engine/exact/losses.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string>

#include "gridlock/core/error.hpp"

namespace gridlock::exact {

namespace {

void require_size(std::vector<double> const& given, std::size_t wanted, std::size_t kinds, std::string const& key,
                  std::string const& order) {
  if (given.empty() || given.size() == wanted) return;
  throw Error({.what = fmt::format("collisions.{} has {} numbers, and {} kinds of disks need {}", key, given.size(),
                                   kinds, wanted),
               .hint = fmt::format("kinds are in the order of radius, then of mass; give {}", order),
               .key = fmt::format("collisions.{}", key)});
}

}  // namespace

Kinds kinds_of(Disks const& disks) {
  Kinds kinds;
  for (std::size_t i = 0; i < disks.size(); ++i) {
    std::pair const kind{disks.column<Radius>()[i], disks.column<Mass>()[i]};
    if (!kinds.empty() && kinds.back() == kind) continue;
    auto const place = std::ranges::lower_bound(kinds, kind);
    if (place == kinds.end() || *place != kind) kinds.insert(place, kind);
    if (kinds.size() > max_kinds_in_collisions) break;
  }
  return kinds;
}

Losses losses_for(CollisionSettings const& settings, Disks const& disks) {
  std::vector<double> const& pairs = settings.restitution_by_kind;
  std::vector<double> const& walls = settings.wall_restitution_by_kind;
  Losses losses{.contact_time = settings.contact_time, .exist = settings.lose_energy()};
  std::size_t const n = pairs.empty() && walls.empty() ? 1 : kinds_of(disks).size();
  require_size(pairs, n * (n + 1) / 2, n, "restitution_by_kind", "e of AA, AB, …, BB, BC, …");
  require_size(walls, n, n, "wall_restitution_by_kind", "e of A, B, …");
  losses.kinds = n;
  losses.of_pairs.assign(n * n, settings.restitution);
  losses.of_walls.assign(n, settings.of_walls());
  if (!walls.empty()) losses.of_walls = walls;
  for (std::size_t a = 0, k = 0; a < n && !pairs.empty(); ++a) {
    for (std::size_t b = a; b < n; ++b, ++k) losses.of_pairs[a * n + b] = losses.of_pairs[b * n + a] = pairs[k];
  }
  return losses;
}

}  // namespace gridlock::exact
