#include "lattice/sizes.hpp"

#include <fmt/format.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <string_view>

#include "gridlock/core/error.hpp"

namespace gridlock {

namespace {

/// The normal distribution is cut off at this many standard deviations.
constexpr double cut = 3.0;
/// The standard deviation after the cut: √(1 − 2·3 φ(3)/(2 Φ(3) − 1)).
constexpr double deviation_after_cut = 0.98657839255810862;
/// The part of the distribution within the cut: 2 Φ(3) − 1.
constexpr double share_within_cut = 0.99730020393673981;

constexpr double default_spread = 0.23;  // Ninarello, Berthier, Coslovich 2017, doi:10.1103/PhysRevX.7.021039

/// Returns z = (σ_max − σ_min)/(σ_max + σ_min) of P(σ) ∝ σ⁻³: spread² = artanh(z)/z − 1 = z²/3 + z⁴/5 + …
double width_of_inverse_cube(double spread) {
  auto const squared_spread = [](double z) {
    double sum = 0.0;
    double power = z * z;
    for (double odd = 3.0; sum + power / odd > sum; odd += 2.0, power *= z * z) sum += power / odd;
    return sum;
  };
  double below = 0.0;
  double above = 0.999;
  for (int halvings = 0; halvings < 60; ++halvings) {
    double const middle = 0.5 * (below + above);
    (squared_spread(middle) < spread * spread ? below : above) = middle;
  }
  return below;
}

/// Returns x ≥ 0 such that a normal variable of variance 1 lies in [0, x] with probability p < ½. Newton's method from
/// 0 never passes x, since Φ is concave there; Φ and its derivative are computed from the power series of exp(−x²/2).
double normal_quantile(double p) {
  constexpr double normalization = 0.39894228040143267794;  // 1/√(2π)
  double x = 0.0;
  for (int steps = 0; steps < 50; ++steps) {
    double density = 0.0;
    double share = 0.0;
    double term = normalization;
    for (double k = 1.0; std::abs(term) > 1e-18; k += 1.0) {
      density += term;
      share += term * x / (2.0 * k - 1.0);
      term *= -x * x / (2.0 * k);
    }
    double const step = (p - share) / density;
    if (!(step > 1e-15)) break;
    x += step;
  }
  return x;
}

void require_spread(DisksSettings const& settings, double spread, double most, std::string_view name) {
  if (spread < most) return;
  throw Error({.what = fmt::format("{} sizes with a spread of {} would reach below 0", name, spread),
               .hint = fmt::format("use a disks.size_spread below {:.3f}{}", most - 0.0005,
                                   settings.sizes == SizeDistribution::normal ? ", or another disks.sizes" : ""),
               .key = "disks.size_spread"});
}

/// Returns the function that gives the diameter σ below which a given fraction of disks lies.
std::function<double(double)> quantile_function(DisksSettings const& settings) {
  double const spread = settings.size_spread.value_or(default_spread);
  if (settings.sizes == SizeDistribution::uniform) {
    require_spread(settings, spread, 1.0 / std::numbers::sqrt3, "uniform");
    return [width = std::sqrt(3.0) * spread](double u) { return 1.0 + width * (2.0 * u - 1.0); };
  }
  if (settings.sizes == SizeDistribution::normal) {
    require_spread(settings, spread, deviation_after_cut / cut, "normal");
    return [scale = spread / deviation_after_cut](double u) {
      double const x = normal_quantile(std::abs(u - 0.5) * share_within_cut);
      return 1.0 + scale * (u < 0.5 ? -x : x);
    };
  }
  double const z = width_of_inverse_cube(spread);
  double const smallest_over_largest = (1.0 - z) / (1.0 + z);
  return [range = 1.0 - smallest_over_largest * smallest_over_largest](double u) {
    return 1.0 / std::sqrt(1.0 - u * range);
  };
}

}  // namespace

std::vector<double> sizes_in_order(DisksSettings const& settings, std::uint64_t count) {
  std::function<double(double)> const quantile = quantile_function(settings);
  std::vector<double> sizes(count);
  double sum = 0.0;
  for (std::uint64_t k = 0; k < count; ++k) {
    sizes[k] = quantile((static_cast<double>(k) + 0.5) / static_cast<double>(count));
    sum += sizes[k];
  }
  double const scale = static_cast<double>(count) / sum;
  for (double& size : sizes) size *= scale;
  return sizes;
}

}  // namespace gridlock
