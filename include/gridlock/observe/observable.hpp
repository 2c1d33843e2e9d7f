#pragma once

/// \file
/// Observables measure a run: the interface, its settings and the shipped ones.
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

/// An observable is defined in a world that has all of this.
struct Requirements {
  std::vector<std::string_view> columns;
  bool collisions = false;  ///< Counters are kept: pair collisions, wall hits, impulses
};

/// One column of a table.
struct ColumnInfo {
  std::string name;  ///< full and unique: the key in summary.json and the head of the column in series.csv
  std::string unit;  ///< in the units of the box, the masses and the velocities; empty for pure numbers
  std::string documentation;
  std::string former_name = {};  ///< its name in earlier versions
  bool is_count = false;         ///< whole numbers, written without a point
};

struct NamedEstimate {
  std::string name;
  Estimate estimate;
  std::string unit;
};

/// A measured curve; becomes `name`.csv.
struct Distribution {
  std::string name;
  std::vector<ColumnInfo> columns;
  std::vector<std::vector<double>> columns_of_values;  ///< one vector per column, all of the same length
  std::vector<std::string> names = {};                 ///< of the rows: the column "name" behind the first; or none
};

/// A cell of a row without a value: not defined at this time, or not measured in this sample. Tables leave it empty.
inline constexpr double no_value = std::numeric_limits<double>::quiet_NaN();

/// Something measured along a run: a few numbers at every sample, and their averages at the end.
///
/// The run calls begin() once, then sample() at every sampled time in order (the start may be one), then results() and
/// distributions(). The state may be reordered between samples; Ids keep their meaning. Where several processes share
/// the run, each has the same observables and calls them together: what is measured of all agents is written with the
/// functions of Snapshot, and no observable can tell one process from many.
class Observable {
 public:
  Observable() = default;
  Observable(Observable const&) = delete;
  Observable& operator=(Observable const&) = delete;
  virtual ~Observable() = default;

  /// The columns and counters that it needs in such a box. A simulation has the observables whose needs its world
  /// meets.
  [[nodiscard]] virtual Requirements requirements(Box const& box) const = 0;

  /// The columns this observable fills in each row; the same from begin() on.
  [[nodiscard]] virtual std::vector<ColumnInfo> columns() const = 0;

  /// Forgets everything and starts to measure from this time.
  virtual void begin(Snapshot const& start) = 0;

  /// Measures now: writes one number per column, or `no_value`. Rates are those since the previous sample (or since
  /// begin), and enter the averages with that interval's duration.
  /// `counts_for_average` says whether this snapshot, and the interval that ends with it, enter averages.
  /// Contract: row.size() == columns().size().
  virtual void sample(Snapshot const& now, std::span<double> row, bool counts_for_average) = 0;

  /// The averages over what counted, and the final values of what grows with time; only finite numbers. What is not
  /// defined (a rate of no time, a pressure of no disks) is left out.
  [[nodiscard]] virtual std::vector<NamedEstimate> results() const = 0;

  /// The measured curves, averaged over what counted; those without a sample are left out.
  [[nodiscard]] virtual std::vector<Distribution> distributions() const { return {}; }

  /// Serializes what was gathered since begin(); restored after a begin() at the same start, it measures on as if it
  /// had never stopped.
  virtual void serialize(Archive& archive) = 0;
};

/// The settings `[observe]`.
struct ObserveSettings {
  std::uint64_t every = 100;            ///< steps between samples
  double equilibration = 0.2;           ///< share of the run left out of averages
  std::uint64_t structure_every = 10;   ///< samples between measurements of ψ6 and g(r); 0 for none
  double pair_correlation_range = 5.0;  ///< in mean diameters
  std::uint64_t pair_correlation_bins = 250;
  double speed_range = 3.0;  ///< in root mean square speeds of the lightest disks
  std::uint64_t speed_bins = 60;
  std::uint64_t velocity_origin_every = 0;  ///< samples between origins of the velocity autocorrelation; 0: one
};
void describe(ObserveSettings& settings, SettingVisitor& visitor);

/// The properties of an engine on which observables depend.
struct DynamicsTraits {
  bool keeps_counters = true;  ///< see Requirements::collisions
  bool halts_moves = true;     ///< agents move in turns, which end where they would overlap
};

/// Every observable whose requirements such a world meets, ready to sample: begun at `start`.
///
/// Displacement, Energy, Speed, Rates, Pressure, VelocityAutocorrelation; BondOrientation and PairCorrelation unless
/// structure_every is 0. Each is described in its own header. Quantities of walls exist in walled boxes only.
/// Cost of a sample: a few passes over the agents, about 20 ns an agent; ψ6 and g(r) about 1 µs an agent when they are
/// due.
std::vector<std::unique_ptr<Observable>> make_observables(ObserveSettings const& settings, Snapshot const& start,
                                                          DynamicsTraits const& dynamics = {});

/// Throws Error for an observable that requires a column which the agents lack.
void require_columns(Observable const& observable, Snapshot const& start);

/// The columns of all of them, as they are for disks between walls, where most is measured.
std::vector<ColumnInfo> observed_columns();

/// An observable whose every column is averaged over the samples that count: a derived class only measures.
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
  /// One estimate per column that ever had a value that counted.
  [[nodiscard]] std::vector<NamedEstimate> results() const override;

  /// Serializes the averages; a derived class with more to serialize adds that.
  void serialize(Archive& archive) override { gridlock::serialize(archive, "averages", averages_); }

 protected:
  /// Sets the columns and forgets all averages; for begin().
  void reset(std::vector<ColumnInfo> columns);

  /// Adds one finite value of a column to its average.
  void average(std::size_t column, double value, double weight = 1.0) { averages_[column].add(value, weight); }

  [[nodiscard]] BlockAverage const& average_of(std::size_t column) const { return averages_[column]; }

 private:
  std::vector<ColumnInfo> columns_;
  std::vector<BlockAverage> averages_;
};

}  // namespace gridlock
