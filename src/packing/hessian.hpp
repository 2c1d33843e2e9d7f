#pragma once

// Eigen's own vector instructions would make the bits depend on the compiler and the processor.
#define EIGEN_DONT_VECTORIZE
#define EIGEN_DONT_PARALLELIZE
#include <Eigen/SparseCore>

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "gridlock/packing/soft_disks.hpp"

namespace gridlock {

using SparseMatrix = Eigen::SparseMatrix<double>;

/// Which unknowns belong to a disk: 2 · place and 2 · place + 1.
struct Unknowns {
  static constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();

  std::vector<std::uint32_t> place;  ///< of every disk; `none` for a disk that is held
  std::size_t disks = 0;             ///< that have a place

  /// All disks.
  explicit Unknowns(std::size_t all);
  /// Those disks that are marked.
  explicit Unknowns(std::vector<bool> const& takes_part);
};

/// The second derivatives of the energy by the positions, the lower triangle.
///
/// A contact gives k n nᵀ − (f/r) (1 − n nᵀ) to the diagonal blocks of its two disks, and the negative of it to the block between
/// them; a wall k n nᵀ. A disk that is held acts as a wall of its shape.
SparseMatrix hessian_of(std::span<Contact const> contacts, Potential potential, Unknowns const& unknowns);

}  // namespace gridlock
