#pragma once

/// \file
/// Means with standard errors, from blocks of samples or from a series of unknown length.
///
/// ```cpp
/// std::vector<Block> const blocks{{.sum = 1.1, .weight = 1.0}, {.sum = 0.9, .weight = 1.0}};
/// Estimate const mean = *estimate_from(blocks);  // 1.0 ± 0.1
/// ```

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "gridlock/core/archive.hpp"

namespace gridlock {

/// A measured value with its standard error.
struct Estimate {
  double value = 0.0;
  /// One standard error; absent if the data do not determine it (a single sample, a single disk), never 0 in its place.
  std::optional<double> error;
};

/// One block of samples: sum = Σ w v and weight = Σ w over samples of value v and weight w.
struct Block {
  double sum = 0.0;
  double weight = 0.0;

  void add(Block const& other) {
    sum += other.sum;
    weight += other.weight;
  }
};

/// Serializes blocks; it restores into the same number of blocks.
void serialize(Archive& archive, std::string_view name, std::span<Block> blocks);

/// Returns the weighted mean of all blocks, with its standard error from the scatter of the block means.
///
///     mean = Σ_b S_b / X,   error² = Σ_b (S_b − mean·X_b)² / (X² − Σ_b X_b²),   X = Σ_b X_b
///
/// S_b and X_b are sum and weight of block b. For n equal blocks the error is the textbook Σ (m_b − m)² / (n(n−1));
/// a shorter block counts by its weight. With durations as weights the mean is a rate: events over time.
/// Contract: weights ≥ 0; blocks of weight 0 are ignored. Returns nothing without weight; the error is absent for fewer
/// than two blocks. The error is right only if blocks are longer than the correlation time of the quantity.
/// Source: W. G. Cochran, Sampling Techniques (1977), chapter 6, the ratio estimate.
std::optional<Estimate> estimate_from(std::span<Block const> blocks);

/// The mean over several runs.
struct CombinedEstimate {
  Estimate mean;                           ///< with equal weights of the runs; its error is the larger of the next two
  std::optional<double> error_by_scatter;  ///< from the differences between the runs; absent for one run
  std::optional<double> error_by_runs;     ///< from the errors of the runs; absent if a run has no error
  std::optional<double> chi_squared;  ///< Σ (value − mean)²/error², to compare with runs − 1; absent if a run has no
                                      ///< error
};

/// Returns the mean over equally good runs, such as runs of different seeds.
///
///     error_by_scatter = √(Σ (v − mean)² / (n (n − 1))),   error_by_runs = √(Σ e²) / n
///
/// The scatter of few runs is a poor estimate: for two runs it is less than half of the true error in 38 % of all cases
/// (|z| < 1/2). The errors of the runs miss changes that are slower than their blocks, or from start to start. If both
/// are right, the larger one is too large by 17 % on average for two runs (E max(|z|, 1) = 1.17), and by less for more
/// runs. A χ² far above n − 1 says that the runs differ by more than their errors. Runs are not weighted by their
/// errors, since an error that is too small by chance would get the largest weight. A single run keeps its own error.
/// Contract: at least one run (asserted). Source of the errors of runs: Flyvbjerg & Petersen (1989),
/// doi:10.1063/1.457480.
///
/// ```cpp
/// std::vector<Estimate> const runs{{.value = 1.0, .error = 0.1}, {.value = 1.4, .error = 0.1}};
/// CombinedEstimate const both = combine(runs);  // 1.2 ± 0.2, for the runs differ by more than their errors: χ² = 8
/// ```
CombinedEstimate combine(std::span<Estimate const> runs);

/// Averages a series of unknown length, with a standard error from blocks.
///
/// Successive samples of a simulation are correlated, so that their scatter gives too small an error. Means over blocks
/// longer than the correlation time are independent. Whenever 32 blocks are full, pairs of blocks are merged:
///
///     samples    │▪▪│▪▪│▪▪│▪▪│ …           32 blocks of b samples
///     merged     │▪▪▪▪│▪▪▪▪│ …             16 blocks of 2b samples, room for 16 more
///
/// so that there are 17 to 32 blocks from the 17th sample on, and the error itself is known to about 15 %. The error is
/// too small for fewer than 17 samples, or for a correlation time longer than 1/32 of the series. Cost: O(1) a sample,
/// constant memory (about 0.5 KiB). Source: H. Flyvbjerg & H. G. Petersen, Error estimates on averages of correlated
/// data (1989), doi:10.1063/1.457480.
///
/// ```cpp
/// BlockAverage average;
/// for (double const pressure : {1.1, 0.9, 1.2, 1.0}) average.add(pressure);
/// double const mean = average.estimate()->value;
/// double const error = average.estimate()->error.value_or(0.0);
/// ```
class BlockAverage {
 public:
  static constexpr std::size_t max_blocks = 32;

  /// Adds one sample; the weight of a rate is its time interval. Contract: both are finite, weight > 0 (asserted).
  void add(double value, double weight = 1.0);

  [[nodiscard]] std::uint64_t samples() const { return samples_; }
  /// Returns the mean of all samples with its standard error; nothing without samples, and no error for one sample.
  [[nodiscard]] std::optional<Estimate> estimate() const { return estimate_from(blocks()); }
  /// Returns the blocks in the order of time; the last block may still be filling, and then has a lower weight.
  [[nodiscard]] std::span<Block const> blocks() const { return {blocks_.data(), used_}; }
  /// Returns the mean of every block.
  [[nodiscard]] std::vector<double> block_means() const;

  /// Serializes averages; it restores into the same number of averages.
  friend void serialize(Archive& archive, std::string_view name, std::span<BlockAverage> averages);

 private:
  void open_block();

  std::array<Block, max_blocks> blocks_{};
  std::size_t used_ = 0;
  std::uint64_t samples_per_block_ = 1;
  std::uint64_t samples_in_last_ = 0;
  std::uint64_t samples_ = 0;
};

void serialize(Archive& archive, std::string_view name, std::span<BlockAverage> averages);

}  // namespace gridlock
