#pragma once

#include <cstddef>

#include "gridlock/core/archive.hpp"
#include "packing/soft_forces.hpp"

namespace gridlock {

/// Follows the steepest descent dx/dt = F in steps whose error stays below a hundredth of the smallest diameter.
///
/// Steps are those of an explicit Runge–Kutta–Chebyshev method of second order. Its s stages are stable over a time
/// that grows with s², so that slow motions take few evaluations of the forces; s follows from a bound of the largest
/// eigenvalue of the Hessian.
/// Source: B. P. Sommeijer, L. F. Shampine and J. G. Verwer (1998), doi:10.1016/S0377-0427(97)00219-7.
class SteepestDescent {
 public:
  explicit SteepestDescent(std::size_t disks) : from_(disks), before_(disks), after_(disks), force_(disks) {}

  /// Starts anew. Contract: it is called before the first step and whenever the smallest diameter has changed.
  void restart(double diameter);

  /// Moves the disks. `force` is the force at their positions, before and after. Velocities are passed to SoftForces.
  ForceSums step(Packing& packing, SoftForces& forces, Potential potential, Columns const& velocities, Columns& force);

  void serialize(Archive& archive);

 private:
  ForceSums try_step(Packing& packing, SoftForces& forces, int stages, Columns const& velocities, Columns const& force);
  [[nodiscard]] double find_error(Packing const& packing, Columns const& force) const;

  double diameter_ = 1.0;
  double time_ = 0.0;  ///< duration of the next step
  Columns from_;       ///< positions before the step; the next arrays are positions at two of its stages
  Columns before_;
  Columns after_;
  Columns force_;  ///< force at the last stage
};

}  // namespace gridlock
