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

#include "gridlock/parallel/detail/all_processes.hpp"
#include "gridlock/parallel/detail/row_division.hpp"

namespace gridlock {

/// Which rows of a start this process makes: all of them, or some where several ranks divide them.
class ShareOfRows {
 public:
  /// All of so many rows, in one process.
  explicit ShareOfRows(std::uint64_t rows) : division_(RowDivision::even(rows, 1)) {}
  /// Those of this rank, which outlives the share.
  ShareOfRows(Communicator& ranks, RowDivision division) : processes_(ranks), division_(std::move(division)) {}

  /// Rows first() … end() − 1 of all().
  [[nodiscard]] std::uint64_t first() const { return division_.first(rank()); }
  [[nodiscard]] std::uint64_t end() const { return division_.end(rank()); }
  [[nodiscard]] std::uint64_t size() const { return division_.rows_of(rank()); }
  [[nodiscard]] std::uint64_t all() const { return division_.rows(); }

  /// Sums over all rows, added up row after row, so that they have the same bits in any number of processes: add(sums)
  /// adds those of the share. All processes call it.
  template <class Sums, class Add>
  [[nodiscard]] Sums add_in_order(Sums sums, Add add) const {
    return processes_.change_in_order(std::move(sums), std::move(add));
  }

  [[nodiscard]] Communicator& processes() const { return processes_.communicator(); }
  [[nodiscard]] RowDivision const& division() const { return division_; }

 private:
  [[nodiscard]] std::size_t rank() const { return processes_.rank(); }

  AllProcesses processes_;
  RowDivision division_;
};

}  // namespace gridlock
