#pragma once

#include <optional>
#include <span>

namespace gridlock {

/// The reason why the error of a mean over a series is not to be trusted: one of the two.
struct Doubt {
  /// The mean of the later half of what was left out of the mean, less the mean, in standard errors of such a
  /// difference.
  std::optional<double> differs_by = {};
  /// How often the slowest change was seen: 32 blocks of the series are worth so many independent ones.
  std::optional<double> times_seen = {};
};

/// Whether a series lets its mean be trusted to within the scatter of its blocks; nothing where nothing speaks against
/// it.
///
/// `kept` is what the mean is of, `left_out` the samples before it, which averages leave out. Three looks, with x_b the means of 32 blocks
/// of `kept`, x their mean and d_b = x_b − x:
///
///     the later half of `left_out` differs from x by more than 4 errors √(1/n_left_out + 1/n_kept) s, s² = n_kept Σ d_b²/(32·31)
///     neighbouring blocks remember each other: ρ = Σ d_b d_b+1 / Σ d_b² > 1/2;  seen 32 (1 − ρ)/(1 + ρ) times
///     few blocks make up all the scatter, as rare events do: (Σ d_b²)²/Σ d_b⁴ < 4, where independent ones have about 11;  seen so often
///
/// The earlier half of what is left out is not looked at: a start may differ from all that follows. A series without
/// memory is accused in less than one of 500 cases, one with a memory of a tenth of a block in one of 300. Fewer than
/// 64 samples say nothing: no doubt. The error that s gives is that of estimate_from() for samples of one weight.
std::optional<Doubt> find_doubt(std::span<double const> left_out, std::span<double const> kept);

}  // namespace gridlock
