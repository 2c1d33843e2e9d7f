#pragma once

#include <cstddef>

#include "gridlock/core/archive.hpp"
#include "gridlock/packing/minimizer.hpp"
#include "gridlock/packing/soft_disks.hpp"
#include "packing/hessian.hpp"
#include "packing/soft_forces.hpp"

namespace gridlock {

/// Deforms a box and the points in it by a pure shear, x ← s x, y ← y/s with s ≈ e^(γ/2), then by a simple shear.
void deform(Packing& packing, double pure_shear, double simple_shear);

/// The forces on the sites of a minimization: the disks, and the box as one more site where its shape is free.
///
/// The coordinates of that site are the strains of a pure and a simple shear, times √A, so that it is about as stiff as
/// a disk. They are 0 at every state: a step goes on from there. With the energy E, its force is −dE/dγ/√A, the shear
/// stress of the packing times √A.
class SiteForces {
 public:
  SiteForces(Packing const& packing, MinimizerSettings const& settings);

  [[nodiscard]] std::size_t sites() const { return disks_ + (is_box_free_ ? 1 : 0); }
  /// Computes the forces on all sites.
  ForceSums evaluate(Packing const& packing, Columns const& velocities, Columns& forces) {
    return with_box(packing, of_disks_.evaluate(packing, velocities, forces), velocities, forces);
  }
  /// Adds the force on the box, where its shape is free, to forces on the disks and their sums.
  ForceSums with_box(Packing const& packing, ForceSums sums, Columns const& velocities, Columns& forces) const;
  /// Moves all sites by `factor` times a step: the disks first, then the box with the disks in it.
  void displace(Packing& packing, Columns const& step, double factor) const;
  /// Returns the lower triangle of the second derivatives of the energy by the coordinates of all sites. Those by a
  /// disk and the box lack a term with the net force on the disk, which vanishes at a minimum.
  SparseMatrix hessian(Packing const& packing);

  /// The forces on the disks.
  SoftForces& of_disks() { return of_disks_; }

 private:
  std::size_t disks_;
  Potential potential_;
  bool is_box_free_;
  SoftForces of_disks_;
};

/// Saves the positions, and the box where its shape is free.
void serialize_places(Archive& archive, Packing& packing, BoxShape shape);

}  // namespace gridlock
