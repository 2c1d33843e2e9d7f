#include "engine/exact/prediction.hpp"

#include <cmath>

namespace gridlock::exact {

namespace {

/// The candidate with the earliest collision so far.
class Earliest {
 public:
  Earliest(PredictionInput const& s, Index i, double now, Index apart)
      : s_(s), self_(s.disks[i]), now_(now), apart_(apart), radius_(s.radius_of(i)), best_(predict_border(s, i, now)) {}

  /// Looks at the image of disk j shifted by whole sides of the box.
  void consider(Index j, double shift_x, double shift_y) {
    MovingDisk const& other = s_.disks[j];
    double const w_x = other.velocity_x - self_.velocity_x;
    double const w_y = other.velocity_y - self_.velocity_y;
    double const d_x = (other.x - self_.x) + w_x * now_ + shift_x;
    double const d_y = (other.y - self_.y) + w_y * now_ + shift_y;
    double const b = d_x * w_x + d_y * w_y;
    if (!(b < 0.0)) return;
    double const contact = radius_ + s_.radius_of(j);
    double const c = d_x * d_x + d_y * d_y - contact * contact;
    if (j == apart_ && c < 1e-3 * contact * contact) return;
    double const discriminant = b * b - (w_x * w_x + w_y * w_y) * c;
    if (!(discriminant >= 0.0)) return;
    double const wait = c / (std::sqrt(discriminant) - b);
    double const time = now_ + (wait > 0.0 ? wait : 0.0);
    if (!(time < other.event_time)) return;
    bool const is_tie = time == best_.time && best_.partner < vertical_border;
    if (time < best_.time || (is_tie && other.id_index < s_.disks[best_.partner].id_index)) best_ = {time, j};
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

}  // namespace

Prediction predict_scalar(PredictionInput const& s, Index i, double now, Index apart) {
  Earliest earliest(s, i, now, apart);
  MovingDisk const& disk = s.disks[i];
  for (std::int32_t row = disk.row - 1; row <= disk.row + 1; ++row) {
    double const shift_y = shift_of_image(row, s.rows, s.height);
    Index const* slot =
        s.slots + static_cast<std::size_t>(row + 1) * s.row_stride + static_cast<std::size_t>(disk.column) * s.capacity;
    for (std::int32_t column = disk.column - 1; column <= disk.column + 1; ++column) {
      double const shift_x = shift_of_image(column, s.columns, s.width);
      for (std::size_t k = 0; k < s.capacity; ++k, ++slot) {
        if (*slot != no_disk && *slot != i) earliest.consider(*slot, shift_x, shift_y);
      }
    }
  }
  return earliest.best();
}

PairPrediction predict_pair_scalar(PredictionInput const& s, Index i, Index j, double now) {
  return {predict_scalar(s, i, now, j), predict_scalar(s, j, now, i)};
}

bool can_use_highway(PredictionInput const& s) {
  bool const has_room = !s.is_periodic || (s.columns >= 5 && s.rows >= 5);
  return has_room && (s.capacity == 4 || s.neighbours != nullptr);
}

Predictor fastest_predictor(PredictionInput const& s) {
  bool const is_growing = s.last_hit != nullptr;
  if (is_growing && can_use_avx512(s)) return {predict_growing_with_avx512, predict_pair_growing_with_avx512};
  if (can_use_avx512(s)) return {predict_with_avx512, predict_pair_with_avx512};
  Predictor const scalar =
      is_growing ? Predictor{predict_growing, predict_pair_growing} : Predictor{predict_scalar, predict_pair_scalar};
  return can_use_highway(s) ? highway_predictor(target(), is_growing).value_or(scalar) : scalar;
}

}  // namespace gridlock::exact
