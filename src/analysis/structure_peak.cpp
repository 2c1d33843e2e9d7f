#include "gridlock/analysis/structure_peak.hpp"

#include <fmt/format.h>

#include <cmath>
#include <cstddef>
#include <span>
#include <string>
#include <utility>

#include "analysis/plane_waves.hpp"
#include "grid/require.hpp"
#include "gridlock/core/detail/thread_pool.hpp"

namespace gridlock {

namespace {

constexpr double max_vectors_of_square = 1e8;

/// The wave vectors of one column in the square, and S of each.
struct PeakColumn {
  std::vector<Vector> wave_vectors;
  std::vector<double> structure_factor;
};

/// Returns the first and the last whole number in (centre ± half)/unit, where rounding excludes none.
std::pair<std::int64_t, std::int64_t> whole_numbers_in(double centre, double half, double unit) {
  double const wider = half + 1e-9 * unit;
  return {static_cast<std::int64_t>(std::ceil((centre - wider) / unit)),
          static_cast<std::int64_t>(std::floor((centre + wider) / unit))};
}

PeakColumn structure_of_column(Box const& box, std::span<double const> x, std::span<double const> y,
                               std::int64_t column, Vector centre, double half) {
  PeakColumn found;
  double const row_height = two_pi / box.height();
  double const lowered = lean(box, column);
  auto const [first, last] = whole_numbers_in(centre.y + lowered * row_height, half, row_height);
  PlaneWaves waves(box, x, y, column, first);
  for (std::int64_t row = first; row <= last; ++row) {
    Vector const q{two_pi / box.width() * static_cast<double>(column),
                   row_height * (static_cast<double>(row) - lowered)};
    if (column != 0 || row != 0) {
      found.wave_vectors.push_back(q);
      waves.sum(0, x.size(), [&](double real, double imaginary) {
        found.structure_factor.push_back((real * real + imaginary * imaginary) / static_cast<double>(x.size()));
      });
    }
    waves.next_row();
  }
  return found;
}

void require_square(Box const& box, PointsInMemory const& points, Vector centre, double half) {
  auto const refuse = [](std::string what, std::string hint) {
    throw Error({.what = std::move(what), .hint = std::move(hint)});
  };
  if (!box.is_periodic())
    refuse("the structure factor needs a box that is periodic in x and y", "between walls there are no plane waves");
  if (points.count == 0) refuse("no points have a structure factor", "give at least one point");
  if (!std::isfinite(centre.x) || !std::isfinite(centre.y) || !(half > 0.0) || !std::isfinite(half)) {
    refuse(fmt::format("the square of wave vectors is ({}, {}) ± {}", centre.x, centre.y, half),
           "use finite numbers, and a half width above 0");
  }
  double const vectors = 4.0 * half * half * box.area() / (two_pi * two_pi);
  if (vectors > max_vectors_of_square) {
    refuse(fmt::format("{:.3g} wave vectors are in the square; the most is {:.0g}", vectors, max_vectors_of_square),
           "use a smaller half width");
  }
}

}  // namespace

StructurePeak find_structure_peak(Box const& box, PointsInMemory const& points, Vector centre, double half_width,
                                  std::uint64_t threads) {
  require_points_in_memory(points);
  require_box_for(box, 0.0);
  require_square(box, points, centre, half_width);
  std::vector<double> x, y;
  for (std::size_t i = 0; i < points.count; ++i) {
    x.push_back(points.x[i * points.stride]);
    y.push_back(points.y[i * points.stride]);
  }
  auto const [first, last] = whole_numbers_in(centre.x, half_width, two_pi / box.width());
  std::vector<PeakColumn> columns(last < first ? 0 : static_cast<std::size_t>(last - first + 1));
  ThreadPool pool(threads);
  pool.for_each(columns.size(), [&, from = first](std::size_t k) {
    columns[k] = structure_of_column(box, x, y, from + static_cast<std::int64_t>(k), centre, half_width);
  });
  StructurePeak peak;
  for (PeakColumn const& column : columns) {
    for (std::size_t k = 0; k < column.wave_vectors.size(); ++k) {
      double const height = column.structure_factor[k] / static_cast<double>(points.count);
      if (height > peak.height) peak.at = column.wave_vectors[k], peak.height = height;
      peak.wave_vectors.push_back(column.wave_vectors[k]);
      peak.structure_factor.push_back(column.structure_factor[k]);
    }
  }
  if (peak.wave_vectors.empty()) {
    throw Error({.what = fmt::format("no wave vector of the box is in the square ({}, {}) ± {}", centre.x, centre.y,
                                     half_width),
                 .hint = fmt::format("use a half width above {:.6g}", two_pi / box.shortest_period())});
  }
  return peak;
}

}  // namespace gridlock
