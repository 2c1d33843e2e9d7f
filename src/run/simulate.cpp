#include "gridlock/run/simulate.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>
#include <utility>

#include "gridlock/core/error.hpp"

namespace gridlock {

namespace {

/// Cells and disks looked at between two looks at the clock and at Ctrl-C: a few tenths of a second.
constexpr double looks_per_chunk = 1e8;

/// Steps between two looks at the clock, from the set-up alone: nothing that is timed may reach the dynamics.
std::uint64_t steps_per_chunk(EngineSettings const& settings, State const& state) {
  double const disks = std::max(1.0, static_cast<double>(state.disks.size()));
  // A grid chosen from the sizes has a block of 3×3 cells with about one disk in each.
  double cells = 9.0;
  double candidates = 9.0;
  if (settings.cells) {
    double const k = static_cast<double>(*settings.cells);
    double const reach = 2.0 * radius_range(state.disks).largest / std::min(state.box.width(), state.box.height());
    double const block = std::min(k, 3.0 + 2.0 * k * reach);
    cells = block * block;
    candidates = disks * cells / (k * k);
  }
  double const looks = disks * static_cast<double>(settings.substeps) * (10.0 + cells + candidates);
  return static_cast<std::uint64_t>(std::max(1.0, looks_per_chunk / looks));
}

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// One run in progress: the loop of chunks, samples and reports.
class Simulation {
 public:
  Simulation(Setup setup, OnProgress const& on_progress)
      : settings_(std::move(setup.configuration)),
        horizon_(horizon_of({settings_, setup.state, {}})),
        on_progress_(on_progress),
        engine_(make_engine(settings_.engine, setup.state)),
        first_(setup.state.clock) {
    result_.state = std::move(setup.state);
    result_.time_step = engine_->time_step();
    observables_ = make_observables(settings_.observe, moment());
    open_series();
  }

  RunResult run() {
    auto const start = std::chrono::steady_clock::now();
    sample();
    try {
      while (result_.ending == Ending::finished && !is_at_horizon()) {
        advance_to_next_sample(start);
        sample();
      }
    } catch (RunFailure const& failure) {
      result_.ending = Ending::failed;
      result_.failure = failure.what();
    }
    result_.seconds = seconds_since(start);
    result_.steps = steps_done();
    for (auto const& observable : observables_) {
      std::ranges::move(observable->results(), std::back_inserter(result_.results));
      std::ranges::move(observable->distributions(), std::back_inserter(result_.distributions));
    }
    return std::move(result_);
  }

 private:
  [[nodiscard]] Moment moment() const { return {result_.state, result_.tally}; }
  [[nodiscard]] std::uint64_t steps_done() const { return result_.state.clock.step - first_.step; }

  [[nodiscard]] bool is_at_horizon() const {
    Clock const& clock = result_.state.clock;
    return clock.step >= horizon_.step || clock.time >= horizon_.time ||
           result_.tally.pair_collisions >= horizon_.pair_collisions;
  }

  /// The share of the run that is done: the largest of the shares of its lengths.
  [[nodiscard]] double fraction_done() const {
    Clock const& clock = result_.state.clock;
    auto const share = [](double done, double all) { return all > 0.0 ? done / all : 1.0; };
    double fraction = share(clock.time - first_.time, horizon_.time - first_.time);
    if (settings_.run.steps) {
      fraction =
          std::max(fraction, share(static_cast<double>(steps_done()), static_cast<double>(*settings_.run.steps)));
    }
    if (settings_.run.collisions_per_disk) {
      fraction = std::max(fraction, share(static_cast<double>(result_.tally.pair_collisions),
                                          static_cast<double>(horizon_.pair_collisions)));
    }
    return std::min(fraction, 1.0);
  }

  void advance_to_next_sample(std::chrono::steady_clock::time_point start) {
    std::uint64_t const every = settings_.observe.every;
    // Multiples of `every` counted from the start, so that the times of the samples do not depend on interruptions.
    std::uint64_t const next = first_.step + (steps_done() / every + 1) * every;
    std::uint64_t const chunk = steps_per_chunk(settings_.engine, result_.state);
    Horizon stop = horizon_;
    std::uint64_t const sample_step = std::min(next, horizon_.step);
    while (result_.state.clock.step < sample_step && !is_at_horizon()) {
      stop.step = std::min(sample_step, result_.state.clock.step + chunk);
      engine_->advance(result_.state, result_.tally, stop);
      // A wish to stop that comes with the last step comes too late to interrupt anything.
      if (!report(seconds_since(start)) && !is_at_horizon()) {
        result_.ending = Ending::interrupted;
        return;
      }
    }
  }

  bool report(double seconds) const {
    if (!on_progress_) return true;
    double const turns = static_cast<double>(steps_done()) * static_cast<double>(result_.state.disks.size());
    return on_progress_({.fraction = fraction_done(),
                         .steps = steps_done(),
                         .seconds = seconds,
                         .disk_steps_per_second = seconds > 0.0 ? turns / seconds : 0.0});
  }

  void open_series();
  void sample();

  Configuration settings_;
  Horizon horizon_;
  OnProgress const& on_progress_;
  std::unique_ptr<Engine> engine_;
  Clock first_;
  std::vector<std::unique_ptr<Observable>> observables_;
  RunResult result_;
};

void Simulation::open_series() {
  result_.series_columns = {{"step", "", "Whole time steps since the clock was started."},
                            {"time", "time", "Physical time."}};
  for (auto const& observable : observables_)
    std::ranges::move(observable->columns(), std::back_inserter(result_.series_columns));
  for (ColumnInfo const& column : result_.series_columns) {
    bool const is_step = &column == &result_.series_columns.front();
    result_.series.add_column(column.name, is_step ? CellColumn(std::vector<std::uint64_t>{}) : std::vector<double>{});
  }
}

void Simulation::sample() {
  // The first sample is the start itself, which is no average of anything.
  bool const counts = steps_done() > 0 && fraction_done() > settings_.observe.discard;
  std::vector<Cell> row{result_.state.clock.step, result_.state.clock.time};
  std::vector<double> values;
  for (auto const& observable : observables_) {
    values.assign(observable->columns().size(), std::nan(""));
    observable->sample(moment(), values, counts);
    std::ranges::copy(values, std::back_inserter(row));
  }
  result_.series.add_row(row);
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

RunResult simulate(Setup setup, OnProgress const& on_progress) {
  return Simulation(std::move(setup), on_progress).run();
}

}  // namespace gridlock
