#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "gridlock/packing/soft_disks.hpp"
#include "packing/eigen.hpp"

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

/// A symmetric matrix of 2 × 2.
struct HessianBlock {
  double xx = 0.0;
  double xy = 0.0;
  double yy = 0.0;

  HessianBlock& operator+=(HessianBlock const& other) {
    xx += other.xx;
    xy += other.xy;
    yy += other.yy;
    return *this;
  }
  friend Vector operator*(HessianBlock const& m, Vector v) {
    return {m.xx * v.x + m.xy * v.y, m.xy * v.x + m.yy * v.y};
  }
};

/// The second derivatives of the energy of a contact by the separation of its two disks: k n nᵀ − (f/r) (1 − n nᵀ), at
/// a wall k n nᵀ.
HessianBlock block_of(Contact const& contact, Potential potential, bool is_at_wall);

/// The second derivatives of the energy by the positions, the lower triangle.
///
/// A contact gives its block to the diagonal blocks of its two disks, and the negative of it to the block between them.
/// A disk that is held acts as a wall of its shape.
SparseMatrix hessian_of(std::span<Contact const> contacts, Potential potential, Unknowns const& unknowns);

}  // namespace gridlock
