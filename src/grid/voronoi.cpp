#include "gridlock/grid/voronoi.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "grid/require.hpp"
#include "grid/voronoi_polygon.hpp"
#include "gridlock/core/detail/thread_pool.hpp"
#include "gridlock/grid/detail/cell_list.hpp"

namespace gridlock {

namespace {

/// Returns a grid of cells with about two points each, as square as the box allows.
CellLayout layout_for(Box const& box, std::size_t points) {
  auto const cells = std::max(1.0, 0.5 * static_cast<double>(points));
  double const side = std::sqrt(box.area() / cells);
  auto const along = [&](double length) {
    return static_cast<std::uint64_t>(std::clamp(std::round(length / side), 1.0, cells));
  };
  return {box, along(box.width()), along(box.height())};
}

/// Neighbours, edges, the number of both, and areas of the points of a band of grid cells, in the order of its rows.
struct VoronoiBand {
  std::vector<std::uint32_t> neighbours;
  std::vector<double> edges;
  std::vector<std::uint32_t> counts;
  std::vector<double> areas;
};

/// Makes the Voronoi cells of the points in a range of rows of grid cells.
class CellMaker {
 public:
  CellMaker(Box const& box, CellList const& points)
      : box_(box),
        points_(points),
        layout_(points.layout()),
        cell_width_(box.width() / layout_.columns()),
        cell_height_(box.height() / layout_.rows()) {}

  [[nodiscard]] VoronoiBand make(int first, int end) {
    VoronoiBand band;
    for (int row = first; row < end; ++row) {
      for (int column = 0; column < layout_.columns(); ++column) {
        std::size_t const cell = cell_at(column, row);
        for (std::size_t k = points_.first_of(cell); k < points_.first_of(cell + 1); ++k) {
          make_polygon(k, column, row);
          std::size_t const before = band.neighbours.size();
          polygon_.for_each_neighbour([&](std::uint32_t neighbour, double length) {
            band.neighbours.push_back(neighbour);
            band.edges.push_back(length);
          });
          band.counts.push_back(static_cast<std::uint32_t>(band.neighbours.size() - before));
          band.areas.push_back(polygon_.area());
        }
      }
    }
    return band;
  }

 private:
  [[nodiscard]] std::size_t cell_at(int column, int row) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(layout_.columns()) +
           static_cast<std::size_t>(column);
  }

  void make_polygon(std::size_t k, int column, int row) {
    Vector const p{points_.x()[k], points_.y()[k]};
    // Walls, or the bisectors with the point's own images left, right, above and below.
    Vector least = -1.0 * p;
    Vector most = Vector{box_.width(), box_.height()} - p;
    if (box_.is_periodic_x()) least.x = -0.5 * box_.width(), most.x = 0.5 * box_.width();
    if (box_.is_periodic_y()) least.y = -0.5 * box_.height(), most.y = 0.5 * box_.height();
    // In an oblique box the images above and below are not straight above; they cut as other points do.
    if (box_.is_oblique()) least.y *= 4.0, most.y *= 4.0;
    bool const is_own_above = box_.is_periodic_y() && !box_.is_oblique();
    polygon_.begin(least, most, box_.is_periodic_x() ? points_.index(k) : VoronoiPolygon::nobody,
                   is_own_above ? points_.index(k) : VoronoiPolygon::nobody);
    int const last = boxes_around() * std::max(layout_.columns(), layout_.rows());
    for (int ring = 0; ring <= last; ++ring) {
      cut_by_ring(k, p, column, row, ring);
      double const seen = distance_seen(p, column, row, ring);
      if (seen > 0.0 && seen * seen >= 4.0 * polygon_.squared_radius()) return;
    }
  }

