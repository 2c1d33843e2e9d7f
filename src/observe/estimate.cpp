#include "gridlock/observe/estimate.hpp"

#include <cmath>
#include <vector>

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

void serialize(Archive& archive, std::string_view name, std::span<Block> blocks) {
  std::vector<double> numbers;
  for (Block const& block : blocks) {
    numbers.push_back(block.sum);
    numbers.push_back(block.weight);
  }
  archive.visit(name, numbers);
  archive.require(numbers.size() == 2 * blocks.size(), "the blocks differ in number");
  for (std::size_t b = 0; b < blocks.size(); ++b) blocks[b] = {.sum = numbers[2 * b], .weight = numbers[2 * b + 1]};
}

}  // namespace gridlock
