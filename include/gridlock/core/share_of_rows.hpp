#pragma once

/// \file
/// Which rows of a start a process makes.
///
/// ```cpp
/// ShareOfRows const share(100);  // all rows, in one process
/// auto const sum = share.add_in_order(std::uint64_t{0}, [&](std::uint64_t& so_far) {
///   for (std::uint64_t row = share.first(); row < share.end(); ++row) so_far += row;
/// });
/// ```

#include <cstdint>
#include <utility>

#include "gridlock/core/detail/ranks.hpp"
#include "gridlock/core/detail/row_division.hpp"

namespace gridlock {

/// Which rows of a start this process makes: all of them, or some where several ranks divide them.
class ShareOfRows {
 public:
  /// All of so many rows, in one process.
  explicit ShareOfRows(std::uint64_t rows) : division_(RowDivision::even(rows, 1)) {}
  /// Those of this rank, which outlives the share.
  ShareOfRows(Ranks& ranks, RowDivision division) : ranks_(&ranks), division_(std::move(division)) {}

  /// Rows first() … end() − 1 of all().
  [[nodiscard]] std::uint64_t first() const { return division_.first(rank()); }
  [[nodiscard]] std::uint64_t end() const { return division_.end(rank()); }
  [[nodiscard]] std::uint64_t size() const { return division_.rows_of(rank()); }
  [[nodiscard]] std::uint64_t all() const { return division_.rows(); }

  /// Sums over all rows, added up row after row, so that they have the same bits in any number of processes: add(sums) adds those of the
  /// share. All processes call it.
  template <class Sums, class Add>
  [[nodiscard]] Sums add_in_order(Sums sums, Add add) const {
    if (ranks_ != nullptr) return gridlock::add_in_order(*ranks_, std::move(sums), std::move(add));
    add(sums);
    return sums;
  }

  /// nullptr in one process.
  [[nodiscard]] Ranks* ranks() const { return ranks_; }
  [[nodiscard]] RowDivision const& division() const { return division_; }

 private:
  [[nodiscard]] std::size_t rank() const { return ranks_ != nullptr ? ranks_->rank() : 0; }

  Ranks* ranks_ = nullptr;
  RowDivision division_;
};

}  // namespace gridlock
