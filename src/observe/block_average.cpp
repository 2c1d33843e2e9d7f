#include "gridlock/observe/block_average.hpp"

#include <cassert>
#include <cmath>

namespace gridlock {

void BlockAverage::add(double value, double weight) {
  assert(std::isfinite(value) && std::isfinite(weight) && weight > 0.0);
  if (used_ == 0 || samples_in_last_ == samples_per_block_) open_block();
  blocks_[used_ - 1].add({.sum = weight * value, .weight = weight});
  ++samples_in_last_;
  ++samples_;
}

void BlockAverage::open_block() {
  if (used_ == most_blocks) {
    for (std::size_t b = 0; b < most_blocks / 2; ++b) {
      blocks_[b] = blocks_[2 * b];
      blocks_[b].add(blocks_[2 * b + 1]);
    }
    used_ = most_blocks / 2;
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

}  // namespace gridlock
