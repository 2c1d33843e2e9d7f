#pragma once

#include <fmt/format.h>

#include <cstdint>
#include <string>
#include <vector>

#include "gridlock/engine/engine.hpp"
#include "gridlock/lattice/start.hpp"

namespace gridlock::golden {

struct Scene {
  std::string name;
  Box box;
  DisksSettings disks;
  VelocitySettings velocities;
  EngineSettings engine;
  double time = 1.0;
};

inline std::vector<Scene> scenes() {
  Box const walls(1.0, 1.0, Edge::wall);
  Box const periodic(1.0, 1.0, Edge::periodic);
  return {
      {.name = "paper",
       .box = walls,
       .disks = {.count = 841, .packing_fraction = 0.7},
       .engine = {.cells = 10},
       .time = 0.5},
      {.name = "triangular",
       .box = walls,
       .disks = {.count = 400, .packing_fraction = 0.8, .start = StartKind::triangular},
       .engine = {.contact = CollisionRule::approaching}},
      {.name = "mixture",
       .box = periodic,
       .disks = {.count = 200,
                 .packing_fraction = 0.4,
                 .start = StartKind::random,
                 .species = {{.fraction = 0.5}, {.fraction = 0.5, .size_ratio = 1.4, .mass = 1.96}}},
       .velocities = {.kind = VelocityKind::maxwell}},
      {.name = "rectangle",
       .box = Box(3.0, 0.7, Edge::periodic),
       .disks = {.count = 150, .packing_fraction = 0.6, .start = StartKind::triangular},
       .engine = {.time_step = 0.3, .substeps = 2}},
      {.name = "gas", .box = walls, .disks = {.count = 100, .packing_fraction = 0.02}, .time = 10.0},
      {.name = "few", .box = periodic, .disks = {.count = 4, .packing_fraction = 0.4}, .time = 20.0},
      // Enough disks for many tiles of each colour; in the second one some cells hold more disks than a block.
      {.name = "crowd",
       .box = walls,
       .disks = {.count = 10'000, .packing_fraction = 0.65, .start = StartKind::triangular},
       .time = 0.05},
      {.name = "large_and_small",
       .box = periodic,
       .disks = {.count = 4'000,
                 .packing_fraction = 0.3,
                 .start = StartKind::random,
                 .species = {{.fraction = 0.9}, {.fraction = 0.1, .size_ratio = 4.0, .mass = 16.0}}},
       .time = 0.05},
      {.name = "obstacles",
       .box = Box(1.3, 0.8, Edge::periodic),
       .disks = {.count = 300,
                 .packing_fraction = 0.4,
                 .start = StartKind::random,
                 .species = {{.fraction = 0.25, .size_ratio = 1.5, .fixed = true}, {.fraction = 0.75}}},
       .time = 0.5},
  };
}

/// Scenes in boxes that are periodic along one axis; in one of them with walls inside the box.
inline std::vector<Scene> scenes_of_channels() {
  Box const channel(1.4, 0.9, Edge::periodic, Edge::wall);
  return {
      {.name = "channel",
       .box = channel,
       .disks = {.count = 200,
                 .packing_fraction = 0.4,
                 .start = StartKind::random,
                 .species = {{.fraction = 0.5}, {.fraction = 0.5, .size_ratio = 1.4, .mass = 1.96}}},
       .velocities = {.kind = VelocityKind::maxwell}},
      // Enough disks for threads to share, and for many tiles.
      {.name = "channel_crowd",
       .box = channel,
       .disks = {.count = 10'000, .packing_fraction = 0.6, .start = StartKind::triangular},
       .time = 0.05},
      // Disks flow through a gap into the other half, and through the edge.
      {.name = "partition",
       .box = channel,
       .disks = {.count = 400, .packing_fraction = 0.4, .start = StartKind::triangular, .region = {0.1, 0.0, 0.7, 0.9}},
       .engine = {.walls = {{.from = {0.7, 0.0}, .to = {0.7, 0.4}},
                            {.from = {0.7, 0.5}, .to = {0.7, 0.9}},
                            {.from = {0.0, 0.3}, .to = {0.1, 0.6}},
                            {.from = {1.0, 0.2}, .to = {1.2, 0.2}}}}},
      {.name = "upright_channel",
       .box = Box(0.9, 1.4, Edge::wall, Edge::periodic),
       .disks = {.count = 6'000, .packing_fraction = 0.5, .start = StartKind::triangular},
       .time = 0.05},
  };
}

/// Scenes of what the engine exact alone has: thermostats and grains.
inline std::vector<Scene> scenes_of_exact() {
  ThermostatSettings const brownian{.kind = ThermostatKind::brownian, .temperature = 0.5, .interval = 0.004};
  return {
      {.name = "brownian",
       .box = Box(1.2, 1.0, Edge::periodic),
       .disks = {.count = 300,
                 .packing_fraction = 0.4,
                 .start = StartKind::random,
                 .species = {{.fraction = 0.5}, {.fraction = 0.5, .size_ratio = 1.4, .mass = 1.96}}},
       .engine = {.thermostat = brownian},
       .time = 0.5},
      // Enough disks for threads to share.
      {.name = "brownian_crowd",
       .box = Box(1.0, 1.0, Edge::periodic),
       .disks = {.count = 10'000, .packing_fraction = 0.5, .start = StartKind::triangular},
       .engine = {.thermostat = brownian},
       .time = 0.05},
      {.name = "andersen",
       .box = Box(1.2, 1.0, Edge::wall),
       .disks = {.count = 300, .packing_fraction = 0.5, .start = StartKind::random},
       .engine = {.thermostat = {.kind = ThermostatKind::andersen, .temperature = 0.5, .rate = 20.0}},
       .time = 0.5},
      {.name = "inelastic",
       .box = Box(1.2, 1.0, Edge::periodic),
       .disks = {.count = 300, .packing_fraction = 0.5, .start = StartKind::random},
       .engine = {.collisions = {.restitution = 0.9}},
       .time = 0.5},
      {.name = "falling",
       .box = Box(1.2, 1.0, Edge::wall),
       .disks = {.count = 300,
                 .packing_fraction = 0.4,
                 .start = StartKind::random,
                 .species = {{.fraction = 0.5}, {.fraction = 0.5, .size_ratio = 1.4, .mass = 1.96}}},
       .engine = {.gravity = {.x = 0.3, .y = -2.0}},
       .time = 0.5},
      {.name = "grains",
       .box = Box(1.0, 1.0, Edge::wall),
       .disks = {.count = 100,
                 .packing_fraction = 0.2,
                 .species = {{.fraction = 0.1, .fixed = true}, {.fraction = 0.9}}},
       .engine = {.collisions = {.restitution = 0.8, .wall_restitution = 0.9, .contact_time = 1e-3},
                  .gravity = {.y = -1.0},
                  .walls = {{.from = {0.1, 0.3}, .to = {0.5, 0.3}}, {.from = {0.8, 0.2}, .to = {0.8, 0.7}}}}},
      {.name = "brownian_active",
       .box = Box(1.2, 1.0, Edge::periodic),
       .disks = {.count = 300, .packing_fraction = 0.4, .start = StartKind::random},
       .engine = {.speed = 1.5, .thermostat = brownian, .propulsion = {.speed = 1.5, .rotational_diffusion = 5.0}},
       .time = 0.5},
      {.name = "oblique",
       .box = Box(1.2, 1.0, Edge::periodic).tilted(0.35),
       .disks = {.count = 300,
                 .packing_fraction = 0.4,
                 .start = StartKind::random,
                 .species = {{.fraction = 0.1, .fixed = true},
                             {.fraction = 0.5},
                             {.fraction = 0.4, .size_ratio = 1.4}}},
       .time = 0.5},
      // Enough disks for threads to share.
      {.name = "oblique_crowd",
       .box = Box(1.0, 1.3, Edge::periodic).tilted(-0.25),
       .disks = {.count = 10'000, .packing_fraction = 0.6, .start = StartKind::square},
       .time = 0.05},
  };
}

/// Scenes of self-propelled disks, for the engines with a time step.
inline std::vector<Scene> scenes_of_active_disks() {
  PropulsionSettings const propulsion{.speed = 0.5, .rotational_diffusion = 2.0};
  return {
      {.name = "active",
       .box = Box(1.2, 1.0, Edge::periodic),
       .disks = {.count = 300,
                 .packing_fraction = 0.5,
                 .start = StartKind::random,
                 .species = {{.fraction = 0.5}, {.fraction = 0.5, .size_ratio = 1.4, .mass = 1.96}}},
       .engine = {.speed = 0.5, .propulsion = propulsion},
       .time = 2.0},
      {.name = "active_crowd",
       .box = Box(1.0, 1.0, Edge::wall),
       .disks = {.count = 10'000, .packing_fraction = 0.6, .start = StartKind::triangular},
       .engine = {.speed = 0.5, .propulsion = propulsion},
       .time = 0.1},
  };
}

/// Scenes of the engine soft, one for each potential and each dynamics.
inline std::vector<Scene> scenes_of_soft_disks() {
  DisksSettings const mixture{.count = 300,
                              .packing_fraction = 0.6,
                              .start = StartKind::random,
                              .species = {{.fraction = 0.5}, {.fraction = 0.5, .size_ratio = 1.4, .mass = 1.96}}};
  DisksSettings const equal{.count = 300, .packing_fraction = 0.6, .start = StartKind::triangular};
  Box const box(1.2, 1.0, Edge::periodic);
  auto const bath = [](ThermostatKind kind, double friction) {
    return ThermostatSettings{.kind = kind, .temperature = 0.5, .friction = friction};
  };
  auto const scene = [&](char const* name, DisksSettings const& disks, PairPotential potential, double time_step) {
    return Scene{.name = name,
                 .box = box,
                 .disks = disks,
                 .engine = {.time_step = time_step, .speed = 1.0, .potential = {.kind = potential}},
                 .time = 0.1};
  };
  std::vector<Scene> all{scene("soft_harmonic", mixture, PairPotential::harmonic, 0.02),
                         scene("soft_hertzian", equal, PairPotential::hertzian, 0.02),
                         scene("soft_power", mixture, PairPotential::inverse_power, 0.002),
                         scene("soft_liquid", equal, PairPotential::lennard_jones, 0.004),
                         scene("soft_langevin", mixture, PairPotential::wca, 0.004),
                         scene("soft_overdamped", mixture, PairPotential::wca, 0.001),
                         scene("soft_active", equal, PairPotential::wca, 0.001),
                         scene("soft_flow", mixture, PairPotential::wca, 0.004),
                         scene("soft_table", mixture, PairPotential::table, 0.004),
                         scene("soft_drag", mixture, PairPotential::harmonic, 0.02)};
  all[4].engine.thermostat = bath(ThermostatKind::langevin, 5.0);
  all[5].engine.thermostat = bath(ThermostatKind::overdamped, 100.0);
  all[6].engine.thermostat = bath(ThermostatKind::overdamped, 100.0);
  all[6].engine.propulsion = {.speed = 1.0, .rotational_diffusion = 5.0};
  all[7].engine.thermostat = bath(ThermostatKind::langevin, 5.0);
  all[7].engine.flow = {.shear_rate = 10.0};
  all[8].engine.potential.distances = {0.5, 0.6, 0.7, 0.8, 0.9, 1.0, 1.1, 1.2, 1.35, 1.5};
  all[8].engine.potential.energies = {60.0, 40.0, 24.0, 12.0, 5.0, 1.0, -0.5, -0.8, -0.4, 0.0};
  all[9].engine.flow = {.shear_rate = 10.0};
  all[9].engine.pair_drag = {.coefficient = 5.0, .direction = DragDirection::normal};
  return all;
}

/// Scenes of event chains: equal disks, for which there are kernels of their own, and disks of two sizes.
inline std::vector<Scene> scenes_of_chains() {
  Scene const equal{.name = "chains",
                    .box = Box(1.2, 0.8, Edge::periodic),
                    .disks = {.count = 400, .packing_fraction = 0.7, .start = StartKind::triangular},
                    .velocities = {.kind = VelocityKind::maxwell},
                    .engine = {.chain_length = 50}};
  Scene newtonian = equal;
  newtonian.name = "chains_newtonian";
  newtonian.engine.chains = ChainKind::newtonian;
  Scene mixture = newtonian;
  mixture.name = "chains_of_two_sizes";
  mixture.disks = {.count = 200,
                   .packing_fraction = 0.4,
                   .start = StartKind::random,
                   .species = {{.fraction = 0.5}, {.fraction = 0.5, .size_ratio = 1.4}}};
  return {equal, newtonian, mixture};
}

inline constexpr std::uint64_t seed = 20;

/// How a scene starts.
inline State start_of(Scene const& scene) {
  State state = make_start(scene.box, scene.disks, seed);
  draw_velocities(state, scene.velocities);
  return state;
}

inline std::string hash_text(State const& state) { return fmt::format("{:016x}", hash(state)); }

}  // namespace gridlock::golden