  /// Returns the distance within which all points are in the rings so far. Images more than a whole side away do not
  /// cut: another image of the same point is nearer to every place of the cell.
  [[nodiscard]] double distance_seen(Vector p, int column, int row, int ring) const {
    double seen = std::numeric_limits<double>::infinity();
    if (ring < boxes_around() * layout_.columns()) {
      double const inside = p.x - column * cell_width_;
      seen = ring * cell_width_ + std::min(inside, cell_width_ - inside);
    }
    if (ring < boxes_around() * layout_.rows()) {
      double const inside = p.y - row * cell_height_;
      seen = std::min(seen, ring * cell_height_ + std::min(inside, cell_height_ - inside));
    }
    return seen * (1.0 - 1e-9);
  }

  /// Returns how many boxes to each side have images that may cut a cell. In an oblique box the nearest image may be
  /// two rows of boxes away.
  [[nodiscard]] int boxes_around() const { return box_.is_oblique() ? 2 : 1; }

  void cut_by_ring(std::size_t k, Vector p, int column, int row, int ring) {
    int const rows = std::min(ring, boxes_around() * layout_.rows());
    for (int down = -rows; down <= rows; ++down) {
      bool const is_whole_row = std::abs(down) == ring;
      int const step = is_whole_row || ring == 0 ? 1 : 2 * ring;
      for (int right = -ring; right <= ring; right += step) {
        if (std::abs(right) <= boxes_around() * layout_.columns()) cut_by_cell(k, p, column + right, row + down);
      }
    }
  }

  /// Cuts the polygon of point k by the points of a grid cell, which may be an image of a cell.
  void cut_by_cell(std::size_t k, Vector p, int column, int row) {
    if (!box_.is_periodic_x() && (column < 0 || column >= layout_.columns())) return;
    if (!box_.is_periodic_y() && (row < 0 || row >= layout_.rows())) return;
    int const boxes_up = wrap(row, layout_.rows());
    double const lean = boxes_up * box_.shift();
    if (lean == 0.0) {
      cut_by_image(k, p, column, row, boxes_up);
      return;
    }
    // The images in this place of the plane come from two columns of the box.
    int const from_left = column - static_cast<int>(std::ceil(lean / cell_width_));
    cut_by_image(k, p, from_left, row, boxes_up);
    cut_by_image(k, p, from_left + 1, row, boxes_up);
  }

  /// Cuts the polygon of point k by the images of a grid cell that are `boxes_up` boxes above; a column may be outside.
  void cut_by_image(std::size_t k, Vector p, int column, int row, int boxes_up) {
    Vector const from = p - box_.offset_of_image(wrap(column, layout_.columns()), boxes_up);
    std::size_t const cell = cell_at(column, row);
    for (std::size_t other = points_.first_of(cell); other < points_.first_of(cell + 1); ++other) {
      Vector const separation = Vector{points_.x()[other], points_.y()[other]} - from;
      if (separation == Vector{}) {
        if (other != k) refuse(k, other);
        continue;
      }
      polygon_.cut(separation, points_.index(other));
    }
  }

  /// Wraps a column or row of cells into 0 … count − 1. Returns the number of boxes by which it was outside.
  static int wrap(int& number, int count) {
    int boxes = 0;
    for (; number < 0; number += count) --boxes;
    for (; number >= count; number -= count) ++boxes;
    return boxes;
  }

  [[noreturn]] void refuse(std::size_t k, std::size_t other) const {
    std::uint32_t const first = std::min(points_.index(k), points_.index(other));
    std::uint32_t const second = std::max(points_.index(k), points_.index(other));
    throw Error({.what = fmt::format("the points {} and {} are at the same place", first, second),
                 .hint = "leave one of them out: neither has a cell"});
  }

