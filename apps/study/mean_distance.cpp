#include "study/mean_distance.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <map>
#include <numbers>

namespace gridlock {

namespace {

/// ∫∫ |q| over 0 ≤ x ≤ a, 0 ≤ y ≤ b.
double integral_from_corner(double a, double b) {
  if (a <= 0.0 || b <= 0.0) return 0.0;
  return (2.0 * a * b * std::hypot(a, b) + a * a * a * std::asinh(b / a) + b * b * b * std::asinh(a / b)) / 6.0;
}

constexpr std::size_t bins = 64;
using Distribution1D = std::array<double, bins>;

/// The normal distribution function.
double normal_below(double z) { return 0.5 * std::erfc(-z / std::numbers::sqrt2); }

/// How likely each of equal bins of [0, length] is after diffusing from `start`, by mirror images at both ends.
Distribution1D diffused_between_walls(double start, double length, double deviation) {
  // Beyond eight deviations nothing is left that a double could hold.
  int const images = static_cast<int>(std::ceil(8.0 * deviation / (2.0 * length))) + 1;
  auto const below = [&](double x) {
    double sum = 0.0;
    for (int m = -images; m <= images; ++m) {
      double const shift = 2.0 * m * length;
      sum += normal_below((x - start - shift) / deviation) + normal_below((x + start - shift) / deviation);
    }
    return sum;
  };
  Distribution1D distribution{};
  double last = below(0.0);
  for (std::size_t i = 0; i < bins; ++i) {
    double const next = below(length * static_cast<double>(i + 1) / bins);
    distribution[i] = next - last;
    last = next;
  }
  return distribution;
}

/// Sites of a lattice share few coordinates, so each is diffused once.
class DiffusedCoordinates {
 public:
  DiffusedCoordinates(double length, double deviation) : length_(length), deviation_(deviation) {}

  Distribution1D const& from(double start) {
    auto const [entry, is_new] = known_.try_emplace(start);
    if (is_new) entry->second = diffused_between_walls(start, length_, deviation_);
    return entry->second;
  }
  [[nodiscard]] double middle_of(std::size_t bin) const {
    return length_ * (static_cast<double>(bin) + 0.5) / static_cast<double>(bins);
  }

 private:
  double length_;
  double deviation_;
  std::map<double, Distribution1D> known_;
};

}  // namespace

Rectangle room_of_centres(Box const& box, double radius) {
  return {{radius, radius}, {box.width() - radius, box.height() - radius}};
}

double mean_distance(Vector p, Rectangle const& rectangle) {
  double const left = p.x - rectangle.lower.x;
  double const right = rectangle.upper.x - p.x;
  double const below = p.y - rectangle.lower.y;
  double const above = rectangle.upper.y - p.y;
  double const sum = integral_from_corner(left, below) + integral_from_corner(right, below) +
                     integral_from_corner(left, above) + integral_from_corner(right, above);
  return sum / (rectangle.width() * rectangle.height());
}

double mean_distance(std::span<Vector const> sites, Rectangle const& rectangle) {
  assert(!sites.empty());
  double sum = 0.0;
  for (Vector const& site : sites) sum += mean_distance(site, rectangle);
  return sum / static_cast<double>(sites.size());
}

double mean_distance_in_square(double side) {
  return side * (2.0 + std::numbers::sqrt2 + 5.0 * std::asinh(1.0)) / 15.0;
}

double mean_distance_after_diffusion(std::span<Vector const> sites, Rectangle const& rectangle, double diffused) {
  assert(!sites.empty() && diffused >= 0.0);
  double const deviation = std::sqrt(2.0 * diffused);
  // Narrower than a few bins, the walls are far for nearly all sites and the plane's value holds: ⟨|u|⟩ = s √(π/2).
  if (deviation < 3.0 * std::max(rectangle.width(), rectangle.height()) / bins) {
    return deviation * std::sqrt(0.5 * std::numbers::pi);
  }
  DiffusedCoordinates along_x(rectangle.width(), deviation);
  DiffusedCoordinates along_y(rectangle.height(), deviation);
  double sum = 0.0;
  for (Vector const& site : sites) {
    Vector const start = site - rectangle.lower;
    Distribution1D const& in_x = along_x.from(start.x);
    Distribution1D const& in_y = along_y.from(start.y);
    for (std::size_t i = 0; i < bins; ++i) {
      double const dx = along_x.middle_of(i) - start.x;
      for (std::size_t j = 0; j < bins; ++j) {
        double const dy = along_y.middle_of(j) - start.y;
        sum += in_x[i] * in_y[j] * std::sqrt(dx * dx + dy * dy);
      }
    }
  }
  return sum / static_cast<double>(sites.size());
}

double enskog_diffusion(double packing_fraction, double radius, double temperature) {
  double const diameter = 2.0 * radius;
  double const density = 4.0 * packing_fraction / std::numbers::pi;  // ρσ²
  double const free = 1.0 - packing_fraction;
  double const contact_value = (1.0 - 7.0 * packing_fraction / 16.0) / (free * free);
  return diameter * std::sqrt(temperature / std::numbers::pi) / (2.0 * density * contact_value);
}

}  // namespace gridlock
