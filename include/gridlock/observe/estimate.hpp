#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string_view>

#include "gridlock/core/archive.hpp"

namespace gridlock {

/// A measured number and how well it is known.
struct Estimate {
  double value = 0.0;
  /// One standard error; absent where the data cannot tell (a single sample, a single disk). Never a stand-in zero.
  std::optional<double> error;
};

/// What one block of samples amounts to: Σ w v and Σ w over its samples of value v and weight w.
struct Block {
  double sum = 0.0;
  double weight = 0.0;

  void add(Block const& other) {
    sum += other.sum;
    weight += other.weight;
  }
};

/// Serializes blocks; there must be as many where they are restored.
void serialize(Archive& archive, std::string_view name, std::span<Block> blocks);

/// The weighted mean of all blocks, with its standard error from the scatter of the block means.
///
///     mean = Σ_b S_b / X,   error² = Σ_b (S_b − mean·X_b)² / (X² − Σ_b X_b²),   X = Σ_b X_b
///
/// S_b and X_b are sum and weight of block b. For n equal blocks the error is the textbook Σ (m_b − m)² / (n(n−1));
/// a shorter block counts by its weight. With durations as weights the mean is a rate: events over time.
/// Contract: weights ≥ 0; blocks of weight 0 are ignored. Absent where there is no weight at all; the error is absent
/// for fewer than two blocks. The error is right only if blocks are longer than what they measure remembers.
/// Source: W. G. Cochran, Sampling Techniques (1977), chapter 6, the ratio estimate.
///
/// ```cpp
/// std::vector<Block> const blocks{{.sum = 1.1, .weight = 1.0}, {.sum = 0.9, .weight = 1.0}};
/// Estimate const mean = *estimate_from(blocks);  // 1.0 ± 0.1
/// ```
std::optional<Estimate> estimate_from(std::span<Block const> blocks);

}  // namespace gridlock
