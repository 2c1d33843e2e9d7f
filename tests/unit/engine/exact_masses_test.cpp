// Masses far apart: the light disks become fast. Up to the limit no overlap is more than rounding; beyond it is
// refused.

#include <gtest/gtest.h>

#include <string>

#include "gridlock/core/error.hpp"
#include "gridlock/engine/engine.hpp"
#include "gridlock/lattice/start.hpp"

namespace gridlock {
namespace {

EngineSettings audited() { return {.kind = "exact", .audit_every = 1000}; }

/// 100 disks, a share of them of mass 1 and the others heavier.
State mixture(double light_share, double heavy_mass, Edge edge) {
  DisksSettings disks{.count = 100, .packing_fraction = 0.5, .start = StartKind::triangular};
  disks.species = {{.fraction = light_share, .mass = 1.0}, {.fraction = 1.0 - light_share, .mass = heavy_mass}};
  State state = make_start(Box(1.0, 1.0, edge), disks, 1);
  draw_velocities(state, {});
  return state;
}

struct Masses {
  double light_share;
  double heavy_mass;
};

class MassesApart : public ::testing::TestWithParam<Masses> {};

TEST_P(MassesApart, UpToTheLimitRunWithoutOverlapsUnderTheAudit) {
  for (Edge const edge : {Edge::wall, Edge::periodic}) {
    State state = mixture(GetParam().light_share, GetParam().heavy_mass, edge);
    double const energy = kinetic_energy(state.agents);
    Counters counters;
    auto const engine = make_engine(audited(), state);
    EXPECT_NO_THROW(engine->advance(state, counters, {.pair_collisions = 200'000}));
    EXPECT_EQ(counters.pair_collisions, 200'000U);
    EXPECT_NEAR(kinetic_energy(state.agents) / energy, 1.0, 1e-9);
  }
}

INSTANTIATE_TEST_SUITE_P(Exact, MassesApart,
                         ::testing::Values(Masses{0.5, 1.5e6}, Masses{0.01, 0.9e6}, Masses{0.95, 1.5e7}));

TEST(MassesFarApart, AreRefusedWhereOverlapsWouldBeMoreThanRounding) {
  for (Masses const masses : {Masses{0.5, 1e9}, Masses{0.5, 1e12}, Masses{0.01, 2e6}}) {
    State const state = mixture(masses.light_share, masses.heavy_mass, Edge::wall);
    try {
      static_cast<void>(make_engine(audited(), state));
      FAIL() << "a mass of " << masses.heavy_mass << " was accepted";
    } catch (Error const& error) {
      EXPECT_NE(std::string(error.what()).find("times as fast"), std::string::npos) << error.what();
      EXPECT_EQ(error.problems().front().key, "disks.species");
    }
  }
}

TEST(MassesFarApart, DoNotMatterWhereAllAreEqualOrAtRest) {
  State state = mixture(1.0, 1.0, Edge::wall);
  for (double& mass : state.agents.column<Mass>()) mass = 1e20;
  EXPECT_NO_THROW(static_cast<void>(make_engine(audited(), state)));
  State resting = mixture(0.5, 1e12, Edge::wall);
  for (double& v : resting.agents.column<VelocityX>()) v = 0.0;
  for (double& v : resting.agents.column<VelocityY>()) v = 0.0;
  EXPECT_NO_THROW(static_cast<void>(make_engine(audited(), resting)));
}

}  // namespace
}  // namespace gridlock
