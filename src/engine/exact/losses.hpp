#pragma once

namespace gridlock::exact {

/// The energy that collisions lose: the normal part of the relative velocity becomes −e times itself.
struct Losses {
  double restitution = 1.0;       ///< e of two disks, one of which may be fixed
  double wall_restitution = 1.0;  ///< e of a disk and a wall
  double contact_time = 0.0;      ///< e is 1 for a disk that collided a shorter time ago

  [[nodiscard]] bool has_any() const { return restitution != 1.0 || wall_restitution != 1.0; }
};

}  // namespace gridlock::exact
