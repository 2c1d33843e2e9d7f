#include "io/nearest_name.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace gridlock {
namespace {

std::vector<std::string> const names{"count", "packing_fraction", "radius", "start", "file", "species", "side"};

TEST(NearestName, FindsTheNameBehindASlipOfTheFinger) {
  EXPECT_EQ(nearest_name("cuont", names), "count") << "letters swapped";
  EXPECT_EQ(nearest_name("conut", names), "count");
  EXPECT_EQ(nearest_name("raduis", names), "radius");
  EXPECT_EQ(nearest_name("packing_fracton", names), "packing_fraction") << "a letter missing";
  EXPECT_EQ(nearest_name("sstart", names), "start") << "a letter too many";
  EXPECT_EQ(nearest_name("fule", names), "file") << "a wrong letter";
  EXPECT_EQ(nearest_name("Packing-Fraction", names), "packing_fraction") << "capitals and hyphens";
}

TEST(NearestName, TheNearestOfSeveralWins) {
  std::vector<std::string> const alike{"steps", "substeps", "step"};
  EXPECT_EQ(nearest_name("stepz", alike), "steps");
  EXPECT_EQ(nearest_name("substep", alike), "substeps");
}

TEST(NearestName, CompletesTheBeginningOfExactlyOneName) {
  EXPECT_EQ(nearest_name("packing", names), "packing_fraction");
  EXPECT_EQ(nearest_name("abc", std::vector<std::string>{"abcdefghi", "abcdefghj"}), "");
}

TEST(NearestName, SuggestsNothingWhereNothingIsNear) {
  EXPECT_EQ(nearest_name("temperature", names), "");
  EXPECT_EQ(nearest_name("x", names), "");
  EXPECT_EQ(nearest_name("", names), "");
  EXPECT_EQ(nearest_name("count", {}), "");
  EXPECT_EQ(nearest_name(std::string(100'000, 'a'), names), "");
}

}  // namespace
}  // namespace gridlock
