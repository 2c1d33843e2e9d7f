#pragma once

#include <optional>
#include <span>

namespace gridlock {

/// A reason to doubt the standard error of a mean over a series; one of the two numbers is set.
struct Doubt {
  /// The mean of the later half of the samples left out minus the mean, in standard errors of this difference.
  std::optional<double> differs_by = {};
  /// The number of times that the slowest change was seen: the number of independent blocks that 32 blocks are worth.
  std::optional<double> times_seen = {};
};

/// Returns a reason to doubt that the mean of a series is right within the scatter of its blocks, if there is one.
///
/// `kept` are the samples of the mean, `left_out` the samples before it. Three checks are made, with x_b the means of
/// 32 blocks of `kept`, x their mean and d_b = x_b − x:
///
///     the later half of `left_out` differs from x by over 4 s √(1/n_left_out + 1/n_kept), s² = n_kept Σ d_b²/(32·31)
///     neighbouring blocks are correlated: ρ = Σ d_b d_b+1 / Σ d_b² > 1/2; seen 32 (1 − ρ)/(1 + ρ) times
///     few blocks cause the scatter, as rare events do: seen (Σ d_b²)²/Σ d_b⁴ < 4 times; independent blocks give 11
///
/// The earlier half of `left_out` is not checked, because a start may differ from all that follows. A series without
/// correlations is doubted in less than one of 500 cases, one correlated over a tenth of a block in one of 300. Fewer
/// than 64 samples are never doubted. s gives the error of estimate_from() for samples of equal weight.
std::optional<Doubt> find_doubt(std::span<double const> left_out, std::span<double const> kept);

}  // namespace gridlock
