#pragma once

/// \file
/// The loop of a run: chunks of steps, samples, writers, progress.
///
/// ```cpp
/// auto const run_to = [](Simulation& simulation, std::uint64_t step) {
///   Run run(simulation, {.stop_condition = {.step = step}, .sample_every = 10});
///   run.advance([](Progress const& progress) { return progress.seconds < 60.0; });
///   return run.record().series.numbers("time");
/// };
/// ```

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "gridlock/io/table.hpp"
#include "gridlock/simulation/detail/rate_limiter.hpp"
#include "gridlock/simulation/simulation.hpp"

namespace gridlock {

/// The progress of a run, which is reported a few times a second.
struct Progress {
  Clock clock;
  double fraction = 0.0;    ///< share of the run that is done, from 0 to 1
  Preparation preparation;  ///< progress of the protocol; complete in the run itself
  std::uint64_t steps = 0;  ///< steps done in this run
  double seconds = 0.0;     ///< real time since the start
  double agent_steps_per_second = 0.0;
  std::span<ColumnInfo const> columns;  ///< columns of the series, step and time first
  /// One value for each column; empty until the first sample after the start.
  std::span<double const> last_sample;
  [[nodiscard]] double seconds_left() const { return fraction > 0.0 ? seconds * (1.0 - fraction) / fraction : 0.0; }
};

/// A function called between two steps, or within a long step of `exact`; if it returns false, the run stops.
using OnProgress = std::function<bool(Progress const&)>;

/// A callback between two steps, or within a long step of `exact`, for example to save the simulation, which is then up
/// to date.
struct Callback {
  std::function<bool(std::uint64_t steps)> is_due;  ///< called as often as progress is reported
  std::function<void(std::uint64_t steps)> call;
  /// Called at the end of the run, before its last sample: a run saved here can be lengthened, with the same bits as a
  /// longer run.
  std::function<void(std::uint64_t steps)> call_at_end = {};
};

/// The length of a run so far, in each unit in which a length can be given.
struct Extent {
  std::uint64_t steps = 0;
  double time = 0.0;
  std::uint64_t pair_collisions = 0;
};
void serialize(Archive& archive, Extent& extent);

/// How a run ended.
enum class RunStatus { finished, interrupted, failed };
char const* to_text(RunStatus status);

/// A writer writes from a run at steps of its own choice, for example the frames of a trajectory.
class Writer {
 public:
  Writer() = default;
  Writer(Writer const&) = delete;
  Writer& operator=(Writer const&) = delete;
  virtual ~Writer() = default;

  /// Returns whether write() is due now, `steps` after the start of the run; called once for each step at which the run
  /// stops.
  [[nodiscard]] virtual bool is_due(std::uint64_t steps) const = 0;
  /// Returns the next step after `steps` at which write() is due, or `never_reached`. The run stops at this step.
  [[nodiscard]] virtual std::uint64_t next_after(std::uint64_t steps) const = 0;
  /// Writes the present state. `sample` is the row of the series of this step, without step and time. It is empty where
  /// the plan has no sample, also at the end of the run, so that the output does not depend on the
  /// length of the run.
  virtual void write(Simulation const& simulation, std::span<double const> sample) = 0;
  /// Flushes its files and serializes their lengths: a restored run cuts the files to these lengths.
  virtual void serialize(Archive& archive) = 0;
};

/// Returns the first columns of every series: step and time.
std::vector<ColumnInfo> clock_columns();

/// The length of a run, and how often it takes samples and reports progress.
struct RunPlan {
  StopCondition stop_condition;
  std::uint64_t sample_every = 100;  ///< steps between samples
  /// Samples for each factor of ten in the number of steps, p of them after sample_every · ⌊10^(k/p) + ½⌋ steps, k = 0,
  /// 1, 2 …; none of them counts for averages, whose blocks need even ones. 0: even samples.
  std::uint64_t samples_per_decade = 0;
  double equilibration = 0.0;  ///< share of the run that averages leave out at its start
  /// Real time between two reports of progress; 0: a report after every step.
  double seconds_per_look = 0.1;

  /// Returns whether a sample is due after so many steps; the start and the end have one besides.
  [[nodiscard]] bool is_sample_due(std::uint64_t steps) const;
  /// Returns the number of steps after which the next sample is due, or `never_reached`.
  [[nodiscard]] std::uint64_t next_sample(std::uint64_t steps) const;
};

/// The record of a run of any simulation.
struct RunRecord {
  RunStatus status = RunStatus::interrupted;
  std::string failure;  ///< the reason for RunStatus::failed
  Clock clock;
  std::uint64_t steps = 0;
  double time_step = 0.0;
  double seconds = 0.0;  ///< real time, without set-up
  std::size_t agents = 0;
  Preparation preparation;  ///< progress of the protocol
  std::uint64_t state_hash = 0;
  std::vector<Count> counts;
  Table series;  ///< step, time and one column per instantaneous or interval value
  std::vector<ColumnInfo> series_columns;
  std::vector<NamedEstimate> results;
  std::vector<Distribution> distributions;
  std::vector<Event> notes;  ///< notes on the preparation, the errors of results and the motion of agents

