#include "observe/id_blocks.hpp"

#include <gtest/gtest.h>

#include <cstddef>
#include <vector>

#include "unit/observe/hand_built.hpp"

namespace gridlock {
namespace {

TEST(IdBlocks, AreConsecutiveAndEqualToOneAgent) {
  State const state = hand_built::empty_state(Box(1, 1, Edge::wall));
  Counters const counters;
  for (Id const step : {1U, 3U}) {
    for (std::size_t agents = 1; agents < 100; ++agents) {
      std::vector<Id> ids(agents);
      for (std::size_t i = 0; i < agents; ++i) ids[i] = 7 + step * i;
      IdBlocks const blocks({state, counters}, IdIndex(ids));
      for (std::size_t place = 0; place < agents; ++place) {
        ASSERT_EQ(blocks.block_of(ids[place]), 16 * place / agents) << place << " of " << agents;
      }
    }
  }
}

}  // namespace
}  // namespace gridlock
