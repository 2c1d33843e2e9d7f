#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <utility>

#include "gridlock/core/box.hpp"
#include "gridlock/core/error.hpp"
#include "gridlock/grid/detail/packed_grid.hpp"
#include "gridlock/grid/detail/point_pairs.hpp"
#include "gridlock/grid/detail/sorted_grid.hpp"

namespace gridlock {

/// Who is nearer than a cutoff to whom, among any points of a box.
///
/// ```cpp
/// std::vector<double> const x{0.1, 0.9, 0.5};
/// std::vector<double> const y{0.5, 0.5, 0.5};
/// NeighbourSearch const search(Box(1.0, 1.0, Edge::periodic), 0.3, x, y);
/// search.for_each_pair([](std::size_t i, std::size_t j, Vector separation) { /* r_j − r_i */ });
/// search.for_each_neighbour(0, [](std::size_t j, Vector separation) { /* r_j − r_0 */ });
/// ```
///
/// A separation is measured in double precision, the minimum image in a periodic box; |separation| < cutoff.
/// Coordinates may be any finite numbers: outside a periodic box they stand for the image inside, outside walls for
/// themselves, which is right but slow where there are many. The order of the visits is a function of the points alone,
/// and of those before where they were updated.
///
/// The search keeps views of x and y, not copies. They must stay as they are, and where they are, until update() or the
/// end of the search. Several threads may search at once.
/// Errors: Error for lists of different lengths, coordinates that are not finite, more than 250 million points, a
/// cutoff outside 10⁻⁶⁰ … 10⁶⁰ or above half the shorter side of a periodic box, and a box with sides outside that
/// range.
/// Cost for a million points in no order with six neighbours each: 35 ns a point to build, 15 ns to update, 45 ns for
/// all pairs (AMD Zen 4); 60 bytes a point. Where points crowd in a part of the box, up to 2.8 times as much for
/// building and an update, up to 1.5 times as much for all pairs, and as much for an update as for building where more
/// than one point in eight comes to another cell. Whether points crowd no longer is asked after as many have come to
/// other cells as there are points.
class NeighbourSearch {
 public:
  /// Point i is at (x[i], y[i]).
  NeighbourSearch(Box const& box, double cutoff, std::span<double const> x, std::span<double const> y);

  [[nodiscard]] Box const& box() const { return box_; }
  [[nodiscard]] double cutoff() const { return cutoff_; }
  [[nodiscard]] std::size_t size() const { return x_.size(); }

  /// Point i is at (x[i], y[i]) now: cheaper than a new search where most points have moved less than the cutoff.
  /// Errors: Error for another number of points, and for coordinates that are not finite; nothing has changed then.
  void update(std::span<double const> x, std::span<double const> y);

  /// Calls visit(i, j, separation) once for every pair, where i > j and separation = r_j − r_i.
  template <class Visit>
  void for_each_pair(Visit visit) const {
    if (crowd_) [[unlikely]] {
      gridlock::for_each_pair(points(), *crowd_, cutoff_, std::move(visit));
    } else {
      gridlock::for_each_pair(points(), grid_, cutoff_, std::move(visit));
    }
  }

  /// Calls visit(j, separation) once for every neighbour j of point i, which is none of them; separation = r_j − r_i.
  /// Errors: Error where there is no point i.
  template <class Visit>
  void for_each_neighbour(std::size_t i, Visit visit) const {
    require_point(i);
    visit_near(points()[i], [&](std::size_t j, Vector separation) {
      if (j != i) visit(j, separation);
    });
  }

  /// The same for the points around any place: separation = r_j − p. Errors: Error where p is not finite.
  template <class Visit>
  void for_each_neighbour(Vector p, Visit visit) const {
    require_finite(p);
    visit_near(p, std::move(visit));
  }

 private:
  [[nodiscard]] PointsInBox points() const { return {box_, x_, y_}; }
  template <class Visit>
  void visit_near(Vector p, Visit visit) const {
    if (crowd_) [[unlikely]] {
      visit_near_in_crowd(p, std::move(visit));
    } else {
      gridlock::for_each_neighbour(points(), grid_, cutoff_, p, std::move(visit));
    }
  }
  /// By itself, or the compiler would not put what the caller does into the loop of the other one.
  template <class Visit>
  [[gnu::noinline]] void visit_near_in_crowd(Vector p, Visit visit) const {
    gridlock::for_each_neighbour(points(), *crowd_, cutoff_, p, std::move(visit));
  }
  /// The cells of points that do not crowd.
  [[nodiscard]] CellLayout plain_layout() const;
  /// Makes that of points that crowd in cells of `layout`, and returns whether they do.
  bool make_grid_of_crowd(CellLayout const& layout);
  [[nodiscard]] bool has_crowd(CellLayout const& layout) const;
  void require_point(std::size_t i) const;
  static void require_finite(Vector p);

  Box box_;
  double cutoff_;
  std::span<double const> x_;
  std::span<double const> y_;
  PackedGrid grid_;                  ///< of points that do not crowd
  std::optional<SortedGrid> crowd_;  ///< of points that do
  std::size_t arrivals_ = 0;         ///< in other cells, since they were found to crowd
};

}  // namespace gridlock
