#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <set>
#include <vector>

#include "gridlock/core/disks.hpp"

namespace gridlock {
namespace {

State small_state() {
  State state{.box = Box(1.0, 2.0, Edge::periodic), .clock = {.step = 3, .time = 0.75}, .seed = 42};
  for (int n = 0; n < 4; ++n) state.agents.add(0.1 * n, 0.2, 1.0, -1.0 * n, 0.05, 1.0, -n, n);
  return state;
}

template <class Column>
void flip_bit(State& state, std::size_t row, unsigned bit) {
  auto& value = state.agents.column<Column>()[row];
  if constexpr (sizeof value == 8) {
    value = std::bit_cast<typename Column::type>(std::bit_cast<std::uint64_t>(value) ^ (std::uint64_t{1} << bit));
  } else {
    value =
        std::bit_cast<typename Column::type>(std::bit_cast<std::uint32_t>(value) ^ (std::uint32_t{1} << (bit % 32)));
  }
}

template <class Column>
void expect_every_bit_matters() {
  std::set<std::uint64_t> hashes{hash(small_state())};
  for (std::size_t row = 0; row < 4; ++row) {
    for (unsigned bit = 0; bit < 8 * sizeof(typename Column::type); ++bit) {
      State state = small_state();
      flip_bit<Column>(state, row, bit);
      EXPECT_TRUE(hashes.insert(hash(state)).second) << Column::name << " bit " << bit << " of row " << row;
    }
  }
}

TEST(StateHash, ChangesWithEveryBitOfEveryColumn) {
  expect_every_bit_matters<X>();
  expect_every_bit_matters<Y>();
  expect_every_bit_matters<VelocityX>();
  expect_every_bit_matters<VelocityY>();
  expect_every_bit_matters<Radius>();
  expect_every_bit_matters<Mass>();
  expect_every_bit_matters<ImageX>();
  expect_every_bit_matters<ImageY>();
}

TEST(StateHash, ChangesWithBoxClockAndSeed) {
  std::set<std::uint64_t> hashes{hash(small_state())};
  auto const expect_new = [&](State const& state) { EXPECT_TRUE(hashes.insert(hash(state)).second); };
  State state = small_state();
  state.box = Box(1.0, 2.0, Edge::wall);
  expect_new(state);
  state.box = Box(2.0, 1.0, Edge::periodic);
  expect_new(state);
  state.box = Box(1.0, 2.0, Edge::periodic, Edge::wall);
  expect_new(state);
  state.box = Box(1.0, 2.0, Edge::wall, Edge::periodic);
  expect_new(state);
  state = small_state();
  ++state.clock.step;
  expect_new(state);
  state = small_state();
  state.clock.time = std::nextafter(state.clock.time, 1.0);
  expect_new(state);
  state = small_state();
  ++state.seed;
  expect_new(state);
  state = small_state();
  state.agents.add(0.9, 0.9, 0.0, 0.0, 0.01, 1.0, 0, 0);
  expect_new(state);
}

TEST(StateHash, TellsPlusZeroFromMinusZero) {
  State a = small_state();
  State b = small_state();
  a.agents.column<X>()[0] = 0.0;
  b.agents.column<X>()[0] = -0.0;
  EXPECT_NE(hash(a), hash(b)) << "bits, not values: equal hashes promise equal futures";
}

TEST(StateHash, DoesNotDependOnTheOrderOfTheRows) {
  struct Row {
    Id id;
    double x;
  };
  std::vector<Row> rows{{0, 0.1}, {1, 0.2}, {2, 0.3}, {(Id{5} << 32) | 3, 0.4}};
  std::set<std::uint64_t> hashes;
  std::ranges::sort(rows, {}, &Row::id);
  do {
    State state{.box = Box(1.0, 1.0, Edge::wall), .seed = 1};
    for (Row const& row : rows) EXPECT_TRUE(state.agents.add_as(row.id, row.x, 0.5, 0.0, 0.0, 0.01, 1.0, 0, 0));
    hashes.insert(hash(state));
  } while (std::ranges::next_permutation(rows, {}, &Row::id).found);
  EXPECT_EQ(hashes.size(), 1U);
}

TEST(StateHash, ForgetsTheDeadAndTheWayTheRowsWereFilled) {
  State plain{.box = Box(1.0, 1.0, Edge::wall)};
  State shuffled = plain;
  for (int n = 0; n < 3; ++n) plain.agents.add(0.1 * n, 0.5, 0.0, 0.0, 0.01, 1.0, 0, 0);
  for (int n = 0; n < 3; ++n) shuffled.agents.add(0.1 * n, 0.5, 0.0, 0.0, 0.01, 1.0, 0, 0);
  Id const extra = shuffled.agents.add(0.9, 0.5, 0.0, 0.0, 0.01, 1.0, 0, 0);
  EXPECT_NE(hash(plain), hash(shuffled));
  shuffled.agents.remove(extra);
  EXPECT_EQ(hash(plain), hash(shuffled));
  plain.agents.remove(0);  // moves row 2 to the front
  State in_order{.box = Box(1.0, 1.0, Edge::wall)};
  ASSERT_TRUE(in_order.agents.add_as(1, 0.1, 0.5, 0.0, 0.0, 0.01, 1.0, 0, 0));
  ASSERT_TRUE(in_order.agents.add_as(2, 0.1 * 2, 0.5, 0.0, 0.0, 0.01, 1.0, 0, 0));
  EXPECT_EQ(hash(plain), hash(in_order));
}

TEST(StateHash, ChangesWhenTwoDisksSwapTheirNames) {
  State a{.box = Box(1.0, 1.0, Edge::wall)};
  State b = a;
  ASSERT_TRUE(a.agents.add_as(0, 0.1, 0.5, 0.0, 0.0, 0.01, 1.0, 0, 0));
  ASSERT_TRUE(a.agents.add_as(1, 0.2, 0.5, 0.0, 0.0, 0.01, 1.0, 0, 0));
  ASSERT_TRUE(b.agents.add_as(1, 0.1, 0.5, 0.0, 0.0, 0.01, 1.0, 0, 0));
  ASSERT_TRUE(b.agents.add_as(0, 0.2, 0.5, 0.0, 0.0, 0.01, 1.0, 0, 0));
  EXPECT_NE(hash(a), hash(b));
}

}  // namespace
}  // namespace gridlock
