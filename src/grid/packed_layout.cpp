#include "gridlock/grid/packed_layout.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace gridlock {

CellLayout packed_layout(Box const& box, Disks const& disks, double way) {
  RadiusRange const radii = radius_range(disks);
  CellLayout const finest = layout_for_reach(box, 2.0 * radii.largest + way, disks.size());
  double const widest = widest_for_four(radii.smallest);
  auto const cells = [&](double side, int most) {
    return static_cast<std::uint64_t>(std::min(std::floor(side / widest) + 1.0, static_cast<double>(most)));
  };
  return {box, cells(box.width(), finest.columns()), cells(box.height(), finest.rows())};
}

}  // namespace gridlock
