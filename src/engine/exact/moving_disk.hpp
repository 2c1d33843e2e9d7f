#pragma once

#include <cstdint>
#include <limits>

namespace gridlock::exact {

/// The name of a disk inside the engine: its place in memory, which changes when the disks are put in cell order.
using Index = std::uint32_t;

/// The border that a disk meets next, where that is no other disk: that of its cell, or the wall there.
inline constexpr Index vertical_border = std::numeric_limits<Index>::max() - 1;
inline constexpr Index horizontal_border = std::numeric_limits<Index>::max();

/// The time of what does not happen.
inline constexpr double never = std::numeric_limits<double>::infinity();

/// An empty slot of a cell.
inline constexpr Index no_disk = std::numeric_limits<Index>::max();

/// One disk in free flight, with the one event it waits for.
///
/// The centre at time t of the present epoch is (x + velocity_x·t, y + velocity_y·t): all disks share one clock, so no
/// disk is ever brought up to date, and a prediction reads this one cache line of each neighbour and nothing else.
///
///     byte  0   8   16          24          32          40        48       52                       56               60
///           x   y   velocity_x  velocity_y  event_time  last_hit  partner  partner_collision_count  collision_count  id_index
struct alignas(64) MovingDisk {
  double x;
  double y;
  double velocity_x;
  double velocity_y;
  double event_time;  ///< when the disk's event is due, in time of the epoch; never earlier than now
  double last_hit;    ///< when its velocity last changed, in this epoch; 0 where it has not
  Index partner;      ///< the disk it is to meet, or a border
  /// The partner's collision count when the event was predicted; another one means that it was hit since.
  std::uint32_t partner_collision_count;
  std::uint32_t
      collision_count;  ///< how often this disk's velocity has changed, or its coordinates at the edge of a periodic box
  std::uint32_t id_index;  ///< place in the order of Ids; breaks ties
};
static_assert(sizeof(MovingDisk) == 64);

/// The cell of a disk.
struct Cell {
  std::int32_t column;
  std::int32_t row;

  friend bool operator==(Cell const&, Cell const&) = default;
};

/// Gives a disk a change of velocity at time `now`: its centre at the zero of time moves so that its path does not
/// jump.
inline void change_velocity(MovingDisk& disk, double change_x, double change_y, double now) {
  disk.velocity_x += change_x;
  disk.velocity_y += change_y;
  disk.x -= change_x * now;
  disk.y -= change_y * now;
  disk.last_hit = now;
  ++disk.collision_count;
}

}  // namespace gridlock::exact
