#include "engine/headings.hpp"

#include <cmath>

#include "gridlock/core/random.hpp"

namespace gridlock {

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
