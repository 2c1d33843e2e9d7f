#include "engine/exact/prediction.hpp"

#include "engine/exact/earliest_contact.hpp"

namespace gridlock::exact {

namespace {

Prediction predict_one_by_one(PredictionInput const& s, Index i, double now, Index apart) {
  EarliestContact earliest(s, i, now, apart,
                           s.is_growing() ? predict_border_growing(s, i, now) : predict_border(s, i, now));
  if (s.neighbours != nullptr) {
    for (Index const j : s.neighbours_of(i)) earliest.consider_nearest_image(j);
    return earliest.best();
  }
  Cell const cell = s.cells[i];
  for (std::int32_t row = cell.row - 1; row <= cell.row + 1; ++row) {
    double const shift_y = shift_of_image(row, s.rows, s.height);
    Index const* slot =
        s.slots + static_cast<std::size_t>(row + 1) * s.row_stride + static_cast<std::size_t>(cell.column) * s.capacity;
    for (std::int32_t column = cell.column - 1; column <= cell.column + 1; ++column) {
      double const shift_x = shift_of_image(column, s.columns, s.width);
      // The used slots of a cell are the first ones.
      for (std::size_t k = 0; k < s.capacity && slot[k] != no_disk; ++k) {
        if (slot[k] != i) earliest.consider(slot[k], shift_x, shift_y);
      }
      slot += s.capacity;
    }
  }
  return earliest.best();
}

/// The motion of a growing disk in one coordinate.
struct Track {
  double place;
  double velocity;
  double radius;
  double last_hit;
};

/// Bounds of a growing disk in one coordinate: of its cell, or of the room around its place.
struct Range {
  double lower;
  double upper;
  double side;
  bool ends_at_lower_edge;  ///< whether the range ends at an edge of a periodic box
  bool ends_at_upper_edge;
  bool has_lower_wall;  ///< the disk may touch a wall at the lower bound
  bool has_upper_wall;
};

BorderEvent first_border(Track const& track, Range const& range, Scale const& scale, Border inner, Side lower,
                         Side upper) {
  BorderEvent first{never, lower, inner};
  if (track.velocity > 0.0) {
    first = {(range.upper - track.place) / track.velocity, upper, range.ends_at_upper_edge ? Border::edge : inner};
  } else if (track.velocity < 0.0) {
    first = {(range.lower - track.place) / track.velocity, lower, range.ends_at_lower_edge ? Border::edge : inner};
  }
  auto const consider_wall = [&](double gap, double outwards, Side side) {
    double const approach = outwards + track.radius * scale.rate;
    if (!(approach > 0.0)) return;
    double const time = track.last_hit + gap / approach;
    if (time < first.time) first = {time, side, Border::wall};
  };
  double const place = track.place + track.velocity * track.last_hit;
  double const radius = track.radius * scale.at(track.last_hit);
  if (range.has_lower_wall) consider_wall(place - radius, -track.velocity, lower);
  if (range.has_upper_wall) consider_wall((range.side - place) - radius, track.velocity, upper);
  return first;
}

}  // namespace

Predictor reference_predictor() {
  return {[](PredictionInput const& s, Index i, double now) { return predict_one_by_one(s, i, now, no_disk); },
          [](PredictionInput const& s, Index i, Index j, double now) {
            return PairPrediction{predict_one_by_one(s, i, now, j), predict_one_by_one(s, j, now, i)};
          }};
}

BorderEvent border_event_growing(PredictionInput const& s, Index i) {
  MovingDisk const& disk = s.disks[i];
  bool const has_place = s.places != nullptr;
  Border const inner = has_place ? Border::of_place : Border::of_cell;
  double const radius = s.radius_of(i);
  auto const range = [&](double place, double side, double const* limits, std::int32_t index, std::int32_t count,
                         bool is_periodic) {
    if (!has_place) {
      bool const is_first = index == 0;
      bool const is_last = index == count - 1;
      bool const has_lower_wall = is_first && !is_periodic;
      bool const has_upper_wall = is_last && !is_periodic;
      // A wall is no border of the cell: the disk touches it before its centre gets there.
      return Range{.lower = has_lower_wall ? -never : limits[std::ptrdiff_t{2} * index],
                   .upper = has_upper_wall ? never : limits[std::ptrdiff_t{2} * index + 1],
                   .side = side,
                   .ends_at_lower_edge = is_first,
                   .ends_at_upper_edge = is_last,
                   .has_lower_wall = has_lower_wall,
                   .has_upper_wall = has_upper_wall};
    }
    double const lower = place - s.room;
    double const upper = place + s.room;
    if (!is_periodic) {
      return Range{.lower = lower,
                   .upper = upper,
                   .side = side,
                   .ends_at_lower_edge = false,
                   .ends_at_upper_edge = false,
                   .has_lower_wall = true,
                   .has_upper_wall = true};
    }
    return Range{.lower = std::max(lower, 0.0),
                 .upper = std::min(upper, side),
                 .side = side,
                 .ends_at_lower_edge = lower <= 0.0,
                 .ends_at_upper_edge = upper >= side,
                 .has_lower_wall = false,
                 .has_upper_wall = false};
  };
  Place const place = has_place ? s.places[i] : Place{0.0, 0.0};
  BorderEvent const vertical =
      first_border({disk.x, disk.velocity_x, radius, disk.last_hit},
                   range(place.x, s.width, s.column_limits, s.cells[i].column, s.columns, s.is_periodic_x()), s.scale,
                   inner, Side::left, Side::right);
  BorderEvent const horizontal =
      first_border({disk.y, disk.velocity_y, radius, disk.last_hit},
                   range(place.y, s.height, s.row_limits, s.cells[i].row, s.rows, s.is_periodic_y()), s.scale, inner,
                   Side::bottom, Side::top);
  return horizontal.time < vertical.time ? horizontal : vertical;
}

bool has_room_for_registers(PredictionInput const& s) {
  // With fewer cells the nearest image of a disk may not be the one in the neighbouring cell.
  return s.neighbours != nullptr || ((!s.is_periodic_x() || s.columns >= 5) && (!s.is_periodic_y() || s.rows >= 5));
}

std::optional<Predictor> predictor_for(Target target, bool is_growing) {
  if (target == Target::scalar) return plain_predictor(is_growing);
  if (target == Target::avx512) return avx512_predictor(is_growing);
  return highway_predictor(target, is_growing);
}

Predictor fastest_predictor(PredictionInput const& s) {
  if (!has_room_for_registers(s)) return reference_predictor();
  return predictor_for(target(), s.is_growing()).value_or(plain_predictor(s.is_growing()));
}

}  // namespace gridlock::exact
