#pragma once

/// \file
/// Observables measure quantities of a run: their interface, settings and list.
///
/// ```cpp
/// State state{.box = Box(1.0, 1.0, Edge::wall)};
/// state.agents.add(0.5, 0.5, 1.0, 0.0, 0.1, 1.0, 0, 0);
/// Counters const counters;
/// for (auto const& observable : make_observables({}, Snapshot(state, counters))) {
///   std::vector<double> row(observable->columns().size());
///   observable->begin(Snapshot(state, counters));
///   observable->sample(Snapshot(state, counters), row, true);
/// }
/// ```

#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "gridlock/core/agents_view.hpp"
#include "gridlock/core/archive.hpp"
#include "gridlock/core/box.hpp"
#include "gridlock/core/setting.hpp"
#include "gridlock/core/world.hpp"
#include "gridlock/engine/engine.hpp"
#include "gridlock/observe/estimate.hpp"
#include "gridlock/observe/snapshot.hpp"

namespace gridlock {

/// The columns and counters that a world must have for an observable.
struct Requirements {
  std::vector<std::string_view> columns;
  bool collisions = false;  ///< whether it needs Counters: pair collisions, wall hits, impulses
  bool reports = false;     ///< whether it needs every pair collision, see Observable::collided()
};

/// One column of a table.
struct ColumnInfo {
  std::string name;  ///< unique: the key in summary.json, and the name of the column in series.csv
  std::string unit;  ///< from the units of the box, masses and velocities; empty for pure numbers
  std::string documentation;
  std::string former_name = {};  ///< the name in earlier versions
  bool is_count = false;         ///< values are whole numbers, written without a decimal point
};

struct NamedEstimate {
  std::string name;
  Estimate estimate;
  std::string unit;
};

/// A measured curve, written to the file `name`.csv.
struct Distribution {
  std::string name;
  std::vector<ColumnInfo> columns;
  std::vector<std::vector<double>> columns_of_values;  ///< one vector per column, all of the same length
  std::vector<std::string> names = {};                 ///< names of the rows, written as column 2, "name"; may be empty
};

/// The entry of a row for a quantity that is not defined, or not measured in this sample. Tables leave it empty.
inline constexpr double no_value = std::numeric_limits<double>::quiet_NaN();

/// A quantity that is measured during a run: a few numbers at every sample, and their averages at the end.
///
/// The run calls begin() once, then sample() at every sampled time in order (perhaps also at the start), then results()
/// and distributions(). Rows may change between samples; Ids do not. If several processes share the run, each has the
/// same observables and calls them together. Observables compute sums over all agents by the functions of Snapshot, so
/// that their code is the same for one process and for many.
class Observable {
 public:
  Observable() = default;
  Observable(Observable const&) = delete;
  Observable& operator=(Observable const&) = delete;
  virtual ~Observable() = default;

  /// Returns the columns and counters that it needs in a box. A simulation has the observables whose needs its world
  /// meets.
  [[nodiscard]] virtual Requirements requirements(Box const& box) const = 0;

  /// Returns the columns that it fills in each row; they do not change after begin().
  [[nodiscard]] virtual std::vector<ColumnInfo> columns() const = 0;

  /// Deletes all data, and starts to measure from this time.
  virtual void begin(Snapshot const& start) = 0;

  /// Writes one number per column, or `no_value`, to `row`. A rate is measured since the previous sample (or since
  /// begin()), and is weighted in averages by this time interval. If `counts_for_average`, the snapshot and the
  /// interval that ends with it enter averages. Contract: row.size() == columns().size().
  virtual void sample(Snapshot const& now, std::span<double> row, bool counts_for_average) = 0;

  /// Called at every pair collision between samples, in the order of time, if requirements() ask for reports.
  virtual void collided(PairCollision const& /*collision*/) {}

  /// Returns averages, and the final values of quantities that grow with time. Quantities that are not defined (a rate
  /// over no time, a pressure of no disks) are left out, so that all numbers are finite.
  [[nodiscard]] virtual std::vector<NamedEstimate> results() const = 0;

  /// Returns the measured curves, averaged over samples that count; a curve without a sample is left out.
  [[nodiscard]] virtual std::vector<Distribution> distributions() const { return {}; }

