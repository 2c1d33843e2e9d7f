#include "gridlock/analysis/spectral_density.hpp"

#include <fmt/format.h>
#include <math.h>  // POSIX declares j1 here; <cmath> need not

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <string>
#include <utility>

#include "analysis/plane_waves.hpp"
#include "grid/require.hpp"
#include "gridlock/core/detail/thread_pool.hpp"

namespace gridlock {

namespace {

constexpr std::size_t max_bins_of_spectrum = 10'000'000;
constexpr double max_vectors = 1e8;

/// Disks in the order of their radii, so that disks of equal radius share a form factor.
struct SortedDisks {
  std::vector<double> x;
  std::vector<double> y;
  std::vector<double> radii;       ///< the different radii
  std::vector<std::size_t> begin;  ///< index of the first disk of each radius, and the number of disks

  SortedDisks(PointsInMemory const& points, std::span<double const> radius) {
    std::vector<std::size_t> order(points.count);
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::ranges::stable_sort(order, {}, [&](std::size_t i) { return radius[i]; });
    for (std::size_t const i : order) {
      if (radii.empty() || radius[i] != radii.back()) {
        radii.push_back(radius[i]);
        begin.push_back(x.size());
      }
      x.push_back(points.x[i * points.stride]);
      y.push_back(points.y[i * points.stride]);
    }
    begin.push_back(x.size());
  }
};

/// Returns |Σ m(q R_j) exp(i q·r_j)|² with m = 2π R J₁(q R)/q.
double power_of(PlaneWaves const& waves, SortedDisks const& disks, double q) {
  double real = 0.0;
  double imaginary = 0.0;
  for (std::size_t k = 0; k < disks.radii.size(); ++k) {
    double const radius = disks.radii[k];
    double const area = two_pi * radius * ::j1(q * radius) / q;
    waves.sum(disks.begin[k], disks.begin[k + 1], [&](double sum_real, double sum_imaginary) {
      real += area * sum_real;
      imaginary += area * sum_imaginary;
    });
  }
  return real * real + imaginary * imaginary;
}

/// The lengths and the powers of the wave vectors of one column that lie in the rings.
struct Column {
  std::vector<double> lengths;
  std::vector<double> powers;
};

Column powers_of_column(Box const& box, SortedDisks const& disks, std::int64_t column, double largest) {
  Column found;
  double const along_x = two_pi / box.width() * static_cast<double>(column);
  double const left = std::sqrt(std::max(0.0, largest * largest - along_x * along_x));
  auto const reach = static_cast<std::int64_t>(left * box.height() / two_pi) + 1;
  double const lowered = lean(box, column);
  auto const middle = static_cast<std::int64_t>(std::round(lowered));
  std::int64_t const last = middle + reach + (lowered == 0.0 ? 0 : 1);
  // Opposite vectors have equal powers, so one of the two is used; 0 is left out.
  std::int64_t const first = column == 0 ? 1 : middle - reach - (lowered == 0.0 ? 0 : 1);
  PlaneWaves waves(box, disks.x, disks.y, column, first);
  for (std::int64_t row = first; row <= last; ++row) {
    double const along_y = two_pi / box.height() * (static_cast<double>(row) - lowered);
    double const length = std::sqrt(along_x * along_x + along_y * along_y);
    if (length <= largest) {
      found.lengths.push_back(length);
      found.powers.push_back(power_of(waves, disks, length));
    }
    waves.next_row();
  }
  return found;
}

void require_spectrum(Box const& box, PointsInMemory const& points, std::span<double const> radii, double largest,
                      std::size_t bins) {
  auto const refuse = [](std::string what, std::string hint) {
    throw Error({.what = std::move(what), .hint = std::move(hint)});
  };
  if (!box.is_periodic())
    refuse("the spectral density needs a box that is periodic in x and y", "between walls there are no plane waves");
  if (radii.size() != points.count)
    refuse(fmt::format("there are {} radii for {} disks", radii.size(), points.count), "give one for each disk");
  for (double const radius : radii) {
    if (!(radius > 0.0) || !std::isfinite(radius)) refuse(fmt::format("a radius is {}", radius), "use numbers above 0");
  }
  if (!(largest > 0.0) || !std::isfinite(largest))
    refuse(fmt::format("the largest wave number is {}", largest), "use a number above 0");
  if (bins == 0 || bins > max_bins_of_spectrum)
    refuse(fmt::format("the spectral density has {} bins", bins), fmt::format("use 1 to {}", max_bins_of_spectrum));
  // Half of the circle of wave vectors is used.
  double const vectors = 0.5 * std::numbers::pi * largest * largest * box.area() / (two_pi * two_pi);
  if (vectors > max_vectors) {
    refuse(
        fmt::format("{:.3g} wave vectors are shorter than {:.6g}; the most is {:.0g}", vectors, largest, max_vectors),
        "use a smaller largest wave number");
  }
}

}  // namespace

SpectralDensity find_spectral_density(Box const& box, PointsInMemory const& points, std::span<double const> radii,
                                      double largest_wave_number, std::size_t bins, std::uint64_t threads) {
  require_points_in_memory(points);
  require_box_for(box, 0.0);
  require_spectrum(box, points, radii, largest_wave_number, bins);
  SortedDisks const disks(points, radii);
  // A factor above 1 keeps rounding from excluding the vectors at the end of the last ring.
  double const largest = largest_wave_number * (1.0 + 1e-12);
  std::vector<Column> columns(static_cast<std::size_t>(largest * box.width() / two_pi) + 1);
  ThreadPool pool(threads);
  pool.for_each(columns.size(), [&](std::size_t column) {
    columns[column] = powers_of_column(box, disks, static_cast<std::int64_t>(column), largest);
  });
  std::vector<std::uint64_t> counts(bins);
  std::vector<double> lengths(bins), powers(bins);
  for (Column const& column : columns) {
    for (std::size_t k = 0; k < column.lengths.size(); ++k) {
      auto const ring = static_cast<std::size_t>(column.lengths[k] / largest_wave_number * static_cast<double>(bins));
      std::size_t const bin = std::min(ring, bins - 1);
      ++counts[bin];
      lengths[bin] += column.lengths[k];
      powers[bin] += column.powers[k];
    }
  }
  SpectralDensity found;
  for (std::size_t bin = 0; bin < bins; ++bin) {
    if (counts[bin] == 0) continue;
    auto const count = static_cast<double>(counts[bin]);
    found.wave_number.push_back(lengths[bin] / count);
    found.density.push_back(powers[bin] / count / box.area());
    found.vectors.push_back(counts[bin]);
  }
  return found;
}

}  // namespace gridlock
