#pragma once

#include "gridlock/core/direction.hpp"
#include "gridlock/core/disks.hpp"
#include "gridlock/core/setting.hpp"
#include "gridlock/model/model_engine.hpp"
#include "gridlock/model/observations.hpp"

namespace gridlock {

/// What a model needs is all in here: ModelEngine says what a model is.
///
/// ```cpp
/// struct Walkers {
///   static constexpr std::string_view name = "walkers";
///   static constexpr std::string_view documentation = "Points that walk at random.";
///   static constexpr Schedule schedule = Schedule::synchronous;
///   using Agents = Population<X, Y>;
///   double cutoff() const { return 0.1; }
///   double time_step() const { return 1.0; }
///   void start(World<Walkers>& world) const { world.agents.add(0.5, 0.5); }
///   void turn(Turn<Walkers>& self) const {
///     RandomStream random = self.random();
///     self.move_by(0.01 * random.in_unit_disk());
///   }
///   void observe(World<Walkers> const& world, Observations& observations) const {
///     observations.add("agents", static_cast<double>(world.agents.size()));
///   }
/// };
/// ```

}  // namespace gridlock
