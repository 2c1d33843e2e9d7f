#include "engine/headings.hpp"

#include <Random123/philox.h>

#include <bit>
#include <cmath>

#include "gridlock/core/random.hpp"

namespace gridlock {

namespace {

using Series = detail::HeadingSeries;

template <std::size_t count>
float series(float const (&coefficients)[count], float z) {
  float sum = coefficients[0];
  for (std::size_t k = 1; k < count; ++k) sum = sum * z + coefficients[k];
  return sum;
}

/// Returns ln u for 0 < u ≤ 1.
float logarithm(float u) {
  // u = m / 2^k, where k is the whole part of a difference of bits that is rounded up.
  auto const bits = std::bit_cast<std::uint32_t>(u);
  std::uint32_t const k = (Series::bits_of_root_half + ((1U << 23U) - 1U) - bits) >> 23U;
  auto const m = std::bit_cast<float>(bits + (k << 23U));
  float const s = (m - 1.0F) / (m + 1.0F);
  return 2.0F * s * series(Series::logarithm, s * s) - static_cast<float>(k) * Series::ln_2;
}

}  // namespace

HeadingRule heading_rule(PropulsionSettings const& settings, double duration, std::uint64_t seed) {
  // Headings that turn by more than this in a step are uniform to all digits.
  constexpr double max_width = 64.0;
  return {.speed = settings.speed, .width = std::fmin(turn_width(settings, duration), max_width), .seed = seed};
}

HeadingStep heading_step(HeadingRule const& rule, std::uint64_t step) {
  // The stream of no disk.
  std::uint64_t const bits = RandomStream(rule.seed, step, ~Id{0}, Purpose::heading).bits();
  return {.key = static_cast<std::uint32_t>(bits),
          .word = static_cast<std::uint32_t>(bits >> 32U),
          .width = static_cast<float>(rule.width),
          .inverse_square = 1.0 / (rule.speed * rule.speed)};
}

float heading_noise(HeadingStep const& step, std::uint32_t id_index) {
  r123::Philox2x32_R<Series::rounds> const philox;
  auto const word = philox({{id_index, step.word}}, {{step.key}});
  // 31 bits, of which the last is set, so that u is not 0.
  float const u = static_cast<float>(static_cast<std::int32_t>(word[0] >> 1U | 1U)) * Series::two_to_minus_31;
  float const x = static_cast<float>(static_cast<std::int32_t>(word[1])) * Series::pi_by_two_to_32;
  return std::sqrt(std::abs(2.0F * logarithm(u))) * (x * series(Series::sine, x * x));
}

HeadingTurn heading_turn(float angle) {
  float const shifted = angle * Series::quarters_per_radian + Series::large;
  float const quarters = shifted - Series::large;
  float const x = (angle - quarters * Series::quarter_high) - quarters * Series::quarter_low;
  float const z = x * x;
  float const c = series(Series::cosine_near_zero, z);
  float const s = x * series(Series::sine_near_zero, z);
  // The last two bits are the quarter.
  switch (std::bit_cast<std::uint32_t>(shifted) & 3U) {
    case 0:
      return {c, s};
    case 1:
      return {-s, c};
    case 2:
      return {-c, -s};
    default:
      return {s, -c};
  }
}

Vector turned_velocity(HeadingStep const& step, std::uint32_t id_index, Vector velocity) {
  HeadingTurn const turn = heading_turn(step.width * heading_noise(step, id_index));
  Vector const turned = rotated(velocity, {turn.cosine, turn.sine});
  return (1.5 - 0.5 * (squared_length(turned) * step.inverse_square)) * turned;
}

Vector direction_of(Vector v) {
  // Divided by the larger part first, so that no square overflows or vanishes.
  double const larger = std::fmax(std::abs(v.x), std::abs(v.y));
  if (larger == 0.0) return {};
  Vector const scaled{v.x / larger, v.y / larger};
  double const length = std::sqrt(squared_length(scaled));
  return {scaled.x / length, scaled.y / length};
}

Vector first_heading(std::uint64_t seed, Id id, Vector velocity) {
  Vector heading = direction_of(velocity);
  RandomStream random(seed, 0, id, Purpose::heading);
  while (heading == Vector{}) heading = direction_of(random.in_unit_disk());
  return heading;
}

void set_speeds(HeadingRule const& rule, std::span<DiskInTurn> disks) {
  if (!rule.is_on()) return;
  double const square = rule.speed * rule.speed;
  for (DiskInTurn& disk : disks) {
    if (std::abs(squared_length(disk.velocity) - square) <= 1e-12 * square) continue;
    disk.velocity = rule.speed * first_heading(rule.seed, disk.id_index, disk.velocity);
  }
}

}  // namespace gridlock
