#pragma once

// Minima of small packings by Newton steps with the Hessian: short, slow, and independent of the engines.

#include <cmath>
#include <cstddef>
#include <vector>

#include "gridlock/core/random.hpp"
#include "gridlock/packing/soft_disks.hpp"
#include "packing/eigen.hpp"
#include "packing/hessian.hpp"

namespace gridlock::reference {

/// Disks of two sizes, 1 : 1.4, at random places.
inline Packing random_packing(std::size_t disks, double packing_fraction, Box const& box, std::uint64_t seed) {
  Packing packing{.box = box, .x = {}, .y = {}, .radius = {}};
  RandomStream random(seed, 0, 0, Purpose::start_position);
  for (std::size_t i = 0; i < disks; ++i) {
    packing.radius.push_back(i % 2 == 0 ? 1.0 : 1.4);
    packing.x.push_back(box.width() * random.uniform());
    packing.y.push_back(box.height() * random.uniform());
  }
  double const scale = std::sqrt(packing_fraction / gridlock::packing_fraction(packing));
  for (double& radius : packing.radius) radius *= scale;
  return packing;
}

inline void scale_radii(Packing& packing, double factor) {
  for (double& radius : packing.radius) radius *= factor;
}

inline double energy_of(Packing const& packing, Potential potential) {
  return gridlock::energy_of(find_contacts(packing), potential);
}

/// The packing after all disks have moved; between walls no further than them.
inline Packing moved(Packing packing, Eigen::VectorXd const& step) {
  auto const along = [&](double& coordinate, double side, double displacement) {
    coordinate += displacement;
    if (packing.box.is_periodic()) {
      coordinate = image_inside(coordinate, side);
    } else {
      coordinate = std::min(std::max(coordinate, 0.0), side);
    }
  };
  for (std::size_t i = 0; i < packing.size(); ++i) {
    auto const row = static_cast<Eigen::Index>(2 * i);
    along(packing.x[i], packing.box.width(), step(row));
    along(packing.y[i], packing.box.height(), step(row + 1));
  }
  return packing;
}

/// The net forces as a vector of unknowns.
inline Eigen::VectorXd force_vector(Packing const& packing, Potential potential) {
  Eigen::VectorXd vector(static_cast<Eigen::Index>(2 * packing.size()));
  auto const forces = forces_of(find_contacts(packing), potential, packing.size());
  for (std::size_t i = 0; i < forces.size(); ++i) {
    vector(static_cast<Eigen::Index>(2 * i)) = forces[i].x;
    vector(static_cast<Eigen::Index>(2 * i + 1)) = forces[i].y;
  }
  return vector;
}

/// Follows the Hessian, shifted until it is positive definite, down to where rounding ends it.
inline Packing minimum_near(Packing packing, Potential potential) {
  double shift = 1e-9;
  for (int step = 0; step < 3000; ++step) {
    Eigen::VectorXd const force = force_vector(packing, potential);
    SparseMatrix const hessian = hessian_of(find_contacts(packing), potential, Unknowns(packing.size()));
    double const unit = 1.0 / (smallest_diameter(packing) * smallest_diameter(packing));
    Eigen::SimplicialLLT<SparseMatrix> cholesky;
    for (;; shift *= 10.0) {
      cholesky.setShift(shift * unit);
      cholesky.compute(hessian);
      if (cholesky.info() == Eigen::Success) break;
    }
    Eigen::VectorXd displacement = cholesky.solve(force);
    double const longest = displacement.cwiseAbs().maxCoeff();
    if (longest < 1e-14 * smallest_diameter(packing)) return packing;
    displacement *= std::min(1.0, 0.1 * smallest_diameter(packing) / longest);
    Packing const next = moved(packing, displacement);
    bool const is_better = energy_of(next, potential) < energy_of(packing, potential) ||
                           force_vector(next, potential).norm() < 0.5 * force.norm();
    if (is_better) packing = next;
    if (!is_better && shift > 1e3) return packing;
    shift = is_better ? std::max(1e-9, 0.2 * shift) : 10.0 * shift;
  }
  return packing;
}

}  // namespace gridlock::reference
