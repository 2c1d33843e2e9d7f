#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "drawing/page.hpp"
#include "gridlock/simulation/simulate.hpp"

namespace gridlock {

/// One curve of Figures 6 and 7: an engine and what the plots call it.
struct PaperEngine {
  std::string kind;   ///< engine.kind
  std::string label;  ///< in the keys of the plots
};

/// How long runs are, and how many there are of each.
struct PaperLength {
  std::uint64_t steps = 0;
  std::uint64_t sample_every = 0;
  std::uint64_t seeds = 0;  ///< one alone has no error over seeds, and no verdict rests on it
  /// Densities above it are left to the first engine: exact disks near closest packing collide so often that one point takes
  /// longer than all the others.
  double densest_of_others = 1.0;
};

/// How much of the paper is simulated. Densities rise and lie in (0, 0.785] for the square lattice, in (0, 0.865] for the
/// triangular one where there are 841 disks.
struct PaperExtent {
  std::string name;  ///< "quick" or "full", for titles
  std::uint64_t disks = 841;
  /// Figures 6 and 7. Another engine's curves are one more entry here; all engines run for the same physical time.
  std::vector<PaperEngine> engines{{"stepped", "the paper's rule"}, {"exact", "exact dynamics"}};
  PaperLength figure_6;  ///< also of what compares the points of Figure 7 among themselves, for which it takes errors
  PaperLength figure_7;  ///< where it is the same, so are the runs
  std::vector<double> square_densities;
  std::vector<double> triangular_densities;
  std::vector<double> fan_densities;  ///< of Figure 6; those above the square lattice's largest start triangular

  /// Figure 5: disks of one size, so large that the most of them just fit.
  std::vector<std::uint64_t> timing_counts;
  std::uint64_t timing_repeats = 0;

  /// The plateau at low density: runs long enough to forget the start, with a step chosen for speed.
  std::vector<double> plateau_densities;
  std::uint64_t plateau_seeds = 0;
  double plateau_time_step = 0.5;   ///< diameters per v_max
  double plateau_relaxations = 10;  ///< length in relaxation times of the box's slowest mode; the last 40 % count

  /// What the paper leaves open, at the same physical time for every time step, beside a dynamics without one.
  std::optional<PaperEngine> choice_reference = PaperEngine{"exact", "exact dynamics"};  ///< none: not compared
  std::vector<double> choice_time_steps;                                                 ///< diameters per v_max
  double choice_diameters = 0.0;  ///< length of the runs in diameters per v_max
  std::uint64_t choice_seeds = 0;
  std::vector<double> choice_square_densities;
  std::vector<double> choice_triangular_densities;

  /// The order of the turns, which the paper leaves open too: `stepped` and `tiled`, beside `exact`, from the same starts.
  double order_diameters = 0.0;          ///< length of the runs in diameters per v_max
  std::vector<double> order_time_steps;  ///< diameters per v_max; the curves are drawn of the first
  std::uint64_t order_seeds = 0;
  std::vector<double> order_square_densities;  ///< none here and in the next: not compared
  std::vector<double> order_triangular_densities;
  std::vector<double> order_periodic_densities;  ///< the same in a periodic box, square start; none: left out
};

/// About three minutes on two cores: Figure 7 has the paper's 100,000 steps and one seed, all else 10,000 steps and more
/// seeds.
PaperExtent quick_paper();
/// The paper's length, 100,000 steps: 2 lattices, at least 20 densities each, 4 seeds.
PaperExtent full_paper();

/// What to make, and where.
struct PaperSettings {
  PaperExtent extent = quick_paper();
  std::optional<int> figure;     ///< 4, 5, 6 or 7 alone; left out: all of them and the choices the paper leaves open
  std::filesystem::path output;  ///< a directory; made where it is missing, files of the same names are replaced
  bool overwrites = false;       ///< whether everything is made again, also what an interrupted study has kept
  unsigned threads = 0;          ///< simulations at a time; 0: one for each core
  std::uint64_t seed = 1;        ///< the seeds of the runs are seed, seed + 1 …
};

/// How far the study has come.
struct PaperProgress {
  double fraction = 0.0;  ///< of the whole work
  double seconds = 0.0;   ///< of real time so far
  std::string what;       ///< what is being done now, in a few words
};

/// Called from any thread, one call at a time; returning false ends the study within about a second. What is finished is
/// kept, and the same call again continues from there.
using OnPaperProgress = std::function<bool(PaperProgress const&)>;

/// One statement of the paper beside what was measured.
struct PaperClaim {
  std::string where;      ///< "Figure 5"
  std::string statement;  ///< what the paper says
  std::string measured;   ///< what came out, with errors, and what the verdict rests on
  Verdict verdict = Verdict::undecided;
};

struct PaperResult {
  RunStatus status = RunStatus::finished;
  std::size_t simulations = 0;
  std::size_t finished_simulations = 0;
  std::vector<PaperClaim> claims;            ///< of a finished study
  std::vector<std::filesystem::path> files;  ///< everything written, report.html last, which only a finished study has
  std::vector<std::string> notes;            ///< runs that failed, pictures that could not be drawn
  double seconds = 0.0;                      ///< of real time
};

/// Makes Figures 4 to 7 of the paper afresh and sets its claims beside what was measured.
///
/// Writes into settings.output, for each figure, its data (figure_*.csv), gnuplot script (.gp), SVG and PNG; runs.csv
/// with every simulation, its settings and state hash; and report.html, which holds all pictures, claims and verdicts and
/// needs no other file. The numbers, except for the timings of Figure 5, follow from settings.seed alone.
/// A study that is stopped or killed draws no report. It keeps every simulation and every timing that is finished in
/// partial_results/, by its settings and the version of the library, and the same call again does only the rest; the
/// results are those of a study that was never interrupted. A finished study removes partial_results/.
/// Errors: Error for an impossible extent (naming it) or for a directory that is unusable or in use; RunFailure where a
/// file cannot be written.
/// Cost: quick about three minutes, full about an hour on two cores.
/// Source: J.-X. Shen, Agent based simulations and optimization with uniform grid applied to colloidal jamming
/// transitions.
PaperResult run_paper(PaperSettings const& settings, OnPaperProgress const& on_progress = {});

}  // namespace gridlock