  [[nodiscard]] double agent_steps_per_second() const {
    return seconds > 0.0 ? static_cast<double>(steps) * static_cast<double>(agents) / seconds : 0.0;
  }
};

/// The loop of a run. It advances the simulation in chunks of steps, takes samples between chunks, and reports
/// progress.
///
/// A chunk ends at the next sample or writer, since starting a chunk costs time in some engines. Samples are taken at
/// the start, where the plan has them and at the end. The bits of the simulation and of the series
/// depend neither on how often progress is reported nor on interruptions nor, up to the sample at the end, on the
/// length of the run. The simulation must outlive the run.
class Run {
 public:
  Run(Simulation& simulation, RunPlan const& plan);

  /// Advances the simulation until the stop condition holds, on_progress asks to stop or an invariant breaks. May be
  /// called again after an interruption.
  RunStatus advance(OnProgress const& on_progress = {}, Callback const& callback = {});

  /// Like advance(), but stops at `step` of the clock at the latest. Such a stop takes no additional sample.
  RunStatus advance_to(std::uint64_t step, OnProgress const& on_progress = {}, Callback const& callback = {});

  /// Call it after restoring the simulation alone, at a step whose samples and frames were taken: the run goes on from
  /// there.
  void continue_from_here() { last_stop_ = simulation_.clock(); }

  /// Makes averages leave out samples up to `step` of the clock, in place of the equilibration of the plan.
  void leave_out_until(std::uint64_t step) { left_out_until_ = step; }

  /// Adds a writer, which must outlive the run.
  void add(Writer& writer) { writers_.push_back(&writer); }

  /// Returns whether only the sample at the end is left to do.
  [[nodiscard]] bool has_reached_end() const;
  /// Returns the length of the run so far.
  [[nodiscard]] Extent extent() const;
  /// Returns the share of a length in that of the run, from 0 to 1: the largest of steps, time and collisions.
  [[nodiscard]] double fraction_of(Extent const& extent) const;
  /// Returns the share of the run that is done, from 0 to 1.
  [[nodiscard]] double fraction_done() const { return fraction_of(extent()); }
  /// Returns the series so far, as in record().
  [[nodiscard]] Table const& series() const { return series_; }
  /// Returns the steps from the start to the last stop, at which samples and writers could be due; nothing before the
  /// first.
  [[nodiscard]] std::optional<std::uint64_t> last_stop() const;

  /// Call it after restoring a run of another length. Chooses the equilibration such that averages keep or leave out
  /// the same samples as so far, and later samples as in a run with this equilibration and length from its start. Keeps
  /// the equilibration of the plan if that does so already. Returns the equilibration, a share of the run.
  double fit_equilibration();

  [[nodiscard]] RunRecord record() const;

  /// Returns the quantities that the simulation has measured. A standard error that the series contradicts is left out,
  /// with a note in `notes`.
  [[nodiscard]] std::vector<NamedEstimate> results(std::vector<Event>* notes = nullptr) const;

  /// Serializes everything on which the rest of the run depends, with the simulation.
  void serialize(Archive& archive);

 private:
  [[nodiscard]] std::uint64_t steps_done() const { return simulation_.clock().step - first_.step; }
  void stop_here();
  void sample();
  void serialize_series(Archive& archive);
  [[nodiscard]] StopCondition next_stop() const;
  bool prepare(OnProgress const& on_progress, Callback const& callback);
  [[nodiscard]] double share_of_preparation() const;
  bool advance_one_chunk(OnProgress const& on_progress, Callback const& callback);
  void note_time();
  bool report(OnProgress const& on_progress);

  Simulation& simulation_;
  RunPlan plan_;
  RateLimiter rate_limiter_;
  Clock first_;
  std::uint64_t pause_at_ = std::numeric_limits<std::uint64_t>::max();
  std::optional<std::uint64_t> left_out_until_;  ///< a step of the clock, in place of the equilibration of the plan
  std::optional<Clock> last_stop_;               ///< the last step at which samples and writers could be due
  Extent last_left_out_;                  ///< length at the last sample that averages leave out; they always leave out
                                          ///< the first
  std::optional<Extent> first_averaged_;  ///< length at the first sample that averages include
  std::vector<double> last_row_;
  std::vector<Writer*> writers_;
  double seconds_ = 0.0;  ///< real time of all calls of advance()
  double seconds_before_ = 0.0;
  std::chrono::steady_clock::time_point resumed_at_;
  RunStatus status_ = RunStatus::interrupted;
  std::string failure_;
  std::vector<ColumnInfo> columns_;
  Table series_;
};

}  // namespace gridlock
