#pragma once

#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <numeric>
#include <utility>
#include <vector>

#include "gridlock/core/disks.hpp"
#include "gridlock/core/random.hpp"

namespace gridlock::reference {

/// The same disks under the same Ids, their rows in another order.
inline State with_rows_shuffled(State const& state, std::uint64_t seed) {
  State shuffled{.box = state.box, .agents = {}, .clock = state.clock, .seed = state.seed};
  std::vector<std::size_t> rows(state.agents.size());
  std::iota(rows.begin(), rows.end(), std::size_t{0});
  RandomStream random(seed, 1, 0, Purpose::start_position);
  for (std::size_t k = rows.size(); k > 1; --k) std::swap(rows[k - 1], rows[random.below(k)]);
  Disks const& d = state.agents;
  for (std::size_t const i : rows) {
    EXPECT_TRUE(shuffled.agents.add_as(d.ids()[i], d.column<X>()[i], d.column<Y>()[i], d.column<VelocityX>()[i],
                                       d.column<VelocityY>()[i], d.column<Radius>()[i], d.column<Mass>()[i],
                                       d.column<ImageX>()[i], d.column<ImageY>()[i]));
  }
  return shuffled;
}

}  // namespace gridlock::reference
