#pragma once

#include <algorithm>
#include <cstddef>
#include <optional>
#include <span>

#include "engine/exact/moving_disk.hpp"
#include "engine/exact/neighbours.hpp"
#include "engine/exact/scale.hpp"
#include "gridlock/core/target.hpp"

namespace gridlock::exact {

/// Everything that a prediction reads: borrowed pointers and the numbers of the box.
struct PredictionInput {
  MovingDisk const* disks;  ///< all disks and behind them the spare disk `nobody`, which no disk ever meets
  Index nobody;
  Cell const* cells;     ///< cell of each disk
  double const* radius;  ///< radius of each disk and of `nobody`; nullptr while all are equal
  double equal_radius;
  double const* mass;  ///< mass of each disk; nullptr while all are equal; prefetched for coming collisions only
  Index const* slots;  ///< slots of the SlotGrid, where there are no lists
  std::size_t row_stride;
  std::size_t capacity;
  double const* column_limits;  ///< limits of the columns, as in SlotGrid
  double const* row_limits;
  std::int32_t columns;
  std::int32_t rows;
  double width;
  double height;
  double period_x;  ///< distance between the images of a disk; infinite between walls
  double period_y;
  double walls[2];  ///< along x and y: 1 between walls, 0 along a periodic axis
  bool has_images;
  bool has_walls;
  bool falls = false;                      ///< whether there is gravity
  Vector gravity = {};                     ///< acceleration of every disk
  Scale scale = {};                        ///< factor of all radii
  Neighbours const* neighbours = nullptr;  ///< list of each disk; nullptr while the block of cells is searched
  LongList const* long_lists = nullptr;    ///< lists of the disks with too many neighbours for `neighbours`
  Place const* places = nullptr;           ///< place of each disk; nullptr where there are no lists
  double room = 0.0;                       ///< largest distance of a disk from its place, in x and in y
  double margin = 0.0;                     ///< disks whose places are further from the edges meet no other across them
  double lean = 0.0;                       ///< xy of an oblique box, where there are always lists; 0 in a rectangle

