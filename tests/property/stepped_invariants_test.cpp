// What the engine `stepped` promises for every system: no overlap, nobody outside, energy and momentum to rounding, and
// a run that does not depend on how it is cut into pieces.

#include <gtest/gtest.h>
#include <rapidcheck.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <ostream>

#include "gridlock/core/error.hpp"
#include "gridlock/engine/engine.hpp"
#include "gridlock/grid/validate.hpp"
#include "reference/random_scene.hpp"

namespace gridlock {
namespace {

using reference::random_scene;
using reference::SceneSettings;

struct System {
  SceneSettings scene;
  EngineSettings engine;

  friend std::ostream& operator<<(std::ostream& out, System const& s) {
    out << s.scene << ", time step " << s.engine.time_step << ", sub-steps " << s.engine.substeps
        << (s.engine.contact == CollisionRule::always ? ", always" : ", approaching")
        << (s.engine.grid == GridKind::linked ? ", linked" : ", packed") << ", cells ";
    return s.engine.cells ? out << *s.engine.cells : out << "default";
  }
};

double number_between(double low, double high) { return low + (high - low) * (*rc::gen::inRange(0, 1001) / 1000.0); }

/// Drawn from the whole range at once: RapidCheck would start with nearly empty boxes, where nothing happens.
rc::Gen<System> any_system() {
  return rc::gen::resize(rc::kNominalSize, rc::gen::exec([] {
                           System s;
                           s.scene.edge = *rc::gen::element(Edge::wall, Edge::periodic);
                           s.scene.edge_y = *rc::gen::element(Edge::wall, Edge::periodic);
                           s.scene.width = number_between(0.5, 3.0);
                           s.scene.height = number_between(0.5, 3.0);
                           s.scene.count = static_cast<std::uint64_t>(*rc::gen::inRange(1, 41));
                           s.scene.packing_fraction = number_between(0.01, 0.78);
                           s.scene.smallest_ratio = *rc::gen::element(1.0, 1.0 / 1.4, 0.3);
                           s.scene.heaviest_mass = *rc::gen::element(1.0, 10.0);
                           s.scene.seed = *rc::gen::arbitrary<std::uint64_t>();
                           s.engine.substeps = static_cast<std::uint64_t>(*rc::gen::inRange(1, 9));
                           // Room for disks to gain four times the speed of the start before a sub-step is too long.
                           s.engine.time_step =
                               std::min(number_between(0.02, 1.0), 0.25 * static_cast<double>(s.engine.substeps));
                           s.engine.contact = *rc::gen::element(CollisionRule::always, CollisionRule::approaching);
                           auto const cells = static_cast<std::uint64_t>(*rc::gen::inRange(0, 16));
                           if (cells > 0) s.engine.cells = cells;
                           s.engine.grid = *rc::gen::element(GridKind::linked, GridKind::packed);
                           return s;
                         }));
}

/// Rounding errors of a sum of `operations` terms of a size: each may be wrong by a few ulps.
double rounding(std::uint64_t operations, double size) {
  return 8.0 * std::numeric_limits<double>::epsilon() * (static_cast<double>(operations) + 10.0) * size;
}

RC_GTEST_PROP(SteppedInvariants, HoldForEverySystem, ()) {
  System const system = *any_system();
  State state = random_scene(system.scene);
  RC_ASSERT(largest_overlap(state) == 0.0);
  auto const engine = make_engine(system.engine, state);
  double const energy = kinetic_energy(state.agents);
  Vector const total = momentum(state.agents);
  std::size_t const count = state.agents.size();
  double const scale = system.scene.heaviest_mass * static_cast<double>(count);
  Counters counters;
  for (std::uint64_t const step : {1U, 2U, 10U, 60U, 150U}) {
    try {
      engine->advance(state, counters, {.step = step});
    } catch (RunFailure const&) {
      RC_DISCARD("a light disk became too fast for the time step");
    }
    RC_ASSERT(state.clock.step == step);
    try {
      validate(state);
    } catch (Error const& error) {
      RC_FAIL(error.what());
    }
    RC_ASSERT(std::abs(kinetic_energy(state.agents) - energy) <= rounding(counters.pair_collisions, scale));
    Vector const drift = momentum(state.agents) - total;
    auto const& hits = counters.wall_hits;
    if (state.box.is_periodic_x()) {
      RC_ASSERT(std::abs(drift.x) <= rounding(counters.pair_collisions, scale));
      RC_ASSERT(hits[Counters::left] + hits[Counters::right] == 0U);
    }
    if (state.box.is_periodic_y()) {
      RC_ASSERT(std::abs(drift.y) <= rounding(counters.pair_collisions, scale));
      RC_ASSERT(hits[Counters::bottom] + hits[Counters::top] == 0U);
    }
    RC_ASSERT(counters.moves == step * count);
    RC_ASSERT(counters.halted_moves <= counters.moves);
    RC_ASSERT(counters.pair_collisions <= counters.halted_moves);
    if (system.engine.contact == CollisionRule::approaching) RC_ASSERT(counters.pair_virial >= 0.0);
  }
  RC_CLASSIFY(counters.pair_collisions > 0);
  RC_CLASSIFY(state.box.has_images());
}

RC_GTEST_PROP(SteppedInvariants, MomentumChangesByWhatTheWallsGiveAndByNothingElse, ()) {
  System system = *any_system();
  system.scene.edge = Edge::wall;
  State state = random_scene(system.scene);
  auto const engine = make_engine(system.engine, state);
  Vector const before = momentum(state.agents);
  Counters counters;
  try {
    engine->advance(state, counters, {.step = 100});
  } catch (RunFailure const&) {
    RC_DISCARD("a light disk became too fast for the time step");
  }
  Vector const change = momentum(state.agents) - before;
  double const scale = system.scene.heaviest_mass * static_cast<double>(state.agents.size());
  double const allowed = rounding(counters.pair_collisions + counters.all_wall_hits(), scale);
  RC_ASSERT(std::abs(change.x - (counters.wall_impulse[Counters::left] - counters.wall_impulse[Counters::right])) <=
            allowed);
  RC_ASSERT(std::abs(change.y - (counters.wall_impulse[Counters::bottom] - counters.wall_impulse[Counters::top])) <=
            allowed);
}

bool same_counters(Counters const& a, Counters const& b) {
  return a.moves == b.moves && a.halted_moves == b.halted_moves && a.pair_collisions == b.pair_collisions &&
         a.distance_checks == b.distance_checks && a.wall_hits == b.wall_hits && a.wall_impulse == b.wall_impulse &&
         a.pair_virial == b.pair_virial;
}

RC_GTEST_PROP(SteppedInvariants, ARunDoesNotDependOnHowItIsCutIntoPieces, ()) {
  System const system = *any_system();
  State const start = random_scene(system.scene);
  State whole = start;
  Counters whole_counters;
  try {
    make_engine(system.engine, whole)->advance(whole, whole_counters, {.step = 100});
  } catch (RunFailure const&) {
    RC_DISCARD("a light disk became too fast for the time step");
  }
  State pieces = start;
  Counters counters;
  auto const engine = make_engine(system.engine, pieces);
  while (pieces.clock.step < 100) {
    std::uint64_t const next =
        std::min<std::uint64_t>(100, pieces.clock.step + static_cast<std::uint64_t>(*rc::gen::inRange(1, 40)));
    switch (*rc::gen::inRange(0, 3)) {
      case 0:
        engine->advance(pieces, counters, {.step = next});
        break;
      case 1:
        engine->advance(pieces, counters, {.step = 100, .time = pieces.clock.time + 3.5 * engine->time_step()});
        break;
      default:
        engine->advance(pieces, counters, {.step = 100, .pair_collisions = counters.pair_collisions + 5});
    }
  }
  RC_ASSERT(hash(pieces) == hash(whole));
  RC_ASSERT(same_counters(counters, whole_counters));
}

RC_GTEST_PROP(SteppedInvariants, ANewEngineInTheMiddleOfARunChangesNoBit, ()) {
  // What a checkpoint relies on: everything that matters is in the state and the settings.
  System const system = *any_system();
  State whole = random_scene(system.scene);
  State resumed = whole;
  Counters whole_counters;
  Counters counters;
  auto const stop = static_cast<std::uint64_t>(*rc::gen::inRange(1, 100));
  try {
    make_engine(system.engine, whole)->advance(whole, whole_counters, {.step = 100});
    make_engine(system.engine, resumed)->advance(resumed, counters, {.step = stop});
    make_engine(system.engine, resumed)->advance(resumed, counters, {.step = 100});
  } catch (RunFailure const&) {
    RC_DISCARD("a light disk became too fast for the time step");
  }
  RC_ASSERT(hash(resumed) == hash(whole));
  RC_ASSERT(counters.pair_virial == whole_counters.pair_virial);
}

}  // namespace
}  // namespace gridlock
