#include "gridlock/observe/estimate.hpp"

#include <cmath>

namespace gridlock {

std::optional<Estimate> estimate_from(std::span<Block const> blocks) {
  Block total;
  double squared_weights = 0.0;
  std::size_t filled = 0;
  for (Block const& block : blocks) {
    if (!(block.weight > 0.0)) continue;
    total.add(block);
    squared_weights += block.weight * block.weight;
    ++filled;
  }
  if (filled == 0) return std::nullopt;
  Estimate estimate{.value = total.sum / total.weight, .error = std::nullopt};
  if (filled < 2) return estimate;
  double scatter = 0.0;
  for (Block const& block : blocks) {
    double const deviation = block.sum - estimate.value * block.weight;
    scatter += deviation * deviation;
  }
  double const room = total.weight * total.weight - squared_weights;
  // Blocks so unequal that all others vanish beside one are as good as one block.
  if (room > 0.0) estimate.error = std::sqrt(scatter / room);
  return estimate;
}

}  // namespace gridlock
