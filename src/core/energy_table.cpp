#include "core/energy_table.hpp"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <string>
#include <string_view>

#include "core/magnitude.hpp"
#include "gridlock/core/error.hpp"

namespace gridlock {

namespace {

constexpr std::size_t min_rows = 4;
/// Nearer rows have slopes made of rounding errors.
constexpr double min_spacing = 1e-6;
constexpr double max_cutoff = 100.0;
/// Between a long and a short spacing a spline swings; a row is missing, or a point is misplaced.
constexpr double max_ratio = 10.0;

/// Returns the derivative at the first of four points of the cubic through them.
double slope_of_cubic(std::span<double const> x, std::span<double const> y) {
  auto const divided = [&](double left, double right, std::size_t from, std::size_t to) {
    return (right - left) / (x[to] - x[from]);
  };
  double const a = divided(y[0], y[1], 0, 1);
  double const b = divided(y[1], y[2], 1, 2);
  double const c = divided(y[2], y[3], 2, 3);
  double const ab = divided(a, b, 0, 2);
  double const abc = divided(ab, divided(b, c, 1, 3), 0, 3);
  return a + (x[0] - x[1]) * (ab + (x[0] - x[2]) * abc);
}

/// Returns the slopes of the spline at all points: the second derivative is continuous between the two ends.
std::vector<double> slopes_of_spline(std::span<double const> x, std::span<double const> y) {
  std::size_t const last = x.size() - 1;
  std::vector<double> slope(x.size(), 0.0);
  slope[0] = slope_of_cubic(x, y);
  std::vector<double> factor(x.size(), 0.0);
  for (std::size_t k = 1; k < last; ++k) {
    double const before = x[k] - x[k - 1];
    double const after = x[k + 1] - x[k];
    double const right = 3.0 * (after * (y[k] - y[k - 1]) / before + before * (y[k + 1] - y[k]) / after);
    double const pivot = 2.0 * (before + after) - after * factor[k - 1];
    factor[k] = before / pivot;
    slope[k] = (right - after * slope[k - 1]) / pivot;
  }
  for (std::size_t k = last - 1; k > 0; --k) slope[k] = slope[k] - factor[k] * slope[k + 1];
  return slope;
}

[[noreturn]] void refuse_table(std::string what, std::string hint, std::string key) {
  throw Error({.what = std::move(what), .hint = std::move(hint), .key = std::move(key)});
}

/// Returns the key of an entry, counted from 0: "potential.distances[2]".
std::string entry(std::string_view key, std::size_t row) { return fmt::format("{}[{}]", key, row); }

void require_numbers(std::span<double const> values, double most, std::string_view name, char const* key) {
  for (std::size_t k = 0; k < values.size(); ++k) {
    if (std::isfinite(values[k]) && std::abs(values[k]) <= most) continue;
    refuse_table(
        fmt::format("row {} of the table of the potential has the {} {}, out of bounds", k + 1, name, values[k]),
        fmt::format("give numbers up to {:g}", most), entry(key, k));
  }
}

void require_increase(std::span<double const> distances) {
  for (std::size_t k = 1; k < distances.size(); ++k) {
    if (distances[k] - distances[k - 1] >= min_spacing) continue;
    refuse_table(fmt::format("the distances of the table of the potential do not increase: row {} has {}, and row {} "
                             "after it {}",
                             k, distances[k - 1], k + 1, distances[k]),
                 fmt::format("sort the rows; each distance is at least {:g} above the one before", min_spacing),
                 entry("potential.distances", k));
  }
}

void require_no_gap(std::span<double const> x) {
  for (std::size_t k = 1; k + 1 < x.size(); ++k) {
    double const before = x[k] - x[k - 1];
    double const after = x[k + 1] - x[k];
    if (std::max(before, after) <= max_ratio * std::min(before, after)) continue;
    refuse_table(fmt::format("the table of the potential has a gap at row {}: the distances before and after {} are "
                             "{:.6g} and {:.6g} away, and one of them is more than {:g} times the other",
                             k + 1, x[k], before, after, max_ratio),
                 "give rows between, so that the spacing changes step by step", entry("potential.distances", k));
  }
}

}  // namespace

EnergyTable::EnergyTable(std::span<double const> distances, std::span<double const> energies) {
  std::vector<double> const slopes = slopes_of_spline(distances, energies);
  double shortest = distances[1] - distances[0];
  for (std::size_t k = 0; k + 1 < distances.size(); ++k) {
    double const h = distances[k + 1] - distances[k];
    double const mean = (energies[k + 1] - energies[k]) / h;
    pieces_.push_back({.from = distances[k],
                       .energy = energies[k] - energies.back(),
                       .slope = slopes[k],
                       .square = (3.0 * mean - 2.0 * slopes[k] - slopes[k + 1]) / h,
                       .cube = (slopes[k] + slopes[k + 1] - 2.0 * mean) / (h * h)});
    shortest = std::min(shortest, h);
  }
  pieces_.push_back({.from = std::numeric_limits<double>::infinity(), .energy = 0, .slope = 0, .square = 0, .cube = 0});
  // A bin as narrow as the shortest piece has the beginning of at most one; more bins than a few a piece are not worth
  // their memory.
  constexpr double max_bins_per_piece = 16.0;
  double const range = distances.back() - distances.front();
  double const bins = std::min(std::ceil(range / shortest), max_bins_per_piece * static_cast<double>(pieces_.size()));
  first_piece_.assign(static_cast<std::size_t>(bins), 0);
  bins_per_distance_ = bins / range;
  distance_at_end_ = distances.back();
  // A piece that begins in an earlier bin begins before all distances of this bin, since bin_of() never falls.
  std::size_t bin = 0;
  for (std::size_t k = 0; k + 1 < pieces_.size(); ++k) {
    bool const is_last = k + 2 == pieces_.size();
    std::size_t const end = is_last ? first_piece_.size() : bin_of(pieces_[k + 1].from) + 1;
    for (; bin < end; ++bin) first_piece_[bin] = static_cast<std::uint32_t>(k);
  }
}

double EnergyTable::largest_push() const {
  double largest = 0.0;
  for (Piece const& piece : pieces_) largest = std::max(largest, std::abs(piece.slope) / piece.from);
  return largest;
}

void EnergyTable::require_no_swing() const {
  constexpr double max_share = 0.01;            // of the range of the rows around
  std::size_t const last = pieces_.size() - 2;  // the last piece
  auto const row = [&](std::size_t k) { return k > last ? 0.0 : pieces_[k].energy; };
  for (std::size_t k = 0; k <= last; ++k) {
    std::size_t const first = k == 0 ? 0 : k - 1;
    std::size_t const end = std::min(k + 2, last + 1);
    bool rises = true;
    bool falls = true;
    for (std::size_t m = first; m < end; ++m) {
      rises &= row(m + 1) >= row(m);
      falls &= row(m + 1) <= row(m);
    }
    if (!rises && !falls) continue;  // next to a minimum or a maximum of the rows a spline may pass them
    auto const [low, high] = std::minmax({row(k), row(k + 1)});
    // The slope is a parabola, a + b t + c t²; where it vanishes within the piece the spline turns back.
    Piece const& piece = pieces_[k];
    double const root = piece.square * piece.square - 3.0 * piece.cube * piece.slope;
    if (!(root > 0.0)) continue;
    for (double const sign : {-1.0, 1.0}) {
      double const t = -piece.slope / (piece.square + sign * std::sqrt(root));
      double const length = k == last ? distance_at_end_ - piece.from : pieces_[k + 1].from - piece.from;
      if (!(t > 0.0 && t < length)) continue;
      double const reached = piece.energy + t * (piece.slope + t * (piece.square + t * piece.cube));
      double const beyond = std::max(low - reached, reached - high);
      if (beyond <= max_share * std::abs(row(end) - row(first))) continue;
      refuse_table(
          fmt::format("the spline through the table of the potential turns back between the distances {:.6g} and "
                      "{:.6g}, whose energies are {:.6g} and {:.6g} above that of the last row: it reaches {:.3g}",
                      piece.from, piece.from + length, row(k), row(k + 1), reached),
          "give more rows there, or energies without a kink", entry("potential.energies", k));
    }
  }
}

void require_table(std::span<double const> distances, std::span<double const> energies) {
  if (distances.size() != energies.size()) {
    refuse_table(
        fmt::format("the table of the potential has {} distances and {} energies", distances.size(), energies.size()),
        "give an energy for each distance", "potential.energies");
  }
  if (distances.size() < min_rows) {
    refuse_table(fmt::format("the table of the potential has {} rows, and a spline needs at least {}", distances.size(),
                             min_rows),
                 "give potential.distances and potential.energies, as in distances = [0.9, 1.0, 1.1, 1.2]",
                 "potential.distances");
  }
  require_numbers(distances, max_cutoff, "distance", "potential.distances");
  require_numbers(energies, max_magnitude, "energy", "potential.energies");
  if (!(distances.front() > 0.0)) {
    refuse_table(fmt::format("the first distance of the table of the potential is {}, not above 0", distances.front()),
                 "begin at a small distance, such as 0.01", entry("potential.distances", 0));
  }
  require_increase(distances);
  require_no_gap(distances);
  if (distances.back() < 1.0) {
    refuse_table(fmt::format("the table of the potential ends at {}, below the contact distance 1", distances.back()),
                 "distances are in sums of two radii; choose larger radii",
                 entry("potential.distances", distances.size() - 1));
  }
  EnergyTable(distances, energies).require_no_swing();
}

}  // namespace gridlock
