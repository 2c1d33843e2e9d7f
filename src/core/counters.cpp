#include "gridlock/core/counters.hpp"

#include <algorithm>
#include <vector>

namespace gridlock {

void add(Counters& sum, Counters const& part) {
  sum.moves += part.moves;
  sum.halted_moves += part.halted_moves;
  sum.pair_collisions += part.pair_collisions;
  sum.distance_checks += part.distance_checks;
  for (std::size_t wall = 0; wall < 4; ++wall) {
    sum.wall_hits[wall] += part.wall_hits[wall];
    sum.wall_impulse[wall] += part.wall_impulse[wall];
  }
  sum.inner_wall_hits += part.inner_wall_hits;
  sum.inner_wall_impulse += part.inner_wall_impulse;
  sum.pair_virial += part.pair_virial;
  sum.swum += part.swum;
  sum.swum_if_free += part.swum_if_free;
}

void serialize(Archive& archive, Counters& counters) {
  archive.visit("moves", counters.moves);
  archive.visit("halted_moves", counters.halted_moves);
  archive.visit("pair_collisions", counters.pair_collisions);
  archive.visit("distance_checks", counters.distance_checks);
  std::vector<std::uint64_t> hits(counters.wall_hits.begin(), counters.wall_hits.end());
  std::vector<double> impulses(counters.wall_impulse.begin(), counters.wall_impulse.end());
  archive.visit("wall_hits", hits);
  archive.visit("wall_impulse", impulses);
  archive.visit("inner_wall_hits", counters.inner_wall_hits);
  archive.visit("inner_wall_impulse", counters.inner_wall_impulse);
  archive.visit("pair_virial", counters.pair_virial);
  archive.visit("swum", counters.swum);
  archive.visit("swum_if_free", counters.swum_if_free);
  archive.require(hits.size() == counters.wall_hits.size() && impulses.size() == counters.wall_impulse.size(),
                  "a box has four walls");
  std::ranges::copy(hits, counters.wall_hits.begin());
  std::ranges::copy(impulses, counters.wall_impulse.begin());
}

}  // namespace gridlock
