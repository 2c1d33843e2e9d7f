#pragma once

/// \file
/// Grains: collisions that lose energy, gravity, and walls inside the box.
///
/// ```cpp
/// #include "gridlock/engine/engine.hpp"
/// #include "gridlock/lattice/start.hpp"
///
/// State state = make_start(Box(1.0, 1.0, Edge::wall), {.count = 100, .packing_fraction = 0.3}, 1);
/// Counters counters;
/// EngineSettings const grains{.kind = "exact",
///                             .collisions = {.restitution = 0.9, .contact_time = 1e-6},
///                             .gravity = {.y = -1.0},
///                             .walls = {{.from = {0.0, 0.4}, .to = {0.5, 0.2}}}};
/// make_engine(grains, state)->advance(state, counters, {.time = 1.0});
/// ```

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "gridlock/core/disks.hpp"
#include "gridlock/core/setting.hpp"
#include "gridlock/core/vector.hpp"

namespace gridlock {

/// The settings `[collisions]`, which the engine `exact` knows. The normal part v_n of the relative velocity of two
/// disks becomes −e v_n. Collisions that lose energy may come without end in a finite time, the inelastic collapse: the
/// remedy is the TC model (Luding and McNamara 1998, doi:10.1007/s100350050017), in which a disk that collided less
/// than `contact_time` ago collides with e = 1.
struct CollisionSettings {
  double restitution = 1.0;                ///< e of two disks, one of which may be fixed
  std::optional<double> wall_restitution;  ///< e of a disk and a wall; left out: restitution
  double contact_time = 0.0;               ///< 0: no contact lasts
  /// e of two disks by their kinds, AA, AB, …, BB, …: kinds of equal radius and mass, by radius and then by mass in
  /// ascending order. Empty: `restitution` for all.
  std::vector<double> restitution_by_kind = {};
  std::vector<double> wall_restitution_by_kind = {};  ///< e of a disk of kind A, B, … and a wall; empty: of_walls()

  [[nodiscard]] double of_walls() const { return wall_restitution.value_or(restitution); }
  /// Returns the smallest e of any collision.
  [[nodiscard]] double lowest() const;
  [[nodiscard]] bool lose_energy() const { return lowest() != 1.0; }
};
/// Largest number of kinds of disks that collisions tell apart.
inline constexpr std::size_t max_kinds_in_collisions = 64;
void describe(CollisionSettings& settings, SettingVisitor& visitor);

/// The settings `[gravity]`, which the engine `exact` knows: the acceleration of every disk that is not fixed.
struct GravitySettings {
  double x = 0.0;
  double y = 0.0;

  [[nodiscard]] Vector acceleration() const { return {x, y}; }
  [[nodiscard]] bool exists() const { return x != 0.0 || y != 0.0; }
};
void describe(GravitySettings& settings, SettingVisitor& visitor);

/// A wall inside the box, `[[walls]]`: the line between two points. Disks meet both of its sides and both of its ends.
struct WallSettings {
  std::vector<double> from;  ///< x and y
  std::vector<double> to;    ///< x and y
};
void describe(WallSettings& settings, SettingVisitor& visitor);

/// Errors: Error for a wall that is not two points of the box, and for a disk that overlaps a wall inside it.
/// Cost: O(disks · walls near them).
void require_room_beside_walls(State const& state, std::span<WallSettings const> walls);

}  // namespace gridlock
