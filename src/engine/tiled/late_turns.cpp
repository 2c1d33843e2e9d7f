#include "engine/tiled/late_turns.hpp"

#include <algorithm>
#include <cstdlib>
#include <numeric>
#include <unordered_map>

namespace gridlock::tiled {

namespace {

/// Returns the distance of two columns or rows, of `all` in a box.
int apart(int one, int other, int all, bool is_periodic) {
  int const distance = std::abs(one - other);
  return is_periodic ? std::min(distance, all - distance) : distance;
}

/// Disjoint sets that can be joined.
class Sets {
 public:
  explicit Sets(std::size_t count) : parent_(count) { std::iota(parent_.begin(), parent_.end(), std::size_t{0}); }

  std::size_t find(std::size_t k) {
    while (parent_[k] != k) k = parent_[k] = parent_[parent_[k]];
    return k;
  }
  void join(std::size_t one, std::size_t other) { parent_[find(one)] = find(other); }

 private:
  std::vector<std::size_t> parent_;
};

}  // namespace

bool may_meet(CellLayout const& layout, int cell, int other, int reach) {
  int const columns = layout.columns();
  return apart(cell % columns, other % columns, columns, layout.is_periodic_x()) <= 2 * reach &&
         apart(cell / columns, other / columns, layout.rows(), layout.is_periodic_y()) <= 2 * reach;
}

LateGroups groups_of(CellLayout const& layout, std::span<LateDisk const> disks, int reach) {
  // Sorted by row, only disks of near rows are compared; behind the last row the first rows follow again.
  std::vector<std::size_t> by_row(disks.size());
  std::iota(by_row.begin(), by_row.end(), std::size_t{0});
  auto const row_of = [&](std::size_t k) { return disks[k].cell / layout.columns(); };
  std::ranges::sort(by_row, {}, row_of);
  Sets sets(disks.size());
  std::size_t const count = disks.size();
  for (std::size_t n = 0; n < count; ++n) {
    for (std::size_t m = n + 1; m < n + count; ++m) {
      std::size_t const other = by_row[m % count];
      if (m >= count && !layout.is_periodic_y()) break;
      int const row = row_of(other) + (m >= count ? layout.rows() : 0);
      if (row - row_of(by_row[n]) > 2 * reach) break;
      if (may_meet(layout, disks[by_row[n]].cell, disks[other].cell, reach)) sets.join(by_row[n], other);
    }
  }
  LateGroups found{.groups = {}, .group_of = std::vector<std::size_t>(count)};
  constexpr auto none = static_cast<std::size_t>(-1);
  std::vector<std::size_t> number(count, none);
  for (std::size_t k = 0; k < count; ++k) {
    std::size_t& group = number[sets.find(k)];
    LateDisk const& disk = disks[k];
    if (group == none) {
      group = found.groups.size();
      found.groups.push_back({.smallest_mass = disk.smallest_mass,
                              .largest_radius = disk.largest_radius,
                              .smallest_radius = disk.smallest_radius});
    }
    LateGroup& of_disk = found.groups[group];
    of_disk.energy += disk.energy;
    of_disk.smallest_mass = std::min(of_disk.smallest_mass, disk.smallest_mass);
    of_disk.largest_radius = std::max(of_disk.largest_radius, disk.largest_radius);
    of_disk.smallest_radius = std::min(of_disk.smallest_radius, disk.smallest_radius);
    found.group_of[k] = group;
  }
  return found;
}

std::vector<std::size_t> levels_of(CellLayout const& layout, std::span<LateDisk const> disks, int reach) {
  std::vector<std::size_t> levels(disks.size(), 0);
  std::unordered_map<std::uint32_t, std::size_t> last_of_process;
  std::unordered_map<int, std::vector<std::size_t>> of_row;  // indices of earlier disks by row
  int const rows = layout.rows();
  int const rows_around = std::min(4 * reach + 1, rows);
  for (std::size_t k = 0; k < disks.size(); ++k) {
    std::size_t& last = last_of_process[disks[k].process];
    std::size_t level = last;
    int const row = disks[k].cell / layout.columns();
    for (int n = 0; n < rows_around; ++n) {
      auto const near = of_row.find(((row - 2 * reach + n) % rows + rows) % rows);
      if (near == of_row.end()) continue;
      for (std::size_t const before : near->second) {
        bool const waits =
            disks[before].process != disks[k].process && may_meet(layout, disks[before].cell, disks[k].cell, reach);
        if (waits) level = std::max(level, levels[before] + 1);
      }
    }
    levels[k] = level;
    last = level;
    of_row[row].push_back(k);
  }
  return levels;
}

}  // namespace gridlock::tiled
