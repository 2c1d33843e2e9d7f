#include "gridlock/engine/grains.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/magnitude.hpp"
#include "engine/obstacles.hpp"
#include "gridlock/core/error.hpp"

namespace gridlock {

namespace {

SettingInfo restitution_info(std::string_view key, std::string_view documentation) {
  return {.key = key, .documentation = documentation, .min = 0.0, .max = 1.0, .min_is_allowed = false};
}

/// Visits e by kind. Bounds are checked here, since visitors check those of single numbers only.
void visit_by_kind(SettingVisitor& visitor, std::string_view key, std::string_view documentation,
                   std::vector<double>& values) {
  visitor.visit({.key = key, .documentation = documentation, .default_note = "the same for all kinds"}, values);
  for (double const e : values) {
    if (e > 0.0 && e <= 1.0) continue;
    throw Error({.what = fmt::format("collisions.{} has the number {}, which is no coefficient of restitution", key, e),
                 .hint = "use numbers above 0 and up to 1",
                 .key = fmt::format("collisions.{}", key)});
  }
}

void require_in_box(Box const& box, WallSettings const& wall, std::size_t k) {
  std::string const key = fmt::format("walls[{}]", k);
  if (wall.from.size() != 2 || wall.to.size() != 2) {
    throw Error({.what = fmt::format("wall {} has {} and {} numbers for its two points", k + 1, wall.from.size(),
                                     wall.to.size()),
                 .hint = "give x and y of each, as in from = [0, 0.4] and to = [0.5, 0.2]",
                 .key = key});
  }
  for (auto const& point : {wall.from, wall.to}) {
    bool const is_inside = point[0] >= 0.0 && point[0] <= box.width() && point[1] >= 0.0 && point[1] <= box.height();
    if (is_inside) continue;
    throw Error({.what = fmt::format("wall {} has a point ({:.6g}, {:.6g}) outside the box of {} × {}", k + 1, point[0],
                                     point[1], box.width(), box.height()),
                 .hint = "points of walls lie in the box; in a periodic box cut the wall at the edge",
                 .key = key});
  }
  if (wall.from != wall.to) return;
  throw Error({.what = fmt::format("wall {} is the point ({:.6g}, {:.6g})", k + 1, wall.from[0], wall.from[1]),
               .hint = "give two different points, or use a fixed disk",
               .key = key});
}

}  // namespace

void describe(CollisionSettings& settings, SettingVisitor& visitor) {
  visitor.visit(restitution_info("restitution",
                                 "e: the normal part of the relative velocity of two disks of the engine exact becomes "
                                 "−e times itself; 1 is elastic."),
                settings.restitution);
  SettingInfo of_walls = restitution_info("wall_restitution", "e of a disk and a wall.");
  of_walls.default_note = "collisions.restitution";
  visitor.visit(of_walls, settings.wall_restitution);
  visitor.visit(
      {.key = "contact_time",
       .unit = "time",
       .documentation = "A disk that collided less than this time ago collides with e = 1 (the TC model), so that no "
                        "disk collides without end; far shorter than the time between collisions, or 0 for never.",
       .min = 0.0,
       .max = max_magnitude},
      settings.contact_time);
  visit_by_kind(
      visitor, "restitution_by_kind",
      "e of two disks by their kinds, AA, AB, …, BB, …: kinds of equal radius and mass, by radius and then by "
      "mass in ascending order.",
      settings.restitution_by_kind);
  visit_by_kind(visitor, "wall_restitution_by_kind", "e of a disk and a wall by the kind of the disk, A, B, ….",
                settings.wall_restitution_by_kind);
}

double CollisionSettings::lowest() const {
  double lowest =
      std::min(restitution_by_kind.empty() ? restitution : 1.0, wall_restitution_by_kind.empty() ? of_walls() : 1.0);
  for (double const e : restitution_by_kind) lowest = std::min(lowest, e);
  for (double const e : wall_restitution_by_kind) lowest = std::min(lowest, e);
  return lowest;
}

void describe(GravitySettings& settings, SettingVisitor& visitor) {
  visitor.visit({.key = "x",
                 .unit = "length / time²",
                 .documentation = "Acceleration of all disks of the engine exact that are not fixed, to the right.",
                 .min = -max_magnitude,
                 .max = max_magnitude},
                settings.x);
  visitor.visit({.key = "y",
                 .unit = "length / time²",
                 .documentation = "The same upwards: −1 pulls to the floor.",
                 .min = -max_magnitude,
                 .max = max_magnitude},
                settings.y);
}

void describe(WallSettings& settings, SettingVisitor& visitor) {
  visitor.visit({.key = "from", .unit = "length", .documentation = "x and y of one end."}, settings.from);
  visitor.visit({.key = "to", .unit = "length", .documentation = "x and y of the other end."}, settings.to);
}

std::vector<Obstacle> obstacles_of(std::span<WallSettings const> walls) {
  std::vector<Obstacle> obstacles;
  for (WallSettings const& wall : walls) {
    obstacles.push_back({.from = {wall.from[0], wall.from[1]}, .to = {wall.to[0], wall.to[1]}});
  }
  return obstacles;
}

Obstacles walls_of(std::span<WallSettings const> walls, Box const& box, double largest_radius) {
  return {box, obstacles_of(walls), largest_radius};
}

void require_room_beside_walls(State const& state, std::span<WallSettings const> walls) {
  for (std::size_t k = 0; k < walls.size(); ++k) require_in_box(state.box, walls[k], k);
  Disks const& disks = state.agents;
  Obstacles const obstacles = walls_of(walls, state.box, radius_range(disks).largest);
  if (obstacles.empty()) return;
  for (std::size_t i = 0; i < disks.size(); ++i) {
    Vector const p = position(disks, i);
    double const radius = disks.column<Radius>()[i];
    obstacles.view().for_each_near(p, p, [&](std::uint32_t k) {
      Obstacle const& wall = obstacles[k];
      double const distance = std::sqrt(squared_length(p - wall.nearest_to(p)));
      if (distance >= radius * (1.0 - rounding_at_walls) || is_fixed(disks, i)) return;
      throw Error({.what = fmt::format("disk {} at ({:.6g}, {:.6g}) of radius {:.6g} overlaps {} by {:.3g}",
                                       disks.ids()[i], p.x, p.y, radius, to_text(wall), radius - distance),
                   .hint = "move the wall, or start in a part of the box (disks.region), or from a file",
                   .key = "walls"});
    });
  }
}

}  // namespace gridlock