  [[nodiscard]] double radius_of(Index i) const { return radius != nullptr ? radius[i] : equal_radius; }
  [[nodiscard]] bool is_growing() const { return scale.rate != 0.0; }
  /// Returns the neighbours of disk i. Contract: there are lists.
  [[nodiscard]] std::span<Index const> neighbours_of(Index i) const {
    Neighbours const& list = neighbours[i];
    if (list.has_all()) return {list.disks, list.count};
    return long_lists[list.long_list()];
  }
  [[nodiscard]] bool is_periodic_x() const { return walls[0] == 0.0; }
  [[nodiscard]] bool is_periodic_y() const { return walls[1] == 0.0; }
  /// Returns whether disk i may meet another across a periodic edge.
  [[nodiscard]] bool needs_images(Index i) const {
    if (!has_images) return false;
    if (places != nullptr) {
      Place const place = places[i];
      return (place.x < margin) | (place.x > width - margin) | (place.y < margin) | (place.y > height - margin);
    }
    return static_cast<std::uint32_t>(cells[i].column - 1) >= static_cast<std::uint32_t>(columns - 2) ||
           static_cast<std::uint32_t>(cells[i].row - 1) >= static_cast<std::uint32_t>(rows - 2);
  }
};

/// The time of a disk's next event, and the disk or border that it will meet.
struct Prediction {
  double time;
  Index partner;
};

/// The predictions of two disks that have just collided.
struct PairPrediction {
  Prediction of_i;
  Prediction of_j;
};

/// Predicts the first event of disk i after `now` that no other disk's event precedes.
///
/// Two disks at distance d with relative velocity w, σ = (R_i + R_j) · scale(t) and a = dσ/dt, A = w² − a², b = d·w −
/// aσ, c = d² − σ², touch after
///     Δt = c / (−b + √(b² − Ac))   if b < 0, the form that does not cancel,
///     Δt = (b + √(b² − Ac)) / (−A)   if b ≥ 0 and A < 0: the disks grow faster than they part.
/// For disks that do not grow b² − Ac is computed as w²σ² − (d × w)², which keeps its digits where small disks far from
/// each other will touch at their rims. d, b and c are taken at the time when the velocity of one of the two last
/// changed. So the time of contact has the same bits whenever it is predicted, and the trajectory does not depend on
/// cells, lists or void events.
///
/// A collision with j counts only if it comes before j's own event: at its own event j searches its neighbours again
/// and finds it. The 3×3 block of cells is enough, because leaving a cell is an event too; so is the list of
/// neighbours, because leaving the room around a place is one. Every implementation gives the same bits: the same
/// operations on each candidate in the same order, no contraction, ties to the lower Id.
/// Contract: all event times since the start of the epoch come from this kernel.
using Predict = Prediction (*)(PredictionInput const& prediction_input, Index i, double now);
/// Predicts for two disks that have just collided; they meet each other again only if they grow.
using PredictPair = PairPrediction (*)(PredictionInput const& prediction_input, Index i, Index j, double now);

/// The two functions of a kernel: for one disk, and for a pair that has just collided.
struct Predictor {
  Predict one;
  PredictPair pair;
};

/// Returns the kernel that defines the results: one candidate at a time, for any box and any number of slots.
Predictor reference_predictor();

/// Returns whether kernels other than the reference can be used: the box has five cells a side, or disks have lists.
bool has_room_for_registers(PredictionInput const& prediction_input);
/// Returns the kernel for the instructions of this target, which the processor must have; nothing where this build has
/// no such kernel.
/// Contract: has_room_for_registers().
std::optional<Predictor> predictor_for(Target target, bool is_growing);

/// Returns the fastest kernel for this processor and these cells.
Predictor fastest_predictor(PredictionInput const& prediction_input);

/// Kernels of each target; predictor_for() chooses one.
Predictor plain_predictor(bool is_growing);
std::optional<Predictor> avx512_predictor(bool is_growing);
std::optional<Predictor> highway_predictor(Target target, bool is_growing);

/// The sides of the rectangle that a disk leaves next: its cell, or the room around its place, as far as the box goes.
struct Bounds {
  double left, right, bottom, top;
};
inline Bounds bounds_of(PredictionInput const& s, Index i) {
  double const r = s.has_walls ? s.radius_of(i) : 0.0;
  double const r_x = r * s.walls[0];
  double const r_y = r * s.walls[1];
  auto const in_x = [&](double x) { return std::min(std::max(x, r_x), s.width - r_x); };
  auto const in_y = [&](double y) { return std::min(std::max(y, r_y), s.height - r_y); };
  if (s.places != nullptr) {
    Place const& place = s.places[i];
    return {in_x(place.x - s.room), in_x(place.x + s.room), in_y(place.y - s.room), in_y(place.y + s.room)};
  }
  double const* const columns = s.column_limits + std::ptrdiff_t{2} * s.cells[i].column;
  double const* const rows = s.row_limits + std::ptrdiff_t{2} * s.cells[i].row;
  return {in_x(columns[0]), in_x(columns[1]), in_y(rows[0]), in_y(rows[1])};
}

/// Predicts when disk i, which falls, reaches a border; see predict_border().
Prediction predict_border_falling(PredictionInput const& prediction_input, Index i, double now);

/// Predicts when disk i reaches the border of its cell or of the room around its place, the edge of a periodic box, or
/// a wall. Contract: the disk does not grow, or the box has no walls.
inline Prediction predict_border(PredictionInput const& s, Index i, double now) {
  if (s.falls) [[unlikely]]
    return predict_border_falling(s, i, now);
  MovingDisk const& disk = s.disks[i];
  bool const is_rightwards = disk.velocity_x > 0.0;
  bool const is_upwards = disk.velocity_y > 0.0;
  double x_edge = 0.0;
  double y_edge = 0.0;
  if (s.places != nullptr) {
    x_edge = s.places[i].x + (is_rightwards ? s.room : -s.room);
    y_edge = s.places[i].y + (is_upwards ? s.room : -s.room);
  } else {
    x_edge = s.column_limits[std::ptrdiff_t{2} * s.cells[i].column + (is_rightwards ? 1 : 0)];
    y_edge = s.row_limits[std::ptrdiff_t{2} * s.cells[i].row + (is_upwards ? 1 : 0)];
  }
  double const r = s.has_walls ? s.radius_of(i) : 0.0;
  double const r_x = r * s.walls[0];
  double const r_y = r * s.walls[1];
  x_edge = std::min(std::max(x_edge, r_x), s.width - r_x);
  y_edge = std::min(std::max(y_edge, r_y), s.height - r_y);
  double const x_time = disk.velocity_x != 0.0 ? (x_edge - disk.x) / disk.velocity_x : never;
  double const y_time = disk.velocity_y != 0.0 ? (y_edge - disk.y) / disk.velocity_y : never;
  // Chosen without a branch, because both borders are equally likely.
  static_assert(horizontal_border == vertical_border + 1);
  return {std::max(now, std::min(x_time, y_time)), vertical_border + static_cast<Index>(y_time < x_time)};
}

enum class Side { left, right, bottom, top };  // the order of Counters::Wall

enum class Border { of_cell, of_place, edge, wall };

/// The border that a disk has reached. Without places a periodic edge is the border of a cell.
struct BorderEvent {
  double time;
  Side side;
  Border border;
};
/// Returns whether a disk that falls has reached the upper of two borders: the nearer of the two, because at the top of
/// its path the sign of its velocity is a matter of rounding.
bool is_at_upper_border(PredictionInput const& prediction_input, Index i, bool is_vertical, double now);

/// Returns the border of a disk that does not grow from its event with `partner`, now; its time is not set.
inline BorderEvent border_event(PredictionInput const& s, Index i, Index partner, double now) {
  bool const is_vertical = partner == vertical_border;
  double const velocity = is_vertical ? s.disks[i].velocity_x : s.disks[i].velocity_y;
  bool const is_upwards = s.falls ? is_at_upper_border(s, i, is_vertical, now) : velocity > 0.0;
  Side const side = is_vertical ? (is_upwards ? Side::right : Side::left) : (is_upwards ? Side::top : Side::bottom);
  bool const is_periodic = is_vertical ? s.is_periodic_x() : s.is_periodic_y();
  Border const at_edge = is_periodic ? Border::edge : Border::wall;
  if (s.places == nullptr) {
    std::int32_t const index = is_vertical ? s.cells[i].column : s.cells[i].row;
    std::int32_t const last = is_upwards ? (is_vertical ? s.columns : s.rows) - 1 : 0;
    return {0.0, side, index == last ? at_edge : Border::of_cell};
  }
  double const place = is_vertical ? s.places[i].x : s.places[i].y;
  double const r = is_periodic ? 0.0 : s.radius_of(i);
  bool const is_edge = is_upwards ? place + s.room >= (is_vertical ? s.width : s.height) - r : place - s.room <= r;
  return {0.0, side, is_edge ? at_edge : Border::of_place};
}

/// Returns the first border that a growing disk reaches.
BorderEvent border_event_growing(PredictionInput const& prediction_input, Index i);

/// Predicts when a growing disk reaches a border or a wall.
inline Prediction predict_border_growing(PredictionInput const& s, Index i, double now) {
  if (!s.has_walls) return predict_border(s, i, now);
  BorderEvent const border = border_event_growing(s, i);
  bool const is_vertical = border.side == Side::left || border.side == Side::right;
  return {std::max(now, border.time), is_vertical ? vertical_border : horizontal_border};
}

template <bool grows>
Prediction predict_any_border(PredictionInput const& s, Index i, double now) {
  return grows ? predict_border_growing(s, i, now) : predict_border(s, i, now);
}

/// Returns the shift of a position in a cell of this column or row, which may be a ghost cell outside the box.
inline double shift_of_image(std::int32_t index, std::int32_t count, double side) {
  if (index < 0) return -side;
  return index >= count ? side : 0.0;
}

}  // namespace gridlock::exact
