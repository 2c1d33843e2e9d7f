#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

namespace gridlock {

/// A cubic spline through energies that are given at some distances, with a continuous second derivative.
///
/// At the last distance the energy is shifted to 0 and the slope is 0, so that a force ends there without a step. At
/// the first distance the slope is that of the cubic through the first four rows. Energies then have errors of the
/// fourth order of the spacing, as splines with exact slopes at their ends have (Hall and Meyer 1976,
/// doi:10.1016/0021-9045(76)90040-X), if the true slope at the last distance is 0.
class EnergyTable {
 public:
  EnergyTable() = default;
  /// Contract: require_table() accepts the rows.
  EnergyTable(std::span<double const> distances, std::span<double const> energies);

  [[nodiscard]] double first_distance() const { return pieces_.front().from; }
  /// Returns the energy. Contract: the distance is neither below the first nor above the last.
  [[nodiscard]] double energy(double distance) const {
    Piece const& piece = piece_at(distance);
    double const t = distance - piece.from;
    return piece.energy + t * (piece.slope + t * (piece.square + t * piece.cube));
  }
  /// Returns the derivative of the energy. Contract: as of energy().
  [[nodiscard]] double slope(double distance) const {
    Piece const& piece = piece_at(distance);
    double const t = distance - piece.from;
    return piece.slope + t * (2.0 * piece.square + 3.0 * piece.cube * t);
  }
  /// Returns −(dV/dr)/r of disks at the squared distance r² whose contact distance is σ, for an energy of 1; infinite
  /// below the first distance. Contract: r is below the cutoff.
  [[nodiscard]] double push(double square, double sigma) const {
    double const r = std::sqrt(square);
    double const distance = r / sigma;
    if (distance < first_distance()) [[unlikely]]
      return std::numeric_limits<double>::infinity();
    return -slope(distance) / (sigma * r);
  }
  /// Returns the largest size of the slope over the distance at the rows.
  [[nodiscard]] double largest_push() const;
  /// Throws Error where rows rise or fall, and the spline turns back between two of them by more than a hundredth of
  /// the energies around: it has a well or a hill that the rows do not have.
  void require_no_swing() const;

 private:
  /// A polynomial of the distance from `from`, up to where the next piece begins.
  struct Piece {
    double from;
    double energy;
    double slope;
    double square;
    double cube;
  };

  /// Returns the number of the bin of a distance, which grows with the distance.
  [[nodiscard]] std::size_t bin_of(double distance) const {
    auto const bin = static_cast<std::int64_t>((distance - pieces_.front().from) * bins_per_distance_);
    return std::min(static_cast<std::size_t>(bin), first_piece_.size() - 1);
  }
  [[nodiscard]] Piece const& piece_at(double distance) const {
    std::size_t k = first_piece_[bin_of(distance)];
    // A sum instead of a branch, which nobody could predict; mostly no bin has more than one beginning.
    k += static_cast<std::size_t>(distance >= pieces_[k + 1].from);
    while (distance >= pieces_[k + 1].from) [[unlikely]]++ k;
    return pieces_[k];
  }

  std::vector<Piece> pieces_;               ///< and one more at infinity
  std::vector<std::uint32_t> first_piece_;  ///< of each bin: a piece that no distance in the bin lies before
  double bins_per_distance_ = 0.0;
  double distance_at_end_ = 0.0;
};

/// Errors: Error for rows of which no spline can be made, or one that turns back between them. The key is
/// potential.distances or potential.energies, with the number of a wrong row from 0: "potential.distances[2]".
void require_table(std::span<double const> distances, std::span<double const> energies);

}  // namespace gridlock
