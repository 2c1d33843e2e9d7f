#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "engine/soft/disks.hpp"
#include "gridlock/core/box.hpp"
#include "gridlock/core/detail/thread_pool.hpp"

namespace gridlock::soft {

/// Entries are padded to a multiple of this number, so that kernels take whole registers.
inline constexpr std::size_t entries_at_once = 4;

/// The neighbours of the disks in rows first … end − 1, which one thread moves.
struct Band {
  std::size_t first = 0;
  std::size_t end = 0;
  std::vector<std::uint32_t> begin;           ///< first entry of each row, and one behind
  UninitializedArray<std::uint32_t> entries;  ///< rows of neighbours, padded with Disks::size()
  std::vector<std::uint8_t> is_at_edge;       ///< whether a neighbour of the row may be beyond a periodic edge
};

/// Calls visit(row, d) for each neighbour in the lists of the disk in row band.first + k, with its row and the vector d
/// from it to the disk, from the nearest image.
template <class Visit>
[[gnu::always_inline]] inline void for_each_neighbour(Band const& band, std::size_t k, Box const& box,
                                                      Disks const& disks, Visit visit) {
  Vector const place = disks.places[band.first + k];
  bool const is_at_edge = band.is_at_edge[k] != 0;
  for (std::size_t n = band.begin[k]; n < band.begin[k + 1]; ++n) {
    std::uint32_t const other = band.entries[n];
    if (other == disks.size()) continue;
    Vector const from = disks.places[other];
    visit(other, is_at_edge ? box.displacement_inside(from, place) : place - from);
  }
}

/// Distances of the lists.
struct ListReach {
  double cutoff;         ///< in contact distances
  double largest_sigma;  ///< largest contact distance
  double skin;           ///< entries are nearer than their cutoff plus this
  bool are_equal;        ///< whether all radii are equal
  bool flows;            ///< whether a flow carries disks across edges while the lists are used
};

/// Sorts the disks by their cells and makes the lists of all neighbours of each disk. They are complete while no disk
/// moves farther than half the skin, except by a flow.
/// Contract: the cutoff and the skin together are at most half of the shortest period of the box.
std::vector<Band> make_lists(Box const& box, ListReach const& reach, Disks& disks, ThreadPool& pool);

}  // namespace gridlock::soft
