#pragma once

/// \file
/// The settings of a protocol: what happens to disks before a run.
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
#include "gridlock/packing/soft_disks.hpp"

namespace gridlock {

/// One stage, `[[protocol]]`: it does one thing to the disks. A kind of stage takes the settings at which it is named.
struct StageSettings {
  std::string kind = "quench";                     ///< one of stage_kinds()
  std::optional<double> rate;                      ///< grow: γ
  std::optional<double> packing_fraction;          ///< quench: at which
  std::optional<double> until_packing_fraction;    ///< grow, compress, decompress
  std::optional<double> until_pressure;            ///< grow: reduced; compress, decompress: in ε/D²
  std::optional<double> until_time;                ///< run
  std::optional<double> collisions_per_disk;       ///< run
  std::optional<std::uint64_t> levels_per_decade;  ///< decompress
  std::optional<double> step;                      ///< compress, decompress: of the packing fraction
  std::optional<std::uint64_t> sweeps;             ///< swap
  std::optional<double> swap_fraction;             ///< swap
};
void describe(StageSettings& settings, SettingVisitor& visitor);

/// The settings `[soft]`.
struct SoftSettings {
  Potential potential = Potential::harmonic;
  double residual = 1e-8;
};
void describe(SoftSettings& settings, SettingVisitor& visitor);

/// "grow", "run" …
std::vector<std::string> stage_kinds();

/// Whether disks may overlap when such a stage has ended. Errors: Error for a kind that is none of stage_kinds().
bool leaves_overlaps(std::string_view kind);

/// Throws Error, with the place of each, for stages of an unknown kind, that have settings of others, lack one that
/// they need, start from what the stage before cannot leave, or end at a packing fraction on the other side of the one
/// at which they are known to begin.
///
/// The packing fraction is that of the start, where it is known.
void require_valid(std::vector<StageSettings> const& stages, std::optional<double> packing_fraction = {});

}  // namespace gridlock
