#include "packing/fire.hpp"

#include <algorithm>
#include <cmath>

namespace gridlock {

namespace {

constexpr double first_time_step = 0.1;  // time step, in √(m D²/ε)
constexpr double longest_time_step = 0.45;
constexpr double shortest_time_step = 0.002;
constexpr std::uint64_t delay = 20;
constexpr double first_mixing = 0.25;

}  // namespace

void Fire::start(double diameter) {
  stop();
  diameter_ = diameter;
  time_step_ = first_time_step * diameter;
  mixing_ = first_mixing;
  downhill_ = 0;
}

void Fire::stop() {
  std::ranges::fill(velocity_.x, 0.0);
  std::ranges::fill(velocity_.y, 0.0);
}

void Fire::step(Packing& packing, SiteForces& forces, ForceSums const& sums, Columns& force, std::uint64_t iteration) {
  bool const is_downhill = sums.power > 0.0;
  if (is_downhill) {
    if (++downhill_ > delay) {
      time_step_ = std::min(time_step_ * 1.1, longest_time_step * diameter_);
      mixing_ *= 0.99;
    }
  } else {
    downhill_ = 0;
    if (iteration > delay) {
      time_step_ = std::max(time_step_ * 0.5, shortest_time_step * diameter_);
      mixing_ = first_mixing;
    }
    forces.displace(packing, velocity_, -0.5 * time_step_);
    stop();
  }
  // After half a step back the forces have changed; with the old forces the next step could go uphill.
  ForceSums const here = is_downhill ? sums : forces.evaluate(packing, velocity_, force);
  double const dt = time_step_;
  double const squared_speed = here.speed_squares + 2.0 * dt * here.power + dt * dt * here.force_squares;
  double const along = here.force_squares > 0.0 ? mixing_ * std::sqrt(squared_speed / here.force_squares) : 0.0;
  double const kept = 1.0 - mixing_;
  for (std::size_t i = 0; i < velocity_.x.size(); ++i) {
    velocity_.x[i] = kept * (velocity_.x[i] + dt * force.x[i]) + along * force.x[i];
    velocity_.y[i] = kept * (velocity_.y[i] + dt * force.y[i]) + along * force.y[i];
  }
  forces.displace(packing, velocity_, dt);
}

void Fire::serialize(Archive& archive) {
  std::size_t const disks = velocity_.x.size();
  archive.visit("velocity_x", velocity_.x);
  archive.visit("velocity_y", velocity_.y);
  archive.require(velocity_.x.size() == disks && velocity_.y.size() == disks,
                  "a minimization has another number of velocities than of disks");
  archive.visit("diameter", diameter_);
  archive.visit("time_step", time_step_);
  archive.visit("mixing", mixing_);
  archive.visit("downhill", downhill_);
}

}  // namespace gridlock
