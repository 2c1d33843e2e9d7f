#include "gridlock/grid/detail/packed_layout.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace gridlock {

CellLayout packed_layout(Box const& box, RadiusRange const& radii, std::size_t disks, double displacement) {
  CellLayout const finest = layout_for_cutoff(box, 2.0 * radii.largest + displacement, disks);
  double const widest = widest_for_four(radii.smallest);
  auto const cells = [&](double side, int most) {
    return static_cast<std::uint64_t>(std::min(std::floor(side / widest) + 1.0, static_cast<double>(most)));
  };
  return {box, cells(box.width(), finest.columns()), cells(box.height(), finest.rows())};
}

}  // namespace gridlock
