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
  double energy;         ///< that it can have at most when its turn comes
  double smallest_mass;  ///< of those that share this energy
  double largest_radius;
  double smallest_radius;
};

/// Disks that can disturb each other's turns, directly or through others.
struct LateGroup {
  double energy = 0.0;
  double smallest_mass = 0.0;
  double largest_radius = 0.0;
  double smallest_radius = 0.0;
};

/// Whether two turns that look up to `reach` cells to each side may look at a common cell.
bool may_meet(CellLayout const& layout, int cell, int other, int reach);

/// Late disks in groups that cannot disturb each other; group_of[k] is that of disk k.
///
/// Who is late gets energy before its turn only from those who hit it in their turns, and these got theirs in the same
/// way: so none of a group has more than all of them had together.
struct LateGroups {
  std::vector<LateGroup> groups;
  std::vector<std::size_t> group_of;
};
LateGroups groups_of(CellLayout const& layout, std::span<LateDisk const> disks, int reach);

/// The levels in which disks take their turns that other processes must know of: those of one level at once, after
/// those of the levels before. `disks` are in the order of their turns. A process keeps that order among its own; a
/// disk that may meet an earlier one of another process comes a level after it.
std::vector<std::size_t> levels_of(CellLayout const& layout, std::span<LateDisk const> disks, int reach);

}  // namespace gridlock::tiled
