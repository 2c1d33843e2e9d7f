#include "gridlock/grid/neighbour_search.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "gridlock/core/error.hpp"

namespace gridlock {
namespace {

constexpr double beyond_all = std::numeric_limits<double>::infinity();

using Pairs = std::set<std::pair<std::size_t, std::size_t>>;

Pairs pairs_of(NeighbourSearch const& search) {
  Pairs pairs;
  search.for_each_pair(
      [&](std::size_t i, std::size_t j, Vector) { EXPECT_TRUE(pairs.emplace(i, j).second) << "a pair came twice"; });
  return pairs;
}

/// What is wrong with a search, or "".
std::string refusal(Box const& box, double cutoff, std::span<double const> x, std::span<double const> y) {
  try {
    NeighbourSearch const search(box, cutoff, x, y);
    return "";
  } catch (Error const& error) {
    return error.what();
  }
}

Box const walled(1.0, 1.0, Edge::wall);
Box const periodic(1.0, 1.0, Edge::periodic);
std::vector<double> const middle{0.5, 0.5, 0.5};

TEST(NeighbourSearch, MeasuresTheNearestImageInAPeriodicBox) {
  std::vector<double> const x{0.1, 0.9, 0.5};
  EXPECT_EQ(pairs_of(NeighbourSearch(walled, 0.3, x, middle)), Pairs{});
  NeighbourSearch const search(periodic, 0.3, x, middle);
  EXPECT_EQ(pairs_of(search), (Pairs{{1, 0}}));
  search.for_each_pair([](std::size_t, std::size_t, Vector r) {
    EXPECT_NEAR(r.x, 0.2, 1e-15) << "from point 1 to point 0";
    EXPECT_EQ(r.y, 0.0);
  });
  std::size_t found = 0;
  search.for_each_neighbour(0, [&](std::size_t j, Vector r) {
    EXPECT_EQ(j, 1U);
    EXPECT_NEAR(r.x, -0.2, 1e-15);
    ++found;
  });
  EXPECT_EQ(found, 1U);
}

TEST(NeighbourSearch, FindsThePointsAroundAnyPlaceAlsoOneThatIsThere) {
  std::vector<double> const x{0.1, 0.9, 0.5};
  NeighbourSearch const search(periodic, 0.3, x, middle);
  std::set<std::size_t> found;
  search.for_each_neighbour({-0.9, 0.5}, [&](std::size_t j, Vector) { found.insert(j); });
  EXPECT_EQ(found, (std::set<std::size_t>{0, 1}));
}

TEST(NeighbourSearch, FollowsPointsThatMove) {
  std::vector<double> x{0.1, 0.2, 0.9};
  NeighbourSearch search(walled, 0.15, x, middle);
  EXPECT_EQ(pairs_of(search), (Pairs{{1, 0}}));
  x = {0.1, 0.8, 0.9};
  search.update(x, middle);
  EXPECT_EQ(pairs_of(search), (Pairs{{2, 1}}));
}

TEST(NeighbourSearch, AnUpdateThatIsRefusedChangesNothing) {
  std::vector<double> const x{0.1, 0.2, 0.9};
  NeighbourSearch search(walled, 0.15, x, middle);
  std::vector<double> const bad{0.1, 0.8, std::nan("")};
  std::vector<double> const four{0.1, 0.8, 0.85, 0.9};
  EXPECT_THROW(search.update(bad, middle), Error);
  EXPECT_THROW(search.update(four, four), Error);
  EXPECT_THROW(search.update(std::span(x).first(2), std::span(x).first(2)), Error);
  EXPECT_EQ(pairs_of(search), (Pairs{{1, 0}}));
}

TEST(NeighbourSearch, RefusesPointsThatAreNotFinite) {
  for (double const bad : {std::nan(""), beyond_all, -beyond_all}) {
    std::vector<double> const with_bad_one{0.1, 0.2, bad};
    EXPECT_NE(refusal(walled, 0.1, with_bad_one, middle).find("point 2 is at ("), std::string::npos);
    EXPECT_NE(refusal(walled, 0.1, middle, with_bad_one).find("point 2 is at (0.5, "), std::string::npos);
    NeighbourSearch const search(walled, 0.1, middle, middle);
    EXPECT_THROW(search.for_each_neighbour({bad, 0.0}, [](std::size_t, Vector) {}), Error);
    EXPECT_THROW(search.for_each_neighbour({0.0, bad}, [](std::size_t, Vector) {}), Error);
  }
}

TEST(NeighbourSearch, RefusesACutoffThatFindsNothingOrTwoImages) {
  for (double const bad : {0.0, -0.0, -1.0, 1e-61, 1e61, beyond_all, -beyond_all, std::nan("")}) {
    EXPECT_NE(refusal(walled, bad, middle, middle).find("the cutoff of a neighbour search is"), std::string::npos)
        << bad;
  }
  EXPECT_EQ(refusal(walled, 1e60, middle, middle), "") << "between walls there are no images";
  EXPECT_EQ(refusal(periodic, 0.5, middle, middle), "");
  EXPECT_NE(refusal(Box(3.0, 1.0, Edge::periodic), 0.5001, middle, middle)
                .find("a cutoff of 0.5001 is more than half a side of the periodic box of 3 × 1"),
            std::string::npos);
}

TEST(NeighbourSearch, RefusesListsOfDifferentLengthsAndMorePointsThanItHolds) {
  std::span<double const> const two = std::span(middle).first(2);
  EXPECT_NE(refusal(walled, 0.1, two, middle).find("there are 2 x coordinates and 3 y coordinates"), std::string::npos);
  EXPECT_NE(refusal(walled, 0.1, middle, two).find("there are 3 x coordinates and 2 y coordinates"), std::string::npos);
  // Refused by the number alone: there is no memory behind it.
  std::span<double const> const many(middle.data(), 250'000'001);
  EXPECT_NE(refusal(walled, 0.1, many, many).find("among 250000001 points"), std::string::npos);
}

TEST(NeighbourSearch, RefusesABoxThatCannotBeComputedWith) {
  EXPECT_NE(refusal(Box(1e61, 1.0, Edge::wall), 0.1, {}, {}).find("too large"), std::string::npos);
  EXPECT_NE(refusal(Box(1e20, 1e-20, Edge::wall), 1.0, {}, {}).find("elongated"), std::string::npos);
}

TEST(NeighbourSearch, RefusesAPointThatItDoesNotHave) {
  NeighbourSearch const search(walled, 0.1, middle, middle);
  EXPECT_THROW(search.for_each_neighbour(3, [](std::size_t, Vector) {}), Error);
}

TEST(NeighbourSearch, FindsNothingAmongNoneOrOne) {
  EXPECT_EQ(pairs_of(NeighbourSearch(periodic, 0.4, {}, {})), Pairs{});
  std::vector<double> const one{0.5};
  EXPECT_EQ(pairs_of(NeighbourSearch(periodic, 0.4, one, one)), Pairs{});
}

}  // namespace
}  // namespace gridlock
