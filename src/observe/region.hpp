#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "gridlock/core/agents_view.hpp"
#include "gridlock/core/detail/rows_in_order.hpp"
#include "gridlock/core/disks.hpp"
#include "gridlock/grid/detail/packed_grid.hpp"
#include "gridlock/grid/detail/point_pairs.hpp"
#include "gridlock/observe/detail/other_agents.hpp"

namespace gridlock {

/// The pairs of agents nearer than a cutoff: of all agents, or on ranks of those in a part of the box. Each agent is among the own
/// ones of one rank, whose neighbours all are there. Contract: the agents have x and y; the cutoff is that of for_each_pair().
class Region {
 public:
  Region(Box const& box, AgentsView const& agents, OtherAgents const* others, double cutoff)
      : cutoff_(cutoff),
        layout_(layout_for_cutoff(box, cutoff, count_of_all(agents, others))),
        points_of_cells_(points_of_cells(agents, others)),
        points_{box, points_of_cells_ ? points_of_cells_->x : agents.column<X>(),
                points_of_cells_ ? points_of_cells_->y : agents.column<Y>()},
        own_(points_of_cells_ ? points_of_cells_->own : points_.x.size()),
        grid_(make_grid()) {}
  Region(Region const&) = delete;
  Region& operator=(Region const&) = delete;

  /// Agents 0 … own() − 1 are the own ones, those up to size() around them.
  [[nodiscard]] std::size_t own() const { return own_; }
  [[nodiscard]] std::size_t size() const { return points_.x.size(); }

  /// Calls visit(i, j, separation) once for every pair with an own agent, and for some pairs without, separation = r_j − r_i.
  template <class Visit>
  void for_each_pair(Visit visit) const {
    gridlock::for_each_pair(points_, grid_, cutoff_, std::move(visit));
  }

 private:
  [[nodiscard]] std::optional<PointsOfCells> points_of_cells(AgentsView const& agents,
                                                             OtherAgents const* others) const {
    if (others == nullptr) return std::nullopt;
    PointsOfCells points = others->points_of_cells(layout_, cutoff_, agents.column<X>(), agents.column<Y>());
    // Points that are near one another in memory, too, are found five times as fast.
    put_in_order_of_cells(points, 0, points.own);
    put_in_order_of_cells(points, points.own, points.x.size());
    return points;
  }
  void put_in_order_of_cells(PointsOfCells& points, std::size_t first, std::size_t end) const {
    std::vector<std::uint64_t> cells(end - first);
    for (std::size_t k = 0; k < cells.size(); ++k) {
      cells[k] = static_cast<std::uint64_t>(layout_.cell_of({points.x[first + k], points.y[first + k]}));
    }
    std::vector<std::uint32_t> const order = rows_in_order(cells);
    for (std::vector<double>* const coordinates : {&points.x, &points.y}) {
      std::vector<double> const before(coordinates->begin() + static_cast<std::ptrdiff_t>(first),
                                       coordinates->begin() + static_cast<std::ptrdiff_t>(end));
      for (std::size_t k = 0; k < order.size(); ++k) (*coordinates)[first + k] = before[order[k]];
    }
  }
  [[nodiscard]] PackedGrid make_grid() const {
    if (!points_of_cells_) return {layout_, points_.x, points_.y};
    PackedGrid grid(layout_, points_of_cells_->window, size());
    for (std::size_t i = 0; i < size(); ++i) grid.insert(i, points_[i]);
    return grid;
  }

  double cutoff_;
  CellLayout layout_;
  std::optional<PointsOfCells> points_of_cells_;  ///< on ranks
  PointsInBox points_;
  std::size_t own_;
  PackedGrid grid_;
};

}  // namespace gridlock
