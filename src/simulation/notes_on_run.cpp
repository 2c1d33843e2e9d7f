#include "simulation/notes_on_run.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>

#include "gridlock/core/disks.hpp"
#include "gridlock/core/frame_source.hpp"
#include "observe/doubt.hpp"

namespace gridlock {

namespace {

/// Returns the measured values of a column in rows first … end − 1.
std::vector<double> values_of(std::vector<double> const& column, std::size_t first, std::size_t end) {
  std::vector<double> values;
  for (std::size_t row = first; row < std::min(end, column.size()); ++row) {
    if (std::isfinite(column[row])) values.push_back(column[row]);
  }
  return values;
}

/// Returns whether an estimate is the mean of the samples, and not a value at the end of the run.
bool is_mean_of(std::vector<double> const& samples, Estimate const& estimate) {
  double sum = 0.0;
  for (double const sample : samples) sum += sample;
  double const mean = sum / static_cast<double>(samples.size());
  // The last interval of a rate may be shorter and has less weight, so the means may differ slightly.
  return std::abs(mean - estimate.value) <= 0.2 * *estimate.error + 1e-12 * std::abs(mean);
}

std::optional<Doubt> doubt_of(Table const& series, std::size_t left_out, NamedEstimate const& result) {
  if (!result.estimate.error || !(*result.estimate.error > 0.0)) return std::nullopt;
  std::vector<std::string> const& names = series.names();
  if (std::ranges::find(names, result.name) == names.end()) return std::nullopt;
  std::vector<double> const* column = std::get_if<std::vector<double>>(&series.column(result.name));
  if (column == nullptr) return std::nullopt;
  std::vector<double> const kept = values_of(*column, left_out, column->size());
  if (kept.empty() || !is_mean_of(kept, result.estimate)) return std::nullopt;
  return find_doubt(values_of(*column, 0, left_out), kept);
}

/// Returns the value of a count of the simulation; 0 if there is none of this name.
std::uint64_t count_of(Simulation const& simulation, std::string_view name) {
  for (Count const& count : simulation.counts()) {
    if (count.name == name) return count.value;
  }
  return 0;
}

/// Averages over all disks: diameter, and root mean square speed.
struct MeanDisk {
  double diameter = 0.0;
  double speed = 0.0;
};

/// Returns nothing for agents without radii and velocities. Reads the frame in pieces, which processes may share.
std::optional<MeanDisk> mean_disk_of(FrameSource const& frame) {
  auto const radius = frame.find(Radius::name);
  auto const x = frame.find(VelocityX::name);
  auto const y = frame.find(VelocityY::name);
  if (frame.size() == 0 || !radius || !x || !y) return std::nullopt;
  MeanDisk mean;
  double squares = 0.0;
  constexpr std::size_t rows_in_memory = 100'000;
  for_each_piece(frame.size(), rows_in_memory, [&](std::size_t first, std::size_t count) {
    auto const values = [&](std::size_t column) {
      return std::get<std::vector<double>>(frame.values(column, first, count));
    };
    for (double const r : values(*radius)) mean.diameter += 2.0 * r;
    for (double const v : values(*x)) squares += v * v;
    for (double const v : values(*y)) squares += v * v;
  });
  auto const count = static_cast<double>(frame.size());
  mean.diameter /= count;
  mean.speed = std::sqrt(squares / count);
  return mean;
}

/// Returns a note on viscosities for which the run is too short: they have no errors or, with `no_values`, no values.
std::optional<Event> note_on_viscosities(Table const& series, std::size_t left_out,
                                         std::span<NamedEstimate const> results) {
  if (!series.contains("shear_viscosity")) return std::nullopt;
  auto const found = std::ranges::find(results, "shear_viscosity", &NamedEstimate::name);
  if (found != results.end() && found->estimate.error) return std::nullopt;
  Event note{.kind = EventKind::error_not_known,
             .key = "observe.viscosity_lag",
             .values = {{"names", "shear_viscosity, bulk_viscosity"},
                        {"samples", static_cast<std::uint64_t>(series.row_count() - left_out)}}};
  if (found == results.end()) note.values.emplace_back("no_values", std::uint64_t{1});
  return note;
}

}  // namespace

std::vector<Event> withhold_errors(Table const& series, std::size_t left_out, std::vector<NamedEstimate>& results) {
  // One note lists all quantities with the same reason, since quantities are usually doubtful together.
  Event differs{.kind = EventKind::error_not_known, .key = "observe.equilibration", .values = {}};
  Event slow{.kind = EventKind::error_not_known, .key = "run", .values = {}};
  std::optional<Event> too_short = note_on_viscosities(series, left_out, results);
  std::string names_that_differ;
  std::string slow_names;
  double differs_by = 0.0;
  double times_seen = 1e9;
  auto const add = [](std::string& names, std::string const& name) { names += names.empty() ? name : ", " + name; };
  for (NamedEstimate& result : results) {
    std::optional<Doubt> const doubt = doubt_of(series, left_out, result);
    if (!doubt) continue;
    result.estimate.error.reset();
    if (doubt->differs_by) {
      add(names_that_differ, result.name);
      differs_by = std::max(differs_by, *doubt->differs_by);
    } else {
      add(slow_names, result.name);
      times_seen = std::min(times_seen, *doubt->times_seen);
    }
  }
  std::vector<Event> notes;
  if (too_short) notes.push_back(*std::move(too_short));
  if (!names_that_differ.empty()) {
    differs.values = {{"names", names_that_differ}, {"differs_by", differs_by}};
    notes.push_back(std::move(differs));
  }
  if (!slow_names.empty()) {
    slow.values = {{"names", slow_names}, {"times_seen", times_seen}};
    notes.push_back(std::move(slow));
  }
  return notes;
}

std::vector<Event> notes_on_motion(Simulation const& simulation, double time, std::span<NamedEstimate const> results) {
  std::vector<Event> notes;
  std::uint64_t const pairs = simulation.pair_collisions();
  auto const disks = static_cast<double>(simulation.agents());
  if (pairs == 0 || disks == 0.0 || !(time > 0.0)) return notes;
  double const hits = 2.0 * static_cast<double>(pairs) + static_cast<double>(count_of(simulation, "wall_hits"));
  // After fewer collisions per disk no conclusion is possible.
  constexpr double min_hits_per_disk = 20.0;
  if (!(hits >= min_hits_per_disk * disks)) return notes;
  std::optional<MeanDisk> disk;
  simulation.give_frame([&](FrameSource const& frame) { disk = mean_disk_of(frame); });
  disk = simulation.processes().of_root(disk);
  if (!disk) return notes;
  double const flight = disk->speed * time * disks / hits / disk->diameter;
  constexpr double min_flight = 1e-6;
  if (flight < min_flight) {
    notes.push_back({.kind = EventKind::time_stands_still,
                     .values = {{"collisions", static_cast<std::uint64_t>(hits)}, {"time", time}, {"flight", flight}}});
    return notes;
  }
  auto const moved = std::ranges::find(results, "mean_squared_displacement", &NamedEstimate::name);
  if (moved == results.end()) return notes;
  double const squared_diameters = moved->estimate.value / (disk->diameter * disk->diameter);
  if (squared_diameters < 1.0) {
    notes.push_back({.kind = EventKind::disks_in_cages,
                     .key = "run",
                     .values = {{"collisions_per_disk", hits / disks}, {"squared_diameters", squared_diameters}}});
  }
  return notes;
}

}  // namespace gridlock