  Box const& box_;
  CellList const& points_;
  CellLayout const& layout_;
  double cell_width_;
  double cell_height_;
  VoronoiPolygon polygon_;
};

void require_inside_walls(Box const& box, PointsInMemory const& points) {
  if (box.is_periodic()) return;
  for (std::size_t i = 0; i < points.count; ++i) {
    double const x = points.x[i * points.stride];
    double const y = points.y[i * points.stride];
    bool const is_inside_x = box.is_periodic_x() || (x >= 0.0 && x <= box.width());
    bool const is_inside_y = box.is_periodic_y() || (y >= 0.0 && y <= box.height());
    if (is_inside_x && is_inside_y) continue;
    throw Error({.what = fmt::format("point {} at ({}, {}) is outside of the walls", i, x, y),
                 .hint = fmt::format("the box is {} × {}", box.width(), box.height())});
  }
}

/// Returns the lists of all bands in the order of the points.
VoronoiCells collected(std::vector<VoronoiBand> const& bands, CellList const& points, std::size_t count) {
  VoronoiCells cells{.neighbours = {.begin = std::vector<std::uint64_t>(count + 1, 0), .neighbours = {}},
                     .areas = std::vector<double>(count),
                     .edge_lengths = {}};
  std::size_t row = 0;
  for (VoronoiBand const& band : bands) {
    for (std::size_t k = 0; k < band.counts.size(); ++k, ++row) {
      cells.neighbours.begin[points.index(row) + 1] = band.counts[k];
      cells.areas[points.index(row)] = band.areas[k];
    }
  }
  for (std::size_t i = 0; i < count; ++i) cells.neighbours.begin[i + 1] += cells.neighbours.begin[i];
  cells.neighbours.neighbours.resize(cells.neighbours.begin[count]);
  cells.edge_lengths.resize(cells.neighbours.begin[count]);
  row = 0;
  for (VoronoiBand const& band : bands) {
    auto from = band.neighbours.begin();
    auto edge = band.edges.begin();
    for (std::uint32_t const size : band.counts) {
      std::uint64_t const to = cells.neighbours.begin[points.index(row++)];
      std::copy_n(from, size, cells.neighbours.neighbours.data() + to);
      std::copy_n(edge, size, cells.edge_lengths.data() + to);
      from += size;
      edge += size;
    }
  }
  return cells;
}

/// Removes a neighbour from a list if the neighbour's list lacks the point: their edge is at the tolerance.
void make_mutual(VoronoiCells& cells) {
  NeighbourLists const& lists = cells.neighbours;
  std::size_t const count = lists.begin.size() - 1;
  auto const knows = [&](std::uint32_t i, std::uint32_t j) {
    auto const* const all = lists.neighbours.data();
    return std::find(all + lists.begin[i], all + lists.begin[i + 1], j) != all + lists.begin[i + 1];
  };
  NeighbourLists mutual{.begin = {0}, .neighbours = {}};
  std::vector<double> edges;
  for (std::uint32_t i = 0; i < count; ++i) {
    for (std::uint64_t k = lists.begin[i]; k < lists.begin[i + 1]; ++k) {
      if (!knows(lists.neighbours[k], i)) continue;
      mutual.neighbours.push_back(lists.neighbours[k]);
      edges.push_back(cells.edge_lengths[k]);
    }
    mutual.begin.push_back(mutual.neighbours.size());
  }
  cells.neighbours = std::move(mutual);
  cells.edge_lengths = std::move(edges);
}

}  // namespace

VoronoiCells find_voronoi_cells(Box const& box, PointsInMemory const& points, std::uint64_t threads) {
  require_points_in_memory(points);
  require_box_for(box, 0.0);
  require_inside_walls(box, points);
  ThreadPool pool(threads);
  CellList const sorted(layout_for(box, points.count), {}, points, pool);
  std::vector<int> const ends = bands_of(sorted, pool);
  std::vector<VoronoiBand> bands(ends.size() - 1);
  pool.for_each(bands.size(), [&](std::size_t b) { bands[b] = CellMaker(box, sorted).make(ends[b], ends[b + 1]); });
  VoronoiCells cells = collected(bands, sorted, points.count);
  make_mutual(cells);
  return cells;
}

}  // namespace gridlock
