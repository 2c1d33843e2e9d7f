#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "gridlock/grid/cell_layout.hpp"

namespace gridlock::tiled {

/// A disk that was too fast for its tile and takes its turn at the end of the step.
struct LateDisk {
  std::uint32_t tile;
  std::uint32_t id_index;
  std::int32_t cell;
  std::uint32_t process;
  double energy;         ///< largest kinetic energy that the disk can have when its turn comes
  double smallest_mass;  ///< smallest mass of the disks that share this energy
  double largest_radius;
  double smallest_radius;
};

/// A group of disks that can change each other's turns, directly or through others.
struct LateGroup {
  double energy = 0.0;
  double smallest_mass = 0.0;
  double largest_radius = 0.0;
  double smallest_radius = 0.0;
};

/// Returns whether two turns that look at up to `reach` cells to each side may look at a common cell.
bool may_meet(CellLayout const& layout, int cell, int other, int reach);

/// Groups of late disks that cannot change each other's turns; group_of[k] is the index of the group of disk k.
///
/// A late disk gains energy before its turn only from late disks that hit it in theirs, which gained energy in the same
/// way. So no disk of a group has more energy than all of the group had together.
struct LateGroups {
  std::vector<LateGroup> groups;
  std::vector<std::size_t> group_of;
};
LateGroups groups_of(CellLayout const& layout, std::span<LateDisk const> disks, int reach);

/// Returns the level of each late disk whose turn other processes must know: turns of one level are taken at once,
/// after those of lower levels. `disks` are in the order of their turns. A process keeps this order among its own
/// disks; a disk that may meet an earlier disk of another process comes at least one level after it.
std::vector<std::size_t> levels_of(CellLayout const& layout, std::span<LateDisk const> disks, int reach);

}  // namespace gridlock::tiled
