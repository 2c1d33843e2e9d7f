#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "gridlock/parallel/detail/all_processes.hpp"

namespace gridlock {

/// Which rows of all agents each rank has: those of rank 0 come first, then those of rank 1.
class RowDivision {
 public:
  RowDivision() = default;
  /// As many for each, as far as that is possible.
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
  /// The first row of each rank, and the end of all.
  [[nodiscard]] std::span<std::uint64_t const> begins() const { return begins_; }

 private:
  std::vector<std::uint64_t> begins_{0};
};

/// The division in which each rank has so many rows. All call it.
RowDivision division_of(AllProcesses processes, std::size_t own);

}  // namespace gridlock
