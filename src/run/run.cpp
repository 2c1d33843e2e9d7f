#include "gridlock/run/run.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <iterator>
#include <type_traits>
#include <utility>

#include "gridlock/core/error.hpp"

namespace gridlock {

namespace {

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

}  // namespace

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

Run::Run(Experiment& experiment, RunPlan const& plan)
    : experiment_(experiment), plan_(plan), first_(experiment.clock()) {
  columns_ = {{"step", "", "Whole time steps since the clock was started."}, {"time", "time", "Physical time."}};
  std::ranges::move(experiment_.columns(), std::back_inserter(columns_));
  series_.add_column(columns_.front().name, std::vector<std::uint64_t>{});
  for (std::size_t k = 1; k < columns_.size(); ++k) series_.add_column(columns_[k].name, std::vector<double>{});
}

Ending Run::go_on(OnProgress const& on_progress) {
  auto const start = std::chrono::steady_clock::now();
  ending_ = Ending::interrupted;
  try {
    for (bool goes_on = true; goes_on;) {
      if (is_sample_due()) sample();
      if (is_at_horizon()) {
        ending_ = Ending::finished;
        break;
      }
      advance_one_chunk();
      // A wish to stop that comes with the last step comes too late to interrupt anything.
      goes_on = report(on_progress, seconds_before_ + seconds_since(start)) || is_at_horizon();
    }
  } catch (RunFailure const& failure) {
    ending_ = Ending::failed;
    failure_ = failure.what();
  }
  seconds_before_ += seconds_since(start);
  return ending_;
}

bool Run::is_at_horizon() const {
  Clock const clock = experiment_.clock();
  return clock.step >= plan_.horizon.step || clock.time >= plan_.horizon.time ||
         experiment_.pair_collisions() >= plan_.horizon.pair_collisions;
}

/// The share of the run that is done: the largest of the shares of its lengths.
double Run::fraction_done() const {
  Clock const clock = experiment_.clock();
  Horizon const& end = plan_.horizon;
  auto const share = [](double done, double all) { return all > 0.0 ? done / all : 1.0; };
  double const steps = share(static_cast<double>(steps_done()), static_cast<double>(end.step - first_.step));
  double const time = share(clock.time - first_.time, end.time - first_.time);
  double const collisions =
      share(static_cast<double>(experiment_.pair_collisions()), static_cast<double>(end.pair_collisions));
  return std::min(std::max({steps, time, collisions}), 1.0);
}

/// Multiples of sample_every are counted from the start, so that the times of the samples do not depend on
/// interruptions.
bool Run::is_sample_due() const {
  if (!last_sample_) return true;
  return *last_sample_ != experiment_.clock() && (steps_done() % plan_.sample_every == 0 || is_at_horizon());
}

void Run::sample() {
  // The first sample is the start itself, which is no average of anything.
  bool const counts = steps_done() > 0 && fraction_done() > plan_.discard;
  Clock const clock = experiment_.clock();
  std::vector<double> values(columns_.size() - 2, no_value);
  experiment_.sample(values, counts);
  std::vector<Cell> row{clock.step, clock.time};
  std::ranges::copy(values, std::back_inserter(row));
  series_.add_row(row);
  last_sample_ = clock;
}

void Run::advance_one_chunk() {
  std::uint64_t const step = experiment_.clock().step;
  std::uint64_t const next_sample = first_.step + (steps_done() / plan_.sample_every + 1) * plan_.sample_every;
  Horizon stop = plan_.horizon;
  stop.step = std::min({plan_.horizon.step, next_sample, step + plan_.steps_per_chunk});
  experiment_.advance(stop);
}

bool Run::report(OnProgress const& on_progress, double seconds) const {
  if (!on_progress) return true;
  double const turns = static_cast<double>(steps_done()) * static_cast<double>(experiment_.agents());
  return on_progress({.fraction = fraction_done(),
                      .steps = steps_done(),
                      .seconds = seconds,
                      .agent_steps_per_second = seconds > 0.0 ? turns / seconds : 0.0});
}

void Run::carry(Archive& archive) {
  carry_inside(archive, "first", [&] { gridlock::carry(archive, first_); });
  bool has_sampled = last_sample_.has_value();
  Clock last = last_sample_.value_or(Clock{});
  archive.visit("has_sampled", has_sampled);
  carry_inside(archive, "last_sample", [&] { gridlock::carry(archive, last); });
  last_sample_ = has_sampled ? std::optional(last) : std::nullopt;
  archive.visit("seconds", seconds_before_);
  carry_inside(archive, "series", [&] { carry_series(archive); });
  carry_inside(archive, "experiment", [&] { experiment_.carry(archive); });
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
          .seconds = seconds_before_,
          .agents = experiment_.agents(),
          .state_hash = experiment_.state_hash(),
          .counts = experiment_.counts(),
          .series = series_,
          .series_columns = columns_,
          .results = experiment_.results(),
          .distributions = experiment_.distributions()};
}

}  // namespace gridlock
