#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "gridlock/core/disks.hpp"

namespace gridlock::reference {

/// The rule of the paper written a second time, from its words alone: one record a disk, every disk looked at, nothing
/// shared with the library but the state it starts from. Its arithmetic is in the order the rule is written down, so it
/// must give the same bits.
///
/// It also keeps what the library does not: the virials of walls and of free flight, for the exact identity
///     Σ m r·v (end) − Σ m r·v (start) = flight + pairs + walls
/// of a walled box, r being measured from the centre of the box.
class PaperRule {
 public:
  struct Disk {
    std::uint64_t id;
    double x, y, vx, vy, radius, mass;
    int image_x = 0, image_y = 0;
  };

  std::vector<Disk> disks;  ///< in the order of their ids
  double width, height;
  bool is_periodic_x, is_periodic_y;
  double substep;  ///< in physical time
  int substeps = 5;
  bool scatters_always = true;

  std::uint64_t pair_collisions = 0;
  std::uint64_t halted_moves = 0;
  std::array<std::uint64_t, 4> wall_hits{};  ///< left, right, bottom, top
  double flight_virial = 0.0;                ///< Σ over accepted sub-steps of m v² δt
  double pair_virial = 0.0;                  ///< Σ over colliding pairs of r_i·Δp_i + r_j·Δp_j
  double wall_virial = 0.0;                  ///< Σ over wall hits of r·Δp

  PaperRule(State const& state, double time_step, int substeps_in, bool always)
      : width(state.box.width()),
        height(state.box.height()),
        is_periodic_x(state.box.is_periodic_x()),
        is_periodic_y(state.box.is_periodic_y()),
        substep(time_step / substeps_in),
        substeps(substeps_in),
        scatters_always(always) {
    for (std::size_t n = 0; n < state.agents.size(); ++n) {
      Disk const disk{.id = state.agents.ids()[n],
                      .x = state.agents.column<X>()[n],
                      .y = state.agents.column<Y>()[n],
                      .vx = state.agents.column<VelocityX>()[n],
                      .vy = state.agents.column<VelocityY>()[n],
                      .radius = state.agents.column<Radius>()[n],
                      .mass = state.agents.column<Mass>()[n],
                      .image_x = state.agents.column<ImageX>()[n],
                      .image_y = state.agents.column<ImageY>()[n]};
      auto place = disks.begin();
      while (place != disks.end() && place->id < disk.id) ++place;
      disks.insert(place, disk);
    }
  }

  void step() {
    for (Disk& disk : disks) turn(disk);
  }

  /// Σ m r·v about the centre of the box.
  [[nodiscard]] double virial() const {
    double sum = 0.0;
    for (Disk const& d : disks) sum += d.mass * ((d.x - width / 2) * d.vx + (d.y - height / 2) * d.vy);
    return sum;
  }

 private:
  struct Separation {
    double x, y;
  };

  static double shorter_displacement(double d, double side) {
    if (d > side / 2) return d - side;
    if (d < -side / 2) return d + side;
    return d;
  }

  [[nodiscard]] Separation separation(double from_x, double from_y, Disk const& to) const {
    double const dx = to.x - from_x;
    double const dy = to.y - from_y;
    return {is_periodic_x ? shorter_displacement(dx, width) : dx,
            is_periodic_y ? shorter_displacement(dy, height) : dy};
  }

  void turn(Disk& disk) {
    for (int m = 1; m <= substeps; ++m) {
      double x = disk.x + substep * disk.vx;
      double y = disk.y + substep * disk.vy;
      if (meets_wall(disk, x, y)) {
        ++halted_moves;
        return;
      }
      int image_x = disk.image_x;
      int image_y = disk.image_y;
      if (is_periodic_x) fold(x, width, image_x);
      if (is_periodic_y) fold(y, height, image_y);
      Disk* const partner = nearest_overlapped(disk, x, y);
      if (partner != nullptr) {
        collide(disk, *partner);
        ++halted_moves;
        return;
      }
      flight_virial += disk.mass * substep * (disk.vx * disk.vx + disk.vy * disk.vy);
      disk.x = x;
      disk.y = y;
      disk.image_x = image_x;
      disk.image_y = image_y;
    }
  }

  bool meets_wall(Disk& disk, double x, double y) {
    bool const left = !is_periodic_x && x < disk.radius;
    bool const right = !is_periodic_x && x > width - disk.radius;
    bool const bottom = !is_periodic_y && y < disk.radius;
    bool const top = !is_periodic_y && y > height - disk.radius;
    if (left || right) {
      wall_virial += (disk.x - width / 2) * (-2 * disk.mass * disk.vx);
      disk.vx = -disk.vx;
    }
    if (bottom || top) {
      wall_virial += (disk.y - height / 2) * (-2 * disk.mass * disk.vy);
      disk.vy = -disk.vy;
    }
    wall_hits[0] += left;
    wall_hits[1] += right;
    wall_hits[2] += bottom;
    wall_hits[3] += top;
    return left || right || bottom || top;
  }

  static void fold(double& p, double side, int& image) {
    if (p >= side) {
      p = p - side;
      ++image;
    } else if (p < 0) {
      double const folded = p + side;
      if (folded < side) {
        p = folded;
        --image;
      } else {
        p = 0;  // nearer to the lower edge than the upper edge can express
      }
    }
  }

  Disk* nearest_overlapped(Disk const& disk, double x, double y) {
    Disk* nearest = nullptr;
    double least = 0.0;
    for (Disk& other : disks) {  // rising ids, so that only a nearer one replaces a lower id
      if (&other == &disk) continue;
      Separation const d = separation(x, y, other);
      double const squared = d.x * d.x + d.y * d.y;
      double const contact = disk.radius + other.radius;
      if (squared >= contact * contact) continue;
      if (nearest == nullptr || squared < least) {
        nearest = &other;
        least = squared;
      }
    }
    return nearest;
  }

  void collide(Disk& i, Disk& j) {
    Separation const b = separation(i.x, i.y, j);
    double const wx = i.vx - j.vx;
    double const wy = i.vy - j.vy;
    double const approach = wx * b.x + wy * b.y;
    if (!scatters_always && approach <= 0.0) return;
    double const strength = 2.0 * approach / ((i.mass + j.mass) * (b.x * b.x + b.y * b.y));
    i.vx -= j.mass * strength * b.x;
    i.vy -= j.mass * strength * b.y;
    j.vx += i.mass * strength * b.x;
    j.vy += i.mass * strength * b.y;
    ++pair_collisions;
    // Δp_i = −Δp_j = −m_i m_j strength b, so r_i·Δp_i + r_j·Δp_j = b·Δp_j.
    pair_virial += i.mass * j.mass * strength * (b.x * b.x + b.y * b.y);
  }
};

}  // namespace gridlock::reference
