// Event chains find the first contact among all disks, whatever the cells and registers, and never make an overlap.

#include "engine/event_chain.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "engine/chain/take_step.hpp"
#include "gridlock/grid/validate.hpp"
#include "gridlock/lattice/start.hpp"
#include "reference/problem_of_engine.hpp"

namespace gridlock {
namespace {

using reference::problem_of;

/// Disks of diameter about 1 with Maxwell's velocities in a periodic box, at random for few and else on a lattice.
State fluid(std::uint64_t count, double packing_fraction, double size_ratio = 1.0, double aspect = 1.0) {
  double const side = std::sqrt(static_cast<double>(count) * 0.7854 / packing_fraction);
  DisksSettings disks{.count = count, .packing_fraction = packing_fraction, .start = StartKind::square};
  if (size_ratio != 1.0) {
    disks.start = StartKind::random;
    disks.species = {{.fraction = 0.5}, {.fraction = 0.5, .size_ratio = size_ratio}};
  }
  State state = make_start(Box(side * aspect, side / aspect, Edge::periodic), disks, 3);
  draw_velocities(state, {.kind = VelocityKind::maxwell});
  return state;
}

/// Looks at all disks in every flight.
struct AllDisks {
  State& state;
  double contact = largest_contact_distance(state.agents.column<Radius>());

