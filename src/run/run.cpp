#include "gridlock/run/run.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <exception>
#include <iterator>
#include <string>
#include <type_traits>
#include <utility>

#include "gridlock/core/error.hpp"
#include "gridlock/core/saturating.hpp"
#include "run/countable_time.hpp"

namespace gridlock {

char const* to_text(Ending ending) {
  switch (ending) {
    case Ending::finished:
      return "finished";
    case Ending::interrupted:
      return "interrupted";
    case Ending::failed:
      break;
  }
  return "failed";
}

void carry(Archive& archive, Extent& extent) {
  archive.visit("steps", extent.steps);
  archive.visit("time", extent.time);
  archive.visit("pair_collisions", extent.pair_collisions);
}

Run::Run(Experiment& experiment, RunPlan const& plan)
    : experiment_(experiment),
      plan_(plan),
      pace_(plan.seconds_per_look),
      first_(experiment.clock()),
      columns_{{"step", "", "Whole time steps since the clock was started."}, {"time", "time", "Physical time."}} {
  if (std::isfinite(plan_.horizon.time)) require_countable_end(plan_.horizon.time, experiment_.time_step());
  std::ranges::move(experiment_.columns(), std::back_inserter(columns_));
  series_.add_column(columns_.front().name, std::vector<std::uint64_t>{});
  for (std::size_t k = 1; k < columns_.size(); ++k) series_.add_column(columns_[k].name, std::vector<double>{});
}

Ending Run::go_on(OnProgress const& on_progress, Interlude const& interlude) {
  seconds_before_ = seconds_;
  went_on_ = std::chrono::steady_clock::now();
  ending_ = Ending::interrupted;
  try {
    while (true) {
      if (is_at_horizon() && interlude.take_place_at_end) {
        note_time();
        interlude.take_place_at_end(steps_done());
      }
      stop_here();
      if (is_at_horizon()) {
        ending_ = Ending::finished;
        break;
      }
      // A wish to stop that comes with the last step comes too late to interrupt anything.
      if (!advance_one_chunk(on_progress, interlude) && !is_at_horizon()) break;
    }
  } catch (RunFailure const& failure) {
    ending_ = Ending::failed;
    failure_ = failure.what();
  }
  note_time();
  return ending_;
}

/// Returns whether to go on.
bool Run::advance_one_chunk(OnProgress const& on_progress, Interlude const& interlude) {
  auto const is_interlude_due = [&] { return interlude.is_due && interlude.is_due(steps_done()); };
  bool is_stopped = false;
  std::exception_ptr failure_of_listener;
  std::uint64_t last_look = steps_done();
  Horizon stop = next_stop();
  // Engines need not get through the exceptions of others.
  stop.goes_on = [&]() noexcept {
    if (!pace_.is_due()) return true;
    last_look = steps_done();
    try {
      is_stopped = !report(on_progress);
      return !is_stopped && !is_interlude_due();
    } catch (...) {
      failure_of_listener = std::current_exception();
      return false;
    }
  };
  experiment_.advance(stop);
  if (failure_of_listener) std::rethrow_exception(failure_of_listener);
  if (is_interlude_due()) interlude.take_place(steps_done());
  if (!is_stopped && last_look != steps_done()) is_stopped = !report(on_progress);
  return !is_stopped;
}

void Run::note_time() {
  seconds_ = seconds_before_ + std::chrono::duration<double>(std::chrono::steady_clock::now() - went_on_).count();
}

bool Run::is_at_horizon() const {
  Clock const clock = experiment_.clock();
  return clock.step >= plan_.horizon.step || clock.time >= plan_.horizon.time ||
         experiment_.pair_collisions() >= plan_.horizon.pair_collisions;
}

std::optional<std::uint64_t> Run::last_stop() const {
  return last_stop_ ? std::optional(last_stop_->step - first_.step) : std::nullopt;
}

Extent Run::extent() const {
  return {.steps = steps_done(),
          .time = experiment_.clock().time - first_.time,
          .pair_collisions = experiment_.pair_collisions()};
}

/// The share of the run that is done: the largest of the shares of its lengths.
double Run::fraction_of(Extent const& extent) const {
  Horizon const& end = plan_.horizon;
  auto const share = [](double done, double all) { return all > 0.0 ? done / all : 1.0; };
  double const steps = share(static_cast<double>(extent.steps), static_cast<double>(end.step - first_.step));
  double const time = share(extent.time, end.time - first_.time);
  double const collisions =
      share(static_cast<double>(extent.pair_collisions), static_cast<double>(end.pair_collisions));
  return std::min(std::max({steps, time, collisions}), 1.0);
}

double Run::fit_discard() {
  bool const is_left_out = fraction_of(last_left_out_) <= plan_.discard;
  bool const is_averaged = !first_averaged_ || fraction_of(*first_averaged_) > plan_.discard;
  if (!is_left_out || !is_averaged) plan_.discard = fraction_of(last_left_out_);
  return plan_.discard;
}

/// What is due at this moment, once: multiples of sample_every are counted from the start, so that the times of the
/// samples do not depend on interruptions.
void Run::stop_here() {
  if (last_stop_ == experiment_.clock()) return;
  // Some engines can be stopped between two steps, after which the step they are in is not due again.
  bool const is_new_step = !last_stop_ || last_stop_->step != experiment_.clock().step;
  bool const is_first = !last_stop_;
  last_stop_ = experiment_.clock();
  bool const is_sample_due = is_first || (is_new_step && steps_done() % plan_.sample_every == 0);
  if (is_sample_due || is_at_horizon()) sample();
  if (!is_new_step) return;
  std::span<double const> row = last_row_;
  row = is_sample_due ? row.subspan(2) : row.first(0);
  for (Onlooker* onlooker : onlookers_) {
    if (onlooker->is_due(steps_done())) onlooker->look(experiment_, row);
  }
}

void Run::sample() {
  // The first sample is the start itself, which is no average of anything.
  bool const counts = steps_done() > 0 && fraction_done() > plan_.discard;
  if (!counts) last_left_out_ = extent();
  if (counts && !first_averaged_) first_averaged_ = extent();
  Clock const clock = experiment_.clock();
  std::vector<double> values(columns_.size() - 2, no_value);
  experiment_.sample(values, counts);
  std::vector<Cell> row{clock.step, clock.time};
  std::ranges::copy(values, std::back_inserter(row));
  series_.add_row(row);
  last_row_ = {static_cast<double>(clock.step), clock.time};
  std::ranges::copy(values, std::back_inserter(last_row_));
}

/// Where the next chunk ends.
Horizon Run::next_stop() const {
  std::uint64_t const step = experiment_.clock().step;
  std::uint64_t next = next_multiple(plan_.sample_every, steps_done());
  for (Onlooker const* onlooker : onlookers_) next = std::min(next, onlooker->next_after(steps_done()));
  Horizon stop = plan_.horizon;
  stop.step = std::min({stop.step, saturating_sum(first_.step, next), saturating_sum(step, plan_.steps_per_chunk)});
  return stop;
}

bool Run::report(OnProgress const& on_progress) {
  note_time();
  if (!on_progress) return true;
  double const turns = static_cast<double>(steps_done()) * static_cast<double>(experiment_.agents());
  bool const is_sampled = !last_row_.empty() && last_row_.front() > static_cast<double>(first_.step);
  return on_progress({.clock = experiment_.clock(),
                      .fraction = fraction_done(),
                      .steps = steps_done(),
                      .seconds = seconds_,
                      .agent_steps_per_second = seconds_ > 0.0 ? turns / seconds_ : 0.0,
                      .columns = columns_,
                      .last_sample = is_sampled ? std::span<double const>(last_row_) : std::span<double const>{}});
}

void Run::carry(Archive& archive) {
  carry_inside(archive, "first", [&] { gridlock::carry(archive, first_); });
  bool has_stopped = last_stop_.has_value();
  Clock last = last_stop_.value_or(Clock{});
  archive.visit("has_stopped", has_stopped);
  carry_inside(archive, "last_stop", [&] { gridlock::carry(archive, last); });
  last_stop_ = has_stopped ? std::optional(last) : std::nullopt;
  archive.visit("last_row", last_row_);
  archive.visit("seconds", seconds_);
  carry_inside(archive, "series", [&] { carry_series(archive); });
  carry_inside(archive, "experiment", [&] { experiment_.carry(archive); });
  for (std::size_t k = 0; k < onlookers_.size(); ++k) {
    carry_inside(archive, "onlooker_" + std::to_string(k), [&] { onlookers_[k]->carry(archive); });
  }
  carry_inside(archive, "last_left_out", [&] { gridlock::carry(archive, last_left_out_); });
  bool has_averaged = first_averaged_.has_value();
  Extent first_averaged = first_averaged_.value_or(Extent{});
  archive.visit("has_averaged", has_averaged);
  carry_inside(archive, "first_averaged", [&] { gridlock::carry(archive, first_averaged); });
  first_averaged_ = has_averaged ? std::optional(first_averaged) : std::nullopt;
}

void Run::carry_series(Archive& archive) {
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

RunRecord Run::record() const {
  return {.ending = ending_,
          .failure = failure_,
          .clock = experiment_.clock(),
          .steps = steps_done(),
          .time_step = experiment_.time_step(),
          .seconds = seconds_,
          .agents = experiment_.agents(),
          .state_hash = experiment_.state_hash(),
          .counts = experiment_.counts(),
          .series = series_,
          .series_columns = columns_,
          .results = experiment_.results(),
          .distributions = experiment_.distributions()};
}

}  // namespace gridlock
