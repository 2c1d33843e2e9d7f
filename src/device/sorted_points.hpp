#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "device/backend.hpp"
#include "device/neighbour_kernels.hpp"
#include "device/scan.hpp"
#include "gridlock/grid/detail/stored_cells.hpp"

namespace gridlock::device {

/// Points in the memory of the device, sorted by their cells.
class SortedPoints {
 public:
  SortedPoints(Launcher& launcher, Box const& box, CellLayout const& layout, std::size_t count)
      : launcher_(launcher),
        count_(count),
        cells_(static_cast<std::size_t>(layout.count())),
        cell_of_(count),
        first_(cells_ + 1),
        filled_(cells_),
        index_(count),
        x_(count),
        y_(count),
        faults_(1),
        memory_{.box = box,
                .layout = layout,
                .x_given = nullptr,
                .y_given = nullptr,
                .cell_of = cell_of_.data(),
                .first = first_.data(),
                .filled = filled_.data(),
                .index = index_.data(),
                .x = x_.data(),
                .y = y_.data(),
                .faults = faults_.data()} {}
  SortedPoints(SortedPoints const&) = delete;
  SortedPoints& operator=(SortedPoints const&) = delete;

  /// Sorts points at these coordinates, which the device has. Where `may_crowd` is true it first looks whether they
  /// crowd, and returns false without sorting them if they do, or if a coordinate is not finite.
  bool sort(double const* x, double const* y, bool may_crowd) {
    memory_.x_given = x;
    memory_.y_given = y;
    first_.clear();
    filled_.clear();
    faults_.clear();
    launcher_.for_each(count_, FindCell{memory_});
    if (may_crowd) {
      launcher_.for_each(cells_, CountPairsInCell{memory_});
      PointFaults const found = faults();
      if (found.not_finite > 0 || is_crowd(found.pairs_in_cells, count_)) return false;
    }
    sum_up(launcher_, first_, cells_ + 1);
    launcher_.for_each(count_, PutIntoCell{memory_});
    launcher_.for_each(cells_, SortCell{memory_});
    return true;
  }
  [[nodiscard]] PointsMemory const& memory() const { return memory_; }
  /// Returns the faults of the points of the last sort(); pairs in cells are counted where they may crowd.
  [[nodiscard]] PointFaults faults() const {
    PointFaults faults{};
    faults_.download(std::span(&faults, 1));
    return faults;
  }

  /// Returns the bytes that so many points take.
  static std::size_t bytes(std::size_t points, CellLayout const& layout) {
    return points * (2 * sizeof(double) + 2 * sizeof(std::uint32_t)) +
           static_cast<std::size_t>(layout.count() + 1) * 2 * sizeof(std::uint32_t);
  }

 private:
  Launcher& launcher_;
  std::size_t count_;
  std::size_t cells_;
  Array<std::uint32_t> cell_of_;
  Array<std::uint32_t> first_;
  Array<std::uint32_t> filled_;
  Array<std::uint32_t> index_;
  Array<double> x_;
  Array<double> y_;
  Array<PointFaults> faults_;
  PointsMemory memory_;
};

}  // namespace gridlock::device
