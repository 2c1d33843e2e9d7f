#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "gridlock/observe/estimate.hpp"
#include "study/study.hpp"

namespace gridlock {

/// The time step of runs that are not about it, as engine.time_step.
inline constexpr double usual_time_step = 0.1;

/// Runs that differ in the seed alone.
struct ReplicaSet {
  PaperEngine engine;
  StartKind start = StartKind::square;
  Edge edge = Edge::wall;
  double packing_fraction = 0.0;
  Sites sites = Sites::fitted;
  double time_step = 0.1;  ///< diameters per v_max
  Contact contact = Contact::always;
  std::uint64_t steps = 0;
  std::uint64_t sample_every = 0;
  std::uint64_t seeds = 0;
};

/// The replica set behind one point of Figures 6 and 7, of the length given.
ReplicaSet paper_replica_set(PaperLength const& length, PaperEngine const& engine, StartKind start,
                             double packing_fraction);
/// All points of Figure 7 in runs of one length: engine after engine, square before triangular, density rising.
std::vector<ReplicaSet> paper_replica_sets(PaperExtent const& extent, PaperLength const& length);

/// The replica set with `samples` samples in a physical length in diameters per v_max, each after a whole number of
/// steps, so that samples stand at the same physical times whatever the time step.
ReplicaSet sampled_evenly(ReplicaSet replica_set, double diameters, std::uint64_t samples);

char const* name_of(StartKind start);
char const* name_of(Edge edge);

void plan(Study& study, ReplicaSet const& replica_set);

/// The mean of the last `share` of the samples of a run, at least one; the first is the start and never counts.
double tail_mean(std::vector<double> const& values, double share);

/// What a set of replicas has measured, over those of its runs that are finished.
class ReplicaResult {
 public:
  ReplicaResult(Study const& study, ReplicaSet const& replica_set);

  [[nodiscard]] std::size_t seeds() const { return outcomes_.size(); }
  /// Samples every run has; the first is the start.
  [[nodiscard]] std::size_t samples() const { return outcomes_.empty() ? 0 : outcomes_.front()->steps.size(); }
  /// Those that show on a logarithmic axis, where the start has no place: each about a part 1/parts later than the one
  /// before, and the last.
  [[nodiscard]] std::vector<std::size_t> samples_spread_out(std::size_t parts) const;
  [[nodiscard]] double step(std::size_t sample) const { return outcomes_.front()->steps[sample]; }
  [[nodiscard]] double time(std::size_t sample) const { return outcomes_.front()->times[sample]; }

  /// Mean displacement over the side of the box, mean and standard error over seeds.
  [[nodiscard]] Estimate displacement(std::size_t sample) const;
  [[nodiscard]] Estimate last_displacement() const { return displacement(samples() - 1); }
  /// The same, each run averaged over the last `share` of its samples first.
  [[nodiscard]] Estimate tail_displacement(double share) const;
  [[nodiscard]] Estimate tail_halted_fraction(double share) const;
  [[nodiscard]] Estimate tail_collision_rate(double share) const;

  /// A number from each finished run, in the order of the seeds.
  [[nodiscard]] std::vector<double> of_each_seed(std::function<double(StudyOutcome const&)> const& value) const;

  /// Runs in which, over the last fifth, more than 98 % of all moves were halted: the system has come to a standstill.
  /// None where the engine halts no disks.
  [[nodiscard]] std::size_t arrested() const;

 private:
  [[nodiscard]] Estimate over_seeds(std::function<double(StudyOutcome const&)> const& value) const;

  std::vector<StudyOutcome const*> outcomes_;
};

}  // namespace gridlock
