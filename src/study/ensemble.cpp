#include "study/ensemble.hpp"

#include <algorithm>
#include <cmath>

#include "study/seed_statistics.hpp"

namespace gridlock {

namespace {

constexpr double share_that_shows_arrest = 0.2;
constexpr double blocked_share_of_arrest = 0.98;

StudyRun run_of(Study const& study, Ensemble const& ensemble, std::uint64_t number) {
  StudyRun run{.sites = ensemble.sites};
  run.configuration.disks = {
      .count = study.extent().disks, .packing_fraction = ensemble.packing_fraction, .start = ensemble.start};
  run.configuration.box.edge = ensemble.edge;
  run.configuration.engine.kind = ensemble.engine.kind;
  // The cores are busy with other runs.
  run.configuration.engine.threads = 1;
  run.configuration.engine.time_step = ensemble.time_step;
  run.configuration.engine.contact = ensemble.contact;
  run.configuration.run.steps = ensemble.steps;
  run.configuration.run.seed = study.seed(number);
  run.configuration.observe.every = ensemble.sample_every;
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

Ensemble paper_ensemble(PaperExtent const& extent, PaperEngine const& engine, StartKind start,
                        double packing_fraction) {
  return {.engine = engine,
          .start = start,
          .packing_fraction = packing_fraction,
          .steps = extent.steps,
          .sample_every = extent.sample_every,
          .seeds = extent.seeds};
}

std::vector<Ensemble> paper_ensembles(PaperExtent const& extent) {
  std::vector<Ensemble> ensembles;
  for (PaperEngine const& engine : extent.engines) {
    for (double const density : extent.square_densities) {
      ensembles.push_back(paper_ensemble(extent, engine, StartKind::square, density));
    }
    for (double const density : extent.triangular_densities) {
      ensembles.push_back(paper_ensemble(extent, engine, StartKind::triangular, density));
    }
  }
  return ensembles;
}

char const* name_of(Edge edge) { return edge == Edge::wall ? "wall" : "periodic"; }

Ensemble sampled_evenly(Ensemble ensemble, double diameters, std::uint64_t samples) {
  double const steps_between = diameters / ensemble.time_step / static_cast<double>(samples);
  ensemble.sample_every = std::max<std::uint64_t>(1, static_cast<std::uint64_t>(std::llround(steps_between)));
  ensemble.steps = ensemble.sample_every * samples;
  return ensemble;
}

void plan(Study& study, Ensemble const& ensemble) {
  for (std::uint64_t number = 0; number < ensemble.seeds; ++number) study.runs.add(run_of(study, ensemble, number));
}

EnsembleResult::EnsembleResult(Study const& study, Ensemble const& ensemble) {
  for (std::uint64_t number = 0; number < ensemble.seeds; ++number) {
    StudyOutcome const& outcome = study.runs.outcome_of(run_of(study, ensemble, number));
    if (outcome.is_finished) outcomes_.push_back(&outcome);
  }
}

std::vector<std::size_t> EnsembleResult::samples_spread_out(std::size_t parts) const {
  std::vector<std::size_t> chosen;
  std::size_t next = 1;
  for (std::size_t sample = 1; sample < samples(); ++sample) {
    if (sample < next && sample + 1 < samples()) continue;
    next = sample + 1 + sample / parts;
    chosen.push_back(sample);
  }
  return chosen;
}

std::vector<double> EnsembleResult::of_each_seed(std::function<double(StudyOutcome const&)> const& value) const {
  std::vector<double> values;
  for (StudyOutcome const* outcome : outcomes_) values.push_back(value(*outcome));
  return values;
}

Estimate EnsembleResult::over_seeds(std::function<double(StudyOutcome const&)> const& value) const {
  return mean_over_seeds(of_each_seed(value));
}

Estimate EnsembleResult::displacement(std::size_t sample) const {
  return over_seeds([=](StudyOutcome const& outcome) { return outcome.displacements[sample]; });
}

Estimate EnsembleResult::tail_displacement(double share) const {
  return over_seeds([=](StudyOutcome const& outcome) { return tail_mean(outcome.displacements, share); });
}

Estimate EnsembleResult::tail_blocked_share(double share) const {
  return over_seeds([=](StudyOutcome const& outcome) { return tail_mean(outcome.blocked_shares, share); });
}

Estimate EnsembleResult::tail_collision_rate(double share) const {
  return over_seeds([=](StudyOutcome const& outcome) { return tail_mean(outcome.collision_rates, share); });
}

std::size_t EnsembleResult::arrested() const {
  return static_cast<std::size_t>(std::ranges::count_if(outcomes_, [](StudyOutcome const* outcome) {
    return tail_mean(outcome->blocked_shares, share_that_shows_arrest) > blocked_share_of_arrest;
  }));
}

}  // namespace gridlock
