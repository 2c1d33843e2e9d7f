#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "gridlock/lattice/start.hpp"
#include "gridlock/parallel/share_of_rows.hpp"

namespace gridlock {

bool are_equal(DisksSettings const& settings);

/// Sizes and masses of the disks of some rows, in units of disks.radius and of mass 1, and sums over all. Equal disks
/// take no memory, others 16 bytes for each row of the share.
class Kinds {
 public:
  /// Deals the kinds out over the rows, so that any deal is as likely as any other: the same one however the rows are
  /// shared. All processes call it. Cost: the random numbers of all rows in each process, twice on a rank, which finds
  /// the disks of its rows by undoing the deal. Memory besides, until it returns: on a rank a bit for each disk of all,
  /// and 24 to 32 bytes for each row; for a distribution of sizes 8 bytes for each row.
  /// Errors: Error for settings that contradict each other.
  Kinds(DisksSettings const& settings, ShareOfRows const& share, std::uint64_t seed);

  /// Of all.
  [[nodiscard]] std::uint64_t count() const { return count_; }
  [[nodiscard]] double largest_ratio() const { return largest_ratio_; }
  [[nodiscard]] double sum_of_squared_ratios() const { return sum_of_squared_ratios_; }

  // Of a row of the share.
  [[nodiscard]] double size_ratio(std::uint64_t row) const {
    return size_ratios_.empty() ? 1.0 : size_ratios_[row - first_];
  }
  [[nodiscard]] double mass(std::uint64_t row) const { return masses_.empty() ? 1.0 : masses_[row - first_]; }

 private:
  void deal(DisksSettings const& settings, ShareOfRows const& share, std::uint64_t seed);

  std::uint64_t count_;
  std::uint64_t first_;
  double largest_ratio_ = 1.0;
  double sum_of_squared_ratios_ = 0.0;
  std::vector<double> size_ratios_;
  std::vector<double> masses_;
};

/// Where the disks of rows first … end − 1 were before `count` of them were dealt out by Fisher and Yates from the last
/// one on: the row whose disk they have got.
std::vector<std::uint64_t> rows_before_deal(std::uint64_t count, std::uint64_t seed, std::uint64_t first,
                                            std::uint64_t end);

}  // namespace gridlock
