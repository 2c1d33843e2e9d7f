#pragma once

#include <cstddef>

#include "gridlock/core/archive.hpp"
#include "packing/soft_forces.hpp"

namespace gridlock {

/// Follows dx/dt = F, the steepest way down, by steps whose error is held below a hundredth of the smallest diameter.
///
/// Each step is one of an explicit Runge–Kutta–Chebyshev method of second order. Its s stages are stable over a time
/// that grows as s², so that slow ways take few evaluations of the forces; s follows from a bound of the largest
/// eigenvalue of the Hessian.
/// Source: B. P. Sommeijer, L. F. Shampine and J. G. Verwer (1998), doi:10.1016/S0377-0427(97)00219-7.
class SteepestDescent {
 public:
  explicit SteepestDescent(std::size_t disks) : from_(disks), before_(disks), after_(disks), force_(disks) {}

  /// Contract: before the first step, and where the smallest diameter is another.
  void restart(double diameter);

  /// Moves the disks; `force` is that where they are, before and after. Velocities are handed to SoftForces.
  ForceSums step(Packing& packing, SoftForces& forces, Potential potential, Columns const& velocities, Columns& force);

  void serialize(Archive& archive);

 private:
  ForceSums try_step(Packing& packing, SoftForces& forces, int stages, Columns const& velocities, Columns const& force);
  [[nodiscard]] double find_error(Packing const& packing, Columns const& force) const;

  double diameter_ = 1.0;
  double time_ = 0.0;  ///< of the next step
  Columns from_;       ///< positions before the step, as the next two of its stages
  Columns before_;
  Columns after_;
  Columns force_;  ///< at the last stage
};

}  // namespace gridlock
