#include "gridlock/observe/observable.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <iterator>
#include <string_view>
#include <utility>

#include "gridlock/core/disks.hpp"
#include "gridlock/core/error.hpp"
#include "observe/bond_orientation.hpp"
#include "observe/cluster_sizes.hpp"
#include "observe/defect_fractions.hpp"
#include "observe/density_profile.hpp"
#include "observe/displacement.hpp"
#include "observe/displacement_curve.hpp"
#include "observe/energy.hpp"
#include "observe/free_flights.hpp"
#include "observe/line_flux.hpp"
#include "observe/local_density.hpp"
#include "observe/pair_correlation.hpp"
#include "observe/pressure.hpp"
#include "observe/rates.hpp"
#include "observe/speed.hpp"
#include "observe/stress.hpp"
#include "observe/swim.hpp"
#include "observe/temperature_by_kind.hpp"
#include "observe/velocity_autocorrelation.hpp"
#include "observe/viscosity.hpp"

namespace gridlock {

void describe(ObserveSettings& settings, SettingVisitor& visitor) {
  visitor.visit({.key = "every", .unit = "steps", .documentation = "Steps between two samples.", .min = 1.0},
                settings.every);
  visitor.visit({.key = "per_decade",
                 .documentation = "Samples for each factor of ten in the number of steps, evenly in its logarithm, "
                                  "the first after observe.every steps; averages and curves need even samples and "
                                  "are then left out. 0: a sample every observe.every steps.",
                 .max = 1000},
                settings.per_decade);
  visitor.visit({.key = "equilibration",
                 .documentation = "Share of the run at its start that averages leave out.",
                 .min = 0.0,
                 .max = 1.0,
                 .max_is_allowed = false,
                 .former_key = "discard"},
                settings.equilibration);
  visitor.visit({.key = "structure_every",
                 .unit = "samples",
                 .documentation = "Samples between two measurements of ψ6 and g(r), the expensive ones; 0 for none."},
                settings.structure_every);
  visitor.visit({.key = "pair_correlation_range",
                 .unit = "mean diameters",
                 .documentation = "Largest distance of g(r); at most half the shorter side of the box is used.",
                 .min = 0.0,
                 .min_is_allowed = false},
                settings.pair_correlation_range);
  visitor.visit(
      {.key = "pair_correlation_bins", .documentation = "Bins of g(r) from 0 to its range.", .min = 1.0, .max = 1e6},
      settings.pair_correlation_bins);
  visitor.visit({.key = "orientation_correlation",
                 .documentation = "Whether the table of g(r) has the hexatic correlation g₆(r) of ψ6 too."},
                settings.orientation_correlation);
  visitor.visit({.key = "defects_every",
                 .unit = "samples",
                 .documentation = "Samples between two searches for disclinations, dislocations and other defects of a "
                                  "triangular crystal in a periodic box; 0 for none."},
                settings.defects_every);
  visitor.visit({.key = "speed_range",
                 .unit = "root mean square speeds of the lightest disks",
                 .documentation = "Largest speed of the speed distribution.",
                 .min = 0.0,
                 .min_is_allowed = false},
                settings.speed_range);
  visitor.visit({.key = "speed_bins",
                 .documentation = "Bins of the speed distribution from 0 to its range.",
                 .min = 1.0,
                 .max = 1e6},
                settings.speed_bins);
  visitor.visit({.key = "velocity_origin_every",
                 .unit = "samples",
                 .documentation = "Samples between two origins of the velocity autocorrelation, and the length of its "
                                  "curve; 0 for one origin and the curve of the whole run."},
                settings.velocity_origin_every);
  static constexpr std::array<std::string_view, 4> axes{"none", "x", "y", "both"};
  visit_enum(visitor,
             {.key = "density_profile",
              .documentation = "The axes along which the density of the agents is measured in strips, in every sample "
                               "that counts."},
             axes, settings.density_profile);
  visitor.visit({.key = "density_profile_bins",
                 .documentation = "Strips of a density profile, from one side of the box to the other.",
                 .min = 1.0,
                 .max = 1e5},
                settings.density_profile_bins);
  visitor.visit({.key = "clusters_every",
                 .unit = "samples",
                 .documentation = "Samples between two searches for clusters of near disks; 0 for none."},
                settings.clusters_every);
  visitor.visit({.key = "cluster_cutoff",
                 .unit = "contact distances",
                 .documentation = "Two disks nearer than this many sums of their radii are in one cluster.",
                 .min = 0.0,
                 .max = 1e3,
                 .min_is_allowed = false},
                settings.cluster_cutoff);
  visitor.visit({.key = "local_density_every",
                 .unit = "samples",
                 .documentation = "Samples between two counts of the agents in each cell of a grid; 0 for none."},
                settings.local_density_every);
  visitor.visit({.key = "local_density_side",
                 .unit = "mean diameters",
                 .documentation = "Side of these cells, changed a little so that a whole number of them fills the box.",
                 .min = 0.0,
                 .min_is_allowed = false},
                settings.local_density_side);
  visitor.visit(
      {.key = "displacement_lag",
       .unit = "samples",
       .documentation = "Longest lag of the curve of the mean squared displacement, whose last two thirds give "
                        "the diffusion coefficient; 0 for no curve.",
       .max = 1e9},
      settings.displacement_lag);
  visitor.visit({.key = "displacement_origin_every",
                 .unit = "samples",
                 .documentation = "Samples between two origins of this curve; 0 for an eighth of the longest lag."},
                settings.displacement_origin_every);
  visitor.visit(
      {.key = "temperature_by_kind",
       .documentation = "Whether the temperature along x and along y is measured, and that of each kind of disk "
                        "where there are two to eight."},
      settings.temperature_by_kind);
  visitor.visit({.key = "viscosity_lag",
                 .unit = "samples",
                 .documentation = "Longest lag of the growth of the integrated stress of exact, whose last two thirds "
                                  "give shear and bulk viscosity; 0 for none.",
                 .max = 1e6},
                settings.viscosity_lag);
  visitor.visit({.key = "free_flights",
                 .documentation = "Whether the paths and times of exact disks between their collisions are measured."},
                settings.free_flights);
  static constexpr std::array<std::string_view, 3> lines{"none", "vertical", "horizontal"};
  visit_enum(
      visitor,
      {.key = "flux_line",
       .documentation = "The line through the whole box at which the agents that cross it in either direction are "
                        "counted."},
      lines, settings.flux_line);
  visitor.visit({.key = "flux_position",
                 .unit = "length",
                 .documentation = "x of a vertical line of the flux, y of a horizontal one.",
                 .min = 0.0,
                 .default_note = "the middle of the box"},
                settings.flux_position);
}

namespace {

/// An observable that a setting asks for.
struct RequestedObservable {
  std::string_view setting;
  std::unique_ptr<Observable> observable;
};

std::vector<RequestedObservable> requested_observables(ObserveSettings const& settings) {
  std::vector<RequestedObservable> requested;
  auto const add = [&](std::string_view setting, std::unique_ptr<Observable> observable) {
    requested.push_back({setting, std::move(observable)});
  };
  using Axis = DensityProfile::Axis;
  for (auto const& [asked, axis] : {std::pair(ProfileAxes::x, Axis::x), std::pair(ProfileAxes::y, Axis::y)}) {
    if (settings.density_profile != asked && settings.density_profile != ProfileAxes::both) continue;
    add("density_profile", std::make_unique<DensityProfile>(axis, settings.density_profile_bins));
  }
  if (settings.clusters_every > 0) {
    add("clusters_every", std::make_unique<ClusterSizes>(settings.clusters_every, settings.cluster_cutoff));
  }
  if (settings.local_density_every > 0) {
    add("local_density_every",
        std::make_unique<LocalDensity>(settings.local_density_every, settings.local_density_side));
  }
  if (settings.defects_every > 0) {
    add("defects_every", std::make_unique<DefectFractions>(settings.defects_every));
  }
  if (settings.displacement_lag > 0) {
    add("displacement_lag",
        std::make_unique<DisplacementCurve>(settings.displacement_lag, settings.displacement_origin_every));
  }
  if (settings.temperature_by_kind) add("temperature_by_kind", std::make_unique<TemperatureByKind>());
  if (settings.viscosity_lag > 0) add("viscosity_lag", std::make_unique<Viscosity>(settings.viscosity_lag));
  if (settings.free_flights) add("free_flights", std::make_unique<FreeFlights>());
  if (settings.flux_line != FluxLine::none) {
    add("flux_line", std::make_unique<LineFlux>(settings.flux_line, settings.flux_position));
  }
  return requested;
}

/// Throws Error for an observable that a setting asks for and that agents without a column cannot have.
void require_requested(std::string_view setting, Observable const& observable, Snapshot const& start) {
  for (std::string_view const name : observable.requirements(start.box).columns) {
    if (start.agents.has(name)) continue;
    throw Error({.what = fmt::format("observe.{} measures what needs the column {}, which these agents do not have",
                                     setting, name),
                 .hint = fmt::format("leave it out; they have {}", fmt::join(start.agents.names(), ", ")),
                 .key = fmt::format("observe.{}", setting)});
  }
}

}  // namespace

std::vector<std::unique_ptr<Observable>> make_observables(ObserveSettings const& settings, Snapshot const& start,
                                                          DynamicsTraits const& dynamics) {
  std::vector<std::unique_ptr<Observable>> observables;
  observables.push_back(std::make_unique<Displacement>());
  observables.push_back(std::make_unique<Energy>());
  observables.push_back(std::make_unique<Speed>(settings.speed_range, settings.speed_bins));
  if (dynamics.has_dynamics) observables.push_back(std::make_unique<Rates>(dynamics.halts_moves));
  if (dynamics.has_impulses) observables.push_back(std::make_unique<Pressure>());
  if (dynamics.propels) observables.push_back(std::make_unique<SwimSpeed>());
  if (dynamics.potential) observables.push_back(std::make_unique<Stress>(dynamics));
  if (dynamics.has_dynamics) {
    observables.push_back(std::make_unique<VelocityAutocorrelation>(settings.velocity_origin_every));
  }
  if (settings.structure_every > 0) {
    observables.push_back(std::make_unique<BondOrientation>(settings.structure_every));
    observables.push_back(std::make_unique<PairCorrelation>(settings.structure_every, settings.pair_correlation_range,
                                                            settings.pair_correlation_bins,
                                                            settings.orientation_correlation));
  }
  std::erase_if(observables, [&](auto const& observable) {
    Requirements const needs = observable->requirements(start.box);
    return (needs.collisions && !dynamics.keeps_counters) ||
           std::ranges::any_of(needs.columns, [&](std::string_view name) { return !start.agents.has(name); });
  });
  for (auto& [setting, observable] : requested_observables(settings)) {
    require_requested(setting, *observable, start);
    observables.push_back(std::move(observable));
  }
  for (auto const& observable : observables) observable->begin(start);
  return observables;
}

void require_columns(Observable const& observable, Snapshot const& start) {
  for (std::string_view const name : observable.requirements(start.box).columns) {
    if (start.agents.has(name)) continue;
    throw Error({.what = fmt::format("an observable needs a column {}, which the agents do not have", name),
                 .hint = fmt::format("they have {}", fmt::join(start.agents.names(), ", "))});
  }
}

ObserveSettings settings_of_all_observables() {
  return {.every = 1,
          .structure_every = 1,
          .orientation_correlation = true,
          .density_profile = ProfileAxes::both,
          .clusters_every = 1,
          .local_density_every = 1,
          .displacement_lag = 1,
          .temperature_by_kind = true,
          .flux_line = FluxLine::vertical};
}

std::span<std::string_view const> names_of_curves() {
  static constexpr std::array<std::string_view, 11> names{
      "pair_correlation",       "speed_distribution",        "velocity_autocorrelation",
      "density_profile_x",      "density_profile_y",         "cluster_sizes",
      "local_density",          "mean_squared_displacement", "stress_growth",
      "free_time_distribution", "free_path_distribution"};
  return names;
}

std::vector<ColumnInfo> observed_columns(ObserveSettings const& settings) {
  State state{.box = Box(1.0, 1.0, Edge::wall), .agents = {}, .clock = {}, .seed = 0};
  for (double const radius : {0.1, 0.2}) state.agents.add(0.5, 0.5, 1.0, 0.0, radius, 1.0, 0, 0);
  Counters const counters;
  std::vector<ColumnInfo> columns;
  for (auto const& observable : make_observables(settings, {state, counters}, {.propels = true})) {
    std::ranges::move(observable->columns(), std::back_inserter(columns));
  }
  Stress of_soft_disks({.potential = PotentialSettings{}});
  of_soft_disks.begin({state, counters});
  std::ranges::move(of_soft_disks.columns(), std::back_inserter(columns));
  State const periodic{.box = Box(1.0, 1.0, Edge::periodic)};
  DefectFractions of_periodic_boxes(1);
  of_periodic_boxes.begin({periodic, counters});
  std::ranges::move(of_periodic_boxes.columns(), std::back_inserter(columns));
  Viscosity of_exact_disks(1);
  of_exact_disks.begin({periodic, counters});
  std::ranges::copy_if(of_exact_disks.columns(), std::back_inserter(columns), [&](ColumnInfo const& column) {
    return std::ranges::find(columns, column.name, &ColumnInfo::name) == columns.end();
  });
  FreeFlights flights;
  flights.begin({periodic, counters});
  std::ranges::move(flights.columns(), std::back_inserter(columns));
  return columns;
}

std::vector<NamedEstimate> AveragingObservable::results() const {
  std::vector<NamedEstimate> results;
  for (std::size_t c = 0; c < columns_.size(); ++c) {
    if (auto const estimate = averages_[c].estimate())
      results.push_back({columns_[c].name, *estimate, columns_[c].unit});
  }
  return results;
}

void AveragingObservable::reset(std::vector<ColumnInfo> columns) {
  columns_ = std::move(columns);
  averages_.assign(columns_.size(), {});
}

}  // namespace gridlock
