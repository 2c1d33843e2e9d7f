#include "observe/doubt.hpp"

#include <array>
#include <cmath>
#include <cstddef>
#include <numeric>

namespace gridlock {

namespace {

constexpr std::size_t blocks = 32;
constexpr double max_errors = 4.0;
constexpr double max_correlation = 0.5;
constexpr double min_blocks_that_scatter = 4.0;

double mean_of(std::span<double const> values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

/// Returns the means of the blocks minus the mean of all.
std::array<double, blocks> deviations_of(std::span<double const> series) {
  std::size_t const size = series.size() / blocks;
  std::array<double, blocks> deviations{};
  for (std::size_t b = 0; b < blocks; ++b) deviations[b] = mean_of(series.subspan(b * size, size));
  double const mean = mean_of(deviations);
  for (double& deviation : deviations) deviation -= mean;
  return deviations;
}

}  // namespace

std::optional<Doubt> find_doubt(std::span<double const> left_out, std::span<double const> kept) {
  if (kept.size() < 2 * blocks) return std::nullopt;
  // Blocks are equally long. Samples left over are dropped at the start, where they matter least.
  std::array<double, blocks> const deviations = deviations_of(kept.subspan(kept.size() % blocks));
  double squares = 0.0;
  double fourth_powers = 0.0;
  double neighbours = 0.0;
  for (std::size_t b = 0; b < blocks; ++b) {
    double const square = deviations[b] * deviations[b];
    squares += square;
    fourth_powers += square * square;
    if (b > 0) neighbours += deviations[b] * deviations[b - 1];
  }
  double const mean = mean_of(kept);
  // A series that is constant up to rounding gives no doubt.
  double const error = std::sqrt(squares / static_cast<double>(blocks * (blocks - 1)));
  if (!(error > 1e-13 * std::abs(mean))) return std::nullopt;
  std::span<double const> const late = left_out.subspan(left_out.size() / 2);
  if (late.size() >= 2) {
    double const ratio = static_cast<double>(kept.size()) / static_cast<double>(late.size());
    double const differs_by = (mean_of(late) - mean) / (error * std::sqrt(1.0 + ratio));
    if (std::abs(differs_by) > max_errors) return Doubt{.differs_by = std::abs(differs_by)};
  }
  double const correlation = neighbours / squares;
  if (correlation > max_correlation)
    return Doubt{.times_seen = static_cast<double>(blocks) * (1.0 - correlation) / (1.0 + correlation)};
  double const scattering = squares * squares / fourth_powers;
  if (scattering < min_blocks_that_scatter) return Doubt{.times_seen = scattering};
  return std::nullopt;
}

}  // namespace gridlock
