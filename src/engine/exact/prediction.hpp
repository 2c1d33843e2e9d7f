#pragma once

#include <algorithm>
#include <cstddef>
#include <optional>

#include "engine/exact/moving_disk.hpp"
#include "engine/exact/neighbours.hpp"
#include "engine/exact/scale.hpp"
#include "gridlock/core/target.hpp"

namespace gridlock::exact {

/// Everything a prediction reads; borrowed pointers and the numbers of the box.
struct PredictionInput {
  MovingDisk const* disks;
  double const* radius;  ///< of each disk; nullptr while all are equal
  double equal_radius;
  Index const* slots;  ///< of SlotGrid
  std::size_t row_stride;
  std::size_t capacity;
  double const* column_edges;
  double const* row_edges;
  std::int32_t columns;
  std::int32_t rows;
  double width;
  double height;
  bool is_periodic;
  double const* last_hit =
      nullptr;       ///< when each disk's velocity last changed, in this epoch; nullptr while nothing grows
  Scale scale = {};  ///< of all radii
  Neighbours const* neighbours = nullptr;  ///< of each disk; nullptr while the block of cells is looked at
  Place const* places = nullptr;           ///< of each disk that has neighbours
  double room = 0.0;                       ///< how far a disk may be from its place

  [[nodiscard]] double radius_of(Index i) const { return radius != nullptr ? radius[i] : equal_radius; }
};

/// When a disk's next event is due and what it will meet.
struct Prediction {
  double time;
  Index partner;
};

/// The first event of disk i after `now` that no other disk will look after.
///
/// Two disks at distance d with relative velocity w, b = d·w < 0 and c = d² − σ², touch after
///     Δt = c / (−b + √(b² − w²c)),
/// the form that does not cancel. A collision with j counts only when it comes before j's own event: at its own event
/// j looks at all its neighbours again and finds it. Disk `apart` has just collided with i and cannot meet it
/// there again; no_disk where there is none.
/// The 3×3 block of cells is enough, for leaving its cell is an event as well.
/// Every implementation gives the same bits: the same operations on each candidate in the same order, no contraction,
/// ties to the lower Id.
using Predict = Prediction (*)(PredictionInput const& prediction_input, Index i, double now, Index apart);

Prediction predict_scalar(PredictionInput const& prediction_input, Index i, double now, Index apart);

/// Whether the processor has the instructions, and the box the five cells a side and the cells the few slots, that
/// predict_with_avx512() needs.
bool can_use_avx512(PredictionInput const& prediction_input);
/// Eight candidates at a time.
Prediction predict_with_avx512(PredictionInput const& prediction_input, Index i, double now, Index apart);

/// The predictions of two disks that have just collided.
struct PairPrediction {
  Prediction of_i;
  Prediction of_j;
};
using PredictPair = PairPrediction (*)(PredictionInput const& prediction_input, Index i, Index j, double now);

PairPrediction predict_pair_scalar(PredictionInput const& prediction_input, Index i, Index j, double now);
PairPrediction predict_pair_with_avx512(PredictionInput const& prediction_input, Index i, Index j, double now);

/// The same for disks that grow: σ = (R_i + R_j) · scale(t), a = dσ/dt, A = w² − a², b = d·w − aσ. They touch after
///     Δt = c / (−b + √(b² − Ac))   if b < 0,
///     Δt = (b + √(b² − Ac)) / (−A)   if b ≥ 0 and A < 0: the disks grow faster than they part.
/// d, b and c are those of the moment at which the velocity of one of the two last changed: the time of contact has the
/// same bits whenever it is predicted, so that neither cells nor void events show in the trajectory.
/// Contract: all event times come from this kernel since the zero of the epoch.
Prediction predict_growing(PredictionInput const& prediction_input, Index i, double now, Index apart);
PairPrediction predict_pair_growing(PredictionInput const& prediction_input, Index i, Index j, double now);
Prediction predict_growing_with_avx512(PredictionInput const& prediction_input, Index i, double now, Index apart);
PairPrediction predict_pair_growing_with_avx512(PredictionInput const& prediction_input, Index i, Index j, double now);

/// A kernel that predicts, for one disk and for two.
struct Predictor {
  Predict one;
  PredictPair pair;
};

/// Whether the box has the five cells a side, and the cells the four slots or disks the neighbours, that highway_predictor() needs.
bool can_use_highway(PredictionInput const& prediction_input);
/// Two or four candidates at a time, by the instructions of this target, which the processor must have; none where no such kernel is built.
std::optional<Predictor> highway_predictor(Target target, bool is_growing);

/// The fastest implementation for this processor and these cells.
Predictor fastest_predictor(PredictionInput const& prediction_input);

/// When disk i reaches the border of its cell, or the wall there.
inline Prediction predict_border(PredictionInput const& s, Index i, double now) {
  MovingDisk const& disk = s.disks[i];
  double x_edge = s.column_edges[disk.column + (disk.velocity_x > 0.0 ? 1 : 0)];
  double y_edge = s.row_edges[disk.row + (disk.velocity_y > 0.0 ? 1 : 0)];
  if (!s.is_periodic) {
    double const r = s.radius_of(i);
    x_edge = x_edge < r ? r : x_edge > s.width - r ? s.width - r : x_edge;
    y_edge = y_edge < r ? r : y_edge > s.height - r ? s.height - r : y_edge;
  }
  constexpr double never = std::numeric_limits<double>::infinity();
  double const x_time = disk.velocity_x != 0.0 ? (x_edge - disk.x) / disk.velocity_x : never;
  double const y_time = disk.velocity_y != 0.0 ? (y_edge - disk.y) / disk.velocity_y : never;
  // Without a branch, for either is as likely.
  static_assert(horizontal_border == vertical_border + 1);
  return {std::max(now, std::min(x_time, y_time)), vertical_border + static_cast<Index>(y_time < x_time)};
}

enum class Side { left, right, bottom, top };

enum class Border { of_cell, of_place, wall };

/// The first border of its cell, of the room around its place, or wall, that a growing disk reaches.
struct BorderEvent {
  double time;
  Side side;
  Border border;
};
BorderEvent border_event_growing(PredictionInput const& prediction_input, Index i);

/// How much is to be added to a position in a cell of that index, which may be a ghost beside the box.
inline double shift_of_image(std::int32_t index, std::int32_t count, double side) {
  if (index < 0) return -side;
  return index >= count ? side : 0.0;
}

}  // namespace gridlock::exact
