#pragma once

#include <cstdint>
#include <span>

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

/// A standard normal number, a function of the seed, the step and the disk: the turn of a heading in units of its
/// width.
///
/// One block of Philox-2x32-10 (Salmon et al. 2011, doi:10.1145/2063384.2063405), whose key is drawn for each step,
/// gives two uniform numbers, and these one normal number by the transformation of Box and Muller (1958,
/// doi:10.1214/aoms/1177706645), in single precision. Logarithm and sine are series, so that every compiler and
/// processor gives the same bits.
float heading_noise(HeadingStep const& step, std::uint32_t id_index);

/// Returns (cos, sin) of a turn in single precision.
struct HeadingTurn {
  float cosine;
  float sine;
};
HeadingTurn heading_turn(float angle);

/// Returns this velocity turned by the heading noise of a step. Its length stays that of the rule: an error of the
/// length, as rounding makes it, is squared away.
Vector turned_velocity(HeadingStep const& step, std::uint32_t id_index, Vector velocity);

/// Gives each disk the speed of the rule, along its velocity; a disk at rest gets a random heading. Disks that have
/// this speed stay as they are.
void set_speeds(HeadingRule const& rule, std::span<DiskInTurn> disks);

/// The vector of length 1 along `v`; (0, 0) for (0, 0).
Vector direction_of(Vector v);

/// The heading of a disk at the start: along its velocity, random for a disk at rest.
Vector first_heading(std::uint64_t seed, Id id, Vector velocity);

namespace detail {

/// Constants of heading_noise() and heading_turn(), for all their kernels.
struct HeadingSeries {
  static constexpr int rounds = 10;
  static constexpr std::uint32_t multiplier = 0xd256d193U;  ///< of Philox-2x32
  static constexpr std::uint32_t key_step = 0x9e3779b9U;
  /// ln m = 2 s (1 + z/3 + z²/5 …), s = (m − 1)/(m + 1), z = s², for m between √½ and √2: what is left out is below
  /// 2e-9.
  static constexpr float logarithm[] = {1.0F / 9.0F, 1.0F / 7.0F, 1.0F / 5.0F, 1.0F / 3.0F, 1.0F};
  /// sin x = x (1 − z/3! + z²/5! …), z = x², |x| ≤ π/2: what is left out is below 1e-9.
  static constexpr float sine[] = {
      1.0F / 6227020800.0F, -1.0F / 39916800.0F, 1.0F / 362880.0F, -1.0F / 5040.0F, 1.0F / 120.0F, -1.0F / 6.0F, 1.0F};
  /// The same up to |x| = π/4, and cos x = 1 − z/2! + z²/4! …
  static constexpr float sine_near_zero[] = {1.0F / 362880.0F, -1.0F / 5040.0F, 1.0F / 120.0F, -1.0F / 6.0F, 1.0F};
  static constexpr float cosine_near_zero[] = {-1.0F / 3628800.0F, 1.0F / 40320.0F, -1.0F / 720.0F,
                                               1.0F / 24.0F,       -0.5F,           1.0F};
  static constexpr float ln_2 = 0.69314718056F;
  static constexpr std::uint32_t bits_of_root_half = 0x3f3504f3U;
  static constexpr float two_to_minus_31 = 0x1p-31F;
  static constexpr float pi_by_two_to_32 = 3.14159265359F * 0x1p-32F;
  static constexpr float quarters_per_radian = 0.636619772368F;
  static constexpr float quarter_high = 1.5703125F;  ///< π/2 in two parts; the first has few bits
  static constexpr float quarter_low = 4.83826794897e-4F;
  static constexpr float large = 0x1.8p23F;  ///< a sum with it has no bits for a fraction
};

}  // namespace detail

}  // namespace gridlock
