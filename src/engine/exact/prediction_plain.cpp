#include <algorithm>
#include <array>
#include <cmath>

#include "engine/exact/candidates.hpp"
#include "engine/exact/earliest_contact.hpp"

// This kernel is plain C++ without a branch for each candidate. Compilers turn its loops into vector instructions where
// they can; it is twice as fast as the reference kernel.

namespace gridlock::exact {

namespace {

/// Quantities of a batch of candidates, one array each.
struct Columns {
  double x[batch];
  double y[batch];
  double velocity_x[batch];
  double velocity_y[batch];
  double event_time[batch];
  double last_hit[batch];
  double radii[batch];
  double time[batch];
  double squared_parting[batch];  ///< negative where growth can overtake the pair
};

/// Collects the candidates of disk i, without `apart`. Returns false where there may be too many.
bool collect(PredictionInput const& s, Index i, Index apart, Candidates& candidates) {
  if (s.neighbours != nullptr) {
    Neighbours const& list = s.neighbours[i];
    for (std::size_t k = 0; k < Neighbours::most; ++k) {
      candidates.disks[k] = list.disks[k] == apart ? s.nobody : list.disks[k];
    }
    candidates.disks[Neighbours::most] = s.nobody;
    candidates.count = list.count;
    return list.has_all();
  }
  if (s.capacity != slots_per_cell) [[unlikely]]
    return false;
  Index const* run = first_slot_around(s, i);
  std::size_t count = 0;
  auto const consider = [&](Index name) {
    candidates.disks[count] = name;
    count += static_cast<std::size_t>((name != no_disk) & (name != i) & (name != apart));
  };
  for (int row = 0; row < 3; ++row, run += s.row_stride) {
    for (std::size_t k = 0; k < 3 * slots_per_cell; k += slots_per_cell) {
      consider(run[k]);
      consider(run[k + 1]);
      // The used slots of a cell are the first ones, and few cells hold more than two disks.
      if (run[k + 2] == no_disk) [[likely]]
        continue;
      consider(run[k + 2]);
      consider(run[k + 3]);
    }
  }
  for (std::size_t k = 0; k < batch; ++k) candidates.disks[count + k] = s.nobody;
  candidates.count = count;
  return true;
}

/// Returns the separation, at the start of the epoch, from the image nearest now; sides are infinite between walls.
inline double nearest(double d, double w, double now, double side) { return d + shift_to_nearest(d + w * now, side); }

/// The images of a disk that others may meet.
enum class Images { none, in_rectangle, in_oblique_box };

/// Finds the time of contact of each disk, or `never` where there is none before its own event. Returns whether a disk
/// parts so slowly that growth can overtake the pair.
template <bool grows, Images images>
bool find_times(PredictionInput const& s, Index i, double now, Columns& columns) {
  MovingDisk const self = s.disks[i];
  Scale const scale = s.scale;
  double const period_x = s.period_x;
  double const period_y = s.period_y;
  for (std::size_t k = 0; k < batch; ++k) {
    double const begin = columns.last_hit[k] > self.last_hit ? columns.last_hit[k] : self.last_hit;
    double const w_x = columns.velocity_x[k] - self.velocity_x;
    double const w_y = columns.velocity_y[k] - self.velocity_y;
    double d_x = columns.x[k] - self.x;
    double d_y = columns.y[k] - self.y;
    if constexpr (images == Images::in_rectangle) {
      d_x = nearest(d_x, w_x, now, period_x);
      d_y = nearest(d_y, w_y, now, period_y);
    } else if constexpr (images == Images::in_oblique_box) {
      double const lean = shift_to_nearest(d_y + w_y * now, period_y, s.lean);
      d_x += lean + shift_to_nearest((d_x + w_x * now) + lean, period_x);
      d_y = nearest(d_y, w_y, now, period_y);
    }
    d_x += w_x * begin;
    d_y += w_y * begin;
    double a = w_x * w_x + w_y * w_y;
    double b = d_x * w_x + d_y * w_y;
    double contact = columns.radii[k];
    if constexpr (grows) {
      double const growth = contact * scale.rate;
      contact *= scale.at(begin);
      a -= growth * growth;
      b -= growth * contact;
      columns.squared_parting[k] = a;
    }
    double const squared_contact = contact * contact;
    double const c = (d_x * d_x + d_y * d_y) - squared_contact;
    double const across = d_x * w_y - d_y * w_x;
    double const discriminant = grows ? b * b - a * c : a * squared_contact - across * across;
    double const root = std::sqrt(discriminant > 0.0 ? discriminant : 0.0);
    double const due = begin + c / (root - b);
    double const time = due > now ? due : now;
    double const met = b < 0.0 ? time : never;
    double const real = discriminant >= 0.0 ? met : never;
    columns.time[k] = real < columns.event_time[k] ? real : never;
  }
  bool has_slow_ones = false;
  if constexpr (grows) {
    // In a loop of its own, because compilers would not vectorize the loop above with it.
    for (double const a : columns.squared_parting) has_slow_ones |= a < 0.0;
  }
  return has_slow_ones;
}

/// The earliest of the times, and a bit for each disk with this time.
struct First {
  double time;
  unsigned bits;
};
inline First first_of(double const* times) {
  std::array<double, batch / 2> half{};
  for (std::size_t k = 0; k < batch / 2; ++k)
    half[k] = times[k] < times[k + batch / 2] ? times[k] : times[k + batch / 2];
  double const even = half[0] < half[2] ? half[0] : half[2];
  double const odd = half[1] < half[3] ? half[1] : half[3];
  double const time = even < odd ? even : odd;
  unsigned bits = 0;
  for (std::size_t k = 0; k < batch; ++k) bits |= static_cast<unsigned>((times[k] == time) & (time < never)) << k;
  return {time, bits};
}

/// Returns the first event among `best` and the contacts with the candidates.
template <bool grows>
Prediction earliest_of(PredictionInput const& s, Index i, double now, Candidates const& candidates, Prediction best) {
  double const radius = s.radius_of(i);
  bool const needs_images = s.needs_images(i);
  bool has_slow_ones = false;
  for (std::size_t first = 0; first < candidates.count; first += batch) {
    Index const* const names = candidates.disks + first;
    Columns columns;
    for (std::size_t k = 0; k < batch; ++k) {
      MovingDisk const& disk = s.disks[names[k]];
      columns.x[k] = disk.x;
      columns.y[k] = disk.y;
      columns.velocity_x[k] = disk.velocity_x;
      columns.velocity_y[k] = disk.velocity_y;
      columns.event_time[k] = disk.event_time;
      columns.last_hit[k] = disk.last_hit;
    }
    if (s.radius != nullptr) {
      for (std::size_t k = 0; k < batch; ++k) columns.radii[k] = radius + s.radius[names[k]];
    } else {
      std::fill_n(columns.radii, batch, radius + radius);
    }
    has_slow_ones |= !needs_images   ? find_times<grows, Images::none>(s, i, now, columns)
                     : s.lean == 0.0 ? find_times<grows, Images::in_rectangle>(s, i, now, columns)
                                     : find_times<grows, Images::in_oblique_box>(s, i, now, columns);
    First const earliest = first_of(columns.time);
    best = earlier_of(best, earliest.time, earliest.bits, names, s.disks);
  }
  if (grows && has_slow_ones) [[unlikely]]
    best = with_slow_ones(s, i, now, candidates.disks, candidates.count, best);
  return best;
}

/// Predicts for disk i, which has just collided with `apart`.
template <bool grows>
Prediction predict_beside(PredictionInput const& s, Index i, double now, Index apart, Candidates const& candidates) {
  Prediction const best = earliest_of<grows>(s, i, now, candidates, predict_any_border<grows>(s, i, now));
  return grows ? with_disk_apart(s, i, now, apart, best) : best;
}

/// Predicts for a disk with many candidates. `apart` is the disk it has just collided with, or no_disk.
template <bool grows>
Prediction predict_among_many(PredictionInput const& s, Index i, double now, Index apart) {
  Prediction const best = earliest_of_many(
      s, i, apart, predict_any_border<grows>(s, i, now),
      [&](Candidates const& part, Prediction const& first) { return earliest_of<grows>(s, i, now, part, first); });
  return grows && apart != no_disk ? with_disk_apart(s, i, now, apart, best) : best;
}

template <bool grows>
Prediction predict(PredictionInput const& s, Index i, double now) {
  Candidates candidates;
  if (!collect(s, i, no_disk, candidates)) [[unlikely]]
    return predict_among_many<grows>(s, i, now, no_disk);
  return earliest_of<grows>(s, i, now, candidates, predict_any_border<grows>(s, i, now));
}

template <bool grows>
PairPrediction predict_pair(PredictionInput const& s, Index i, Index j, double now) {
  Candidates around_i;
  Candidates around_j;
  bool const fits_i = collect(s, i, j, around_i);
  bool const fits_j = collect(s, j, i, around_j);
  if (!fits_i || !fits_j) [[unlikely]] {
    return {fits_i ? predict_beside<grows>(s, i, now, j, around_i) : predict_among_many<grows>(s, i, now, j),
            fits_j ? predict_beside<grows>(s, j, now, i, around_j) : predict_among_many<grows>(s, j, now, i)};
  }
  // Each prediction is returned as it is made: a copy would be read before its writes are done.
  return {predict_beside<grows>(s, i, now, j, around_i), predict_beside<grows>(s, j, now, i, around_j)};
}

}  // namespace

Predictor plain_predictor(bool is_growing) {
  return is_growing ? Predictor{predict<true>, predict_pair<true>} : Predictor{predict<false>, predict_pair<false>};
}

}  // namespace gridlock::exact
