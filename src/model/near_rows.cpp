#include "gridlock/model/near_rows.hpp"

#include "model/near_rows_ways.hpp"

namespace gridlock {

namespace {

template <class Displacement>
std::size_t find(NearRowsSearch const& search, std::span<Stretch const> stretches, std::uint32_t* found,
                 Displacement displacement) {
  std::size_t count = 0;
  for (Stretch const& stretch : stretches) {
    for (std::size_t row = stretch.first; row < stretch.end; ++row) {
      // Every candidate is written, and only the count depends on the answer.
      found[count] = static_cast<std::uint32_t>(row);
      bool const is_near =
          squared_length(displacement(search.p, Vector{search.x[row], search.y[row]})) < search.squared_reach;
      count += static_cast<std::size_t>(is_near & (row != search.left_out));
    }
  }
  return count;
}

}  // namespace

std::size_t find_near_rows_plainly(NearRowsSearch const& search, std::span<Stretch const> stretches,
                                   std::uint32_t* found) {
  if (search.box == nullptr) {
    return find(search, stretches, found, [](Vector p, Vector q) { return q - p; });
  }
  Box const box = *search.box;
  return find(search, stretches, found, [&](Vector p, Vector q) { return box.displacement_inside(p, q); });
}

std::size_t find_near_rows(NearRowsSearch const& search, std::span<Stretch const> stretches, std::uint32_t* found) {
  static auto const way = can_find_near_rows_with_avx512() ? find_near_rows_with_avx512 : find_near_rows_plainly;
  return way(search, stretches, found);
}

}  // namespace gridlock
