#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "engine/exact/dynamics.hpp"
#include "gridlock/core/error.hpp"

namespace gridlock::exact {

namespace {

/// Largest overlap of two disks that counts as rounding, in diameters.
constexpr double tolerance = 1e-12;
/// Largest number of disks for which an audit looks at all pairs.
constexpr std::size_t max_disks_for_all_pairs = 2000;

/// The vector between the centres of a pair as a function of time in the epoch, without periodic images.
struct RelativeFlight {
  Vector separation;
  Vector velocity;

  [[nodiscard]] Vector at(double time) const { return separation + time * velocity; }
  /// The time between `now` and `end` at which squared distance minus squared contact distance is least.
  [[nodiscard]] double nearest(Vector image, double sum, Scale const& scale, double now, double end) const {
    double const growth = sum * scale.rate;
    double const a = squared_length(velocity) - growth * growth;
    double const b = dot(separation + image, velocity) - growth * sum * scale.at(0.0);
    if (a > 0.0) return std::clamp(-b / a, now, end);
    return std::isfinite(end) && a < 0.0 ? end : now;
  }
};

RelativeFlight flight(MovingDisk const& a, MovingDisk const& b) {
  return {{b.x - a.x, b.y - a.y}, {b.velocity_x - a.velocity_x, b.velocity_y - a.velocity_y}};
}

}  // namespace

void Dynamics::audit() const {
  audit_overlaps();
  if (looks_for_missed_events()) audit_missed_events();
}

bool Dynamics::looks_for_missed_events() const { return size_ <= max_disks_for_all_pairs; }

void Dynamics::audit_overlaps() const {
  auto const require_gap = [&](Index i, Index j) {
    Vector const d = box_.displacement({}, flight(disks_[i], disks_[j]).at(now_));
    double const contact = (radius_of(i) + radius_of(j)) * scale();
    double const gap = std::sqrt(squared_length(d)) - contact;
    if (gap >= -tolerance * contact) return;
    throw RunFailure(fmt::format("time {}: disks {} and {} overlap by {:.3g}, {:.3g} of their distance at contact",
                                 last_event(), id_of(i), id_of(j), -gap, -gap / contact));
  };
  for (Index i = 0; i < size_; ++i) {
    for_each_run_around(position_at(i, now_), radius_of(i), scale(), lists_.room, [&](std::span<Index const> slots) {
      for (Index const j : slots) {
        if (j != no_disk && j < i) require_gap(j, i);
      }
    });
    audit_obstacles(i);
    if (box_.is_periodic()) continue;
    auto const [x, y] = position_at(i, now_);
    double const r = radius_of(i) * scale();
    double const gap_x = box_.is_periodic_x() ? never : std::min(x - r, box_.width() - r - x);
    double const gap_y = box_.is_periodic_y() ? never : std::min(y - r, box_.height() - r - y);
    double const gap = std::min(gap_x, gap_y);
    if (gap >= -tolerance * 2.0 * r) continue;
    throw RunFailure(fmt::format("time {}: disk {} is {:.3g} outside the box", last_event(), id_of(i), -gap));
  }
}

void Dynamics::audit_obstacles(Index i) const {
  Vector const p = position_at(i, now_);
  for (std::size_t k = 0; k < all_obstacles_.size(); ++k) {
    Obstacle const& obstacle = all_obstacles_[k];
    double const contact = radius_of(i) + obstacle.radius;
    double const gap = std::sqrt(squared_length(p - obstacle.nearest_to(p))) - contact;
    if (gap >= -tolerance * 2.0 * contact) continue;
    throw RunFailure(
        fmt::format("time {}: disk {} overlaps {} by {:.3g}", last_event(), id_of(i), to_text(obstacle), -gap));
  }
}

/// Looks for missed events. No search looks at a pair again before the earlier of the two disks' own events, so until
/// then the pair must not overlap. Disks that grow are all searched again at the end of the epoch.
void Dynamics::audit_missed_events() const {
  double const last_image_x = box_.is_oblique() ? 2.0 : box_.is_periodic_x() ? 1.0 : 0.0;
  double const last_image_y = box_.is_periodic_y() ? 1.0 : 0.0;
  double const last = is_growing() ? epoch_length_ : never;
  for (Index i = 0; i < size_; ++i) {
    for (Index j = 0; j < i; ++j) {
      double const end = std::max(now_, std::min({disks_[i].event_time, disks_[j].event_time, last}));
      RelativeFlight const pair = flight(disks_[i], disks_[j]);
      double const sum = radius_of(i) + radius_of(j);
      for (double n = -last_image_x; n <= last_image_x; n += 1.0) {
        for (double m = -last_image_y; m <= last_image_y; m += 1.0) {
          Vector const image = box_.offset_of_image(n, m);
          double const time = pair.nearest(image, sum, growth_.scale, now_, end);
          double const contact = sum * growth_.scale.at(time);
          double const gap = std::sqrt(squared_length(pair.at(time) + image)) - contact;
          if (gap >= -tolerance * contact) continue;
          throw RunFailure(
              fmt::format("time {}: a collision of disks {} and {} was missed; they would overlap by {:.3g} "
                          "at time {}",
                          last_event(), id_of(i), id_of(j), -gap, epoch_start_ + time));
        }
      }
    }
  }
}

}  // namespace gridlock::exact
