#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "gridlock/core/archive.hpp"
#include "gridlock/observe/estimate.hpp"

namespace gridlock {

/// The mean of a series of unknown length, and its standard error from blocks.
///
/// Neighbouring samples of a simulation remember one another, so their scatter says too little about the mean. Means
/// over blocks longer than that memory are independent. Whenever 32 blocks are full, pairs of them are merged:
///
///     samples    │▪▪│▪▪│▪▪│▪▪│ …           32 blocks of b samples
///     merged     │▪▪▪▪│▪▪▪▪│ …             16 blocks of 2b samples, room for 16 more
///
/// so that there are 17 to 32 blocks from the 17th sample on, and the error itself is known to about 15 %.
/// Errors: with fewer samples than blocks, or a memory longer than 1/32 of the series, the error comes out too small.
/// Cost: O(1) a sample, constant memory (about 0.5 KiB).
/// Source: H. Flyvbjerg & H. G. Petersen, Error estimates on averages of correlated data (1989),
/// doi:10.1063/1.457480.
///
/// ```cpp
/// BlockAverage average;
/// for (double const pressure : {1.1, 0.9, 1.2, 1.0}) average.add(pressure);
/// double const mean = average.estimate()->value;
/// double const error = average.estimate()->error.value_or(0.0);
/// ```
class BlockAverage {
 public:
  static constexpr std::size_t most_blocks = 32;

  /// Adds one sample. Contract: both finite, weight > 0 (asserted); the weight of a rate is the time it was taken over.
  void add(double value, double weight = 1.0);

  [[nodiscard]] std::uint64_t samples() const { return samples_; }
  /// The mean of all samples with its standard error; absent without samples, and without an error for one sample.
  [[nodiscard]] std::optional<Estimate> estimate() const { return estimate_from(blocks()); }
  /// The blocks in the order of time; the last may still be filling and has the lower weight then.
  [[nodiscard]] std::span<Block const> blocks() const { return {blocks_.data(), used_}; }
  /// The mean of every block.
  [[nodiscard]] std::vector<double> block_means() const;

  /// Serializes a number of averages; there must be as many where they are restored.
  friend void serialize(Archive& archive, std::string_view name, std::span<BlockAverage> averages);

 private:
  void open_block();

  std::array<Block, most_blocks> blocks_{};
  std::size_t used_ = 0;
  std::uint64_t samples_per_block_ = 1;
  std::uint64_t samples_in_last_ = 0;
  std::uint64_t samples_ = 0;
};

void serialize(Archive& archive, std::string_view name, std::span<BlockAverage> averages);

}  // namespace gridlock
