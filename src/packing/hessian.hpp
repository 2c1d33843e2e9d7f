#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "gridlock/packing/soft_disks.hpp"
#include "packing/eigen.hpp"

namespace gridlock {

using SparseMatrix = Eigen::SparseMatrix<double>;
/// An entry of a matrix; those of the same place are added up.
using HessianEntry = Eigen::Triplet<double, int>;

/// The unknowns of each disk: 2 · place (x) and 2 · place + 1 (y).
struct Unknowns {
  static constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();

  std::vector<std::uint32_t> place;  ///< index of every disk among the unknowns; `none` for a disk that is held
  std::size_t disks = 0;             ///< number of disks that are not held

  /// All disks are unknowns.
  explicit Unknowns(std::size_t all);
  /// The marked disks are unknowns.
  explicit Unknowns(std::vector<bool> const& takes_part);
};

/// A symmetric matrix of 2 × 2 numbers.
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

/// Returns the second derivatives of a contact's energy by the separation: k n nᵀ − (f/r) (1 − n nᵀ); k n nᵀ at a wall.
HessianBlock block_of(Contact const& contact, Potential potential, bool is_at_wall);

/// Returns the lower triangle of the second derivatives of the energy by the positions.
///
/// A contact adds its block to the diagonal blocks of its two disks, and subtracts it from the block between them. A
/// disk that is held acts as a wall of its shape.
SparseMatrix hessian_of(std::span<Contact const> contacts, Potential potential, Unknowns const& unknowns);
/// Returns the entries of hessian_of().
std::vector<HessianEntry> hessian_entries(std::span<Contact const> contacts, Potential potential,
                                          Unknowns const& unknowns);
/// Returns the matrix of two unknowns for each site with these entries.
SparseMatrix hessian_of(std::vector<HessianEntry> const& entries, std::size_t sites);

}  // namespace gridlock
