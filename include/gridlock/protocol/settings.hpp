#pragma once

/// \file
/// The settings of a protocol, the stages that change disks before a run.
///
/// ```cpp
/// std::vector<StageSettings> const stages{{.kind = "quench", .packing_fraction = 0.86},
///                                         {.kind = "decompress", .until_pressure = 1e-8}};
/// require_valid(stages);  // throws Error for stages that contradict themselves
/// ```

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "gridlock/core/setting.hpp"
#include "gridlock/engine/engine.hpp"
#include "gridlock/packing/quasistatic_shear.hpp"

namespace gridlock {

/// One stage, `[[protocol]]`. Each setting lists the kinds of stage that use it.
struct StageSettings {
  std::string kind = "quench";                     ///< one of stage_kinds()
  std::optional<double> rate;                      ///< grow: growth rate γ
  std::optional<double> packing_fraction;          ///< quench: packing fraction at which it is made
  BoxShape box_shape = BoxShape::fixed;            ///< quench, compress, decompress
  std::optional<double> until_packing_fraction;    ///< grow, compress, decompress
  std::optional<double> until_pressure;            ///< grow: reduced pressure; compress, decompress: pressure in ε/D²
  std::optional<double> until_time;                ///< run
  std::optional<double> collisions_per_disk;       ///< run
  std::optional<std::uint64_t> levels_per_decade;  ///< decompress
  std::optional<double> step;                      ///< compress, decompress: step of the packing fraction
  std::optional<std::uint64_t> sweeps;             ///< swap, monte_carlo, event_chain
  std::optional<double> pressure;                  ///< swap, monte_carlo: βP D̄², D̄ the mean diameter
  std::optional<double> swap_fraction;             ///< swap
  ChainKind chains = ChainKind::straight;          ///< event_chain: as engine.chains
  std::optional<std::uint64_t> chain_length;       ///< event_chain: as engine.chain_length
  Deformation deformation = Deformation::simple_shear;  ///< shear
  std::optional<double> strain_step;                    ///< shear: strain between two minima
  std::optional<double> until_strain;                   ///< shear: strain at the end, or the amplitude of cycles
  std::optional<double> until_stress;                   ///< shear: |σ| in ε/D²
  std::optional<std::uint64_t> cycles;                  ///< shear
  std::optional<double> strain_accuracy;                ///< shear: strain within which an event is found
  std::optional<double> min_drop;                       ///< shear: least drop of the stress that is an event
};
void describe(StageSettings& settings, SettingVisitor& visitor);

/// The settings `[soft]`.
struct SoftSettings {
  Potential potential = Potential::harmonic;
  double residual = 1e-8;
};
void describe(SoftSettings& settings, SettingVisitor& visitor);

/// Returns the kinds of stages: "grow", "run" …
std::vector<std::string> stage_kinds();

/// Returns whether disks may overlap at the end of a stage. Errors: Error for a kind that is not in stage_kinds().
bool leaves_overlaps(std::string_view kind);

/// Returns whether a stage leaves a tilt. Errors: Error for a kind that is not in stage_kinds().
bool tilts(StageSettings const& stage);

/// Throws Error, with the setting, for a stage of an unknown kind, with settings of other kinds, without a setting that
/// it needs, that cannot follow the stage before, or that ends at a packing fraction on the wrong side of that of its
/// start.
///
/// `packing_fraction` belongs to the start of the first stage; empty if it is not known.
void require_valid(std::vector<StageSettings> const& stages, std::optional<double> packing_fraction = {});

}  // namespace gridlock
