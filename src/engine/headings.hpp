#pragma once

#include <Random123/philox.h>

#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>

#include "core/on_device.hpp"
#include "engine/turn.hpp"
#include "gridlock/core/population.hpp"
#include "gridlock/core/vector.hpp"
#include "gridlock/engine/propulsion.hpp"

namespace gridlock {

/// How the headings of self-propelled disks turn in the engines with a time step, where the velocity of a disk is its
/// speed times its heading.
struct HeadingRule {
  double speed = 0.0;  ///< 0: disks do not propel themselves
  double width = 0.0;  ///< √(2 D_R Δt): standard deviation of the turn in a time step, in radians
  std::uint64_t seed = 0;

  [[nodiscard]] bool is_on() const { return speed > 0.0; }
};
HeadingRule heading_rule(PropulsionSettings const& settings, double duration, std::uint64_t seed);

/// The numbers of a step that its turns have in common.
HeadingStep heading_step(HeadingRule const& rule, std::uint64_t step);

namespace detail {

/// Constants of heading_noise() and heading_turn(), for all their kernels. Graphics processors know no static arrays.
struct HeadingSeries {
  static constexpr int rounds = 10;
  static constexpr std::uint32_t multiplier = 0xd256d193U;  ///< of Philox-2x32
  static constexpr std::uint32_t key_step = 0x9e3779b9U;
  /// ln m = 2 s (1 + z/3 + z²/5 …), s = (m − 1)/(m + 1), z = s², for m between √½ and √2: what is left out is below
  /// 2e-9.
  static constexpr std::array<float, 5> logarithm() {
    return {1.0F / 9.0F, 1.0F / 7.0F, 1.0F / 5.0F, 1.0F / 3.0F, 1.0F};
  }
  /// sin x = x (1 − z/3! + z²/5! …), z = x², |x| ≤ π/2: what is left out is below 1e-9.
  static constexpr std::array<float, 7> sine() {
    return {1.0F / 6227020800.0F,
            -1.0F / 39916800.0F,
            1.0F / 362880.0F,
            -1.0F / 5040.0F,
            1.0F / 120.0F,
            -1.0F / 6.0F,
            1.0F};
  }
  /// The same up to |x| = π/4, and cos x = 1 − z/2! + z²/4! …
  static constexpr std::array<float, 5> sine_near_zero() {
    return {1.0F / 362880.0F, -1.0F / 5040.0F, 1.0F / 120.0F, -1.0F / 6.0F, 1.0F};
  }
  static constexpr std::array<float, 6> cosine_near_zero() {
    return {-1.0F / 3628800.0F, 1.0F / 40320.0F, -1.0F / 720.0F, 1.0F / 24.0F, -0.5F, 1.0F};
  }
  static constexpr float ln_2 = 0.69314718056F;
  static constexpr std::uint32_t bits_of_root_half = 0x3f3504f3U;
  static constexpr float two_to_minus_31 = 0x1p-31F;
  static constexpr float pi_by_two_to_32 = 3.14159265359F * 0x1p-32F;
  static constexpr float quarters_per_radian = 0.636619772368F;
  static constexpr float quarter_high = 1.5703125F;  ///< π/2 in two parts; the first has few bits
  static constexpr float quarter_low = 4.83826794897e-4F;
  static constexpr float large = 0x1.8p23F;  ///< a sum with it has no bits for a fraction
};

template <std::size_t count>
constexpr float series(std::array<float, count> const& coefficients, float z) {
  float sum = coefficients[0];
  for (std::size_t k = 1; k < count; ++k) sum = sum * z + coefficients[k];
  return sum;
}

/// Returns ln u for 0 < u ≤ 1.
constexpr float logarithm(float u) {
  // u = m / 2^k, where k is the whole part of a difference of bits that is rounded up.
  auto const bits = std::bit_cast<std::uint32_t>(u);
  std::uint32_t const k = (HeadingSeries::bits_of_root_half + ((1U << 23U) - 1U) - bits) >> 23U;
  auto const m = std::bit_cast<float>(bits + (k << 23U));
  float const s = (m - 1.0F) / (m + 1.0F);
  return 2.0F * s * series(HeadingSeries::logarithm(), s * s) - static_cast<float>(k) * HeadingSeries::ln_2;
}

}  // namespace detail

/// A standard normal number, a function of the seed, the step and the disk: the turn of a heading in units of its
/// width.
///
/// One block of Philox-2x32-10 (Salmon et al. 2011, doi:10.1145/2063384.2063405), whose key is drawn for each step,
/// gives two uniform numbers, and these one normal number by the transformation of Box and Muller (1958,
/// doi:10.1214/aoms/1177706645), in single precision. Logarithm and sine are series, so that every compiler and
/// processor gives the same bits.
GRIDLOCK_ON_DEVICE inline float heading_noise(HeadingStep const& step, std::uint32_t id_index) {
  using Series = detail::HeadingSeries;
  r123::Philox2x32_R<Series::rounds> const philox;
  auto const word = philox({{id_index, step.word}}, {{step.key}});
  // 31 bits, of which the last is set, so that u is not 0.
  float const u = static_cast<float>(static_cast<std::int32_t>(word[0] >> 1U | 1U)) * Series::two_to_minus_31;
  float const x = static_cast<float>(static_cast<std::int32_t>(word[1])) * Series::pi_by_two_to_32;
  return std::sqrt(std::abs(2.0F * detail::logarithm(u))) * (x * detail::series(Series::sine(), x * x));
}

/// Returns (cos, sin) of a turn in single precision.
struct HeadingTurn {
  float cosine;
  float sine;
};
constexpr HeadingTurn heading_turn(float angle) {
  using Series = detail::HeadingSeries;
  float const shifted = angle * Series::quarters_per_radian + Series::large;
  float const quarters = shifted - Series::large;
  float const x = (angle - quarters * Series::quarter_high) - quarters * Series::quarter_low;
  float const z = x * x;
  float const c = detail::series(Series::cosine_near_zero(), z);
  float const s = x * detail::series(Series::sine_near_zero(), z);
  // The last two bits are the quarter.
  return detail::turned_by_quarters<HeadingTurn>(c, s, std::bit_cast<std::uint32_t>(shifted));
}

/// Returns this velocity turned by the heading noise of a step. Its length stays that of the rule: an error of the
/// length, as rounding makes it, is squared away.
GRIDLOCK_ON_DEVICE inline Vector turned_velocity(HeadingStep const& step, std::uint32_t id_index, Vector velocity) {
  HeadingTurn const turn = heading_turn(step.width * heading_noise(step, id_index));
  Vector const turned = rotated(velocity, {turn.cosine, turn.sine});
  return (1.5 - 0.5 * (squared_length(turned) * step.inverse_square)) * turned;
}

/// Gives each disk the speed of the rule, along its velocity; a disk at rest gets a random heading. Disks that have
/// this speed stay as they are.
void set_speeds(HeadingRule const& rule, std::span<DiskInTurn> disks);

/// The vector of length 1 along `v`; (0, 0) for (0, 0).
Vector direction_of(Vector v);

/// The heading of a disk at the start: along its velocity, random for a disk at rest.
Vector first_heading(std::uint64_t seed, Id id, Vector velocity);

}  // namespace gridlock