  /// Serializes the data since begin(). Restored after a begin() at the same start, it gives the same results as
  /// without a stop.
  virtual void serialize(Archive& archive) = 0;
};

/// The axes along which the density is measured.
enum class ProfileAxes { none, x, y, both };

/// The line through which the flux of agents is measured: x = position is vertical, y = position is horizontal.
enum class FluxLine { none, vertical, horizontal };

/// The settings `[observe]`.
struct ObserveSettings {
  std::uint64_t every = 100;            ///< steps between samples
  std::uint64_t per_decade = 0;         ///< samples for each factor of ten in `every` steps; 0: one every `every` steps
  double equilibration = 0.2;           ///< share of the run that averages leave out at its start
  std::uint64_t structure_every = 10;   ///< samples between measurements of ψ6 and g(r); 0 for none
  double pair_correlation_range = 5.0;  ///< largest distance of g(r), in mean diameters
  std::uint64_t pair_correlation_bins = 250;
  bool orientation_correlation = false;  ///< whether g₆(r) is measured with g(r)
  std::uint64_t defects_every = 0;       ///< samples between searches for defects of a crystal; 0 for none
  double speed_range = 3.0;              ///< largest speed, in root mean square speeds of the lightest disks
  std::uint64_t speed_bins = 60;
  std::uint64_t velocity_origin_every = 0;  ///< samples between time origins of the velocity autocorrelation; 0: one
                                            ///< origin
  ProfileAxes density_profile = ProfileAxes::none;
  std::uint64_t density_profile_bins = 50;
  std::uint64_t clusters_every = 0;       ///< samples between searches for clusters; 0 for none
  double cluster_cutoff = 1.1;            ///< largest distance of two disks of a cluster, in sums of their radii
  std::uint64_t local_density_every = 0;  ///< samples between measurements of the local density; 0 for none
  double local_density_side = 6.4;        ///< side of its cells, in mean diameters
  std::uint64_t displacement_lag = 0;     ///< longest lag of the mean squared displacement, in samples; 0 for no curve
  std::uint64_t displacement_origin_every = 0;  ///< samples between its origins; 0 for an eighth of the longest lag
  bool temperature_by_kind = false;             ///< whether to measure kT along x and y, and of each kind of disk
  std::uint64_t viscosity_lag = 0;              ///< longest lag of the growth of stresses, in samples; 0 for none
  bool free_flights = false;                    ///< whether to measure paths and times between pair collisions
  FluxLine flux_line = FluxLine::none;
  std::optional<double> flux_position;  ///< by default in the middle of the box
};
void describe(ObserveSettings& settings, SettingVisitor& visitor);

/// The properties of an engine on which observables depend.
struct DynamicsTraits {
  bool keeps_counters = true;                       ///< whether it keeps Counters, see Requirements::collisions
  bool has_dynamics = true;                         ///< whether rates and velocities mean something; not in Monte Carlo
  bool halts_moves = true;                          ///< whether a move ends where disks would overlap
  bool propels = false;                             ///< whether disks propel themselves
  bool has_impulses = true;                         ///< whether disks that meet, and walls, exchange momentum
  std::optional<PotentialSettings> potential = {};  ///< of soft disks
  ThermostatSettings thermostat = {};               ///< of soft disks, resolved
  PropulsionSettings propulsion = {};               ///< of soft disks
  PairDragSettings pair_drag = {};                  ///< of soft disks
  FlowSettings flow = {};                           ///< of soft disks
};

/// Returns every observable whose requirements the world meets; begin(start) has been called.
///
/// Displacement, Energy, Speed, Rates, Pressure, VelocityAutocorrelation; Stress of soft disks; BondOrientation and
/// PairCorrelation unless structure_every is 0; DensityProfile, ClusterSizes, LocalDensity, DefectFractions, LineFlux,
/// DisplacementCurve, TemperatureByKind, Viscosity, FreeFlights where settings ask (Error where a column is missing).
/// Quantities of walls exist only between walls. Cost of a sample: a few passes over the agents, about 20 ns an agent;
/// ψ6 and g(r) about 1 µs an agent when they are due.
std::vector<std::unique_ptr<Observable>> make_observables(ObserveSettings const& settings, Snapshot const& start,
                                                          DynamicsTraits const& dynamics = {});

/// Throws Error for an observable that requires a column which the agents lack.
void require_columns(Observable const& observable, Snapshot const& start);

/// Returns the settings with which every observable is measured in every sample.
ObserveSettings settings_of_all_observables();

/// Returns the columns that observables have with these settings, for disks of two kinds in a box with walls, which has
/// the most.
std::vector<ColumnInfo> observed_columns(ObserveSettings const& settings = settings_of_all_observables());

/// Returns the names of all curves that observables measure.
std::span<std::string_view const> names_of_curves();

/// An observable that averages every column over the samples that count: a derived class only measures.
///
/// ```cpp
/// struct Crowding : AveragingObservable {
///   Requirements requirements(Box const&) const override { return {}; }
///   void begin(Snapshot const&) override { reset({{"crowding", "1/length²", "Agents per area."}}); }
///   void sample(Snapshot const& now, std::span<double> row, bool counts_for_average) override {
///     row[0] = static_cast<double>(now.count()) / now.box.area();
///     if (counts_for_average) average(0, row[0]);
///   }
/// };
/// ```
class AveragingObservable : public Observable {
 public:
  [[nodiscard]] std::vector<ColumnInfo> columns() const override { return columns_; }
  /// Returns one estimate for each column with a value that counted.
  [[nodiscard]] std::vector<NamedEstimate> results() const override;

  /// Serializes the averages; a derived class with more data overrides it and calls it.
  void serialize(Archive& archive) override { gridlock::serialize(archive, "averages", averages_); }

 protected:
  /// Sets the columns and deletes all averages; begin() calls it.
  void reset(std::vector<ColumnInfo> columns);

  /// Adds one finite value of a column to its average.
  void average(std::size_t column, double value, double weight = 1.0) { averages_[column].add(value, weight); }

  [[nodiscard]] BlockAverage const& average_of(std::size_t column) const { return averages_[column]; }

 private:
  std::vector<ColumnInfo> columns_;
  std::vector<BlockAverage> averages_;
};

}  // namespace gridlock
