#include "gridlock/grid/detail/find_neighbours.hpp"

#include "grid/find_neighbours_kernels.hpp"

namespace gridlock {

namespace {

template <class Displacement>
std::size_t find(RowSearch const& search, std::span<RowRange const> ranges, std::uint32_t* found,
                 Displacement displacement) {
  std::size_t count = 0;
  for (RowRange const& range : ranges) {
    for (std::size_t row = range.first; row < range.end; ++row) {
      // Every candidate is written; only the count depends on the comparison.
      found[count] = static_cast<std::uint32_t>(row);
      bool const is_near =
          squared_length(displacement(search.p, Vector{search.x[row], search.y[row]})) < search.squared_cutoff;
      count += static_cast<std::size_t>(is_near & (row != search.left_out));
    }
  }
  return count;
}

}  // namespace

std::size_t find_neighbours_scalar(RowSearch const& search, std::span<RowRange const> ranges, std::uint32_t* found) {
  if (search.box == nullptr) {
    return find(search, ranges, found, [](Vector p, Vector q) { return q - p; });
  }
  Box const box = *search.box;
  return find(search, ranges, found, [&](Vector p, Vector q) { return box.displacement_inside(p, q); });
}

FindNeighbours find_neighbours_kernel(Target target) {
  if (FindNeighbours const kernel = find_neighbours_with_avx512(target)) return kernel;
#ifdef GRIDLOCK_HIGHWAY
  if (FindNeighbours const kernel = find_neighbours_with_highway(target)) return kernel;
#endif
  return find_neighbours_scalar;
}

std::size_t find_neighbours(RowSearch const& search, std::span<RowRange const> ranges, std::uint32_t* found) {
  static FindNeighbours const kernel = find_neighbours_kernel(target());
  return kernel(search, ranges, found);
}

}  // namespace gridlock
