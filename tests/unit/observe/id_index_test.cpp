#include "observe/id_index.hpp"

#include <gtest/gtest.h>

#include <array>
#include <vector>

#include "io/checkpoint.hpp"

namespace gridlock {
namespace {

TEST(IdIndex, FindsThePlaceOfAnIdFromAnyRow) {
  std::array<Id, 4> const ids{7, 3, (Id{1} << 32) | 3, 0};
  IdIndex const rows(ids);
  for (std::size_t row = 0; row < 6; ++row) {
    EXPECT_EQ(rows.place_of(0, row), 0U);
    EXPECT_EQ(rows.place_of(3, row), 1U);
    EXPECT_EQ(rows.place_of(7, row), 2U);
    EXPECT_EQ(rows.place_of((Id{1} << 32) | 3, row), 3U);
    EXPECT_EQ(rows.place_of(1, row), IdIndex::not_found);
  }
  EXPECT_EQ(IdIndex().place_of(0, 0), IdIndex::not_found);
}

TEST(IdIndex, IdsWithoutAGapAreFoundFromAnyRow) {
  std::array<Id, 4> const ids{6, 8, 5, 7};
  IdIndex const rows(ids);
  EXPECT_EQ(rows.size(), 4U);
  for (std::size_t row = 0; row < 6; ++row) {
    for (Id const id : ids) EXPECT_EQ(rows.place_of(id, row), id - 5);
    for (Id const other : {Id{0}, Id{4}, Id{9}, (Id{1} << 32) | 6}) {
      EXPECT_EQ(rows.place_of(other, row), IdIndex::not_found);
    }
  }
}

TEST(IdIndex, ComeBackFromACheckpointWithAndWithoutGaps) {
  for (std::vector<Id> const& ids : {std::vector<Id>{}, {4, 5, 6}, {4, 6, 5, (Id{1} << 32) | 3}}) {
    IdIndex saved(ids);
    IdIndex restored;
    from_checkpoint(to_checkpoint([&](Archive& archive) { saved.serialize(archive); }), "a",
                    [&](Archive& archive) { restored.serialize(archive); });
    EXPECT_EQ(restored.size(), ids.size());
    for (Id const id : ids) EXPECT_EQ(restored.place_of(id, 0), saved.place_of(id, 9));
  }
}

TEST(IdIndex, BlocksAreConsecutiveAndEqualToOneAgent) {
  for (std::size_t agents = 1; agents < 100; ++agents) {
    std::vector<Id> ids(agents);
    for (std::size_t i = 0; i < agents; ++i) ids[i] = i;
    IdIndex const rows(ids);
    std::vector<std::size_t> sizes(16, 0);
    std::size_t previous = 0;
    for (std::size_t place = 0; place < agents; ++place) {
      std::size_t const block = rows.block_of(place, 16);
      ASSERT_LT(block, 16U);
      ASSERT_GE(block, previous);
      previous = block;
      ++sizes[block];
    }
    for (std::size_t const size : sizes) {
      ASSERT_GE(size, agents / 16) << agents;
      ASSERT_LE(size, agents / 16 + 1) << agents;
    }
  }
}

}  // namespace
}  // namespace gridlock
