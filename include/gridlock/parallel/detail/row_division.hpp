#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "gridlock/parallel/detail/all_processes.hpp"

namespace gridlock {

/// The division of the rows of all agents among ranks: the first rows are on rank 0, the next on rank 1, and so on.
class RowDivision {
 public:
  RowDivision() = default;
  /// Returns a division in which numbers of rows differ by at most one.
  static RowDivision even(std::uint64_t rows, std::size_t ranks) {
    std::vector<std::uint64_t> begins;
    for (std::uint64_t rank = 0; rank <= ranks; ++rank) {
      begins.push_back(rows / ranks * rank + std::min(rows % ranks, rank));
    }
    return RowDivision(std::move(begins));
  }
  explicit RowDivision(std::vector<std::uint64_t> begins) : begins_(std::move(begins)) {}

  [[nodiscard]] std::size_t ranks() const { return begins_.size() - 1; }
  [[nodiscard]] std::uint64_t rows() const { return begins_.back(); }
  [[nodiscard]] std::uint64_t first(std::size_t rank) const { return begins_[rank]; }
  [[nodiscard]] std::uint64_t end(std::size_t rank) const { return begins_[rank + 1]; }
  [[nodiscard]] std::uint64_t rows_of(std::size_t rank) const { return end(rank) - first(rank); }
  [[nodiscard]] std::size_t rank_of(std::uint64_t row) const {
    return static_cast<std::size_t>(std::ranges::upper_bound(begins_, row) - begins_.begin()) - 1;
  }
  /// Returns the first row of each rank, and the number of all rows at the end.
  [[nodiscard]] std::span<std::uint64_t const> begins() const { return begins_; }

 private:
  std::vector<std::uint64_t> begins_{0};
};

/// Returns the division in which this rank has `own` rows. All ranks call it.
RowDivision division_of(AllProcesses processes, std::size_t own);

}  // namespace gridlock
