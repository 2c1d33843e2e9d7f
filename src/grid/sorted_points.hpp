#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "grid/require.hpp"
#include "gridlock/core/detail/large_array.hpp"
#include "gridlock/core/detail/thread_pool.hpp"
#include "gridlock/grid/cell_layout.hpp"
#include "gridlock/grid/neighbour_lists.hpp"

namespace gridlock {

/// The points in the order of their cells, in a cell in their own order.
class SortedPoints {
 public:
  /// The cells begin to count at `origin`. Errors: Error for points that are not finite.
  SortedPoints(CellLayout const& layout, Vector origin, PointsInMemory const& points, ThreadPool& pool)
      : layout_(layout),
        first_(static_cast<std::size_t>(layout_.count()) + 1),
        index_(points.count),
        x_(points.count),
        y_(points.count) {
    sort(origin, points, pool);
  }

  [[nodiscard]] CellLayout const& layout() const { return layout_; }
  [[nodiscard]] std::size_t first_of(std::size_t cell) const { return first_[cell]; }
  [[nodiscard]] std::size_t size() const { return index_.size(); }
  [[nodiscard]] std::uint32_t index(std::size_t row) const { return index_[row]; }
  [[nodiscard]] double const* x() const { return x_.data(); }
  [[nodiscard]] double const* y() const { return y_.data(); }

 private:
  void sort(Vector origin, PointsInMemory const& points, ThreadPool& pool) {
    // Every thread counts and places a range of the points; the second knows where those before it end in each cell.
    std::size_t const parts = pool.size();
    std::size_t const cells = first_.size() - 1;
    auto const first_point = [&](std::size_t part) { return part * points.count / parts; };
    UninitializedArray<std::uint32_t> cell_of(points.count);
    std::vector<std::vector<std::uint32_t>> places(parts);
    std::atomic<bool> are_finite = true;
    pool.for_each(parts, [&](std::size_t part) {
      std::vector<std::uint32_t>& counts = places[part];
      counts.assign(cells, 0);
      for (std::size_t i = first_point(part); i < first_point(part + 1); ++i) {
        Vector const p = Vector{points.x[i * points.stride], points.y[i * points.stride]} - origin;
        if (!(p.x - p.x == 0.0) | !(p.y - p.y == 0.0)) {
          are_finite = false;
          return;
        }
        auto const cell = static_cast<std::uint32_t>(layout_.cell_of(p));
        cell_of[i] = cell;
        ++counts[cell];
      }
    });
    if (!are_finite) require_points_in_memory(points);
    std::uint32_t next = 0;
    for (std::size_t cell = 0; cell < cells; ++cell) {
      first_[cell] = next;
      for (std::size_t part = 0; part < parts; ++part) next += std::exchange(places[part][cell], next);
    }
    first_[cells] = next;
    pool.for_each(parts, [&](std::size_t part) {
      std::vector<std::uint32_t>& place = places[part];
      for (std::size_t i = first_point(part); i < first_point(part + 1); ++i) {
        std::size_t const row = place[cell_of[i]]++;
        Vector const p = layout_.image_in_cell({points.x[i * points.stride], points.y[i * points.stride]});
        index_[row] = static_cast<std::uint32_t>(i);
        x_[row] = p.x;
        y_[row] = p.y;
      }
    });
  }

  CellLayout layout_;
  std::vector<std::uint32_t> first_;
  UninitializedArray<std::uint32_t> index_;
  UninitializedArray<double> x_;
  UninitializedArray<double> y_;
};

/// Bands of whole rows of cells with about as many points each. How many there are changes nothing but who does what.
inline std::vector<int> bands_of(SortedPoints const& points, ThreadPool const& pool) {
  std::size_t const count = pool.size() == 1 ? 1 : 8 * pool.size();
  CellLayout const& layout = points.layout();
  auto const columns = static_cast<std::size_t>(layout.columns());
  std::size_t const all = points.first_of(columns * static_cast<std::size_t>(layout.rows()));
  std::vector<int> ends{0};
  for (int row = 1; row <= layout.rows(); ++row) {
    bool const is_full = points.first_of(static_cast<std::size_t>(row) * columns) * count >= all * ends.size();
    if (is_full || row == layout.rows()) ends.push_back(row);
  }
  return ends;
}

}  // namespace gridlock
