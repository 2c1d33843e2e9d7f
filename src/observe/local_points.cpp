#include <algorithm>
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

/// A point in a message.
struct SentPoint {
  double x;
  double y;
  std::uint64_t is_of_rim;
};

/// Points in some cells of the box, followed by the points in the cells around.
struct PointsOfCells {
  std::vector<double> x;
  std::vector<double> y;
  std::size_t own = 0;  ///< number of points in the cells themselves
  CellWindow window;    ///< the cells and those around
};

/// Returns all points in the rectangle of this process and around it within the cutoff; each point is in the rectangle
/// of one process. (x[i], y[i]) are the points that this process has, anywhere in the box.
PointsOfCells points_of_rectangle(Communicator& processes, CellLayout const& layout, double cutoff,
                                  std::span<double const> x, std::span<double const> y) {
  Domain const domain = Domain::of_cells(processes, layout, cutoff, x, y);
  // By rounding, a point at the end of a rim may lie in the next cell, so the rim is one cell wider.
  int const rim = std::max(layout.columns_within(cutoff), layout.rows_within(cutoff)) + 1;
  PointsOfCells points{.x = {}, .y = {}, .own = 0, .window = domain.own_window(rim)};
  std::vector<SentPoint> of_rim;
  exchange_values<SentPoint>(
      processes, x.size(),
      [&](std::size_t i, auto give) {
        Vector const p{x[i], y[i]};
        std::size_t const owner = domain.owner_of(p);
        give(owner, SentPoint{p.x, p.y, 0});
        domain.for_each_that_sees(p, [&](std::size_t process) {
          if (process != owner) give(process, SentPoint{p.x, p.y, 1});
        });
      },
      [&](SentPoint const& point) {
        if (point.is_of_rim != 0) {
          of_rim.push_back(point);
        } else {
          points.x.push_back(point.x);
          points.y.push_back(point.y);
        }
      });
  points.own = points.x.size();
  for (SentPoint const& point : of_rim) {
    points.x.push_back(point.x);
    points.y.push_back(point.y);
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
  for (std::vector<double>* const coordinates : {&points.x, &points.y}) {
    std::vector<double> const before(coordinates->begin() + static_cast<std::ptrdiff_t>(first),
                                     coordinates->begin() + static_cast<std::ptrdiff_t>(end));
    for (std::size_t k = 0; k < order.size(); ++k) (*coordinates)[first + k] = before[order[k]];
  }
}

}  // namespace

LocalPoints::LocalPoints(Box const& box, std::span<double const> x, std::span<double const> y, double cutoff,
                         Communicator& processes, std::size_t count)
    : cutoff_(cutoff), points_{box, x, y}, own_(x.size()) {
  if (box.is_oblique()) {
    oblique_.emplace(box, cutoff, x, y);
    return;
  }
  CellLayout const layout = layout_for_cutoff(box, cutoff, count);
  if (processes.count() == 1) {
    grid_.emplace(layout, x, y);
    return;
  }
  PointsOfCells points = points_of_rectangle(processes, layout, cutoff, x, y);
  own_ = points.own;
  put_in_order_of_cells(layout, points, 0, own_);
  put_in_order_of_cells(layout, points, own_, points.x.size());
  x_ = std::move(points.x);
  y_ = std::move(points.y);
  points_.x = x_;
  points_.y = y_;
  grid_.emplace(layout, points.window, size());
  for (std::size_t i = 0; i < size(); ++i) grid_->insert(i, points_[i]);
}

}  // namespace gridlock
