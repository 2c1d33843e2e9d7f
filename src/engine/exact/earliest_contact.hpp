#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

#include "engine/exact/prediction.hpp"

namespace gridlock::exact {

/// The rounding error of a squared distance, relative to σ².
inline constexpr double rounding_of_square = std::numeric_limits<double>::epsilon();

/// Returns the time until growth closes the gap between two disks that do not approach each other; A < 0, b ≥ 0. For
/// disks that touch up to rounding the equation may have no root: the time returned is then positive, so that time
/// passes, and the overlap is no larger than rounding.
inline double wait_for_growth(double a, double b, double c, double squared_contact) {
  double const gap = std::max(std::abs(c), rounding_of_square * squared_contact);
  return (b + std::sqrt(b * b - a * gap)) / -a;
}

/// Returns the shift by which the nearest image is away along x or y, for a separation that is d along an axis of this
/// period; the period is infinite between walls.
inline double shift_to_nearest(double d, double period, double shift) {
  double const down = d > 0.5 * period ? -shift : 0.0;
  return d < -0.5 * period ? shift : down;
}

/// Returns the shift of a coordinate of a separation that leads to the nearest image.
inline double shift_to_nearest(double d, double period) { return shift_to_nearest(d, period, period); }

/// The candidate with the earliest collision so far. It defines the result that every kernel must find.
class EarliestContact {
 public:
  /// Disk `apart` has just collided with disk i; it is no_disk where no disk has.
  EarliestContact(PredictionInput const& s, Index i, double now, Index apart, Prediction best)
      : s_(s), self_(s.disks[i]), now_(now), apart_(apart), radius_(s.radius_of(i)), best_(best) {}

  /// Looks at the image of disk j shifted by whole sides of the box.
  void consider(Index j, double shift_x, double shift_y) {
    MovingDisk const& other = s_.disks[j];
    double const begin = std::max(self_.last_hit, other.last_hit);
    double const w_x = other.velocity_x - self_.velocity_x;
    double const w_y = other.velocity_y - self_.velocity_y;
    double const d_x = ((other.x - self_.x) + shift_x) + w_x * begin;
    double const d_y = ((other.y - self_.y) + shift_y) + w_y * begin;
    double const sum = radius_ + s_.radius_of(j);
    double const contact = sum * s_.scale.at(begin);
    double const growth = sum * s_.scale.rate;
    double const a = (w_x * w_x + w_y * w_y) - growth * growth;
    double b = (d_x * w_x + d_y * w_y) - growth * contact;
    if (b >= 0.0 && a >= 0.0) return;
    double const c = (d_x * d_x + d_y * d_y) - contact * contact;
    if (j == apart_ && c < 1e-3 * contact * contact) {
      if (a >= 0.0) return;
      b = std::max(b, 0.0);
    }
    double wait = 0.0;
    if (b < 0.0) {
      double const across = d_x * w_y - d_y * w_x;
      double const discriminant = s_.is_growing() ? b * b - a * c : a * (contact * contact) - across * across;
      if (discriminant >= 0.0) {
        wait = c / (std::sqrt(discriminant) - b);
      } else if (c > 0.0) {
        return;
      }
    } else {
      wait = wait_for_growth(a, b, c, contact * contact);
    }
    double const time = std::max(begin + wait, now_);
    if (j != apart_ && !(time < other.event_time)) return;
    bool const is_tie = time == best_.time && best_.partner < vertical_border;
    if (time < best_.time || (is_tie && other.id_index < s_.disks[best_.partner].id_index)) best_ = {time, j};
  }

  /// Looks at the image of disk j that is nearest at time `now`.
  void consider_nearest_image(Index j) {
    MovingDisk const& other = s_.disks[j];
    double const d_x = (other.x - self_.x) + (other.velocity_x - self_.velocity_x) * now_;
    double const d_y = (other.y - self_.y) + (other.velocity_y - self_.velocity_y) * now_;
    double const lean = s_.lean != 0.0 ? shift_to_nearest(d_y, s_.period_y, s_.lean) : 0.0;
    consider(j, lean + shift_to_nearest(d_x + lean, s_.period_x), shift_to_nearest(d_y, s_.period_y));
  }

  [[nodiscard]] Prediction best() const { return best_; }

 private:
  PredictionInput const& s_;
  MovingDisk const& self_;
  double now_;
  Index apart_;
  double radius_;
  Prediction best_;
};

/// Returns the first event among `best` and the contacts with these disks, some of which move apart more slowly than
/// they grow. That is rare, so the disks are looked at one by one.
inline Prediction with_slow_ones(PredictionInput const& s, Index i, double now, Index const* names, std::size_t count,
                                 Prediction best) {
  EarliestContact earliest(s, i, now, no_disk, best);
  for (std::size_t k = 0; k < count; ++k) earliest.consider_nearest_image(names[k]);
  return earliest.best();
}

/// Adds the contact with `apart`, the disk that i has just collided with. The two touch again before another event only
/// where they grow faster than they part.
inline Prediction with_disk_apart(PredictionInput const& s, Index i, double now, Index apart, Prediction best) {
  MovingDisk const& self = s.disks[i];
  MovingDisk const& other = s.disks[apart];
  double const w_x = other.velocity_x - self.velocity_x;
  double const w_y = other.velocity_y - self.velocity_y;
  double const growth = (s.radius_of(i) + s.radius_of(apart)) * s.scale.rate;
  if (w_x * w_x + w_y * w_y >= growth * growth) [[likely]]
    return best;
  EarliestContact earliest(s, i, now, apart, best);
  earliest.consider_nearest_image(apart);
  return earliest.best();
}

}  // namespace gridlock::exact
