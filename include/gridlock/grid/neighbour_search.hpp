#pragma once

#include <algorithm>
#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <utility>

#include "gridlock/core/box.hpp"
#include "gridlock/core/error.hpp"
#include "gridlock/grid/detail/oblique_points.hpp"
#include "gridlock/grid/detail/packed_grid.hpp"
#include "gridlock/grid/detail/point_pairs.hpp"
#include "gridlock/grid/detail/sorted_grid.hpp"

namespace gridlock {

/// A search for the pairs of points of a box that are nearer than a cutoff, and for the neighbours of a point.
///
/// ```cpp
/// std::vector<double> const x{0.1, 0.9, 0.5};
/// std::vector<double> const y{0.5, 0.5, 0.5};
/// NeighbourSearch const search(Box(1.0, 1.0, Edge::periodic), 0.3, x, y);
/// search.for_each_pair([](std::size_t i, std::size_t j, Vector separation) { /* r_j − r_i */ });
/// search.for_each_neighbour(0, [](std::size_t j, Vector separation) { /* r_j − r_0 */ });
/// ```
///
/// Neighbours have |separation| < cutoff, measured in double precision to the minimum image in a periodic box.
/// Coordinates may be any finite numbers: a point outside a periodic box means its image inside; many points outside
/// walls make the search slow. The order of visits depends only on the points and on those before each update().
///
/// The search keeps views of x and y, not copies. Do not change or free them before update() or the end of the search.
/// Several threads may search at the same time.
/// Errors: Error for lists of different lengths, coordinates that are not finite, more than 250 million points, a
/// cutoff outside 10⁻⁶⁰ … 10⁶⁰ or above half the shorter side of a periodic box, and a box with sides outside that
/// range.
/// Cost for a million points in random order with six neighbours each: 35 ns a point to build, 15 ns to update, 45 ns
/// for all pairs (AMD Zen 4); 60 bytes a point. If points crowd in a part of the box, building and updates take up to
/// 2.8 times as long, all pairs up to 1.5 times; an update takes as long as building if more than one point in eight
/// changes its cell. After as many changes of cell as there are points, the search tests again whether points crowd.
class NeighbourSearch {
 public:
  /// Prepares a search for points at (x[i], y[i]).
  NeighbourSearch(Box const& box, double cutoff, std::span<double const> x, std::span<double const> y);

  [[nodiscard]] Box const& box() const { return box_; }
  [[nodiscard]] double cutoff() const { return cutoff_; }
  [[nodiscard]] std::size_t size() const { return x_.size(); }

  /// Moves point i to (x[i], y[i]): faster than a new search if most points have moved less than the cutoff. Errors:
  /// Error for another number of points or coordinates that are not finite; the search is then unchanged.
  void update(std::span<double const> x, std::span<double const> y);

  /// Calls visit(i, j, separation) once for every pair, where i > j and separation = r_j − r_i.
  template <class Visit>
  void for_each_pair(Visit visit) const {
    if (oblique_) [[unlikely]] {
      visit_pairs_of_oblique(std::move(visit));
    } else if (crowd_) [[unlikely]] {
      gridlock::for_each_pair(points(), *crowd_, cutoff_, std::move(visit));
    } else {
      gridlock::for_each_pair(points(), grid_, cutoff_, std::move(visit));
    }
  }

  /// Calls visit(j, separation) once for every neighbour j ≠ i of point i; separation = r_j − r_i. Errors: Error for an
  /// i that is not below size().
  template <class Visit>
  void for_each_neighbour(std::size_t i, Visit visit) const {
    require_point(i);
    visit_near(points()[i], [&](std::size_t j, Vector separation) {
      if (j != i) visit(j, separation);
    });
  }

  /// Calls visit(j, separation) once for every point j near p; separation = r_j − p. Errors: Error for a p that is not
  /// finite.
  template <class Visit>
  void for_each_neighbour(Vector p, Visit visit) const {
    require_finite(p);
    visit_near(p, std::move(visit));
  }

 private:
  [[nodiscard]] PointsInBox points() const { return {box_, x_, y_}; }
  template <class Visit>
  void visit_near(Vector p, Visit visit) const {
    if (oblique_) [[unlikely]] {
      visit_near_in_oblique(p, std::move(visit));
    } else if (crowd_) [[unlikely]] {
      visit_near_in_crowd(p, std::move(visit));
    } else {
      gridlock::for_each_neighbour(points(), grid_, cutoff_, p, std::move(visit));
    }
  }
  /// Not inlined: otherwise the compiler would not inline `visit` into the loop for points that do not crowd.
  template <class Visit>
  [[gnu::noinline]] void visit_near_in_crowd(Vector p, Visit visit) const {
    gridlock::for_each_neighbour(points(), *crowd_, cutoff_, p, std::move(visit));
  }
  template <class Visit>
  void visit_pairs_of_oblique(Visit visit) const;
  template <class Visit>
  void visit_near_in_oblique(Vector p, Visit visit) const;
  void search_oblique();
  /// Returns the cells for points that do not crowd.
  [[nodiscard]] CellLayout plain_layout() const;
  /// Makes crowd_ if the points crowd in cells of `layout`, and returns whether they do.
  bool make_grid_of_crowd(CellLayout const& layout);
  [[nodiscard]] bool has_crowd(CellLayout const& layout) const;
  void require_point(std::size_t i) const;
  static void require_finite(Vector p);

  Box box_;
  double cutoff_;
  std::span<double const> x_;
  std::span<double const> y_;
  PackedGrid grid_;                  ///< used for points that do not crowd
  std::optional<SortedGrid> crowd_;  ///< used for points that crowd, else empty
  std::size_t arrivals_ = 0;         ///< changes of cell since the last test whether points crowd
  struct Oblique;
  std::shared_ptr<Oblique const> oblique_;  ///< used for an oblique box, else empty
};

/// Points and images of an oblique box, and a grid of them that is periodic along x alone.
struct NeighbourSearch::Oblique {
  ObliquePoints points;
  double cutoff;
  PackedGrid grid;

  Oblique(Box const& box, double cutoff, std::span<double const> x, std::span<double const> y);
  [[nodiscard]] PointsInBox in_frame() const { return {points.frame(), points.x(), points.y()}; }
};

template <class Visit>
void NeighbourSearch::visit_pairs_of_oblique(Visit visit) const {
  ObliquePoints const& all = oblique_->points;
  auto const visit_pair = [&](std::size_t a, std::size_t b, Vector) {
    if (!all.counts(a, b)) return;
    std::size_t const i = std::max(all.point(a), all.point(b));
    std::size_t const j = std::min(all.point(a), all.point(b));
    Vector const separation = box_.displacement(points()[i], points()[j]);
    if (squared_length(separation) < cutoff_ * cutoff_) visit(i, j, separation);
  };
  gridlock::for_each_pair(oblique_->in_frame(), oblique_->grid, oblique_->cutoff, visit_pair);
}

template <class Visit>
void NeighbourSearch::visit_near_in_oblique(Vector p, Visit visit) const {
  ObliquePoints const& all = oblique_->points;
  auto const visit_near = [&](std::size_t k, Vector) {
    std::size_t const j = all.point(k);
    Vector const separation = box_.displacement(p, points()[j]);
    if (squared_length(separation) < cutoff_ * cutoff_) visit(j, separation);
  };
  gridlock::for_each_neighbour(oblique_->in_frame(), oblique_->grid, oblique_->cutoff, all.place(p), visit_near);
}

}  // namespace gridlock
