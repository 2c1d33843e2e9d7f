#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "gridlock/lattice/start.hpp"

namespace gridlock {

namespace {

/// Rounding of site coordinates must not make disks in contact overlap: this much is taken off the radius.
double safe_radius(double radius, Box const& box) {
  constexpr double epsilon = std::numeric_limits<double>::epsilon();
  return radius - 4.0 * epsilon * std::max(box.width(), box.height());
}

LatticeFit make_fit(Box const& box, double radius, std::vector<Vector> const& all_sites, std::uint64_t count) {
  LatticeFit fit{.radius = safe_radius(radius, box)};
  fit.packing_fraction = static_cast<double>(count) * std::numbers::pi * fit.radius * fit.radius / box.area();
  fit.sites.reserve(count);
  std::uint64_t const available = all_sites.size();
  // The n-th disk on site ⌊n·available/count⌋ spreads the empty sites evenly; the product fits for 4·10⁹ disks.
  for (std::uint64_t n = 0; n < count; ++n) fit.sites.push_back(all_sites[n * available / count]);
  return fit;
}

std::uint64_t rounded_up_quotient(std::uint64_t a, std::uint64_t b) { return (a + b - 1) / b; }

/// Lattices far from square are never the best: rows beyond this need not be tried.
std::uint64_t most_rows(Box const& box, std::uint64_t count) {
  double const likely = std::sqrt(static_cast<double>(count) * box.height() / box.width());
  return std::min<std::uint64_t>(count, static_cast<std::uint64_t>(2.0 * likely) + 8);
}

/// Rows of a triangular lattice along x in a box of width × height (which may be the box turned by 90°).
struct Rows {
  std::uint64_t count = 0;
  std::uint64_t even_length = 0;  ///< sites in rows 0, 2, 4 …
  std::uint64_t odd_length = 0;   ///< sites in rows 1, 3, 5 …, shifted by half a spacing
  bool is_turned = false;
  double radius = 0.0;

