#pragma once

#include <cstddef>
#include <cstdint>

#include "gridlock/core/archive.hpp"
#include "packing/site_forces.hpp"

namespace gridlock {

/// FIRE 2.0 (fast inertial relaxation engine): sites move as in dynamics, are steered along their forces, and stop
/// wherever the energy begins to rise.
/// Source: J. Guénolé et al. (2020), doi:10.1016/j.commatsci.2020.109584.
class Fire {
 public:
  explicit Fire(std::size_t sites) : velocity_(sites) {}

  /// Begins anew with all sites at rest.
  void start(double diameter);
  void stop();
  [[nodiscard]] Columns const& velocity() const { return velocity_; }

  /// Moves the sites. `force` and `sums` are those before the step. The first iterations keep the time step long.
  void step(Packing& packing, SiteForces& forces, ForceSums const& sums, Columns& force, std::uint64_t iteration);

  void serialize(Archive& archive);

 private:
  Columns velocity_;
  double diameter_ = 1.0;
  double time_step_ = 0.0;
  double mixing_ = 0.0;
  std::uint64_t downhill_ = 0;
};

}  // namespace gridlock
