#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/exact/dynamics.hpp"
#include "gridlock/core/error.hpp"

namespace gridlock::exact {

namespace {

/// Events between two checks: many for each disk, a few tenths of a second of computing.
constexpr std::uint64_t min_events = std::uint64_t{1} << 20;
constexpr std::uint64_t events_per_disk = 16;

/// Free flights shorter than this count as none, in units of the last digit of a coordinate. Wedged disks fly for
/// hundredths of it; jammed ones for as much as growth.cpp leaves in a gap.
constexpr double digits_per_flight = 1.0;

constexpr char const* wedge =
    "it is in contact on all sides and cannot move\n  hint: give the disks more space, by a lower packing fraction or "
    "a larger box";
constexpr char const* collapse =
    "collisions that lose energy come without end, the inelastic collapse\n  hint: set collisions.contact_time, far "
    "shorter than the time between collisions, or a collisions.restitution nearer to 1";

}  // namespace

/// Throws RunFailure for a stall. Disks wedged between walls or in closed rows can collide infinitely often in finite
/// time (Zeno behaviour). A stall is a disk that moves by no more than the last digits of its coordinates between hits:
/// shorter flights cannot be computed. Hits of each disk are counted only once events as a whole come that fast.
void Dynamics::require_time_to_pass() {
  if (++watch_.looks * events_per_look < std::max<std::uint64_t>(min_events, events_per_disk * size_)) return;
  double const passed = watch_.passed + (now_ - watch_.now);
  double squared_speeds = 0.0;
  for (std::size_t i = 0; i < size_; ++i) {
    squared_speeds += disks_[i].velocity_x * disks_[i].velocity_x + disks_[i].velocity_y * disks_[i].velocity_y;
  }
  double const speed = std::sqrt(squared_speeds / static_cast<double>(size_));
  double const min_displacement =
      digits_per_flight * std::numeric_limits<double>::epsilon() * std::max(box_.width(), box_.height());
  if (!watch_.collision_counts.empty()) {
    std::uint32_t max_hits = 0;
    Index max_hit = 0;
    for (Index i = 0; i < size_; ++i) {
      std::uint32_t const hits = disks_[i].collision_count - watch_.collision_counts[disks_[i].id_index];
      if (hits > max_hits) {
        max_hits = hits;
        max_hit = i;
      }
    }
    auto const [x, y] = position_at(max_hit, now_);
    if (passed * speed < max_hits * min_displacement) {
      throw RunFailure(
          fmt::format("time {}: no time passes: disk {} at ({:.6g}, {:.6g}) was hit {} times in a time of "
                      "{:.3g}: {}",
                      last_event(), id_of(max_hit), x, y, max_hits, passed, losses_.exist ? collapse : wedge));
    }
  }
  bool const is_suspicious = passed * speed < static_cast<double>(watch_.looks * events_per_look) * min_displacement;
  watch_ = {.passed = 0.0, .now = now_, .looks = 0, .collision_counts = {}};
  if (!is_suspicious) return;
  watch_.collision_counts.resize(size_);
  for (Index i = 0; i < size_; ++i) watch_.collision_counts[disks_[i].id_index] = disks_[i].collision_count;
}

}  // namespace gridlock::exact
