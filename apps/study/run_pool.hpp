#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "gridlock/io/table.hpp"
#include "gridlock/simulation/configuration.hpp"
#include "gridlock/simulation/simulate.hpp"
#include "study/partial_results.hpp"

namespace gridlock {

/// Which sites a lattice start uses.
enum class Sites {
  fitted,    ///< as lattice/start.hpp chooses them
  to_walls,  ///< the square lattice with its outermost disks touching the walls
  perfect,   ///< the unstretched triangular lattice in the middle of the box
};

/// One simulation of the study.
struct StudyRun {
  Configuration configuration;
  Sites sites = Sites::fitted;
};

/// What the study keeps of a simulation.
struct StudyOutcome {
  bool is_finished = false;
  std::string failure;  ///< why the run broke, where it did
  std::vector<double> steps;
  std::vector<double> times;
  std::vector<double> displacements;               ///< mean displacement over the side of the box
  std::vector<double> centre_displacements;        ///< over the side of the box
  std::vector<double> displacements_about_centre;  ///< root mean square, over the side of the box
  std::vector<double> halted_fractions;            ///< since the sample before
  std::vector<double> collision_rates;
  std::vector<double> compressibility_factors;
  std::vector<double> wall_pressures;  ///< none in a periodic box
  std::uint64_t state_hash = 0;
  double seconds = 0.0;
};

/// Serializes the outcome of a finished run.
void serialize(Archive& archive, StudyOutcome& outcome);

/// The sites of the paper's starts that the lattices of lattice/start.hpp do not make.
///
/// to_walls needs a square number of disks; perfect has rows of p and p − 1 sites, as lattice/start.hpp, with the spacing
/// that touches two opposite walls. The largest radius there is returned in `radius`.
struct SiteList {
  std::vector<Vector> sites;
  double radius = 0.0;
};
SiteList square_sites_to_walls(double side, std::uint64_t count, double radius);
SiteList perfect_triangular_sites(double side, std::uint64_t count);

/// The state a study's run starts from. Errors: Error where it does not exist.
Setup set_up(StudyRun const& run);

/// Simulations that several figures share, each done once.
class RunPool {
 public:
  /// Notes that a run is needed; a run asked for before is not done twice.
  void add(StudyRun const& run);

  /// Takes over the outcomes that partial results hold, and keeps there every outcome to come; they must outlive the pool.
  void keep_in(PartialResults& partial_results);

  /// Does everything that was added and is not finished, on `threads` cores (0: all), the longest runs first.
  /// on_progress(fraction, finished), the fraction of what this call has to do, is called from any thread, one call at a time; returning false stops every run after
  /// its present chunk.
  void run_all(unsigned threads, std::function<bool(double fraction, std::size_t finished)> const& on_progress);

  [[nodiscard]] std::size_t size() const { return entries_.size(); }
  /// Runs that are finished.
  [[nodiscard]] std::size_t finished() const;
  /// Work of all runs that are not finished, in disk-steps of the paper's rule.
  [[nodiscard]] double work() const;

  /// The outcome of a run that was added (asserted).
  [[nodiscard]] StudyOutcome const& outcome_of(StudyRun const& run) const;

  /// One row for every run that has ended: its settings, how it ended and what came out.
  [[nodiscard]] Table rows() const;
  /// Runs that broke, in words.
  [[nodiscard]] std::vector<std::string> failures() const;

 private:
  struct Entry {
    StudyRun run;
    double work = 0.0;
    StudyOutcome outcome;
  };

  std::vector<Entry> entries_;
  std::map<std::string, std::size_t> by_settings_;
  PartialResults* partial_results_ = nullptr;
};

}  // namespace gridlock
