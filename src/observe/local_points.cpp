#include <algorithm>
#include <complex>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "gridlock/core/detail/rows_in_order.hpp"
#include "gridlock/grid/detail/cell_window.hpp"
#include "gridlock/observe/pairs.hpp"
#include "gridlock/parallel/detail/domain.hpp"
#include "parallel/exchange.hpp"

namespace gridlock {

namespace {

/// Two numbers of a point in a message: its place, or its value.
struct SentPoint {
  double first;
  double second;
  std::uint64_t is_of_rim;
};

/// Points in some cells of the box, followed by the points in the cells around.
struct PointsOfCells {
  std::vector<double> x;
  std::vector<double> y;
  std::vector<std::complex<double>> values;
  std::size_t own = 0;  ///< number of points in the cells themselves
  CellWindow window;    ///< the cells and those around
};

/// Calls take(first, second) for two numbers of each point of a rectangle, then for those of each point around it.
/// Process by process the points come in the order of x and y, so that a second call gives other numbers of the same
/// points in the same order. Returns the number of points of the rectangle.
template <class NumbersOf, class Take>
std::size_t exchange_points(Communicator& processes, Domain const& domain, PointsInBox const& points,
                            NumbersOf numbers_of, Take take) {
  std::vector<SentPoint> of_rim;
  std::size_t own = 0;
  exchange_values<SentPoint>(
      processes, points.x.size(),
      [&](std::size_t i, auto give) {
        Vector const p = points[i];
        std::pair<double, double> const numbers = numbers_of(i);
        std::size_t const owner = domain.owner_of(p);
        give(owner, SentPoint{numbers.first, numbers.second, 0});
        domain.for_each_that_sees(p, [&](std::size_t process) {
          if (process != owner) give(process, SentPoint{numbers.first, numbers.second, 1});
        });
      },
      [&](SentPoint const& point) {
        if (point.is_of_rim != 0) {
          of_rim.push_back(point);
        } else {
          take(point.first, point.second);
          ++own;
        }
      });
  for (SentPoint const& point : of_rim) take(point.first, point.second);
  return own;
}

/// Returns all points in the rectangle of this process and around it within the cutoff; each point is in the rectangle
/// of one process. `given` are the points that this process has, anywhere in the box.
PointsOfCells points_of_rectangle(Communicator& processes, CellLayout const& layout, double cutoff,
                                  PointsInBox const& given, std::vector<std::complex<double>> const* values) {
  Domain const domain = Domain::of_cells(processes, layout, cutoff, given.x, given.y);
  // By rounding, a point at the end of a rim may lie in the next cell, so the rim is one cell wider.
  int const rim = std::max(layout.columns_within(cutoff), layout.rows_within(cutoff)) + 1;
  PointsOfCells points{.x = {}, .y = {}, .values = {}, .own = 0, .window = domain.own_window(rim)};
  points.own = exchange_points(
      processes, domain, given, [&](std::size_t i) { return std::pair(given.x[i], given.y[i]); },
      [&](double x, double y) {
        points.x.push_back(x);
        points.y.push_back(y);
      });
  if (values != nullptr) {
    exchange_points(
        processes, domain, given, [&](std::size_t i) { return std::pair((*values)[i].real(), (*values)[i].imag()); },
        [&](double real, double imaginary) { points.values.emplace_back(real, imaginary); });
  }
  return points;
}

/// Sorts points first … end − 1 by cell: a search is five times as fast if near points are near in memory.
void put_in_order_of_cells(CellLayout const& layout, PointsOfCells& points, std::size_t first, std::size_t end) {
  std::vector<std::uint64_t> cells(end - first);
  for (std::size_t k = 0; k < cells.size(); ++k) {
    cells[k] = static_cast<std::uint64_t>(layout.cell_of({points.x[first + k], points.y[first + k]}));
  }
  std::vector<std::uint32_t> const order = rows_in_order(cells);
  auto const reorder = [&](auto& numbers) {
    auto const begin = numbers.begin() + static_cast<std::ptrdiff_t>(first);
    std::vector const before(begin, begin + static_cast<std::ptrdiff_t>(order.size()));
    for (std::size_t k = 0; k < order.size(); ++k) numbers[first + k] = before[order[k]];
  };
  reorder(points.x);
  reorder(points.y);
  if (!points.values.empty()) reorder(points.values);
}

}  // namespace

LocalPoints::LocalPoints(Box const& box, std::span<double const> x, std::span<double const> y, double cutoff,
                         Communicator& processes, std::size_t count, std::vector<std::complex<double>> const* values)
    : cutoff_(cutoff), points_{box, x, y}, own_(x.size()) {
  if (values != nullptr) values_ = *values;
  if (box.is_oblique()) {
    oblique_.emplace(box, cutoff, x, y);
    return;
  }
  CellLayout const layout = layout_for_cutoff(box, cutoff, count);
  if (processes.count() == 1) {
    grid_.emplace(layout, x, y);
    return;
  }
  PointsOfCells points = points_of_rectangle(processes, layout, cutoff, points_, values);
  own_ = points.own;
  put_in_order_of_cells(layout, points, 0, own_);
  put_in_order_of_cells(layout, points, own_, points.x.size());
  x_ = std::move(points.x);
  y_ = std::move(points.y);
  values_ = std::move(points.values);
  points_.x = x_;
  points_.y = y_;
  grid_.emplace(layout, points.window, size());
  for (std::size_t i = 0; i < size(); ++i) grid_->insert(i, points_[i]);
}

}  // namespace gridlock
