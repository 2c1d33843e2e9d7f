#pragma once

/// \file
/// The pairs of agents of a snapshot that are nearer than a cutoff.
///
/// ```cpp
/// State state{.box = Box(4.0, 3.0, Edge::periodic)};
/// for (double const x : {0.5, 1.4, 3.0}) state.agents.add(x, 0.5, 0.0, 0.0, 0.5, 1.0, 0, 0);
/// Counters const counters;
/// Snapshot const now(state, counters);
/// std::array<std::uint64_t, 1> twice_pairs{};
/// now.pairs(1.0, [&](NearPair const& pair) { twice_pairs[0] += pair.own; });
/// now.counts(twice_pairs);
/// double const neighbours = static_cast<double>(twice_pairs[0]) / static_cast<double>(now.count());  // 2/3
/// ```

#include <complex>
#include <cstddef>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "gridlock/core/disks.hpp"
#include "gridlock/grid/cell_layout.hpp"
#include "gridlock/grid/detail/packed_grid.hpp"
#include "gridlock/grid/detail/point_pairs.hpp"
#include "gridlock/grid/neighbour_search.hpp"
#include "gridlock/observe/snapshot.hpp"

namespace gridlock {

/// The points that a process owns, in its part of the box, and copies of all points within a cutoff around this part.
/// Each agent is owned by one process, which has all of its neighbours too. In a run of one process it owns all agents,
/// in the order of their rows. Contract: that of Snapshot::pairs(). All processes construct it together.
class LocalPoints {
 public:
  /// `count` is the number of points of all processes, (x[i], y[i]) are the points of this process, with the value
  /// (*values)[i] each, if values are given: by all processes or by none.
  LocalPoints(Box const& box, std::span<double const> x, std::span<double const> y, double cutoff,
              Communicator& processes, std::size_t count, std::vector<std::complex<double>> const* values = nullptr);
  LocalPoints(Snapshot const& now, double cutoff)
      : LocalPoints(now.box, now.agents.column<X>(), now.agents.column<Y>(), cutoff, now.processes.communicator(),
                    now.count()) {}
  LocalPoints(LocalPoints const&) = delete;
  LocalPoints& operator=(LocalPoints const&) = delete;

  /// Returns the number of owned points: 0 … own() − 1. Points own() … size() − 1 lie around them.
  [[nodiscard]] std::size_t own() const { return own_; }
  [[nodiscard]] std::size_t size() const { return points_.x.size(); }
  [[nodiscard]] std::span<double const> own_x() const { return points_.x.first(own_); }
  [[nodiscard]] std::span<double const> own_y() const { return points_.y.first(own_); }
  /// Returns the values of all points 0 … size() − 1; none if none were given.
  [[nodiscard]] std::vector<std::complex<double>> const& values() const { return values_; }

  /// Calls visit(i, j, separation) once for every pair with an owned point, and for some other pairs; separation = r_j
  /// − r_i.
  template <class Visit>
  void for_each_pair(Visit visit) const {
    if (oblique_) [[unlikely]] {
      oblique_->for_each_pair(std::move(visit));
    } else {
      gridlock::for_each_pair(points_, *grid_, cutoff_, std::move(visit));
    }
  }

 private:
  std::vector<double> x_, y_;  ///< empty if the points of the caller are used directly
  std::vector<std::complex<double>> values_;
  double cutoff_;
  PointsInBox points_;
  std::size_t own_;
  std::optional<PackedGrid> grid_;
  std::optional<NeighbourSearch> oblique_;  ///< used in an oblique box, of one process
};

template <class Visit>
void Snapshot::pairs(double cutoff, Visit visit) const {
  LocalPoints const points(*this, cutoff);
  std::size_t const own = points.own();
  points.for_each_pair([&](std::size_t i, std::size_t j, Vector separation) {
    std::uint32_t const of_pair = (i < own ? 1U : 0U) + (j < own ? 1U : 0U);
    if (of_pair > 0) visit(NearPair{i, j, separation, of_pair});
  });
}

}  // namespace gridlock
