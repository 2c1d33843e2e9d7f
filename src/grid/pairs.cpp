#include "gridlock/grid/pairs.hpp"

namespace gridlock {

bool are_inside(Box const& box, std::span<double const> x, std::span<double const> y) {
  auto const are_in_range = [](std::span<double const> coordinates, double side) {
    // All are looked at, many at once: as a rule none is outside.
    std::size_t outside = 0;
    for (double const p : coordinates) outside += static_cast<std::size_t>(!((p >= 0.0) & (p < side)));
    return outside == 0;
  };
  return are_in_range(x, box.width()) && are_in_range(y, box.height());
}

}  // namespace gridlock
