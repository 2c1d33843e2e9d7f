#include "study/replica_set.hpp"

#include <algorithm>
#include <cmath>

#include "observe/mean_over_runs.hpp"

namespace gridlock {

namespace {

constexpr double share_that_shows_arrest = 0.2;
constexpr double halted_fraction_of_arrest = 0.98;

StudyRun run_of(Study const& study, ReplicaSet const& replica_set, std::uint64_t number) {
  StudyRun run{.sites = replica_set.sites};
  run.configuration.disks = {
      .count = study.extent().disks, .packing_fraction = replica_set.packing_fraction, .start = replica_set.start};
  run.configuration.box.edge = replica_set.edge;
  run.configuration.engine.kind = replica_set.engine.kind;
  // The cores are busy with other runs.
  run.configuration.engine.threads = 1;
  run.configuration.engine.time_step = replica_set.time_step;
  run.configuration.engine.contact = replica_set.contact;
  run.configuration.run.steps = replica_set.steps;
  run.configuration.run.seed = study.seed(number);
  run.configuration.observe.every = replica_set.sample_every;
  run.configuration.observe.structure_every = 0;
  return run;
}

}  // namespace

double tail_mean(std::vector<double> const& values, double share) {
  auto const all = static_cast<double>(values.size() - 1);
  auto const count = std::max<std::size_t>(1, static_cast<std::size_t>(std::floor(share * all)));
  double sum = 0.0;
  for (std::size_t i = values.size() - count; i < values.size(); ++i) sum += values[i];
  return sum / static_cast<double>(count);
}

char const* name_of(StartKind start) { return start == StartKind::square ? "square" : "triangular"; }

ReplicaSet paper_replica_set(PaperLength const& length, PaperEngine const& engine, StartKind start,
                             double packing_fraction) {
  return {.engine = engine,
          .start = start,
          .packing_fraction = packing_fraction,
          .steps = length.steps,
          .sample_every = length.sample_every,
          .seeds = length.seeds};
}

std::vector<ReplicaSet> paper_replica_sets(PaperExtent const& extent, PaperLength const& length) {
  std::vector<ReplicaSet> replica_sets;
  for (PaperEngine const& engine : extent.engines) {
    bool const is_first = &engine == &extent.engines.front();
    auto const add = [&](StartKind start, std::vector<double> const& densities) {
      for (double const density : densities) {
        if (!is_first && density > length.densest_of_others) continue;
        replica_sets.push_back(paper_replica_set(length, engine, start, density));
      }
    };
    add(StartKind::square, extent.square_densities);
    add(StartKind::triangular, extent.triangular_densities);
  }
  return replica_sets;
}

char const* name_of(Edge edge) { return edge == Edge::wall ? "wall" : "periodic"; }

ReplicaSet sampled_evenly(ReplicaSet replica_set, double diameters, std::uint64_t samples) {
  double const steps_between = diameters / replica_set.time_step / static_cast<double>(samples);
  replica_set.sample_every = std::max<std::uint64_t>(1, static_cast<std::uint64_t>(std::llround(steps_between)));
  replica_set.steps = replica_set.sample_every * samples;
  return replica_set;
}

void plan(Study& study, ReplicaSet const& replica_set) {
  for (std::uint64_t number = 0; number < replica_set.seeds; ++number)
    study.runs.add(run_of(study, replica_set, number));
}

ReplicaResult::ReplicaResult(Study const& study, ReplicaSet const& replica_set) {
  for (std::uint64_t number = 0; number < replica_set.seeds; ++number) {
    StudyOutcome const& outcome = study.runs.outcome_of(run_of(study, replica_set, number));
    if (outcome.is_finished) outcomes_.push_back(&outcome);
  }
}

std::vector<std::size_t> ReplicaResult::samples_spread_out(std::size_t parts) const {
  std::vector<std::size_t> chosen;
  std::size_t next = 1;
  for (std::size_t sample = 1; sample < samples(); ++sample) {
    if (sample < next && sample + 1 < samples()) continue;
    next = sample + 1 + sample / parts;
    chosen.push_back(sample);
  }
  return chosen;
}

std::vector<double> ReplicaResult::of_each_seed(std::function<double(StudyOutcome const&)> const& value) const {
  std::vector<double> values;
  for (StudyOutcome const* outcome : outcomes_) values.push_back(value(*outcome));
  return values;
}

Estimate ReplicaResult::over_seeds(std::function<double(StudyOutcome const&)> const& value) const {
  return mean_over_runs(of_each_seed(value));
}

Estimate ReplicaResult::displacement(std::size_t sample) const {
  return over_seeds([=](StudyOutcome const& outcome) { return outcome.displacements[sample]; });
}

Estimate ReplicaResult::tail_displacement(double share) const {
  return over_seeds([=](StudyOutcome const& outcome) { return tail_mean(outcome.displacements, share); });
}

Estimate ReplicaResult::tail_halted_fraction(double share) const {
  return over_seeds([=](StudyOutcome const& outcome) { return tail_mean(outcome.halted_fractions, share); });
}

Estimate ReplicaResult::tail_collision_rate(double share) const {
  return over_seeds([=](StudyOutcome const& outcome) { return tail_mean(outcome.collision_rates, share); });
}

std::size_t ReplicaResult::arrested() const {
  return static_cast<std::size_t>(std::ranges::count_if(outcomes_, [](StudyOutcome const* outcome) {
    return tail_mean(outcome->halted_fractions, share_that_shows_arrest) > halted_fraction_of_arrest;
  }));
}

}  // namespace gridlock
