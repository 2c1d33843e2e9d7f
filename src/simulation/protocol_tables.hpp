#pragma once

#include <vector>

#include "gridlock/observe/observable.hpp"
#include "gridlock/protocol/protocol.hpp"

namespace gridlock {

/// Returns the table of correlations over the lag, for all stages of swap Monte Carlo.
Distribution swap_table(std::vector<StageResult> const& stages);

/// Returns the table of packing fractions over the sweeps, for all stages at constant pressure.
Distribution density_table(std::vector<StageResult> const& stages);

/// Returns the tables shear, shear_events, shear_motions and shear_cycles of all stages `shear`; without rows where
/// there are none.
std::vector<Distribution> shear_tables(std::vector<StageResult> const& stages);

/// Returns the entries of summary.json for the last stage of Monte Carlo, and for the last one at constant pressure.
std::vector<NamedEstimate> swap_results(std::vector<StageResult> const& stages);
/// Returns their names and meaning.
std::vector<ColumnInfo> swap_entries();

/// Returns the entries of summary.json for a stage `shear`.
std::vector<NamedEstimate> shear_results(ShearResult const& shear);
/// Returns their names and meaning.
std::vector<ColumnInfo> shear_entries();

}  // namespace gridlock
