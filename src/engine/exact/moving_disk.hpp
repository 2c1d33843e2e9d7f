#pragma once

#include <cstdint>
#include <limits>

#include "gridlock/core/vector.hpp"

namespace gridlock::exact {

/// The index of a disk inside the engine: its position in memory, which changes when the disks are sorted by cell.
using Index = std::uint32_t;

/// Values of MovingDisk::partner where the next event is at a border: that of the disk's cell, or a wall there.
inline constexpr Index vertical_border = std::numeric_limits<Index>::max() - 1;
inline constexpr Index horizontal_border = std::numeric_limits<Index>::max();
/// Values of MovingDisk::partner from here on and below the borders: the obstacle to be met. Disks have lower numbers.
inline constexpr Index first_obstacle = Index{1} << 31U;

/// Time of an event that never comes.
inline constexpr double never = std::numeric_limits<double>::infinity();

/// Value of an empty slot of a cell.
inline constexpr Index no_disk = std::numeric_limits<Index>::max();

/// One disk in free flight, with the one event it waits for.
///
/// The centre at time t of the present epoch is (x + velocity_x·t, y + velocity_y·t): all disks share one clock, so no
/// disk is ever brought up to date, and a prediction reads this one cache line of each neighbour and nothing else. In
/// gravity g the centre is ½ g t² further, and the velocity at time t is g t larger: the same for all disks, so that
/// relative motions stay straight.
///
///     byte  0  8  16          24          32          40        48       52               56               60
///           x  y  velocity_x  velocity_y  event_time  last_hit  partner  partner_…_count  collision_count  id_index
struct alignas(64) MovingDisk {
  double x;
  double y;
  double velocity_x;
  double velocity_y;
  double event_time;  ///< time of the disk's event, counted from the start of the epoch; never earlier than the present
  double last_hit;    ///< time in this epoch when the velocity last changed; 0 if it has not
  Index partner;      ///< the disk to be met, or a border
  /// The partner's collision count when the event was predicted; if it differs now, the event is void.
  std::uint32_t partner_collision_count;
  std::uint32_t
      collision_count;     ///< number of changes of the velocity, or of the coordinates at the edge of a periodic box
  std::uint32_t id_index;  ///< index in the order of Ids; it breaks ties
};
static_assert(sizeof(MovingDisk) == 64);

/// The cell of a disk.
struct Cell {
  std::int32_t column;
  std::int32_t row;

  friend bool operator==(Cell const&, Cell const&) = default;
};

/// Returns ½ g t², by which the gravity g has moved every disk at time t of the epoch.
inline Vector fall(Vector gravity, double time) {
  return {0.5 * gravity.x * time * time, 0.5 * gravity.y * time * time};
}

/// Returns the centre of a disk at this time of the epoch.
inline Vector centre_at(MovingDisk const& disk, Vector gravity, double time) {
  return Vector{disk.x + disk.velocity_x * time, disk.y + disk.velocity_y * time} + fall(gravity, time);
}
/// Returns the velocity of a disk at this time of the epoch.
inline Vector velocity_at(MovingDisk const& disk, Vector gravity, double time) {
  return {disk.velocity_x + gravity.x * time, disk.velocity_y + gravity.y * time};
}

/// Changes a disk's velocity at time `now`, and its centre at the start of the epoch so that the path does not jump.
inline void change_velocity(MovingDisk& disk, double change_x, double change_y, double now) {
  disk.velocity_x += change_x;
  disk.velocity_y += change_y;
  disk.x -= change_x * now;
  disk.y -= change_y * now;
  disk.last_hit = now;
  ++disk.collision_count;
}

}  // namespace gridlock::exact
