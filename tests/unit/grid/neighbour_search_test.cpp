#include "gridlock/grid/neighbour_search.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <set>
#include <span>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "gridlock/core/error.hpp"
#include "gridlock/core/random.hpp"
#include "gridlock/grid/neighbour_lists.hpp"

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

static_assert(std::is_nothrow_move_constructible_v<NeighbourSearch> &&
              std::is_nothrow_move_assignable_v<NeighbourSearch>);

TEST(NeighbourSearch, OfACopyIsUpdatedByItself) {
  std::vector<double> x;
  std::vector<double> y;
  for (int k = 0; k < 16; ++k) {
    x.push_back(0.1 + 0.25 * (k % 4));
    y.push_back(0.1 + 0.25 * (k / 4));
  }
  std::vector<double> const together(16, 0.1);
  NeighbourSearch const first(walled, 0.25, x, y);
  NeighbourSearch copy = first;
  copy.update(together, together);
  EXPECT_EQ(pairs_of(copy).size(), 120U);
  std::vector<NeighbourSearch> several(2, first);
  several.push_back(first);
  several[0].update(together, together);
  several[1] = several[0];
  several[1].update(together, together);
  EXPECT_EQ(pairs_of(several[0]).size(), 120U);
  EXPECT_EQ(pairs_of(several[1]).size(), 120U);
  EXPECT_EQ(pairs_of(several[2]), pairs_of(first));
}

/// Points of which nine in ten are in a square of this side.
struct Crowd {
  explicit Crowd(double side) {
    RandomStream random(1, 0, 0, Purpose::start_position);
    for (int k = 0; k < 3000; ++k) {
      double const span = k % 10 == 0 ? 1.0 : side;
      x.push_back(span * random.uniform());
      y.push_back(span * random.uniform());
    }
  }
  std::vector<double> x;
  std::vector<double> y;
};

std::vector<std::pair<std::size_t, std::size_t>> visits_of(NeighbourSearch const& search) {
  std::vector<std::pair<std::size_t, std::size_t>> visits;
  search.for_each_pair([&](std::size_t i, std::size_t j, Vector) { visits.emplace_back(i, j); });
  return visits;
}

TEST(NeighbourSearch, HasAnOrderOfVisitsThatCopiesDoNotChange) {
  Crowd points(0.02);
  NeighbourSearch alone(periodic, 0.002, points.x, points.y);
  NeighbourSearch copied = alone;
  NeighbourSearch const copy = copied;
  std::vector<double> moved = points.x;
  for (std::size_t i = 0; i < moved.size(); i += 20) moved[i] = moved[(i + 1500) % moved.size()];
  alone.update(moved, points.y);
  copied.update(moved, points.y);
  EXPECT_EQ(visits_of(alone), visits_of(copied));
  EXPECT_NE(visits_of(alone), visits_of(copy));
}

TEST(NeighbourSearch, OfACrowdThatDispersesBecomesThatOfOtherPoints) {
  Crowd const crowd(0.02);
  Crowd const dispersed(1.0);
  NeighbourSearch search(periodic, 0.002, crowd.x, crowd.y);
  search.update(dispersed.x, dispersed.y);
  EXPECT_EQ(pairs_of(search), pairs_of(NeighbourSearch(periodic, 0.002, dispersed.x, dispersed.y)));
  search.update(dispersed.y, dispersed.x);
  EXPECT_EQ(visits_of(search), visits_of(NeighbourSearch(periodic, 0.002, dispersed.y, dispersed.x)));
  search.update(crowd.x, crowd.y);
  EXPECT_EQ(pairs_of(search), pairs_of(NeighbourSearch(periodic, 0.002, crowd.x, crowd.y)));
}

TEST(NeighbourSearch, FindsPairsACutoffApartInALongNarrowBox) {
  // 36 million cells of the cutoff in a row.
  Box const box(1.9, 4.7499999952499996e-08, Edge::wall);
  constexpr double cutoff = 5.2777777724999994e-08;
  std::vector<double> x{1.7709283555555555, 1.7709284083333332};
  std::vector<double> y(2, 0.3 * box.height());
  ASSERT_LT(x[1] - x[0], cutoff);
  RandomStream random(1, 0, 0, Purpose::start_position);
  while (x.size() < 620'000) {
    x.push_back(0.01 * box.width() * random.uniform());
    y.push_back(box.height() * random.uniform());
  }
  bool is_found = false;
  NeighbourSearch(box, cutoff, x, y).for_each_pair([&](std::size_t i, std::size_t j, Vector) {
    is_found = is_found || (i == 1 && j == 0);
  });
  EXPECT_TRUE(is_found);
  PointPairs const pairs = find_pairs(box, cutoff, {.x = x.data(), .y = y.data(), .count = x.size()});
  std::size_t found = 0;
  for (std::size_t k = 0; k < pairs.size(); ++k) found += pairs.first()[k] + pairs.second()[k] == 1 ? 1 : 0;
  EXPECT_EQ(found, 1U);
}

TEST(NeighbourSearch, FindsNothingAmongNoneOrOne) {
  EXPECT_EQ(pairs_of(NeighbourSearch(periodic, 0.4, {}, {})), Pairs{});
  std::vector<double> const one{0.5};
  EXPECT_EQ(pairs_of(NeighbourSearch(periodic, 0.4, one, one)), Pairs{});
}

}  // namespace
}  // namespace gridlock
