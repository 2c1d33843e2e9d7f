#include "simulation/patient_engine.hpp"

#include <fmt/format.h>

#include <cmath>
#include <cstddef>

#include "gridlock/core/error.hpp"

namespace gridlock {

double patience_for(State const& state) {
  double const disks = static_cast<double>(state.agents.size());
  Vector mean{};
  if (state.box.is_periodic()) {
    for (std::size_t i = 0; i < state.agents.size(); ++i) mean = mean + velocity(state.agents, i);
    mean = (1.0 / disks) * mean;
  }
  double squares = 0.0;
  for (std::size_t i = 0; i < state.agents.size(); ++i) squares += squared_length(velocity(state.agents, i) - mean);
  return patience_for(state.box, disks, radius_range(state.agents).smallest, squares);
}

double patience_for(Box const& box, double disks, double smallest_radius, double squares) {
  double const speed = std::sqrt(squares / disks);
  double const mean_free_time = box.area() / (disks * 2.0 * smallest_radius * speed);
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
  if (is_patient) return;
  throw RunFailure(
      fmt::format("no two disks have met for a time of {:.6g}, in which disks that move at random meet again "
                  "and again: these never will, and collisions alone end this run\n"
                  "  hint: give run.steps or run.time as well",
                  patience_));
}

}  // namespace gridlock
