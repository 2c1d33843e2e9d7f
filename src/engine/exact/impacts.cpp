#include <algorithm>
#include <cmath>

#include "engine/exact/flight.hpp"
#include "engine/exact/touch.hpp"

namespace gridlock::exact {

namespace {

struct Span {
  double lower;
  double upper;

  void include(double value) {
    lower = std::min(lower, value);
    upper = std::max(upper, value);
  }
};

/// Returns the range of a coordinate x + v t + ½ g t² between two times.
Span span_of(double x, double v, double g, double begin, double end) {
  auto const at = [&](double t) { return x + (v + 0.5 * g * t) * t; };
  Span span{at(begin), at(begin)};
  if (v == 0.0 && g == 0.0) return span;
  span.include(at(end));
  double const top = g != 0.0 ? -v / g : never;
  if (top > begin && top < end) span.include(at(top));
  return span;
}

/// The time from `begin` on at which a disk leaves the range between two borders of one coordinate.
double time_at_border(double x, double v, double g, double begin, double now, double lower, double upper) {
  if (g > 0.0) return time_at_border(-x, -v, -g, begin, now, -upper, -lower);
  if (g == 0.0) return v > 0.0 ? begin + (upper - x) / v : v < 0.0 ? begin + (lower - x) / v : never;
  // The disk leaves downwards on its way down: at the later of two times.
  double const depth = x - lower;
  double const root = std::sqrt(std::max(0.0, v * v - 2.0 * g * depth));
  double first = begin + (v >= 0.0 ? (v + root) / -g : depth > 0.0 ? 2.0 * depth / (root - v) : 0.0);
  if (v + g * (now - begin) > 0.0) {
    double const height = upper - x;
    double const squared = v * v + 2.0 * g * height;
    if (squared >= 0.0) first = std::min(first, begin + 2.0 * height / (v + std::sqrt(squared)));
  }
  return first;
}

}  // namespace

/// Times are counted from the last hit, so that a disk that jumps ever lower on a floor keeps its digits.
Prediction predict_border_falling(PredictionInput const& s, Index i, double now) {
  MovingDisk const& disk = s.disks[i];
  Bounds const bounds = bounds_of(s, i);
  double const begin = disk.last_hit;
  Vector const p = centre_at(disk, s.gravity, begin);
  Vector const v = velocity_at(disk, s.gravity, begin);
  double const x_time = time_at_border(p.x, v.x, s.gravity.x, begin, now, bounds.left, bounds.right);
  double const y_time = time_at_border(p.y, v.y, s.gravity.y, begin, now, bounds.bottom, bounds.top);
  return {std::max(now, std::min(x_time, y_time)), vertical_border + static_cast<Index>(y_time < x_time)};
}

bool is_at_upper_border(PredictionInput const& s, Index i, bool is_vertical, double now) {
  Bounds const bounds = bounds_of(s, i);
  Vector const p = centre_at(s.disks[i], s.gravity, now);
  double const place = is_vertical ? p.x : p.y;
  double const lower = is_vertical ? bounds.left : bounds.bottom;
  double const upper = is_vertical ? bounds.right : bounds.top;
  return upper - place < place - lower;
}

/// Looks at the obstacles along the path to the next event, at which the disk is predicted anew.
Prediction Flight::first_of_obstacles(Index i, Prediction const& next, double time) const {
  MovingDisk const& disk = disks_[i];
  double const begin = disk.last_hit;
  Vector const v = velocity_at(disk, gravity_, begin);
  if (v == Vector{} && !falls()) return next;
  Path const path{position_at(i, begin), v, gravity_};
  Span const x = span_of(disk.x, disk.velocity_x, gravity_.x, time, next.time);
  Span const y = span_of(disk.y, disk.velocity_y, gravity_.y, time, next.time);
  Prediction first = next;
  obstacles_->view().for_each_near({x.lower, y.lower}, {x.upper, y.upper}, [&](std::uint32_t k) {
    double const touch = std::max(time, begin + time_to_touch((*obstacles_)[k], radius_of(i), path));
    bool const is_lower_tie = touch == first.time && first.partner >= first_obstacle &&
                              first_obstacle + k < first.partner && first.partner < vertical_border;
    if (touch < first.time || is_lower_tie) first = {touch, first_obstacle + k};
  });
  return first;
}

double Flight::reflect_from(Obstacle const& obstacle, Index i) {
  Vector const p = position_at(i, now_);
  Vector const d = p - obstacle.nearest_to(p);
  double const approach = dot(velocity_at(disks_[i], gravity_, now_), d);
  double const bounce =
      bounce_of(i, i, obstacle.is_disk() ? restitution_of(kind_of(i), obstacle.kind) : losses_.of_walls[kind_of(i)]);
  double const along = -bounce * std::min(approach, 0.0) / squared_length(d);
  change_velocity(disks_[i], along * d.x, along * d.y, now_);
  ++hits_;
  double const distance = std::sqrt(squared_length(d));
  double const impulse = mass_of(i) * along * distance;
  return obstacle.is_disk() ? impulse * distance : impulse;
}

double Flight::bounce_of(Index i, Index j, double restitution) {
  if (last_contact_.empty()) return 1.0 + restitution;
  bool const is_lasting = now_ - std::max(last_contact_[i], last_contact_[j]) < losses_.contact_time;
  last_contact_[i] = now_;
  last_contact_[j] = now_;
  elastic_contacts_ += is_lasting ? 1U : 0U;
  return is_lasting ? 2.0 : 1.0 + restitution;
}

}  // namespace gridlock::exact
