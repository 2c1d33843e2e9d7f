#include "grid/division.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace gridlock {

namespace {

/// Returns where to cut a row of weights so that piece k has about shares[k] of their sum; the last entry is the end.
/// Each piece has at least one weight while there are enough.
std::vector<std::size_t> cuts(std::span<std::uint64_t const> weights, std::span<std::size_t const> shares) {
  std::size_t const pieces = shares.size();
  auto const sum = static_cast<double>(std::reduce(weights.begin(), weights.end()));
  auto const all_shares = static_cast<double>(std::reduce(shares.begin(), shares.end()));
  std::vector<std::size_t> at(pieces + 1, 0);
  at[pieces] = weights.size();
  double so_far = 0.0;
  std::size_t shares_so_far = 0;
  std::size_t n = 0;
  for (std::size_t k = 1; k < pieces; ++k) {
    shares_so_far += shares[k - 1];
    double const goal = sum * static_cast<double>(shares_so_far) / all_shares;
    // A weight belongs to the piece in which its middle lies.
    while (n < weights.size() && so_far + 0.5 * static_cast<double>(weights[n]) < goal) {
      so_far += static_cast<double>(weights[n++]);
    }
    std::size_t const left = pieces - k;
    std::size_t const most = weights.size() > left ? weights.size() - left : 0;
    at[k] =
        std::max(at[k - 1], std::clamp(n, std::min(k, weights.size()), std::max(most, std::min(k, weights.size()))));
    for (; n < at[k]; ++n) so_far += static_cast<double>(weights[n]);
  }
  return at;
}

}  // namespace

std::vector<Tiling::Rectangle> divide(std::span<std::uint64_t const> weights_of_rows, double shape, std::size_t parts,
                                      WeightsOfColumns const& weights_of_columns) {
  std::size_t const rows = weights_of_rows.size();
  auto const strips = static_cast<std::size_t>(std::clamp(std::round(std::sqrt(static_cast<double>(parts) * shape)),
                                                          1.0, static_cast<double>(std::min(parts, rows))));
  std::vector<std::size_t> parts_of_strip(strips);
  for (std::size_t k = 0; k < strips; ++k) parts_of_strip[k] = parts * (k + 1) / strips - parts * k / strips;
  std::vector<std::size_t> const row_cuts = cuts(weights_of_rows, parts_of_strip);
  std::vector<Tiling::Rectangle> rectangles;
  for (std::size_t strip = 0; strip < strips; ++strip) {
    std::vector<std::size_t> const ones(parts_of_strip[strip], 1);
    std::vector<std::size_t> const column_cuts = cuts(weights_of_columns(row_cuts[strip], row_cuts[strip + 1]), ones);
    for (std::size_t k = 0; k < ones.size(); ++k) {
      rectangles.push_back({.first_column = column_cuts[k],
                            .end_column = column_cuts[k + 1],
                            .first_row = row_cuts[strip],
                            .end_row = row_cuts[strip + 1]});
    }
  }
  return rectangles;
}

}  // namespace gridlock
