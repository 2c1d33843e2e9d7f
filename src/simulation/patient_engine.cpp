#include "simulation/patient_engine.hpp"

#include <fmt/format.h>

#include <cmath>
#include <cstddef>

#include "gridlock/core/error.hpp"

namespace gridlock {

double patience_for(State const& state) {
  return patience_for(state, overview_of(state.agents), [](auto const& add) {
    SpeedSums sums;
    add(sums);
    return sums;
  });
}

double patience_for(State const& some, DisksOverview const& all,
                    std::function<SpeedSums(std::function<void(SpeedSums&)> const& add)> const& add_all) {
  Disks const& own = some.agents;
  auto const disks = static_cast<double>(all.count);
  Vector mean{};
  if (some.box.is_periodic()) {
    SpeedSums const sums = add_all([&](SpeedSums& so_far) {
      for (std::size_t i = 0; i < own.size(); ++i) so_far.velocity = so_far.velocity + velocity(own, i);
    });
    mean = (1.0 / disks) * sums.velocity;
  }
  SpeedSums const sums = add_all([&](SpeedSums& so_far) {
    for (std::size_t i = 0; i < own.size(); ++i) so_far.squares += squared_length(velocity(own, i) - mean);
  });
  double const speed = std::sqrt(sums.squares / disks);
  double const mean_free_time = some.box.area() / (disks * 2.0 * all.radii.smallest * speed);
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
