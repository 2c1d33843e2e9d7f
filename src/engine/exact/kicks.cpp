#include <algorithm>
#include <array>
#include <cmath>

#include "core/unwrapped.hpp"
#include "engine/exact/dynamics.hpp"
#include "engine/exact/strips.hpp"

namespace gridlock::exact {

namespace {

/// Hits of a disk in an epoch, on average, so that the calendar stays small.
constexpr double hits_until_next_epoch = 32.0;

}  // namespace

/// Whether a kick may come at the time `elapsed` of this epoch, in which nothing else is left to happen: then the epoch
/// must not end before.
bool Dynamics::may_be_kicked(double elapsed) const {
  return thermal_speed_squared_ > 0.0 && elapsed - epoch_start_ <= epoch_length_;
}

/// As begin_epoch(), but cells and lists stay as they are, for the disks are where they were: they are made anew, and
/// the disks sorted in memory, only after as long a time as the longest epoch.
void Dynamics::kick_all(double elapsed, double next, VelocitiesOf const& velocities_of) {
  double const duration = std::max(elapsed - epoch_start_, now_);
  auto const hits = static_cast<double>(hits_ - hits_before_epoch_);
  auto const events = static_cast<double>(events_made());
  bool const was_shared = strips_ != nullptr;
  move_zero_of_time(duration);
  now_ = 0.0;
  give_velocities(velocities_of);
  double const hits_per_time = duration > 0.0 ? hits / (static_cast<double>(size_) * duration) : 0.0;
  longest_epoch_ = longest_epoch();
  next_kick_ = next;
  epoch_length_ = std::min(longest_epoch_, next_kick_ - epoch_start_);
  if (hits > 0.0) epoch_length_ = std::min(epoch_length_, power_of_two_below(hits_until_next_epoch / hits_per_time));
  if (duration > 0.0) expected_events_ = static_cast<std::uint64_t>(events * (epoch_length_ / duration));
  time_since_sort_ += duration;
  bool const is_sort_due = time_since_sort_ >= longest_epoch_;
  if (is_sort_due) time_since_sort_ = 0.0;
  if (hits > 0.0 && share_epoch(hits_per_time, is_sort_due)) return;
  strips_ = nullptr;
  if (is_sort_due || was_shared) {
    renew_lists(0.0);
    make_room_in_cells(0.0);
    if (is_sort_due) sort_disks_by_cell(0.0);
  }
  refresh_prediction_input();
  predict_all(0.0);
  open_calendar();
}

void Dynamics::give_velocities(VelocitiesOf const& velocities_of) {
  constexpr std::size_t at_once = 64;
  std::array<Id, at_once> ids;
  std::array<std::uint32_t, at_once> id_indices;
  std::array<double, at_once> masses;
  std::array<Vector, at_once> velocities;
  for (std::size_t first = 0; first < size_; first += at_once) {
    std::size_t const count = std::min(at_once, size_ - first);
    for (std::size_t k = 0; k < count; ++k) {
      auto const i = static_cast<Index>(first + k);
      ids[k] = id_of(i);
      id_indices[k] = disks_[i].id_index;
      masses[k] = mass_of(i);
    }
    velocities_of({.ids = std::span(ids).first(count),
                   .id_indices = std::span(id_indices).first(count),
                   .masses = std::span(masses).first(count)},
                  std::span(velocities).first(count));
    for (std::size_t k = 0; k < count; ++k) {
      MovingDisk& disk = disks_[first + k];
      disk.velocity_x = velocities[k].x;
      disk.velocity_y = velocities[k].y;
      disk.last_hit = 0.0;
    }
  }
}

void Dynamics::visit_disks(double elapsed, std::function<void(Id, std::uint32_t, Vector)> const& visit) const {
  double const time = std::max(elapsed - epoch_start_, now_);
  for (std::size_t i = 0; i < size_; ++i) {
    // As in write_at(), so that the bits are those of any number of threads.
    MovingDisk const& disk = disks_[i];
    int x = image_[i].x;
    int y = image_[i].y;
    Vector const p = box_.wrap(centre_at(disk, gravity_, time), x, y);
    Vector const crossed{static_cast<double>(x), static_cast<double>(y)};
    visit(id_of(static_cast<Index>(i)), disk.id_index, unwrapped_displacement(box_, {}, p, crossed));
  }
}

Id Dynamics::kick(double elapsed, std::uint32_t id_index, VelocityOf const& velocity_of) {
  now_ = std::max(elapsed - epoch_start_, now_);
  Index const i = disk_of(id_index);
  MovingDisk& disk = disks_[i];
  Vector const v = velocity_of(id_of(i), id_index, mass_of(i));
  Vector const at_zero = v - now_ * gravity_;
  disk.x += (disk.velocity_x - at_zero.x) * now_;
  disk.y += (disk.velocity_y - at_zero.y) * now_;
  disk.velocity_x = at_zero.x;
  disk.velocity_y = at_zero.y;
  disk.last_hit = now_;
  ++disk.collision_count;
  Id const id = id_of(i);
  if (next_event() != nullptr) {
    schedule(i, predictor_.one(prediction_input_, i, now_));
  } else {
    begin_epoch(now_, epoch_length_);  // the calendar has come to its end
  }
  return id;
}

Index Dynamics::disk_of(std::uint32_t id_index) {
  bool const is_known = id_index < disk_of_.size() && disks_[disk_of_[id_index]].id_index == id_index;
  if (!is_known) disk_of_ = disks_by_id_index();
  return disk_of_[id_index];
}

}  // namespace gridlock::exact
