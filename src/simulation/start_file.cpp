#include "simulation/start_file.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>

#include "gridlock/core/error.hpp"

namespace gridlock {

namespace {

Error contradiction(std::string key, std::string what) {
  return Error(
      {.what = std::move(what), .hint = "leave the setting out, or give the value of the file", .key = std::move(key)});
}

bool is_close(double a, double b) { return std::abs(a - b) <= 1e-9 * std::abs(b); }

/// Takes the box of the file. Errors: Error if the settings give a different box.
void take_box(BoxSettings& settings, Box const& box, IsGiven const& is_given) {
  bool const asks_for_size = is_given("box.side") || is_given("box.width") || is_given("box.height");
  double const width = settings.width.value_or(settings.side);
  double const height = settings.height.value_or(settings.side);
  if (asks_for_size && !(is_close(width, box.width()) && is_close(height, box.height()))) {
    throw contradiction("box", fmt::format("the box of the start file is {} × {}, not {} × {}", box.width(),
                                           box.height(), width, height));
  }
  auto const require_edge = [&](char const* key, char axis, Edge asked, Edge found) {
    if (!(is_given("box.edge") || is_given(key)) || asked == found) return;
    throw contradiction(
        is_given(key) ? key : "box.edge",
        fmt::format("the start file has {} along {}", found == Edge::wall ? "walls" : "periodic edges", axis));
  };
  require_edge("box.edge_x", 'x', edge_x_of(settings), box.edge_x());
  require_edge("box.edge_y", 'y', edge_y_of(settings), box.edge_y());
  if (is_given("box.tilt") && !is_close(settings.tilt, box.tilt())) {
    throw contradiction("box.tilt",
                        fmt::format("the box of the start file has the tilt {}, not {}", box.tilt(), settings.tilt));
  }
  settings = {.edge = box.edge_x(), .side = box.width(), .tilt = box.tilt()};
  if (box.edge_y() != box.edge_x()) settings.edge_y = axis_edge_of(box.edge_y());
  if (box.width() != box.height()) {
    settings.width = box.width();
    settings.height = box.height();
  }
}

/// Throws an Error if neither file nor settings give radii.
void require_sizes(DisksSettings const& settings) {
  if (!settings.radius && !settings.packing_fraction) {
    throw Error({.what = "the start file has no radii, and none are given",
                 .hint = "give disks.radius or disks.packing_fraction, or add a column radius:R:1 to the file",
                 .key = "disks.file"});
  }
  if (settings.species.empty()) return;
  throw Error({.what = "the start file has no radii, and species are assigned in lattice and random starts only",
               .hint = "add columns radius:R:1 and masses:R:1 to the file, or leave disks.species out",
               .key = "disks.species"});
}

void take_sizes(StartFileSummary const& file, DisksSettings& settings) {
  if (settings.sizes != SizeDistribution::equal) {
    throw Error({.what = "disks.sizes are dealt out in lattice and random starts only",
                 .hint = "leave disks.sizes out, or disks.file",
                 .key = "disks.sizes"});
  }
  if (settings.count && *settings.count != file.count) {
    throw contradiction("disks.count",
                        fmt::format("the start file holds {} disks, not {}", file.count, *settings.count));
  }
  if (!file.has_radii) require_sizes(settings);
  if (settings.radius && !file.are_radii_as_asked) {
    throw contradiction("disks.radius", fmt::format("the start file has radii from {:.9g} to {:.9g}, not {:.9g}",
                                                    file.radii.smallest, file.radii.largest, *settings.radius));
  }
  double const packing_fraction = file.covered_area / file.box.area();
  if (settings.packing_fraction && !is_close(*settings.packing_fraction, packing_fraction)) {
    throw contradiction("disks.packing_fraction", fmt::format("the start file has packing fraction {:.9g}, not {:.9g}",
                                                              packing_fraction, *settings.packing_fraction));
  }
  settings.count = file.count;
}

}  // namespace

AskedRadii::AskedRadii(DisksSettings const& settings) {
  if (!settings.radius) return;
  if (settings.species.empty()) radii_.push_back(*settings.radius);
  for (SpeciesSettings const& kind : settings.species) radii_.push_back(*settings.radius * kind.size_ratio);
}

bool AskedRadii::are_of(Disks const& disks) const {
  if (radii_.empty()) return true;
  return std::ranges::all_of(disks.column<Radius>(), [&](double r) {
    return std::ranges::any_of(radii_, [&](double asked) { return is_close(asked, r); });
  });
}

double radius_without_column(DisksSettings const& settings, Box const& box, std::uint64_t count) {
  double const covered = settings.packing_fraction.value_or(0.0) * box.area();
  return settings.radius.value_or(std::sqrt(covered / (std::numbers::pi * static_cast<double>(count))));
}

void take_summary(Configuration& configuration, StartFileSummary const& file, IsGiven const& is_given) {
  take_box(configuration.box, file.box, is_given);
  take_sizes(file, configuration.disks);
  configuration.disks.start = StartKind::file;
}

State read_whole_start(xyz::Reader& reader, Configuration& configuration, IsGiven const& is_given) {
  XyzFrame frame = xyz::read_all(reader);
  State state = std::move(frame.state);
  if (!frame.has_radii) {
    std::ranges::fill(state.agents.column<Radius>(),
                      radius_without_column(configuration.disks, state.box, state.agents.size()));
  }
  take_summary(configuration,
               {.box = state.box,
                .has_radii = frame.has_radii,
                .count = state.agents.size(),
                .radii = radius_range(state.agents),
                .covered_area = covered_area(state.agents),
                .are_radii_as_asked = AskedRadii(configuration.disks).are_of(state.agents)},
               is_given);
  state.seed = configuration.run.seed;
  if (!frame.has_velocities || configuration.velocities.redraw) draw_velocities(state, configuration.velocities);
  return state;
}

std::optional<Event> flipped_tilt(double given, Box const& box, std::string key) {
  // Half a width to the right and to the left are the same.
  if (std::abs(given) <= (1.0 + 1e-9) * std::abs(box.tilt())) return std::nullopt;
  return Event{
      .kind = EventKind::tilt_flipped, .key = std::move(key), .values = {{"given", given}, {"tilt", box.tilt()}}};
}

std::vector<Event> notes_of_start(xyz::Reader const& reader, VelocitySettings const& velocities) {
  std::vector<Event> notes;
  auto const add = [&](EventKind kind, Severity severity, std::vector<std::pair<std::string, EventValue>> values) {
    notes.push_back({.kind = kind,
                     .severity = severity,
                     .step = clock_of(reader.header()).step,
                     .key = "disks.file",
                     .values = std::move(values)});
  };
  xyz::Columns const& columns = reader.columns();
  if (!columns.has_velocities() && !velocities.redraw) {
    std::string const kind = velocities.kind == VelocityKind::maxwell ? "maxwell" : "uniform";
    add(EventKind::velocities_drawn, Severity::note, {{"velocities", kind}});
  }
  if (columns.has_momenta && !columns.has(xyz::Role::mass)) add(EventKind::masses_assumed, Severity::note, {});
  if (auto const unused = reader.unused(); !unused.empty()) {
    add(EventKind::columns_unused, Severity::note, {{"names", fmt::format("{}", fmt::join(unused, ", "))}});
  }
  std::vector<std::string> entries = reader.header().unused_entries;
  // The seed in a file is not reported as unused, since a run always has a seed of its own.
  std::erase_if(entries, [](std::string const& entry) { return entry.starts_with("seed"); });
  if (!entries.empty()) {
    add(EventKind::entries_unused, Severity::note,
        {{"entries", fmt::format("{}", fmt::join(entries, ", "))}, {"time", clock_of(reader.header()).time}});
  }
  if (auto note = flipped_tilt(reader.given_tilt(), reader.box(), "disks.file")) notes.push_back(*std::move(note));
  if (reader.folded() > 0) add(EventKind::disks_folded, Severity::info, {{"disks", reader.folded()}});
  return notes;
}

}  // namespace gridlock
