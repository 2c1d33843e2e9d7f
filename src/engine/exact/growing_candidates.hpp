#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/exact/prediction.hpp"

namespace gridlock::exact {

/// A distance that rounding leaves open, as part of σ².
inline constexpr double rounding_of_square = std::numeric_limits<double>::epsilon();

/// How long two disks that do not approach each other fly until growth has closed the gap; A < 0, b ≥ 0. The roots of
/// disks that touch but for rounding may not exist: they get a time in which they overlap by no more than rounding, and
/// never none, so that time passes.
inline double wait_for_growth(double a, double b, double c, double squared_contact) {
  double const gap = std::max(std::abs(c), rounding_of_square * squared_contact);
  return (b + std::sqrt(b * b - a * gap)) / -a;
}

/// By how much a coordinate of a separation is to be moved to be the nearest image.
inline double shift_to_nearest(double d, double side) {
  if (d > 0.5 * side) return -side;
  return d < -0.5 * side ? side : 0.0;
}

/// The candidate with the earliest collision so far.
class EarliestGrowing {
 public:
  EarliestGrowing(PredictionInput const& s, Index i, double now, Index apart, Prediction best)
      : s_(s),
        self_(s.disks[i]),
        now_(now),
        apart_(apart),
        radius_(s.radius[i]),
        last_hit_(s.last_hit[i]),
        best_(best) {}

  /// Looks at the image of disk j shifted by whole sides of the box.
  void consider(Index j, double shift_x, double shift_y) {
    MovingDisk const& other = s_.disks[j];
    double const begin = std::max(last_hit_, s_.last_hit[j]);
    double const w_x = other.velocity_x - self_.velocity_x;
    double const w_y = other.velocity_y - self_.velocity_y;
    double const d_x = ((other.x - self_.x) + shift_x) + w_x * begin;
    double const d_y = ((other.y - self_.y) + shift_y) + w_y * begin;
    double const sum = radius_ + s_.radius[j];
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
      double const discriminant = b * b - a * c;
      if (discriminant >= 0.0) {
        wait = c / (std::sqrt(discriminant) - b);
      } else if (c > 0.0) {
        return;
      }
    } else {
      wait = wait_for_growth(a, b, c, contact * contact);
    }
    double const time = std::max(begin + wait, now_);
    if (!(time < other.event_time)) return;
    bool const is_tie = time == best_.time && best_.partner < vertical_border;
    if (time < best_.time || (is_tie && other.id_index < s_.disks[best_.partner].id_index)) best_ = {time, j};
  }

  /// Looks at the image of disk j that is the nearest now.
  void consider_nearest_image(Index j) {
    MovingDisk const& other = s_.disks[j];
    double const d_x = (other.x - self_.x) + (other.velocity_x - self_.velocity_x) * now_;
    double const d_y = (other.y - self_.y) + (other.velocity_y - self_.velocity_y) * now_;
    consider(j, s_.is_periodic ? shift_to_nearest(d_x, s_.width) : 0.0,
             s_.is_periodic ? shift_to_nearest(d_y, s_.height) : 0.0);
  }

  [[nodiscard]] Prediction best() const { return best_; }

 private:
  PredictionInput const& s_;
  MovingDisk const& self_;
  double now_;
  Index apart_;
  double radius_;
  double last_hit_;
  Prediction best_;
};

/// When a disk in a periodic box reaches the border of its cell or of the room around its place.
inline Prediction border_near_place(PredictionInput const& s, Index i, double now) {
  MovingDisk const& disk = s.disks[i];
  Place const place = s.places[i];
  bool const is_rightwards = disk.velocity_x > 0.0;
  bool const is_upwards = disk.velocity_y > 0.0;
  double const x_edge = s.column_edges[disk.column + (is_rightwards ? 1 : 0)];
  double const y_edge = s.row_edges[disk.row + (is_upwards ? 1 : 0)];
  double const x_end = is_rightwards ? std::min(x_edge, place.x + s.room) : std::max(x_edge, place.x - s.room);
  double const y_end = is_upwards ? std::min(y_edge, place.y + s.room) : std::max(y_edge, place.y - s.room);
  constexpr double never = std::numeric_limits<double>::infinity();
  double const x_time = disk.velocity_x != 0.0 ? (x_end - disk.x) / disk.velocity_x : never;
  double const y_time = disk.velocity_y != 0.0 ? (y_end - disk.y) / disk.velocity_y : never;
  return {std::max(now, std::min(x_time, y_time)), vertical_border + static_cast<Index>(y_time < x_time)};
}

/// When a growing disk reaches the border of its cell or of the room around its place, or a wall.
inline Prediction border_growing(PredictionInput const& s, Index i, double now) {
  if (s.is_periodic) return s.places != nullptr ? border_near_place(s, i, now) : predict_border(s, i, now);
  BorderEvent const border = border_event_growing(s, i);
  bool const is_vertical = border.side == Side::left || border.side == Side::right;
  return {std::max(now, border.time), is_vertical ? vertical_border : horizontal_border};
}

/// The disk that i has just collided with touches it again before another event only where growth overtakes the two.
inline Prediction with_disk_apart(PredictionInput const& s, Index i, double now, Index apart, Prediction best) {
  MovingDisk const& self = s.disks[i];
  MovingDisk const& other = s.disks[apart];
  double const w_x = other.velocity_x - self.velocity_x;
  double const w_y = other.velocity_y - self.velocity_y;
  double const growth = (s.radius[i] + s.radius[apart]) * s.scale.rate;
  if (w_x * w_x + w_y * w_y >= growth * growth) [[likely]]
    return best;
  EarliestGrowing earliest(s, i, now, apart, best);
  earliest.consider_nearest_image(apart);
  return earliest.best();
}

}  // namespace gridlock::exact
