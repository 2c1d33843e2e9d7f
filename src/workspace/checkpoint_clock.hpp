#pragma once

#include <chrono>
#include <cstdint>

#include "gridlock/simulation/configuration.hpp"

namespace gridlock {

/// Decides when a checkpoint is due, by time and by steps since the last one.
class CheckpointClock {
 public:
  explicit CheckpointClock(CheckpointSettings const& settings) : settings_(settings) {}

  [[nodiscard]] bool is_due(std::uint64_t steps) const {
    double const waited = std::chrono::duration<double>(Time::now() - last_).count();
    return (settings_.every_seconds > 0.0 && waited >= settings_.every_seconds) ||
           (settings_.every_steps > 0 && steps - last_steps_ >= settings_.every_steps);
  }
  void note(std::uint64_t steps) {
    last_ = Time::now();
    last_steps_ = steps;
  }

 private:
  using Time = std::chrono::steady_clock;
  CheckpointSettings settings_;
  Time::time_point last_ = Time::now();
  std::uint64_t last_steps_ = 0;
};

}  // namespace gridlock
