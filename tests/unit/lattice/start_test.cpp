#include "gridlock/lattice/start.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <numbers>
#include <regex>

#include "gridlock/core/error.hpp"
#include "gridlock/grid/validate.hpp"

namespace {

using namespace gridlock;

TEST(Start, OnEveryLatticeHasThePackingFractionAskedForAndNoOverlap) {
  for (StartKind const start : {StartKind::square, StartKind::triangular, StartKind::random}) {
    for (Edge const edge : {Edge::wall, Edge::periodic}) {
      State const state = make_start(Box(2.0, 1.5, edge), {.count = 300, .packing_fraction = 0.45, .start = start}, 7);
      EXPECT_EQ(state.agents.size(), 300U);
      EXPECT_NEAR(packing_fraction_of(state), 0.45, 1e-12);
      EXPECT_NO_THROW(validate(state));
    }
  }
}

TEST(Start, InAnObliqueBoxHasThePackingFractionAskedForAndNoOverlap) {
  for (double const tilt : {0.05, -0.3, 0.45, 0.66}) {
    Box const box = Box(2.0, 1.5, Edge::periodic).tilted(tilt);
    for (StartKind const start : {StartKind::square, StartKind::random}) {
      State const state = make_start(box, {.count = 300, .packing_fraction = 0.45, .start = start}, 7);
      EXPECT_EQ(state.box, box);
      EXPECT_NEAR(packing_fraction_of(state), 0.45, 1e-12);
      EXPECT_NO_THROW(validate(state)) << tilt;
    }
    // Few large disks, which an insertion sees across more than one edge.
    EXPECT_NO_THROW(validate(make_start(box, {.count = 5, .packing_fraction = 0.3, .start = StartKind::random}, 2)));
    EXPECT_THROW(make_start(box, {.count = 300, .packing_fraction = 0.45, .start = StartKind::triangular}, 7), Error);
  }
}

TEST(Start, AtExactlyTheLargestPackingFractionIsValidForAnyNumberOfDisks) {
  for (Edge const edge : {Edge::wall, Edge::periodic}) {
    Box const box(1.0, 1.0, edge);
    for (std::uint64_t count = 1; count <= 200; ++count) {
      for (StartKind const start : {StartKind::square, StartKind::triangular}) {
        auto const fit =
            start == StartKind::square ? fit_square_lattice(box, count) : fit_triangular_lattice(box, count);
        State const state = make_start(box, {.count = count, .radius = fit.radius, .start = start}, 1);
        ASSERT_NO_THROW(validate(state)) << count;
      }
    }
  }
}

TEST(Start, TooDenseIsRefusedWithALargestValueThatWorksWhenTypedIn) {
  for (std::uint64_t const count : {1U, 5U, 50U, 841U, 1000U}) {
    for (StartKind const start : {StartKind::square, StartKind::triangular}) {
      for (Edge const edge : {Edge::wall, Edge::periodic}) {
        DisksSettings settings{.count = count, .packing_fraction = 0.906, .start = start};
        try {
          make_start(Box(1.0, 1.0, edge), settings, 1);
        } catch (Error const& error) {
          EXPECT_EQ(error.problems().front().key, "disks.packing_fraction");
          std::smatch match;
          std::string const text = error.problems().front().what;
          ASSERT_TRUE(std::regex_search(text, match, std::regex("the largest is ([0-9.e-]+)"))) << text;
          settings.packing_fraction = std::stod(match[1]);
          EXPECT_NO_THROW(validate(make_start(Box(1.0, 1.0, edge), settings, 1))) << text;
        }
      }
    }
  }
}

TEST(Start, ByRandomInsertionDependsOnTheSeedAlone) {
  DisksSettings const settings{.count = 200, .packing_fraction = 0.4, .start = StartKind::random};
  Box const box(1.0, 1.0, Edge::periodic);
  EXPECT_EQ(hash(make_start(box, settings, 3)), hash(make_start(box, settings, 3)));
  EXPECT_NE(hash(make_start(box, settings, 3)), hash(make_start(box, settings, 4)));
}

TEST(Start, OfAMixtureDealsOutExactlyTheSharesAskedFor) {
  DisksSettings const settings{.count = 101,
                               .packing_fraction = 0.4,
                               .species = {{.fraction = 0.25}, {.fraction = 0.75, .size_ratio = 1.4, .mass = 2.0}}};
  State const state = make_start(Box(1.0, 1.0, Edge::wall), settings, 5);
  std::map<double, int> of_mass;
  for (std::size_t i = 0; i < state.agents.size(); ++i) ++of_mass[state.agents.column<Mass>()[i]];
  // 25.25 and 75.75: the larger remainder rounds up.
  EXPECT_EQ(of_mass, (std::map<double, int>{{1.0, 25}, {2.0, 76}}));
  EXPECT_NEAR(packing_fraction_of(state), 0.4, 1e-12);
  auto const [smallest, largest] = radius_range(state.agents);
  EXPECT_NEAR(largest / smallest, 1.4, 1e-14);
  EXPECT_NO_THROW(validate(state));
}

struct Moments {
  double mean_speed = 0.0;
  double mean_square = 0.0;
  double mean_fourth = 0.0;
};

Moments moments_of(State const& state) {
  Moments moments;
  double const count = static_cast<double>(state.agents.size());
  for (std::size_t i = 0; i < state.agents.size(); ++i) {
    double const square = squared_length(velocity(state.agents, i));
    moments.mean_speed += std::sqrt(square) / count;
    moments.mean_square += square / count;
    moments.mean_fourth += square * square / count;
  }
  return moments;
}

State many_disks(Edge edge) { return make_start(Box(1.0, 1.0, edge), {.count = 40'000, .packing_fraction = 0.3}, 11); }

// Uniform in a disk of radius v: v = V √u, so ⟨v⟩ = 2V/3, ⟨v²⟩ = V²/2, ⟨v⁴⟩ = V⁴/3; variances V²/18 and V⁴/12.
TEST(Velocities, UniformHaveTheMomentsOfADisk) {
  State state = many_disks(Edge::wall);
  draw_velocities(state, {.kind = VelocityKind::uniform, .max = 2.0});
  Moments const moments = moments_of(state);
  double const count = static_cast<double>(state.agents.size());
  EXPECT_NEAR(moments.mean_speed, 4.0 / 3.0, 4.0 * std::sqrt(4.0 / 18.0 / count));
  EXPECT_NEAR(moments.mean_square, 2.0, 4.0 * std::sqrt(16.0 / 12.0 / count));
  EXPECT_LE(largest_speed(state.agents), 2.0);
}

// kT/m = V²/4: ⟨v²⟩ = V²/2 with variance V⁴/4; ⟨v⁴⟩/⟨v²⟩² = 2.
TEST(Velocities, MaxwellHaveTheTemperatureTheUniformOnesRelaxTo) {
  State state = many_disks(Edge::wall);
  draw_velocities(state, {.kind = VelocityKind::maxwell, .max = 2.0});
  Moments const moments = moments_of(state);
  double const count = static_cast<double>(state.agents.size());
  EXPECT_NEAR(moments.mean_square, 2.0, 4.0 * std::sqrt(16.0 / 4.0 / count));
  EXPECT_NEAR(moments.mean_fourth / (moments.mean_square * moments.mean_square), 2.0, 0.08);
  EXPECT_NEAR(moments.mean_speed, std::sqrt(std::numbers::pi / 2.0) * 1.0,
              4.0 * std::sqrt((2.0 - std::numbers::pi / 2.0) / count));
}

TEST(Velocities, DriftIsTakenOutInAPeriodicBoxAndKeptBetweenWalls) {
  State periodic = many_disks(Edge::periodic);
  draw_velocities(periodic, {});
  EXPECT_LT(std::sqrt(squared_length(momentum(periodic.agents))), 1e-9);
  State walled = many_disks(Edge::wall);
  draw_velocities(walled, {});
  EXPECT_GT(std::sqrt(squared_length(momentum(walled.agents))), 1.0);
  draw_velocities(walled, {.drift = Drift::remove});
  EXPECT_LT(std::sqrt(squared_length(momentum(walled.agents))), 1e-9);
}

TEST(Velocities, DependOnSeedAndIdAlone) {
  Box const box(1.0, 1.0, Edge::wall);
  State few = make_start(box, {.count = 10, .packing_fraction = 0.2}, 3);
  State many = make_start(box, {.count = 50, .packing_fraction = 0.3, .start = StartKind::triangular}, 3);
  draw_velocities(few, {});
  draw_velocities(many, {});
  for (Id const id : few.agents.ids()) {
    EXPECT_EQ(velocity(few.agents, few.agents.index_of(id)), velocity(many.agents, many.agents.index_of(id)));
  }
}

}  // namespace
