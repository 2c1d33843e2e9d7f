// Random starts that find no room are refused early, and what the refusal proposes does fit.

#include <gtest/gtest.h>

#include <regex>
#include <string>

#include "gridlock/core/error.hpp"
#include "gridlock/grid/validate.hpp"
#include "gridlock/lattice/start.hpp"
#include "unit/lattice/refusal.hpp"

namespace gridlock {
namespace {

DisksSettings mixture(std::uint64_t count, double packing_fraction) {
  DisksSettings disks{.count = count, .packing_fraction = packing_fraction, .start = StartKind::random};
  disks.species = {{.fraction = 0.5}, {.fraction = 0.5, .size_ratio = 1.4}};
  return disks;
}

/// The number behind some words of a hint.
double number_after(std::string const& hint, std::string const& words) {
  std::smatch match;
  if (!std::regex_search(hint, match, std::regex(words + " ([0-9.]+)"))) {
    ADD_FAILURE() << "no \"" << words << "\" in: " << hint;
    return 0.0;
  }
  return std::stod(match[1]);
}

void expect_fits(DisksSettings const& disks, Edge edge = Edge::periodic) {
  EXPECT_NO_THROW(validate(make_start(Box(1.0, 1.0, edge), disks, 1)));
}

TEST(RandomStart, OfADenseMixtureIsRefusedWithADensityThatFits) {
  for (Edge const edge : {Edge::wall, Edge::periodic}) {
    DisksSettings disks = mixture(1000, 0.70);
    std::string const hint = refusal_of(disks, edge).hint;
    disks.packing_fraction = number_after(hint, "use packing fraction");
    EXPECT_GT(*disks.packing_fraction, 0.5);
    expect_fits(disks, edge);
  }
}

TEST(RandomStart, OfADenseMixtureIsRefusedWithALatticeThatFits) {
  DisksSettings disks = mixture(1000, 0.63);
  std::string const hint = refusal_of(disks).hint;
  bool const is_square = hint.find("disks.start = \"square\"") != std::string::npos;
  disks.start = is_square ? StartKind::square : StartKind::triangular;
  double const reached = number_after(hint, "which reaches packing fraction");
  EXPECT_GT(reached, 0.63) << hint;
  expect_fits(disks);
  disks.packing_fraction = reached;
  expect_fits(disks);
}

TEST(RandomStart, OfManyDisksTooDenseIsRefusedByASampleOfThem) {
  Problem const problem = refusal_of(mixture(100'000, 0.64));
  EXPECT_NE(problem.what.find("of these 100000 disks would stop near packing fraction 0.6"), std::string::npos)
      << problem.what;
  double const proposed = number_after(problem.hint, "use packing fraction");
  EXPECT_GT(proposed, 0.5);
  // A tenth of them, for the time it takes; the densities that many disks reach are alike.
  expect_fits(mixture(10'000, proposed));
}

TEST(RandomStart, OfVeryUnequalDisksTooDenseIsRefusedWithTheDensityOfThoseThatFoundRoom) {
  // The large disks, half of all, cover sixteen seventeenths of the area, and go first.
  DisksSettings disks = mixture(2000, 0.59);
  disks.species = {{.fraction = 0.5, .size_ratio = 1.0}, {.fraction = 0.5, .size_ratio = 4.0}};
  Problem const problem = refusal_of(disks);
  EXPECT_GT(number_after(problem.what, "it reached packing fraction"), 0.5) << problem.what;
  disks.packing_fraction = number_after(problem.hint, "use packing fraction");
  EXPECT_GT(*disks.packing_fraction, 0.45) << problem.hint;
  expect_fits(disks);
}

TEST(RandomStart, OfManyEqualDisksTooDenseIsRefusedWithARadiusThatFits) {
  DisksSettings disks{.count = 2000, .radius = 0.01, .start = StartKind::random};
  Problem const problem = refusal_of(disks);
  disks.radius = number_after(problem.hint, "use radius");
  EXPECT_LT(*disks.radius, 0.01);
  expect_fits(disks);
}

TEST(RandomStart, OfManyDisksBelowWhatTheyReachIsFound) {
  expect_fits(mixture(10'000, 0.53));
  expect_fits({.count = 10'000, .packing_fraction = 0.5, .start = StartKind::random}, Edge::wall);
}

}  // namespace
}  // namespace gridlock
