#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "gridlock/lattice/start.hpp"

namespace gridlock {

namespace {

/// Returns the radius less a margin, so that the rounding of site coordinates makes no disks in contact overlap.
double safe_radius(double radius, Box const& box) {
  constexpr double epsilon = std::numeric_limits<double>::epsilon();
  return radius - 4.0 * epsilon * std::max(box.width(), box.height());
}

LatticeFit make_fit(Box const& box, double radius, std::uint64_t available, LatticeFit::Rows const& rows,
                    std::uint64_t count) {
  LatticeFit fit{.radius = safe_radius(radius, box), .count = count, .available = available, .rows = rows};
  fit.packing_fraction = static_cast<double>(count) * std::numbers::pi * fit.radius * fit.radius / box.area();
  return fit;
}

std::uint64_t rounded_up_quotient(std::uint64_t a, std::uint64_t b) { return (a + b - 1) / b; }

/// Returns the largest number of rows to try: lattices far from square are never the best.
std::uint64_t max_rows(Box const& box, std::uint64_t count) {
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
  /// Returns the distance from the leftmost to the rightmost site, in half spacings.
  [[nodiscard]] double extent() const {
    double const even = 2.0 * static_cast<double>(even_length - 1);
    bool const is_shifted_row_longest = count > 1 && odd_length == even_length;
    return is_shifted_row_longest ? even + 1.0 : even;
  }
};

/// Returns half the smallest distance of two sites for spacings a_x and a_y.
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

/// Returns the spacings that leave `margin` between the outermost sites and the walls.
Spacings stretched(Rows const& rows, double width, double height, double margin) {
  double const extent = rows.extent();
  return {extent > 0.0 ? 2.0 * (width - 2.0 * margin) / extent : 0.0,
          rows.count > 1 ? (height - 2.0 * margin) / static_cast<double>(rows.count - 1) : 0.0};
}

/// Returns the largest R with contact_radius(spacings for margin R) ≥ R; the left side falls with R, so there is one
/// root.
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
  for (std::uint64_t m = 1; m <= max_rows(Box(width, height, Edge::wall), count); ++m) {
    // Tried are rows of p and p sites, then rows of p and p − 1, with the smallest p that gives enough sites.
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
  for (std::uint64_t m = 2; m <= max_rows(Box(width, height, Edge::wall), count) + 1; m += 2) {
    std::uint64_t const length = rounded_up_quotient(count, m);
    double const a_x = width / static_cast<double>(length);
    double const a_y = height / static_cast<double>(m);
    double const smallest = std::min({a_x, std::sqrt(0.25 * a_x * a_x + a_y * a_y), 2.0 * a_y});
    best = better_of(best, {m, length, length, is_turned, 0.5 * smallest});
  }
  return best;
}

/// Rows of a triangular lattice in a box that is periodic along one axis. Where the rows lie along the periodic axis,
/// each goes around it; otherwise their number is even.
class RowsOfChannel {
 public:
  RowsOfChannel(Box const& box, bool is_turned)
      : width_(is_turned ? box.height() : box.width()),
        height_(is_turned ? box.width() : box.height()),
        goes_around_(is_turned ? box.is_periodic_y() : box.is_periodic_x()),
        is_turned_(is_turned) {}

  [[nodiscard]] Rows best(std::uint64_t count) const {
    Rows best;
    std::uint64_t const first = goes_around_ ? 1 : 2;
    for (std::uint64_t m = first; m <= max_rows(Box(width_, height_, Edge::wall), count) + 1; m += first) {
      std::uint64_t const equal = rounded_up_quotient(count, m);
      best = better_of(best, with_radius({m, equal, equal, is_turned_}));
      if (goes_around_) continue;
      std::uint64_t const alternating = rounded_up_quotient(count + m / 2, m);
      if (alternating > 1) best = better_of(best, with_radius({m, alternating, alternating - 1, is_turned_}));
    }
    return best;
  }

  /// Returns the spacings that leave `margin` between the outermost sites and the walls.
  [[nodiscard]] Spacings spacings(Rows const& rows, double margin) const {
    auto const [a_x, a_y] = stretched(rows, width_, height_, margin);
    if (goes_around_) return {width_ / static_cast<double>(rows.even_length), a_y};
    return {a_x, height_ / static_cast<double>(rows.count)};
  }

 private:
  [[nodiscard]] Rows with_radius(Rows rows) const {
    double too_large = 0.5 * std::min(width_, height_);
    for (int halving = 0; halving < 200; ++halving) {
      double const radius = 0.5 * (rows.radius + too_large);
      (contact(rows, radius) >= radius ? rows.radius : too_large) = radius;
    }
    return rows;
  }
  /// Returns half the smallest distance of two sites, and of a site and its own image.
  [[nodiscard]] double contact(Rows const& rows, double margin) const {
    auto const [a_x, a_y] = spacings(rows, margin);
    double const image = goes_around_ ? a_x : 2.0 * a_y;
    return std::min(contact_radius(rows, a_x, a_y), 0.5 * image);
  }

