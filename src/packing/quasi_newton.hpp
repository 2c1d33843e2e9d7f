#pragma once

#include <cstddef>
#include <vector>

#include "gridlock/core/archive.hpp"
#include "gridlock/core/detail/thread_pool.hpp"
#include "packing/soft_forces.hpp"

namespace gridlock {

/// The limited-memory method of Broyden, Fletcher, Goldfarb and Shanno: an inverse Hessian estimated from the last few
/// steps and the changes of forces along them.
/// Source: D. C. Liu and J. Nocedal (1989), doi:10.1007/BF01589116.
class QuasiNewton {
 public:
  /// `first_scale` is the length of a step for a unit force while no step is remembered.
  QuasiNewton(std::size_t disks, double first_scale) : disks_(disks), first_scale_(first_scale) {}

  /// Writes the step to the minimum of the quadratic energy that is estimated. Returns step · force.
  double find_direction(Columns const& force, Columns& step, ThreadPool& pool);
  /// Learns from a move by `scale` times `step`. A step along which the energy curves down is ignored.
  void remember(Columns const& step, double scale, Columns const& force_before, Columns const& force_after,
                ThreadPool& pool);
  void forget(double first_scale);

  void serialize(Archive& archive);

 private:
  struct Pair {
    Columns step;
    Columns change;          ///< force before − force after
    double curvature = 0.0;  ///< step · change
    double scale = 0.0;      ///< curvature / change²
  };

  std::size_t disks_;
  double first_scale_;
  std::vector<Pair> pairs_;  ///< oldest first
};

}  // namespace gridlock
