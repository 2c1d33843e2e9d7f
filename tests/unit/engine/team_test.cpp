#include "engine/tiled/team.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <span>
#include <vector>

#include "gridlock/core/random.hpp"
#include "gridlock/grid/detail/packed_grid.hpp"

namespace gridlock::tiled {
namespace {

using Orders = std::vector<std::vector<std::uint32_t>>;

/// Points at random in a grid, and an order of the turns of its tiles.
class Turns {
 public:
  Turns(std::size_t count, std::uint64_t seed) : ids_(count) {
    RandomStream random(seed, 1, 0, Purpose::start_position);
    std::iota(ids_.begin(), ids_.end(), 0U);
    for (std::size_t k = count; k > 1; --k) std::swap(ids_[k - 1], ids_[random.below(k)]);
    for (std::uint32_t k = 0; k < count; ++k) grid_.insert(k, {random.uniform(), random.uniform()});
  }

  void find(UpdateOrder& order, std::uint32_t tile) {
    order.find(grid_, tiling_.tiles()[tile], ids_,
               [](PackedGrid::Block const& block) { return (1U << block.count) - 1U; });
  }

  /// The order of a tile that takes its turns alone.
  std::vector<std::uint32_t> order_of(std::uint32_t tile) {
    UpdateOrder order;
    find(order, tile);
    std::vector<std::uint32_t> rows;
    order.for_each_group(
        [&](std::span<std::uint32_t const> group) { rows.insert(rows.end(), group.begin(), group.end()); });
    return rows;
  }

  [[nodiscard]] std::span<std::uint32_t const> team(std::size_t colour, std::size_t tiles) {
    tiles_.resize(tiles);
    std::iota(tiles_.begin(), tiles_.end(), static_cast<std::uint32_t>(tiling_.first_of(colour)));
    return tiles_;
  }

 private:
  CellLayout layout_{Box(1.0, 1.0, Edge::wall), 79, 75};
  Tiling tiling_{layout_};
  PackedGrid grid_{layout_, 0};
  std::vector<std::uint32_t> ids_;
  std::vector<std::uint32_t> tiles_;
};

/// What each tile of a team does, in its order.
Orders orders_of(Team& team, std::size_t tiles) {
  Orders orders(tiles);
  team.for_each_group([&](std::span<std::uint32_t const> rows, std::uint8_t const* places) {
    EXPECT_FALSE(rows.empty());
    for (std::size_t k = 0; k < rows.size(); ++k) orders.at(places[k]).push_back(rows[k]);
  });
  return orders;
}

/// Sparse points, some to a cell, and so many that nearly every cell has several blocks.
constexpr std::array<std::size_t, 4> numbers_of_points{40, 4000, 12'000, 60'000};

TEST(Team, HasTheOrderOfEachTileFoundOrKept) {
  Team team;
  for (std::size_t const count : numbers_of_points) {
    Turns turns(count, count);
    for (std::size_t tiles = 1; tiles <= Tiling::tiles_of_team; ++tiles) {
      for (unsigned kept = 0; kept < 1U << tiles; ++kept) {
        std::array<KeptOrder, Tiling::tiles_of_team> orders;
        Orders expected;
        std::size_t all = 0;
        team.clear();
        std::size_t k = 0;
        for (std::uint32_t const tile : turns.team(1, tiles)) {
          expected.push_back(turns.order_of(tile));
          all += expected.back().size();
          turns.find(team.room(), tile);
          if ((kept >> k & 1U) != 0) {
            orders[k].keep(team.room());
            EXPECT_TRUE(orders[k].is_kept());
            EXPECT_EQ(orders[k].size(), expected.back().size());
            team.add(orders[k]);
          } else {
            team.add_found();
          }
          ++k;
        }
        EXPECT_EQ(team.turns(), all);
        EXPECT_EQ(orders_of(team, tiles), expected) << count << " points, " << tiles << " tiles, kept " << kept;
      }
    }
  }
}

TEST(Team, TakesTurnsOfAllTilesInOneGroup) {
  Turns turns(12'000, 1);
  Team team;
  team.clear();
  for (std::uint32_t const tile : turns.team(0, 3)) {
    turns.find(team.room(), tile);
    team.add_found();
  }
  std::size_t groups = 0;
  std::size_t with_all = 0;
  team.for_each_group([&](std::span<std::uint32_t const> rows, std::uint8_t const* places) {
    ++groups;
    if (places[0] == 0 && places[rows.size() - 1] == 2) ++with_all;
  });
  EXPECT_GE(with_all, 2 * UpdateOrder::classes);
  EXPECT_LE(groups, 2 * with_all + 2 * UpdateOrder::classes);
}

}  // namespace
}  // namespace gridlock::tiled
