#include "gridlock/observe/estimate.hpp"

#include <algorithm>
#include <cassert>
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
  // With blocks so unequal that one outweighs all others there is effectively one block, and no error.
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

void BlockAverage::add(double value, double weight) {
  assert(std::isfinite(value) && std::isfinite(weight) && weight > 0.0);
  if (used_ == 0 || samples_in_last_ == samples_per_block_) open_block();
  blocks_[used_ - 1].add({.sum = weight * value, .weight = weight});
  ++samples_in_last_;
  ++samples_;
}

void BlockAverage::open_block() {
  if (used_ == max_blocks) {
    for (std::size_t b = 0; b < max_blocks / 2; ++b) {
      blocks_[b] = blocks_[2 * b];
      blocks_[b].add(blocks_[2 * b + 1]);
    }
    used_ = max_blocks / 2;
    samples_per_block_ *= 2;
  }
  blocks_[used_++] = {};
  samples_in_last_ = 0;
}

std::vector<double> BlockAverage::block_means() const {
  std::vector<double> means;
  for (Block const& block : blocks()) means.push_back(block.sum / block.weight);
  return means;
}

void serialize(Archive& archive, std::string_view name, std::span<BlockAverage> averages) {
  std::vector<Block> blocks;
  std::vector<std::uint64_t> counts;
  for (BlockAverage const& average : averages) {
    blocks.insert(blocks.end(), average.blocks_.begin(), average.blocks_.end());
    counts.insert(counts.end(),
                  {average.used_, average.samples_per_block_, average.samples_in_last_, average.samples_});
  }
  serialize_inside(archive, name, [&] {
    serialize(archive, "blocks", blocks);
    archive.visit("counts", counts);
  });
  archive.require(counts.size() == 4 * averages.size(), "the averages differ in number");
  for (std::size_t k = 0; k < averages.size(); ++k) {
    BlockAverage& average = averages[k];
    archive.require(counts[4 * k] <= BlockAverage::max_blocks && counts[4 * k + 1] > 0,
                    "an average has no such blocks");
    std::ranges::copy(std::span(blocks).subspan(k * average.blocks_.size(), average.blocks_.size()),
                      average.blocks_.begin());
    average.used_ = counts[4 * k];
    average.samples_per_block_ = counts[4 * k + 1];
    average.samples_in_last_ = counts[4 * k + 2];
    average.samples_ = counts[4 * k + 3];
  }
}

}  // namespace gridlock
