#include "gridlock/grid/neighbour_search.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/number_text.hpp"
#include "grid/require.hpp"
#include "gridlock/core/error.hpp"
#include "gridlock/grid/detail/stored_cells.hpp"

namespace gridlock {

NeighbourSearch::NeighbourSearch(Box const& box, double cutoff, std::span<double const> x, std::span<double const> y)
    : box_(box), cutoff_(cutoff), x_(x), y_(y) {
  require_bounded_cutoff(cutoff);
  require_box_for(box, cutoff);
  require_equal_lengths(x, y);
  require_point_count(x.size());
  if (box.is_oblique()) {
    search_oblique();
    return;
  }
  CellLayout const layout = plain_layout();
  // PackedGrid itself checks that points are finite.
  if (!make_grid_of_crowd(layout)) grid_ = PackedGrid(layout, x_, y_);
}

NeighbourSearch::Oblique::Oblique(Box const& box, double wanted, std::span<double const> x, std::span<double const> y)
    : points(box, searched_distance(wanted), x, y, ObliquePoints::Images::around),
      cutoff(std::min(searched_distance(wanted), 0.5 * box.width())),
      grid(layout_for_cutoff(points.frame(), cutoff, points.size()), points.x(), points.y()) {}

void NeighbourSearch::search_oblique() {
  require_points(x_, y_);
  oblique_ = std::make_shared<Oblique>(box_, cutoff_, x_, y_);
}

CellLayout NeighbourSearch::plain_layout() const {
  // A block holds four points, so cells of two points each are as fast to search as smaller cells, and faster to make.
  constexpr double cells_per_point = 0.6;
  return layout_for_cutoff(box_, cutoff_, size(), cells_per_point);
}

bool NeighbourSearch::make_grid_of_crowd(CellLayout const& layout) {
  std::optional<CellLayout> const finer = layout_for_crowd(box_, cutoff_, size(), layout);
  if (!finer) return false;
  require_points(x_, y_);
  if (!has_crowd(layout)) return false;
  crowd_.emplace(box_, *finer, x_, y_);
  arrivals_ = 0;
  grid_ = PackedGrid();
  return true;
}

bool NeighbourSearch::has_crowd(CellLayout const& layout) const {
  // Counting stops here: a cell with this many points is a crowd by itself.
  constexpr std::uint8_t most = 255;
  std::vector<std::uint8_t> in_cell(static_cast<std::size_t>(layout.count()), 0);
  std::uint64_t pairs = 0;
  for (std::size_t i = 0; i < size(); ++i) {
    std::uint8_t& count = in_cell[static_cast<std::size_t>(layout.cell_of(points()[i]))];
    pairs += count;
    count = static_cast<std::uint8_t>(count + (count < most ? 1 : 0));
  }
  return is_crowd(pairs, size());
}

void NeighbourSearch::update(std::span<double const> x, std::span<double const> y) {
  require_points(x, y);
  if (x.size() != size()) {
    throw Error({.what = "there are coordinates for " + std::to_string(x.size()) + " points, but the search has " +
                         std::to_string(size()),
                 .hint = "give as many as before, or make a new search"});
  }
  x_ = x;
  y_ = y;
  if (oblique_) {
    search_oblique();
    return;
  }
  if (crowd_) {
    arrivals_ += crowd_->move_all(x, y);
    if (arrivals_ <= size()) return;
    // The crowd may have dispersed.
    arrivals_ = 0;
    CellLayout const layout = plain_layout();
    if (has_crowd(layout)) return;
    grid_ = PackedGrid(layout, x, y);
    crowd_.reset();
    return;
  }
  grid_.move_all(x, y);
  // Long chains of blocks mean that points have come together, or that many are within the cutoff.
  if (grid_.further_blocks() > size() / 8) make_grid_of_crowd(grid_.layout());
}

void NeighbourSearch::require_point(std::size_t i) const {
  if (i < size()) return;
  throw Error({.what = "there is no point " + std::to_string(i) + " among " + std::to_string(size()),
               .hint = "points count from 0"});
}

void NeighbourSearch::require_finite(Vector p) {
  if (std::isfinite(p.x) && std::isfinite(p.y)) return;
  throw Error({.what = "the neighbours of (" + number_text(p.x) + ", " + number_text(p.y) + ") are asked for",
               .hint = "every coordinate must be finite"});
}

bool are_inside(PointsInBox const& points) {
  auto const are_in_range = [](std::span<double const> coordinates, double side) {
    // All coordinates are compared, without a branch: usually none is outside.
    std::size_t outside = 0;
    for (double const p : coordinates) outside += static_cast<std::size_t>(!((p >= 0.0) & (p < side)));
    return outside == 0;
  };
  return are_in_range(points.x, points.box.width()) && are_in_range(points.y, points.box.height());
}

}  // namespace gridlock