  [[nodiscard]] double longest_flight() const { return chain::longest_flight * contact; }
  [[nodiscard]] chain::Number find(chain::Number disk) const { return disk; }
  [[nodiscard]] Vector place(chain::Number disk) const { return position(state.agents, disk); }
  [[nodiscard]] Vector velocity(chain::Number disk) const { return gridlock::velocity(state.agents, disk); }
  void set_velocity(chain::Number disk, Vector velocity) {
    state.agents.column<VelocityX>()[disk] = velocity.x;
    state.agents.column<VelocityY>()[disk] = velocity.y;
  }
  Vector move(chain::Number disk, Vector to) {
    Vector const place = state.box.wrap(to, state.agents.column<ImageX>()[disk], state.agents.column<ImageY>()[disk]);
    state.agents.column<X>()[disk] = place.x;
    state.agents.column<Y>()[disk] = place.y;
    return place;
  }
  template <chain::Way way>
  void find_contact(chain::Flight const& flight, chain::Contact& found) const {
    auto const radii = state.agents.column<Radius>();
    for (std::size_t k = state.agents.size(); k-- > 0;) {
      double const distance = radii[flight.disk] + radii[k];
      chain::meet<way>(flight, state.box.displacement(flight.place, position(state.agents, k)), distance * distance,
                       static_cast<chain::Number>(k), found);
    }
  }
  void end_chain() {}
};

std::vector<State> fluids() {
  return {fluid(20, 0.5),      fluid(100, 0.05),     fluid(225, 0.7),          fluid(100, 0.6, 1.0, 1.5),
          fluid(60, 0.4, 3.0), fluid(100, 0.5, 1.4), fluid(64, 0.3, 1.0, 0.8), fluid(16, 0.72)};
}

TEST(EventChain, MovesTheDisksThatASearchAmongAllWouldMove) {
  for (State const& start : fluids()) {
    for (bool const by_velocity : {false, true}) {
      State expected = start;
      AllDisks all{expected};
      State plain = start;
      State wide = start;
      auto const of_any_size = chain::chain_disks_of_any_size(start);
      auto const equal = chain::chain_disks(start, is_available(Target::avx512) ? Target::avx512 : Target::scalar);
      for (std::uint64_t step = 0; step < 20; ++step) {
        chain::StepOfChains const chains{start.seed, step, 5, 20.0, by_velocity, 1'000'000};
        chain::ChainSums const sums = chain::take_step(all, start.agents.size(), chains);
        EXPECT_GT(sums.contacts, 0U);
        EXPECT_EQ(of_any_size->take(chains).virial, sums.virial);
        EXPECT_EQ(equal->take(chains).virial, sums.virial);
      }
      of_any_size->write_back(plain);
      equal->write_back(wide);
      EXPECT_EQ(hash(plain), hash(expected)) << start.agents.size() << " disks, by velocity: " << by_velocity;
      EXPECT_EQ(hash(wide), hash(expected)) << start.agents.size() << " disks, by velocity: " << by_velocity;
      EXPECT_LE(largest_overlap(expected), rounding_of_contact(expected));
      EXPECT_NEAR(kinetic_energy(expected.agents) / kinetic_energy(start.agents), 1.0, 1e-12);
    }
  }
}

TEST(EventChain, GivesTheSameBitsHoweverTheRunIsDividedIntoCalls) {
  for (ChainKind const kind : {ChainKind::straight, ChainKind::newtonian}) {
    EngineSettings const settings{.kind = "event_chain", .chains = kind, .chain_length = 7};
    for (double const size_ratio : {1.0, 2.0}) {
      State whole = fluid(100, 0.5, size_ratio);
      State parts = whole;
      State const start = whole;
      Counters of_whole;
      Counters of_parts;
      make_engine(settings, whole)->advance(whole, of_whole, {.step = 12});
      for (std::uint64_t const end : {1U, 5U, 6U, 12U}) {
        make_engine(settings, start)->advance(parts, of_parts, {.step = end});
      }
      EXPECT_EQ(hash(parts), hash(whole));
      EXPECT_EQ(of_parts.pair_collisions, of_whole.pair_collisions);
      EXPECT_EQ(of_parts.pair_virial, of_whole.pair_virial);
      EXPECT_EQ(parts.clock.time, whole.clock.time);
    }
  }
}

TEST(EventChain, HasAboutAsManyContactsInAStepAsThereAreDisks) {
  for (ChainKind const kind : {ChainKind::straight, ChainKind::newtonian}) {
    for (double const packing_fraction : {0.3, 0.7}) {
      State state = fluid(400, packing_fraction);
      Counters counters;
      make_engine({.kind = "event_chain", .chains = kind}, state)->advance(state, counters, {.step = 100});
      EXPECT_NEAR(static_cast<double>(counters.pair_collisions) / 4e4, 1.0, 0.2);
    }
  }
}

TEST(EventChain, EndsARunWhoseChainWouldNeverEnd) {
  State state{.box = Box(8.0, 8.0, Edge::periodic)};  // four by four disks that touch on all sides
  for (int k = 0; k < 16; ++k) state.agents.add(1.0 + 2.0 * (k % 4), 1.0 + 2.0 * (k / 4), 0.3, 0.1, 1.0, 1.0, 0, 0);
  for (Target const target : available_targets()) {
    for (bool const by_velocity : {false, true}) {
      EXPECT_THROW(chain::chain_disks(state, target)->take({1, 0, 1, 1.0, by_velocity, 1000}), RunFailure);
    }
  }
}

TEST(EventChain, RefusesWhatItCannotMove) {
  EngineSettings const straight{.kind = "event_chain"};
  EngineSettings newtonian = straight;
  newtonian.chains = ChainKind::newtonian;
  State const equal = fluid(100, 0.5);
  EXPECT_EQ(problem_of(straight, equal), "");
  EXPECT_EQ(problem_of(newtonian, equal), "");
  State walled = equal;
  walled.box = Box(30.0, 30.0, Edge::wall);
  EXPECT_EQ(problem_of(straight, walled), "box.edge: event chains know no walls, and the box is walled");
  State narrow = equal;
  narrow.box = Box(30.0, 3.5, Edge::periodic);
  for (std::size_t i = 0; i < 100; ++i) narrow.agents.column<Radius>()[i] = 0.5;
  while (narrow.agents.size() > 2) narrow.agents.remove(narrow.agents.ids().back());
  EXPECT_EQ(problem_of(straight, narrow),
            "engine.kind: the box of 30 × 3.5 is too small for event chains: these disks need sides of at least 4");
  State resting = equal;
  for (double& v : resting.agents.column<VelocityX>()) v = 0.0;
  for (double& v : resting.agents.column<VelocityY>()) v = 0.0;
  EXPECT_EQ(problem_of(straight, resting), "");
  EXPECT_EQ(problem_of(newtonian, resting),
            "engine.chains: Newtonian chains need velocities, and all disks are at rest");
  State unlike = equal;
  unlike.agents.column<Mass>()[7] = 2.0;
  EXPECT_EQ(problem_of(straight, unlike), "");
  EXPECT_EQ(problem_of(newtonian, unlike), "engine.chains: Newtonian chains need disks of one mass");
  EngineSettings walls = straight;
  walls.walls = {{.from = {1.0, 1.0}, .to = {2.0, 1.0}}};
  EXPECT_EQ(problem_of(walls, equal), "walls: the engine \"event_chain\" has no walls inside the box");
  EngineSettings warm = straight;
  warm.thermostat = {.kind = ThermostatKind::andersen, .temperature = 0.5, .rate = 20.0};
  EXPECT_EQ(problem_of(warm, equal), "thermostat.kind: the engine \"event_chain\" has no thermostat \"andersen\"");
}

}  // namespace
}  // namespace gridlock
