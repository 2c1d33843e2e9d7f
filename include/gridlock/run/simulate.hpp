#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "gridlock/engine/engine.hpp"
#include "gridlock/io/table.hpp"
#include "gridlock/observe/observable.hpp"
#include "gridlock/run/configuration.hpp"

namespace gridlock {

/// How far a run has come; handed out after every chunk of work.
struct Progress {
  double fraction = 0.0;    ///< of the run that is done, from 0 to 1
  std::uint64_t steps = 0;  ///< steps done in this run
  double seconds = 0.0;     ///< of real time so far
  double disk_steps_per_second = 0.0;
  [[nodiscard]] double seconds_left() const { return fraction > 0.0 ? seconds * (1.0 - fraction) / fraction : 0.0; }
};

/// Called after every chunk of work; returning false ends the run there.
using OnProgress = std::function<bool(Progress const&)>;

/// How a run ended.
enum class Ending { finished, interrupted, failed };
char const* to_text(Ending ending);

/// Everything a run leaves behind.
struct RunResult {
  Ending ending = Ending::finished;
  std::string failure;  ///< why, for Ending::failed
  State state;
  Tally tally;
  std::uint64_t steps = 0;
  double time_step = 0.0;
  double seconds = 0.0;  ///< real time, without set-up
  Table series;          ///< step, time and one column per instantaneous or interval value
  std::vector<ColumnInfo> series_columns;
  std::vector<NamedEstimate> results;
  std::vector<Distribution> distributions;
};

/// Runs a set-up to its horizon, sampling every observe.every steps and at the end.
///
/// The bits of state and series do not depend on how often progress is reported.
/// Errors: none for a run that breaks: it ends as Ending::failed with what there is.
RunResult simulate(Setup setup, OnProgress const& on_progress = {});

}  // namespace gridlock
