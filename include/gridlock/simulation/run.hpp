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

/// How far a run has come; handed out a few times a second.
struct Progress {
  Clock clock;
  double fraction = 0.0;    ///< of the run that is done, from 0 to 1
  Preparation preparation;  ///< the stage of the protocol that is carried out; nothing in the run itself
  std::uint64_t steps = 0;  ///< steps done in this run
  double seconds = 0.0;     ///< of real time so far
  double agent_steps_per_second = 0.0;
  std::span<ColumnInfo const> columns;  ///< of the series, step and time first
  /// A value for each of them; empty up to the first sample after the start, where nothing has moved yet.
  std::span<double const> last_sample;
  [[nodiscard]] double seconds_left() const { return fraction > 0.0 ? seconds * (1.0 - fraction) / fraction : 0.0; }
};

/// Called between two steps, and within a long one of exact; returning false ends the run there.
using OnProgress = std::function<bool(Progress const&)>;

/// Called between two steps, or within a long one of exact, with the whole simulation up to date, for example to save
/// it.
struct Callback {
  std::function<bool(std::uint64_t steps)> is_due;  ///< asked as often as progress is reported
  std::function<void(std::uint64_t steps)> call;
  /// Called once the run has reached its end, before the sample that may be due only there: what is saved here can go
  /// on to a later end with the bits of a run that never ended.
  std::function<void(std::uint64_t steps)> call_at_end = {};
};

/// How far a run has come since its start, in every unit its length can have.
struct Extent {
  std::uint64_t steps = 0;
  double time = 0.0;
  std::uint64_t pair_collisions = 0;
};
void serialize(Archive& archive, Extent& extent);

/// How a run ended.
enum class RunStatus { finished, interrupted, failed };
char const* to_text(RunStatus status);

/// Writes from a run at steps of its own choice, for example the frames of a trajectory.
class Writer {
 public:
  Writer() = default;
  Writer(Writer const&) = delete;
  Writer& operator=(Writer const&) = delete;
  virtual ~Writer() = default;

  /// Whether write() is due now, `steps` after the start of the run; asked once for each step the run stops at.
  [[nodiscard]] virtual bool is_due(std::uint64_t steps) const = 0;
  /// The next step after `steps` at which write() is due, `never_reached` where there is none; the run stops there.
  [[nodiscard]] virtual std::uint64_t next_after(std::uint64_t steps) const = 0;
  /// `sample` is the row of the series taken at this very step, without step and time; empty where sample_every asks for
  /// none, also at the end of the run, so that what is written does not depend on how long the run is.
  virtual void write(Simulation const& simulation, std::span<double const> sample) = 0;
  /// Flushes what it has written to the disk and serializes how much that is: a run that is restored goes back to it.
  virtual void serialize(Archive& archive) = 0;
};

/// The columns of every series: step and time.
std::vector<ColumnInfo> clock_columns();

/// How far a simulation runs, and how often it is sampled and reported.
struct RunPlan {
  StopCondition stop_condition;
  std::uint64_t sample_every = 100;  ///< steps between samples
  double equilibration = 0.0;        ///< share of the run left out of averages
  /// Between two reports within a chunk, or one step if that takes longer; 0: a report after every step.
  double seconds_per_look = 0.1;
};

/// The record of a run of any simulation.
struct RunRecord {
  RunStatus status = RunStatus::interrupted;
  std::string failure;  ///< why, for RunStatus::failed
  Clock clock;
  std::uint64_t steps = 0;
  double time_step = 0.0;
  double seconds = 0.0;  ///< real time, without set-up
  std::size_t agents = 0;
  Preparation preparation;  ///< by a protocol
  std::uint64_t state_hash = 0;
  std::vector<Count> counts;
  Table series;  ///< step, time and one column per instantaneous or interval value
  std::vector<ColumnInfo> series_columns;
  std::vector<NamedEstimate> results;
  std::vector<Distribution> distributions;
  std::vector<Event>
      notes;  ///< what there is to say of the preparation, the errors of the results and how the agents moved

  [[nodiscard]] double agent_steps_per_second() const {
    return seconds > 0.0 ? static_cast<double>(steps) * static_cast<double>(agents) / seconds : 0.0;
  }
};

/// The loop of a run: chunks of work, samples between them, and reports, also within a chunk.
///
/// A chunk reaches to the next sample or the next frame of a writer, since some engines pay for beginning one.
/// Samples are taken at the start, at every multiple of sample_every steps and at the end. The bits of the
/// simulation and of the series depend neither on how often progress is reported nor on interruptions, nor, up to the
/// sample at the end, on how long the run is.
/// The simulation must outlive the run.
class Run {
 public:
  Run(Simulation& simulation, RunPlan const& plan);

  /// Advances the simulation until the stop condition holds, on_progress asks to stop or an invariant breaks. May be
  /// called again after an interruption.
  RunStatus advance(OnProgress const& on_progress = {}, Callback const& callback = {});

  /// The same, but stops at `step` of the clock at the latest, as an interruption does: no sample is taken there that
  /// the rest of the run would not take.
  RunStatus advance_to(std::uint64_t step, OnProgress const& on_progress = {}, Callback const& callback = {});

  /// From now on samples up to `step` of the clock are left out of averages, in place of the share of the plan.
  void leave_out_until(std::uint64_t step) { left_out_until_ = step; }

  /// Lets someone look on from now on; it must outlive the run.
  void add(Writer& writer) { writers_.push_back(&writer); }

  /// Whether there is nothing left to do but to sample the end.
  [[nodiscard]] bool has_reached_end() const;
  /// The share of the run that is done, from 0 to 1.
  [[nodiscard]] double fraction_done() const { return fraction_of(extent()); }
  /// The series so far, as in record().
  [[nodiscard]] Table const& series() const { return series_; }
  /// Steps from the start to the last step that writers were asked about; nothing before the first.
  [[nodiscard]] std::optional<std::uint64_t> last_stop() const;

  /// After a run of another length was restored: chooses the share to leave out of averages so that the samples taken
  /// so far count, or not, as they did, and every later one as in a run that had this share and length from its start.
  /// The share of the plan stays where it does so already. Returns the share.
  double fit_equilibration();

  [[nodiscard]] RunRecord record() const;

  /// The quantities that the simulation has measured. Errors of averages that the series contradicts are left out, and
  /// notes say so where they are given.
  [[nodiscard]] std::vector<NamedEstimate> results(std::vector<Event>* notes = nullptr) const;

  /// Serializes everything the rest of the run depends on, the simulation with it.
  void serialize(Archive& archive);

 private:
  [[nodiscard]] std::uint64_t steps_done() const { return simulation_.clock().step - first_.step; }
  [[nodiscard]] Extent extent() const;
  [[nodiscard]] double fraction_of(Extent const& extent) const;
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
  std::optional<std::uint64_t> left_out_until_;  ///< in place of the share of the plan
  std::optional<Clock> last_stop_;               ///< where it was sampled and looked at, if that was due
  Extent last_left_out_;                  ///< at the last sample that is left out of averages; the first always is
  std::optional<Extent> first_averaged_;  ///< at the first sample that is not
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