  [[nodiscard]] std::uint64_t sites() const { return (count + 1) / 2 * even_length + count / 2 * odd_length; }
  /// Half spacings between the leftmost and the rightmost site.
  [[nodiscard]] double extent() const {
    double const even = 2.0 * static_cast<double>(even_length - 1);
    bool const is_shifted_row_longest = count > 1 && odd_length == even_length;
    return is_shifted_row_longest ? even + 1.0 : even;
  }
};

/// Half the smallest distance of two sites for spacings a_x and a_y.
double contact_radius(Rows const& rows, double a_x, double a_y) {
  double smallest = std::numeric_limits<double>::infinity();
  if (rows.even_length > 1) smallest = std::min(smallest, a_x);
  if (rows.count > 1) smallest = std::min(smallest, std::sqrt(0.25 * a_x * a_x + a_y * a_y));
  if (rows.count > 2) smallest = std::min(smallest, 2.0 * a_y);
  return 0.5 * smallest;
}

struct Spacings {
  double a_x;
  double a_y;
};

/// The spacings that leave `margin` between the outermost sites and the walls.
Spacings stretched(Rows const& rows, double width, double height, double margin) {
  double const extent = rows.extent();
  return {extent > 0.0 ? 2.0 * (width - 2.0 * margin) / extent : 0.0,
          rows.count > 1 ? (height - 2.0 * margin) / static_cast<double>(rows.count - 1) : 0.0};
}

/// The largest R with contact_radius(spacings for margin R) ≥ R: one root, since the left side falls and the right
/// side rises with R.
double largest_radius_between_walls(Rows const& rows, double width, double height) {
  double fits = 0.0;
  double too_large = 0.5 * std::min(width, height);
  for (int halving = 0; halving < 200; ++halving) {
    double const radius = 0.5 * (fits + too_large);
    auto const [a_x, a_y] = stretched(rows, width, height, radius);
    (contact_radius(rows, a_x, a_y) >= radius ? fits : too_large) = radius;
  }
  return fits;
}

Rows better_of(Rows const& a, Rows const& b) { return b.radius > a.radius ? b : a; }

Rows best_rows_between_walls(Box const& box, std::uint64_t count, bool is_turned) {
  double const width = is_turned ? box.height() : box.width();
  double const height = is_turned ? box.width() : box.height();
  Rows best;
  for (std::uint64_t m = 1; m <= most_rows(Box(width, height, Edge::wall), count); ++m) {
    // Rows of p and p, then rows of p and p − 1, with the smallest p that has enough sites.
    std::uint64_t const equal = rounded_up_quotient(count, m);
    std::uint64_t const alternating = rounded_up_quotient(count + m / 2, m);
    for (Rows rows : {Rows{m, equal, equal, is_turned}, Rows{m, alternating, alternating - 1, is_turned}}) {
      if (rows.odd_length == 0 && m > 1) continue;
      rows.radius = largest_radius_between_walls(rows, width, height);
      best = better_of(best, rows);
    }
  }
  return best;
}

Rows best_periodic_rows(Box const& box, std::uint64_t count, bool is_turned) {
  double const width = is_turned ? box.height() : box.width();
  double const height = is_turned ? box.width() : box.height();
  Rows best;
  for (std::uint64_t m = 2; m <= most_rows(Box(width, height, Edge::wall), count) + 1; m += 2) {
    std::uint64_t const length = rounded_up_quotient(count, m);
    double const a_x = width / static_cast<double>(length);
    double const a_y = height / static_cast<double>(m);
    double const smallest = std::min({a_x, std::sqrt(0.25 * a_x * a_x + a_y * a_y), 2.0 * a_y});
    best = better_of(best, {m, length, length, is_turned, 0.5 * smallest});
  }
  return best;
}

std::vector<Vector> sites_of(Rows const& rows, Box const& box) {
  double const width = rows.is_turned ? box.height() : box.width();
  double const height = rows.is_turned ? box.width() : box.height();
  Spacings spacings{};
  Vector corner;
  if (box.is_periodic()) {
    spacings = {width / static_cast<double>(rows.even_length), height / static_cast<double>(rows.count)};
    corner = {0.25 * spacings.a_x, 0.5 * spacings.a_y};
  } else {
    spacings = stretched(rows, width, height, rows.radius);
    // One column or one row alone is in the middle.
    corner = {rows.extent() > 0.0 ? rows.radius : 0.5 * width, rows.count > 1 ? rows.radius : 0.5 * height};
  }
  std::vector<Vector> sites;
  sites.reserve(rows.sites());
  for (std::uint64_t row = 0; row < rows.count; ++row) {
    bool const is_odd = row % 2 == 1;
    for (std::uint64_t n = 0; n < (is_odd ? rows.odd_length : rows.even_length); ++n) {
      Vector const site{corner.x + (static_cast<double>(n) + (is_odd ? 0.5 : 0.0)) * spacings.a_x,
                        corner.y + static_cast<double>(row) * spacings.a_y};
      sites.push_back(rows.is_turned ? Vector{site.y, site.x} : site);
    }
  }
  return sites;
}

}  // namespace

LatticeFit fit_square_lattice(Box const& box, std::uint64_t count) {
  std::uint64_t best_columns = count;
  std::uint64_t best_rows = 1;
  double best_radius = 0.0;
  for (std::uint64_t rows = 1; rows <= most_rows(box, count); ++rows) {
    std::uint64_t const columns = rounded_up_quotient(count, rows);
    double const radius =
        0.5 * std::min(box.width() / static_cast<double>(columns), box.height() / static_cast<double>(rows));
    if (radius > best_radius) {
      best_columns = columns;
      best_rows = rows;
      best_radius = radius;
    }
  }
  double const a_x = box.width() / static_cast<double>(best_columns);
  double const a_y = box.height() / static_cast<double>(best_rows);
  std::vector<Vector> sites;
  sites.reserve(best_columns * best_rows);
  for (std::uint64_t row = 0; row < best_rows; ++row) {
    for (std::uint64_t column = 0; column < best_columns; ++column) {
      sites.push_back({(static_cast<double>(column) + 0.5) * a_x, (static_cast<double>(row) + 0.5) * a_y});
    }
  }
  return make_fit(box, best_radius, sites, count);
}

LatticeFit fit_triangular_lattice(Box const& box, std::uint64_t count) {
  auto const best_rows = box.is_periodic() ? best_periodic_rows : best_rows_between_walls;
  Rows const best = better_of(best_rows(box, count, false), best_rows(box, count, true));
  return make_fit(box, best.radius, sites_of(best, box), count);
}

}  // namespace gridlock
