#include "gridlock/simulation/run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <exception>
#include <iterator>
#include <string>
#include <type_traits>
#include <utility>

#include "core/saturating.hpp"
#include "gridlock/core/error.hpp"
#include "simulation/countable_time.hpp"
#include "simulation/decades.hpp"
#include "simulation/notes_on_run.hpp"

namespace gridlock {

char const* to_text(RunStatus status) {
  switch (status) {
    case RunStatus::finished:
      return "finished";
    case RunStatus::interrupted:
      return "interrupted";
    case RunStatus::failed:
      break;
  }
  return "failed";
}

namespace {

/// Returns sample k of `per_decade` in each decade, in intervals.
std::uint64_t logarithmic_sample(double k, std::uint64_t per_decade) {
  double const intervals = rounded_power_of_ten(k / static_cast<double>(per_decade));
  return intervals < 0x1p63 ? static_cast<std::uint64_t>(intervals) : never_reached;
}

}  // namespace

std::uint64_t RunPlan::next_sample(std::uint64_t steps) const {
  if (samples_per_decade == 0) return next_multiple(sample_every, steps);
  std::uint64_t const intervals = steps / sample_every;
  // Rounding may put the logarithm of a sample just below its number.
  double const before = std::log10(std::max(1.0, static_cast<double>(intervals)));
  double k = intervals == 0 ? 0.0 : std::max(0.0, std::floor(before * static_cast<double>(samples_per_decade)) - 1.0);
  std::uint64_t sample = logarithmic_sample(k, samples_per_decade);
  while (sample <= intervals && sample != never_reached) sample = logarithmic_sample(++k, samples_per_decade);
  return sample < never_reached / sample_every ? sample * sample_every : never_reached;
}

bool RunPlan::is_sample_due(std::uint64_t steps) const { return steps == 0 || next_sample(steps - 1) == steps; }

std::vector<ColumnInfo> clock_columns() {
  return {{"step", "", "Whole time steps since the clock was started."}, {"time", "time", "Physical time."}};
}

void serialize(Archive& archive, Extent& extent) {
  archive.visit("steps", extent.steps);
  archive.visit("time", extent.time);
  archive.visit("pair_collisions", extent.pair_collisions);
}

Run::Run(Simulation& simulation, RunPlan const& plan)
    : simulation_(simulation),
      plan_(plan),
      rate_limiter_(plan.seconds_per_look),
      first_(simulation.clock()),
      columns_(clock_columns()) {
  double const duration = simulation_.time_step();
  simulation_.processes().agree([&] {
    if (std::isfinite(plan_.stop_condition.time)) require_countable_end(plan_.stop_condition.time, duration);
  });
  std::ranges::move(simulation_.columns(), std::back_inserter(columns_));
  series_.add_column(columns_.front().name, std::vector<std::uint64_t>{});
  for (std::size_t k = 1; k < columns_.size(); ++k) series_.add_column(columns_[k].name, std::vector<double>{});
}

RunStatus Run::advance(OnProgress const& on_progress, Callback const& callback) {
  return advance_to(never_reached, on_progress, callback);
}

RunStatus Run::advance_to(std::uint64_t step, OnProgress const& on_progress, Callback const& callback) {
  pause_at_ = step;
  seconds_before_ = seconds_;
  resumed_at_ = std::chrono::steady_clock::now();
  status_ = RunStatus::interrupted;
  try {
    if (!prepare(on_progress, callback)) {
      note_time();
      return status_;
    }
    while (true) {
      if (has_reached_end() && callback.call_at_end) {
        note_time();
        callback.call_at_end(steps_done());
      }
      stop_here();
      if (has_reached_end()) {
        status_ = RunStatus::finished;
        break;
      }
      if (simulation_.clock().step >= pause_at_) break;
      // A stop requested during the last step does not interrupt the run, since it has reached its end.
      if (!advance_one_chunk(on_progress, callback) && !has_reached_end()) break;
    }
  } catch (RunFailure const& failure) {
    status_ = RunStatus::failed;
    failure_ = failure.what();
  }
  note_time();
  return status_;
}

/// Prepares the simulation. Returns false if the user stopped it before the end.
bool Run::prepare(OnProgress const& on_progress, Callback const& callback) {
  while (!simulation_.is_prepared()) {
    bool is_stopped = false;
    bool is_callback_due = false;
    std::exception_ptr failure_of_listener;
    bool const is_ready = simulation_.prepare([&]() noexcept {
      if (!rate_limiter_.is_due()) return true;
      try {
        is_stopped = !report(on_progress);
        is_callback_due = callback.is_due && callback.is_due(0);
        return !is_stopped && !is_callback_due;
      } catch (...) {
        failure_of_listener = std::current_exception();
        return false;
      }
    });
    if (failure_of_listener) std::rethrow_exception(failure_of_listener);
    if (is_ready) break;
    if (is_callback_due) callback.call(0);
    if (is_stopped) return false;
  }
  return true;
}

/// Advances to the next stop. Returns false if the user stopped the run.
bool Run::advance_one_chunk(OnProgress const& on_progress, Callback const& callback) {
  auto const is_callback_due = [&] { return callback.is_due && callback.is_due(steps_done()); };
  bool is_stopped = false;
  std::exception_ptr failure_of_listener;
  std::uint64_t last_look = steps_done();
  StopCondition stop = next_stop();
  // An exception of a callback is stored and thrown later, since it must not pass through an engine.
  stop.should_continue = [&]() noexcept {
    if (!rate_limiter_.is_due()) return true;
    last_look = steps_done();
    try {
      is_stopped = !report(on_progress);
      return !is_stopped && !is_callback_due();
    } catch (...) {
      failure_of_listener = std::current_exception();
      return false;
    }
  };
  simulation_.advance(stop);
  if (!std::isfinite(simulation_.clock().time)) {
    throw RunFailure(fmt::format("step {}: the time is beyond all numbers, with a time step of {}",
                                 simulation_.clock().step, simulation_.time_step()));
  }
  // Only the root reads the clock and calls the user's functions, so it decides for all processes.
  struct Look {
    bool is_callback_due = false;
    bool is_stopped = false;
  } look;
  AllProcesses const processes = simulation_.processes();
  processes.on_root([&] {
    if (failure_of_listener) std::rethrow_exception(failure_of_listener);
    look.is_callback_due = is_callback_due();
    if (!is_stopped && last_look != steps_done()) is_stopped = !report(on_progress);
    look.is_stopped = is_stopped;
  });
  look = processes.of_root(look);
  if (look.is_callback_due) callback.call(steps_done());
  return !look.is_stopped;
}

void Run::note_time() {
  seconds_ = seconds_before_ + std::chrono::duration<double>(std::chrono::steady_clock::now() - resumed_at_).count();
}

bool Run::has_reached_end() const {
  return simulation_.is_prepared() &&
         plan_.stop_condition.is_reached(simulation_.clock(), simulation_.pair_collisions());
}

std::optional<std::uint64_t> Run::last_stop() const {
  return last_stop_ ? std::optional(last_stop_->step - first_.step) : std::nullopt;
}

Extent Run::extent() const {
  return {.steps = steps_done(),
          .time = simulation_.clock().time - first_.time,
          .pair_collisions = simulation_.pair_collisions()};
}

double Run::fraction_of(Extent const& extent) const {
  StopCondition const& end = plan_.stop_condition;
  auto const share = [](double done, double all) { return all > 0.0 ? done / all : 1.0; };
  double const steps = share(static_cast<double>(extent.steps), static_cast<double>(end.step - first_.step));
  double const time = share(extent.time, end.time - first_.time);
  double const collisions =
      share(static_cast<double>(extent.pair_collisions), static_cast<double>(end.pair_collisions));
  return std::min(std::max({steps, time, collisions}), 1.0);
}

/// Returns the fraction of progress that the protocol takes: all if no run follows, otherwise half by convention.
double Run::share_of_preparation() const { return plan_.stop_condition.step == first_.step ? 1.0 : 0.5; }

double Run::fit_equilibration() {
  if (plan_.samples_per_decade > 0) return plan_.equilibration;
  bool const is_left_out = fraction_of(last_left_out_) <= plan_.equilibration;
  bool const is_averaged = !first_averaged_ || fraction_of(*first_averaged_) > plan_.equilibration;
  if (!is_left_out || !is_averaged) plan_.equilibration = fraction_of(last_left_out_);
  return plan_.equilibration;
}

/// Samples and writes what is due at this step, once. Samples count from the start, so that interruptions do not change
/// their times.
void Run::stop_here() {
  if (last_stop_ == simulation_.clock()) return;
  // Some engines can stop within a step; the writers of that step are not called again.
  bool const is_new_step = !last_stop_ || last_stop_->step != simulation_.clock().step;
  bool const is_first = !last_stop_;
  last_stop_ = simulation_.clock();
  bool const is_sample_due = is_first || (is_new_step && plan_.is_sample_due(steps_done()));
  if (is_sample_due || has_reached_end()) sample();
  if (!is_new_step) return;
  std::span<double const> row = last_row_;
  row = is_sample_due ? row.subspan(2) : row.first(0);
  for (Writer* writer : writers_) {
    if (writer->is_due(steps_done())) writer->write(simulation_, row);
  }
}

void Run::sample() {
  // The sample at the start is never part of an average.
  bool const is_equilibrated =
      left_out_until_ ? simulation_.clock().step > *left_out_until_ : fraction_done() > plan_.equilibration;
  bool const counts = steps_done() > 0 && is_equilibrated && plan_.samples_per_decade == 0;
  if (!counts) last_left_out_ = extent();
  if (counts && !first_averaged_) first_averaged_ = extent();
  Clock const clock = simulation_.clock();
  std::vector<double> values(columns_.size() - 2, no_value);
  simulation_.sample(values, counts);
  std::vector<Cell> row{clock.step, clock.time};
  std::ranges::copy(values, std::back_inserter(row));
  series_.add_row(row);
  last_row_ = {static_cast<double>(clock.step), clock.time};
  std::ranges::copy(values, std::back_inserter(last_row_));
}

/// Returns the stop condition of the next chunk: the next sample, frame or pause, or the end of the run.
StopCondition Run::next_stop() const {
  std::uint64_t next = plan_.next_sample(steps_done());
  for (Writer const* writer : writers_) next = std::min(next, writer->next_after(steps_done()));
  StopCondition stop = plan_.stop_condition;
  stop.step = std::min({stop.step, saturating_sum(first_.step, next), pause_at_});
  return stop;
}

bool Run::report(OnProgress const& on_progress) {
  note_time();
  if (!on_progress) return true;
  double const turns = static_cast<double>(steps_done()) * static_cast<double>(simulation_.agents());
  bool const is_sampled = !last_row_.empty() && last_row_.front() > static_cast<double>(first_.step);
  Preparation const preparation = simulation_.preparation();
  return on_progress(
      {.clock = simulation_.clock(),
       .fraction = simulation_.is_prepared() ? fraction_done() : preparation.fraction * share_of_preparation(),
       .preparation = preparation,
       .steps = steps_done(),
       .seconds = seconds_,
       .agent_steps_per_second = seconds_ > 0.0 ? turns / seconds_ : 0.0,
       .columns = columns_,
       .last_sample = is_sampled ? std::span<double const>(last_row_) : std::span<double const>{}});
}

void Run::serialize(Archive& archive) {
  serialize_inside(archive, "first", [&] { gridlock::serialize(archive, first_); });
  bool has_stopped = last_stop_.has_value();
  Clock last = last_stop_.value_or(Clock{});
  archive.visit("has_stopped", has_stopped);
  serialize_inside(archive, "last_stop", [&] { gridlock::serialize(archive, last); });
  last_stop_ = has_stopped ? std::optional(last) : std::nullopt;
  archive.visit("last_row", last_row_);
  archive.visit("seconds", seconds_);
  serialize_inside(archive, "series", [&] { serialize_series(archive); });
  serialize_inside(archive, "simulation", [&] { simulation_.serialize(archive); });
  for (std::size_t k = 0; k < writers_.size(); ++k) {
    serialize_inside(archive, "writer_" + std::to_string(k), [&] { writers_[k]->serialize(archive); });
  }
  serialize_inside(archive, "last_left_out", [&] { gridlock::serialize(archive, last_left_out_); });
  bool has_averaged = first_averaged_.has_value();
  Extent first_averaged = first_averaged_.value_or(Extent{});
  archive.visit("has_averaged", has_averaged);
  serialize_inside(archive, "first_averaged", [&] { gridlock::serialize(archive, first_averaged); });
  first_averaged_ = has_averaged ? std::optional(first_averaged) : std::nullopt;
}

void Run::serialize_series(Archive& archive) {
  Table series;
  for (std::size_t k = 0; k < columns_.size(); ++k) {
    std::visit(
        [&](auto values) {
          if constexpr (!std::is_same_v<decltype(values), std::vector<std::string>>) {
            archive.visit(columns_[k].name, values);
            archive.require(k == 0 || values.size() == series.row_count(),
                            "the columns of the series differ in length");
            series.add_column(columns_[k].name, std::move(values));
          }
        },
        series_.column(k));
  }
  series_ = std::move(series);
}

std::vector<NamedEstimate> Run::results(std::vector<Event>* notes) const {
  std::vector<NamedEstimate> results = simulation_.results();
  auto const& steps = std::get<std::vector<std::uint64_t>>(series_.column(0));
  auto const first_kept = std::ranges::upper_bound(steps, first_.step + last_left_out_.steps);
  std::vector<Event> found = withhold_errors(series_, static_cast<std::size_t>(first_kept - steps.begin()), results);
  if (notes != nullptr) std::ranges::move(found, std::back_inserter(*notes));
  return results;
}

RunRecord Run::record() const {
  std::vector<Event> notes = simulation_.notes();
  std::vector<NamedEstimate> results = this->results(&notes);
  std::ranges::move(notes_on_motion(simulation_, simulation_.clock().time - first_.time, results),
                    std::back_inserter(notes));
  return {.status = status_,
          .failure = failure_,
          .clock = simulation_.clock(),
          .steps = steps_done(),
          .time_step = simulation_.time_step(),
          .seconds = seconds_,
          .agents = simulation_.agents(),
          .preparation = simulation_.preparation(),
          .state_hash = simulation_.state_hash(),
          .counts = simulation_.counts(),
          .series = series_,
          .series_columns = columns_,
          .results = std::move(results),
          .distributions = simulation_.distributions(),
          .notes = std::move(notes)};
}

}  // namespace gridlock
