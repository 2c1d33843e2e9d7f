#include <limits>

#include "engine/exact/growing_candidates.hpp"
#include "engine/exact/prediction.hpp"

namespace gridlock::exact {

namespace {

constexpr double never = std::numeric_limits<double>::infinity();

/// One coordinate of a growing disk.
struct Track {
  double place;
  double velocity;
  double radius;
  double last_hit;
};

/// The cell and the room around its place that it is in, in that coordinate.
struct Limits {
  double const* edges;
  std::int32_t index;
  std::int32_t count;
  double side;
  bool is_periodic;
  double lower;  ///< of the room; infinite without one
  double upper;
};

/// `upper` for the border or the wall on the side of larger coordinates.
BorderEvent first_border(Track const& track, Limits const& limits, Scale const& scale, Side lower, Side upper) {
  BorderEvent first{never, lower, Border::of_cell};
  bool const is_upwards = track.velocity > 0.0;
  bool const is_first = limits.index == 0 && !limits.is_periodic;
  bool const is_last = limits.index == limits.count - 1 && !limits.is_periodic;
  if (track.velocity != 0.0) {
    double const edge = limits.edges[limits.index + (is_upwards ? 1 : 0)];
    double const end = is_upwards ? limits.upper : limits.lower;
    bool const is_end_nearer = is_upwards ? end < edge : end > edge;
    bool const is_wall = is_upwards ? is_last : is_first;
    if (is_end_nearer || !is_wall) {
      first = {((is_end_nearer ? end : edge) - track.place) / track.velocity, is_upwards ? upper : lower,
               is_end_nearer ? Border::of_place : Border::of_cell};
    }
  }
  auto const consider_wall = [&](double gap, double outwards, Side side) {
    double const approach = outwards + track.radius * scale.rate;
    if (!(approach > 0.0)) return;
    double const time = track.last_hit + gap / approach;
    if (time < first.time) first = {time, side, Border::wall};
  };
  double const place = track.place + track.velocity * track.last_hit;
  double const radius = track.radius * scale.at(track.last_hit);
  if (is_first) consider_wall(place - radius, -track.velocity, lower);
  if (is_last) consider_wall((limits.side - place) - radius, track.velocity, upper);
  return first;
}

/// The contacts with the neighbours of a list.
void consider_neighbours(PredictionInput const& s, Index i, EarliestGrowing& earliest) {
  Neighbours const& list = s.neighbours[i];
  for (std::uint32_t k = 0; k < list.count; ++k) earliest.consider_nearest_image(list.disks[k]);
}

}  // namespace

BorderEvent border_event_growing(PredictionInput const& s, Index i) {
  MovingDisk const& disk = s.disks[i];
  Place const place = s.places != nullptr ? s.places[i] : Place{0.0, 0.0};
  double const room = s.places != nullptr ? s.room : never;
  BorderEvent const vertical =
      first_border({disk.x, disk.velocity_x, s.radius[i], s.last_hit[i]},
                   {s.column_edges, disk.column, s.columns, s.width, s.is_periodic, place.x - room, place.x + room},
                   s.scale, Side::left, Side::right);
  BorderEvent const horizontal =
      first_border({disk.y, disk.velocity_y, s.radius[i], s.last_hit[i]},
                   {s.row_edges, disk.row, s.rows, s.height, s.is_periodic, place.y - room, place.y + room}, s.scale,
                   Side::bottom, Side::top);
  return horizontal.time < vertical.time ? horizontal : vertical;
}

Prediction predict_growing(PredictionInput const& s, Index i, double now, Index apart) {
  EarliestGrowing earliest(s, i, now, apart, border_growing(s, i, now));
  if (s.neighbours != nullptr && s.neighbours[i].has_all()) {
    consider_neighbours(s, i, earliest);
    return earliest.best();
  }
  MovingDisk const& disk = s.disks[i];
  for (std::int32_t row = disk.row - 1; row <= disk.row + 1; ++row) {
    double const shift_y = shift_of_image(row, s.rows, s.height);
    Index const* slot =
        s.slots + static_cast<std::size_t>(row + 1) * s.row_stride + static_cast<std::size_t>(disk.column) * s.capacity;
    for (std::int32_t column = disk.column - 1; column <= disk.column + 1; ++column) {
      double const shift_x = shift_of_image(column, s.columns, s.width);
      // The first slots of a cell are the ones in use.
      for (std::size_t k = 0; k < s.capacity && slot[k] != no_disk; ++k) {
        if (slot[k] != i) earliest.consider(slot[k], shift_x, shift_y);
      }
      slot += s.capacity;
    }
  }
  return earliest.best();
}

PairPrediction predict_pair_growing(PredictionInput const& s, Index i, Index j, double now) {
  return {predict_growing(s, i, now, j), predict_growing(s, j, now, i)};
}

}  // namespace gridlock::exact
