#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "gridlock/core/detail/rows_in_order.hpp"
#include "gridlock/grid/detail/cell_window.hpp"
#include "gridlock/observe/pairs.hpp"
#include "gridlock/parallel/detail/collectives.hpp"
#include "parallel/exchange.hpp"

namespace gridlock {

namespace {

/// The rows of a layout, or its columns: whichever there are more of.
class Lines {
 public:
  Lines(CellLayout const& layout, double cutoff)
      : layout_(layout),
        are_rows_(layout.rows() >= layout.columns()),
        rim_(are_rows_ ? layout.rows_within(cutoff) : layout.columns_within(cutoff)) {}

  [[nodiscard]] int count() const { return are_rows_ ? layout_.rows() : layout_.columns(); }
  [[nodiscard]] int line_of(double x, double y) const { return are_rows_ ? layout_.row_of(y) : layout_.column_of(x); }
  [[nodiscard]] int rim() const { return rim_; }

  /// Lines begin … end − 1 with the rim around them.
  [[nodiscard]] CellWindow window(int begin, int end) const {
    CellWindow window{.first_column = 0, .end_column = layout_.columns(), .first_row = 0, .end_row = layout_.rows()};
    if (are_rows_) {
      window.first_row = begin - rim_;
      window.end_row = end + rim_;
    } else {
      window.first_column = begin - rim_;
      window.end_column = end + rim_;
    }
    return within(layout_, window);
  }
  /// The line beyond an edge, around a periodic box; −1 for none.
  [[nodiscard]] int image(int line) const {
    if (line >= 0 && line < count()) return line;
    return layout_.is_periodic() ? (line + 2 * count()) % count() : -1;
  }

 private:
  CellLayout const& layout_;
  bool are_rows_;
  int rim_;
};

/// The first line of each process, and the end: each process gets about as many points.
std::vector<int> cuts_between(std::span<std::uint64_t const> points_of_lines, std::size_t processes) {
  std::uint64_t all = 0;
  for (std::uint64_t const points : points_of_lines) all += points;
  std::vector<int> cuts{0};
  std::uint64_t before = 0;
  for (std::size_t line = 0; line < points_of_lines.size(); ++line) {
    // Process k begins at the line in whose first half the k-th part of the points ends, or at the one after it.
    while (cuts.size() < processes && (2 * before + points_of_lines[line]) * processes >= 2 * all * cuts.size()) {
      cuts.push_back(static_cast<int>(line));
    }
    before += points_of_lines[line];
  }
  cuts.resize(processes + 1, static_cast<int>(points_of_lines.size()));
  return cuts;
}

/// The slab of lines that each process searches, and the processes that need the points of a line for it.
class Slabs {
 public:
  Slabs(Lines const& lines, std::vector<int> cuts)
      : cuts_(std::move(cuts)), processes_around_(static_cast<std::size_t>(lines.count())) {
    for (std::size_t process = 0; process + 1 < cuts_.size(); ++process) {
      if (cuts_[process] == cuts_[process + 1]) continue;
      for (int k = 1; k <= lines.rim(); ++k) {
        add_around(lines.image(cuts_[process] - k), process);
        add_around(lines.image(cuts_[process + 1] - 1 + k), process);
      }
    }
  }

  [[nodiscard]] std::size_t owner(int line) const {
    return static_cast<std::size_t>(std::ranges::upper_bound(cuts_, line) - cuts_.begin() - 1);
  }
  /// The processes in whose rim a line lies.
  [[nodiscard]] std::span<std::size_t const> processes_around(int line) const {
    return processes_around_[static_cast<std::size_t>(line)];
  }

 private:
  void add_around(int line, std::size_t process) {
    if (line < 0 || owner(line) == process) return;
    // A rim that meets itself on the other side of the box has a line once.
    std::vector<std::size_t>& processes = processes_around_[static_cast<std::size_t>(line)];
    if (processes.empty() || processes.back() != process) processes.push_back(process);
  }

  std::vector<int> cuts_;
  std::vector<std::vector<std::size_t>> processes_around_;
};

/// A point on its way.
struct SentPoint {
  double x;
  double y;
  std::uint64_t is_of_rim;
};

/// Points of some cells of the box, and after them those of the cells around.
struct PointsOfCells {
  std::vector<double> x;
  std::vector<double> y;
  std::size_t own = 0;  ///< how many lie in the cells themselves
  CellWindow window;    ///< of all their cells
};

/// All points of the slab of this process, and those of the cells around as far as the cutoff reaches; every point is
/// an own one of one process. (x[i], y[i]) are points of this process anywhere.
PointsOfCells points_of_slab(Communicator& processes, CellLayout const& layout, double cutoff,
                             std::span<double const> x, std::span<double const> y) {
  Lines const lines(layout, cutoff);
  std::vector<int> line_of_point;
  std::vector<std::uint64_t> points_of_lines(static_cast<std::size_t>(lines.count()));
  line_of_point.reserve(x.size());
  for (std::size_t i = 0; i < x.size(); ++i) {
    line_of_point.push_back(lines.line_of(x[i], y[i]));
    ++points_of_lines[static_cast<std::size_t>(line_of_point.back())];
  }
  all_sum(processes, points_of_lines);
  std::vector<int> const cuts = cuts_between(points_of_lines, processes.count());

  Slabs const slabs(lines, cuts);
  PointsOfCells points{
      .x = {}, .y = {}, .own = 0, .window = lines.window(cuts[processes.rank()], cuts[processes.rank() + 1])};
  std::vector<SentPoint> rim;
  exchange_values<SentPoint>(
      processes, x.size(),
      [&](std::size_t i, auto give) {
        give(slabs.owner(line_of_point[i]), SentPoint{x[i], y[i], 0});
        for (std::size_t const process : slabs.processes_around(line_of_point[i]))
          give(process, SentPoint{x[i], y[i], 1});
      },
      [&](SentPoint const& point) {
        if (point.is_of_rim != 0) {
          rim.push_back(point);
        } else {
          points.x.push_back(point.x);
          points.y.push_back(point.y);
        }
      });
  points.own = points.x.size();
  for (SentPoint const& point : rim) {
    points.x.push_back(point.x);
    points.y.push_back(point.y);
  }
  return points;
}

/// Puts points first … end − 1 in the order of their cells: points that are near one another in memory, too, are found
/// five times as fast.
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
  CellLayout const layout = layout_for_cutoff(box, cutoff, count);
  if (processes.count() == 1) {
    grid_.emplace(layout, x, y);
    return;
  }
  PointsOfCells points = points_of_slab(processes, layout, cutoff, x, y);
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
