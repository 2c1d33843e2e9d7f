#include "gridlock/core/population.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <set>
#include <span>

namespace gridlock {
namespace {

struct Weight {
  using type = double;
};
struct Dye {
  using type = int;
};
using Marbles = Population<Weight, Dye>;

constexpr Id generation(std::uint64_t n) { return n << 32; }

TEST(Population, NamesTheFirstAgentsZeroOneTwo) {
  Marbles marbles;
  EXPECT_TRUE(marbles.empty());
  for (Id n = 0; n < 5; ++n) EXPECT_EQ(marbles.add(1.0, 2), n);
  EXPECT_EQ(marbles.size(), 5U);
  EXPECT_FALSE(marbles.empty());
}

TEST(Population, RemovingMovesTheLastRowIntoTheGapWithAllItsColumns) {
  Marbles marbles;
  Id const a = marbles.add(0.5, 10);
  Id const b = marbles.add(1.5, 11);
  Id const c = marbles.add(2.5, 12);
  marbles.remove(a);
  ASSERT_EQ(marbles.size(), 2U);
  EXPECT_EQ(marbles.index_of(c), 0U);
  EXPECT_EQ(marbles.index_of(b), 1U);
  EXPECT_EQ(marbles.ids()[0], c);
  EXPECT_EQ(marbles.column<Weight>()[0], 2.5);
  EXPECT_EQ(marbles.column<Dye>()[0], 12);
  EXPECT_EQ(marbles.column<Dye>()[1], 11);
}

TEST(Population, TheLastRowCanBeRemoved) {
  Marbles marbles;
  Id const a = marbles.add(0.5, 10);
  Id const b = marbles.add(1.5, 11);
  marbles.remove(b);
  EXPECT_TRUE(marbles.contains(a));
  EXPECT_FALSE(marbles.contains(b));
  marbles.remove(a);
  EXPECT_TRUE(marbles.empty());
  EXPECT_TRUE(marbles.column<Weight>().empty());
}

TEST(Population, AnUnknownNameIsNotFound) {
  Marbles marbles;
  marbles.add(0.5, 10);
  EXPECT_EQ(marbles.index_of(1), Marbles::not_found);
  EXPECT_EQ(marbles.index_of(generation(1)), Marbles::not_found);
  EXPECT_FALSE(marbles.contains(~Id{0}));
}

TEST(Population, ReusesTheSlotOfTheDeadUnderANewName) {
  Marbles marbles;
  Id const dead = marbles.add(0.5, 10);
  marbles.add(1.5, 11);
  marbles.remove(dead);
  Id const born = marbles.add(2.5, 12);
  EXPECT_EQ(born, generation(1) | dead);
  EXPECT_FALSE(marbles.contains(dead)) << "a stale name must not find the agent that took the slot";
  EXPECT_EQ(marbles.column<Dye>()[marbles.index_of(born)], 12);
}

TEST(Population, NeverGivesANameTwiceInManyBirthsAndDeathsOnFewSlots) {
  Marbles marbles;
  std::set<Id> names;
  std::set<Id> slots;
  for (int n = 0; n < 1000; ++n) {
    Id const a = marbles.add(0.0, n);
    Id const b = marbles.add(0.0, n);
    EXPECT_TRUE(names.insert(a).second && names.insert(b).second);
    slots.insert({a & 0xFFFFFFFFU, b & 0xFFFFFFFFU});
    marbles.remove(n % 2 == 0 ? a : b);
    marbles.remove(n % 2 == 0 ? b : a);
  }
  EXPECT_EQ(slots.size(), 2U) << "memory must stay flat";
}

TEST(Population, AddsUnderAGivenName) {
  Marbles marbles;
  EXPECT_TRUE(marbles.add_as(generation(3) | 5, 0.5, 10));
  EXPECT_TRUE(marbles.add_as(2, 1.5, 11));
  EXPECT_EQ(marbles.ids()[0], generation(3) | 5);
  EXPECT_EQ(marbles.index_of(2), 1U);
  EXPECT_FALSE(marbles.contains(5)) << "another generation of the slot";
}

TEST(Population, RefusesANameWhoseSlotIsTaken) {
  Marbles marbles;
  ASSERT_TRUE(marbles.add_as(7, 0.5, 10));
  EXPECT_FALSE(marbles.add_as(7, 1.5, 11));
  EXPECT_FALSE(marbles.add_as(generation(1) | 7, 1.5, 11));
  ASSERT_EQ(marbles.size(), 1U);
  EXPECT_EQ(marbles.column<Dye>()[0], 10);
}

TEST(Population, RefusesTheNameOfADeadAgent) {
  Marbles marbles;
  Id const dead = marbles.add(0.5, 10);
  marbles.remove(dead);
  EXPECT_FALSE(marbles.add_as(dead, 1.5, 11));
  EXPECT_TRUE(marbles.add_as(generation(1) | dead, 1.5, 11)) << "that name was never given";
}

TEST(Population, AddAfterAddAsTakesTheSlotsLeftFreeAndNeverOneInUse) {
  Marbles marbles;
  ASSERT_TRUE(marbles.add_as(3, 0.0, 3));
  ASSERT_TRUE(marbles.add_as(1, 0.0, 1));
  std::set<Id> names{3, 1};
  for (int n = 0; n < 4; ++n) EXPECT_TRUE(names.insert(marbles.add(0.0, 0)).second);
  EXPECT_EQ(names, (std::set<Id>{0, 1, 2, 3, 4, 5}));
}

TEST(Population, ASlotFilledByNameAndEmptiedAgainIsGivenOutOnce) {
  // add_as() leaves the slot among the free ones and remove() puts it there once more.
  Marbles marbles;
  ASSERT_TRUE(marbles.add_as(2, 0.0, 0));
  ASSERT_TRUE(marbles.add_as(0, 0.0, 0));
  marbles.remove(0);
  ASSERT_TRUE(marbles.add_as(generation(1), 0.0, 0));
  marbles.remove(generation(1));
  std::set<Id> slots{2};
  for (int n = 0; n < 5; ++n) EXPECT_TRUE(slots.insert(marbles.add(0.0, 0) & 0xFFFFFFFFU).second);
  EXPECT_EQ(*slots.rbegin(), 5U);
}

TEST(Population, ReadsAHundredThousandAgentsInFallingOrderOfNamesInAMoment) {
  // Quadratic cost here would take minutes.
  Marbles marbles;
  constexpr Id count = 100'000;
  for (Id n = count; n-- > 0;) ASSERT_TRUE(marbles.add_as(n, 0.0, 0));
  EXPECT_EQ(marbles.size(), count);
  EXPECT_EQ(marbles.add(0.0, 0), count);
}

TEST(Population, GoesOnWithColumnsSideBySideAndLeavesTheOldMemoryAsItWas) {
  Marbles marbles;
  for (int n = 0; n < 50; ++n) marbles.add(n, 2 * n);
  std::span<Weight::type> const before = marbles.column<Weight>();
  std::shared_ptr<void> const kept = marbles.release();
  marbles.column<Weight>()[7] = -1.0;
  EXPECT_EQ(before[7], 7.0);
  EXPECT_NE(before.data(), marbles.column<Weight>().data());
  EXPECT_TRUE(are_side_by_side(marbles.column<Weight>().data(), marbles.column<Dye>().data()));
  EXPECT_EQ(marbles.column<Dye>()[49], 98);
  EXPECT_EQ(marbles.index_of(49), 49U);
}

TEST(Population, ACopyLivesItsOwnLife) {
  Marbles first;
  Id const a = first.add(0.5, 10);
  Marbles second = first;
  second.remove(a);
  EXPECT_TRUE(first.contains(a));
  EXPECT_FALSE(second.contains(a));
}

TEST(Population, FreeNamesAreThoseOfTheAgentsBornNext) {
  Marbles marbles;
  for (int n = 0; n < 6; ++n) marbles.add(1.0, n);
  EXPECT_TRUE(marbles.add_as(generation(2) | 9, 1.0, 9));
  for (Id const dead : {Id{4}, Id{1}, generation(2) | 9}) marbles.remove(dead);
  EXPECT_TRUE(marbles.add_as(generation(5) | 1, 1.0, 9)) << "whose slot is listed as free";
  FreeNames names = marbles.free_names();
  // Somebody dies meanwhile.
  for (int n = 0; n < 9; ++n) {
    EXPECT_EQ(names.take(), marbles.add(0.5, n)) << n;
    if (n != 3) continue;
    for (Id const dead : {Id{5}, generation(5) | 1}) {
      names.give_back(dead);
      marbles.remove(dead);
    }
  }
}

}  // namespace
}  // namespace gridlock
