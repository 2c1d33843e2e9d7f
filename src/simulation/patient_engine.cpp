#include "simulation/patient_engine.hpp"

#include <fmt/format.h>

#include <cmath>
#include <cstddef>

#include "gridlock/core/error.hpp"
#include "gridlock/core/vector.hpp"
#include "parallel/disks_of_all.hpp"

namespace gridlock {

double patience_for(State const& own, AllProcesses processes) {
  /// Sums over the rows of all processes in order: Σ v, and Σ |v − mean|².
  struct Sums {
    Vector velocity;
    double squares = 0.0;
  };
  Disks const& agents = own.agents;
  DisksOverview const all = overview_of_all(agents, processes);
  auto const disks = static_cast<double>(all.count);
  Vector mean{};
  if (own.box.has_images()) {
    Sums const sums = processes.change_in_order(Sums{}, [&](Sums& so_far) {
      for (std::size_t i = 0; i < agents.size(); ++i) so_far.velocity = so_far.velocity + velocity(agents, i);
    });
    mean = (1.0 / disks) * sums.velocity;
    if (!own.box.is_periodic_x()) mean.x = 0.0;
    if (!own.box.is_periodic_y()) mean.y = 0.0;
  }
  Sums const sums = processes.change_in_order(Sums{}, [&](Sums& so_far) {
    for (std::size_t i = 0; i < agents.size(); ++i) so_far.squares += squared_length(velocity(agents, i) - mean);
  });
  double const speed = std::sqrt(sums.squares / disks);
  double const mean_free_time = own.box.area() / (disks * 2.0 * all.radii.smallest * speed);
  return (1e4 + 4e6 / (disks * disks)) * mean_free_time;
}

void PatientEngine::advance(State& state, Counters& counters, StopCondition const& stop_condition) {
  bool is_patient = true;
  StopCondition watched = stop_condition;
  watched.should_continue = [&] {
    if (!last_collision_ || counters.pair_collisions != collisions_seen_) {
      last_collision_ = state.clock.time;
      collisions_seen_ = counters.pair_collisions;
    }
    is_patient = state.clock.time - *last_collision_ <= patience_;
    return is_patient && !stop_condition.stops_here();
  };
  engine_->advance(state, counters, watched);
  // Only the root calls should_continue(), so it decides for all.
  if (processes_.of_root(is_patient)) return;
  throw RunFailure(
      fmt::format("no two disks have met for a time of {:.6g}, in which disks that move at random meet again "
                  "and again: these never will, and collisions alone end this run\n"
                  "  hint: give run.steps or run.time as well",
                  patience_));
}

}  // namespace gridlock