  double width_;
  double height_;
  bool goes_around_;
  bool is_turned_;
};

LatticeFit::Rows sites_of_channel(Rows const& rows, Box const& box) {
  bool const goes_around = rows.is_turned ? box.is_periodic_y() : box.is_periodic_x();
  double const width = rows.is_turned ? box.height() : box.width();
  double const height = rows.is_turned ? box.width() : box.height();
  auto const [a_x, a_y] = RowsOfChannel(box, rows.is_turned).spacings(rows, rows.radius);
  LatticeFit::Rows sites{.even_length = rows.even_length,
                         .odd_length = rows.odd_length,
                         .spacing = {a_x, a_y},
                         .shift_of_odd = 0.5,
                         .is_turned = rows.is_turned};
  // A single column or row between walls is in the middle.
  if (goes_around) {
    sites.corner = {0.25 * a_x, rows.count > 1 ? rows.radius : 0.5 * height};
  } else {
    sites.corner = {rows.extent() > 0.0 ? rows.radius : 0.5 * width, 0.5 * a_y};
  }
  return sites;
}

LatticeFit::Rows sites_of(Rows const& rows, Box const& box) {
  if (box.edge_x() != box.edge_y()) return sites_of_channel(rows, box);
  double const width = rows.is_turned ? box.height() : box.width();
  double const height = rows.is_turned ? box.width() : box.height();
  LatticeFit::Rows sites{
      .even_length = rows.even_length, .odd_length = rows.odd_length, .shift_of_odd = 0.5, .is_turned = rows.is_turned};
  if (box.is_periodic()) {
    sites.spacing = {width / static_cast<double>(rows.even_length), height / static_cast<double>(rows.count)};
    sites.corner = {0.25 * sites.spacing.x, 0.5 * sites.spacing.y};
  } else {
    auto const [a_x, a_y] = stretched(rows, width, height, rows.radius);
    sites.spacing = {a_x, a_y};
    // A single column or row is in the middle.
    sites.corner = {rows.extent() > 0.0 ? rows.radius : 0.5 * width, rows.count > 1 ? rows.radius : 0.5 * height};
  }
  return sites;
}

}  // namespace

Vector LatticeFit::site(std::uint64_t n) const {
  // Disk n on site ⌊n·available/count⌋ spreads the empty sites evenly; the product fits 64 bits for 4·10⁹ disks.
  std::uint64_t const place = n * available / count;
  std::uint64_t const two_rows = rows.even_length + rows.odd_length;
  std::uint64_t const within = place % two_rows;
  bool const is_odd = within >= rows.even_length;
  std::uint64_t const row = 2 * (place / two_rows) + (is_odd ? 1 : 0);
  std::uint64_t const column = is_odd ? within - rows.even_length : within;
  double const shift = is_odd ? rows.shift_of_odd : 0.0;
  Vector const site{rows.corner.x + (static_cast<double>(column) + (rows.offset.x + shift)) * rows.spacing.x,
                    rows.corner.y + (static_cast<double>(row) + rows.offset.y) * rows.spacing.y};
  return rows.is_turned ? Vector{site.y, site.x} : site;
}

LatticeFit fit_square_lattice(Box const& box, std::uint64_t count) {
  std::uint64_t best_columns = count;
  std::uint64_t best_rows = 1;
  double best_radius = 0.0;
  for (std::uint64_t rows = 1; rows <= max_rows(box, count); ++rows) {
    std::uint64_t const columns = rounded_up_quotient(count, rows);
    double const radius =
        0.5 * std::min(box.width() / static_cast<double>(columns), box.height() / static_cast<double>(rows));
    if (radius > best_radius) {
      best_columns = columns;
      best_rows = rows;
      best_radius = radius;
    }
  }
  LatticeFit::Rows const sites{
      .even_length = best_columns,
      .odd_length = best_columns,
      .spacing = {box.width() / static_cast<double>(best_columns), box.height() / static_cast<double>(best_rows)},
      .offset = {0.5, 0.5}};
  return make_fit(box, best_radius, best_columns * best_rows, sites, count);
}

LatticeFit fit_triangular_lattice(Box const& box, std::uint64_t count) {
  auto const best_rows = [&](bool is_turned) {
    if (box.edge_x() != box.edge_y()) return RowsOfChannel(box, is_turned).best(count);
    return box.is_periodic() ? best_periodic_rows(box, count, is_turned)
                             : best_rows_between_walls(box, count, is_turned);
  };
  Rows const best = better_of(best_rows(false), best_rows(true));
  return make_fit(box, best.radius, best.sites(), sites_of(best, box), count);
}

}  // namespace gridlock
