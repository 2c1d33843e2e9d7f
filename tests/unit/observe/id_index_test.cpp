#include "gridlock/observe/detail/id_index.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstddef>
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

TEST(IdIndex, KeepsTheOrderOfTheRowsInACheckpoint) {
  for (std::vector<Id> const& ids : {std::vector<Id>{4, 5, 6}, {6, 4, 5}, {9, 4, 6}}) {
    IdIndex saved(ids);
    IdIndex restored;
    from_checkpoint(to_checkpoint([&](Archive& archive) { saved.serialize(archive); }), "a",
                    [&](Archive& archive) { restored.serialize(archive); });
    for (std::size_t row = 0; row < ids.size(); ++row) {
      EXPECT_EQ(saved.place_of_row(row), saved.place_of(ids[row], row));
      EXPECT_EQ(restored.place_of_row(row), saved.place_of_row(row));
    }
  }
}

TEST(IdIndex, CountsTheAgentsWithALowerId) {
  for (std::vector<Id> const& ids : {std::vector<Id>{}, {4, 6, 5}, {4, 9, 6, (Id{1} << 32) | 3}}) {
    IdIndex const rows(ids);
    for (Id const id : {Id{0}, Id{3}, Id{4}, Id{5}, Id{6}, Id{7}, Id{100}, (Id{1} << 32) | 4, ~Id{0}}) {
      EXPECT_EQ(rows.count_below(id), std::ranges::count_if(ids, [&](Id other) { return other < id; })) << id;
    }
  }
}

}  // namespace
}  // namespace gridlock
