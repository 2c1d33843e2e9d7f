#include "observe/temperature_by_kind.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "gridlock/parallel/detail/collectives.hpp"
#include "observe/mobile.hpp"
#include "observe/motion.hpp"

namespace gridlock {

namespace {

struct KindOfDisk {
  double radius;
  double mass;

  friend bool operator==(KindOfDisk const&, KindOfDisk const&) = default;
};

/// Returns the kind of each row.
std::vector<KindOfDisk> kinds_of_rows(AgentsView const& agents) {
  auto const mass = agents.column<Mass>();
  std::span<double const> radius;
  if (agents.has<Radius>()) radius = agents.column<Radius>();
  std::vector<KindOfDisk> kinds;
  for (std::size_t i = 0; i < agents.size(); ++i) kinds.push_back({radius.empty() ? 0.0 : radius[i], mass[i]});
  return kinds;
}

/// Keeps each kind once, in order, and no more than one above the limit.
void keep_few(std::vector<KindOfDisk>& kinds) {
  std::ranges::sort(kinds, {}, [](KindOfDisk const& kind) { return std::pair(kind.radius, kind.mass); });
  kinds.erase(std::unique(kinds.begin(), kinds.end()), kinds.end());
  if (kinds.size() > TemperatureByKind::max_kinds) kinds.resize(TemperatureByKind::max_kinds + 1);
}

/// Returns the kinds of mobile agents of all processes; if there are too many, one more than the limit.
std::vector<KindOfDisk> few_kinds_of(Snapshot const& now, std::vector<KindOfDisk> const& of_rows) {
  MobileAgents const mobile(now.agents);
  std::vector<KindOfDisk> kinds;
  for (std::size_t i = 0; i < of_rows.size(); ++i) {
    if (mobile.has(i)) kinds.push_back(of_rows[i]);
  }
  keep_few(kinds);
  Communicator& processes = now.processes.communicator();
  if (processes.count() == 1) return kinds;
  std::vector<Message> const messages = all_gather(processes, message_of_all(std::span<KindOfDisk const>(kinds)));
  kinds.clear();
  for (Message const& message : messages) {
    std::vector<KindOfDisk> const some = MessageReader(message).rest<KindOfDisk>();
    kinds.insert(kinds.end(), some.begin(), some.end());
  }
  keep_few(kinds);
  return kinds;
}

std::vector<ColumnInfo> temperature_columns(std::size_t kinds) {
  std::string const unit = "mass · length² / time²";
  std::vector<ColumnInfo> columns{{"temperature_x", unit, "kT of the motion along x."},
                                  {"temperature_y", unit, "kT of the motion along y."}};
  for (std::size_t kind = 1; kind <= kinds; ++kind) {
    for (char const axis : {'x', 'y'}) {
      columns.push_back({fmt::format("temperature_{}_kind_{}", axis, kind), unit,
                         fmt::format("kT of the motion along {} of the disks of kind {}.", axis, kind)});
    }
  }
  return columns;
}

/// Sums over the mobile agents of a kind, along one axis.
enum MotionSum : std::size_t {
  of_agents,
  of_mass,
  of_momentum_x,
  of_momentum_y,
  of_energy_x,
  of_energy_y,
  motion_sums
};
using MotionOfKind = std::array<double, motion_sums>;

/// Returns the temperature along one axis of the agents of a kind, which may be all.
std::optional<double> temperature_along(bool keeps_momentum, MotionOfKind const& kind, MotionOfKind const& all,
                                        MotionSum momentum, MotionSum energy) {
  if (!keeps_momentum) {
    return kind[of_agents] > 0.0 ? std::optional(kind[energy] / kind[of_agents]) : std::nullopt;
  }
  double const degrees = kind[of_agents] - kind[of_mass] / all[of_mass];
  if (!(degrees > 1e-9 * kind[of_agents])) return std::nullopt;
  double const velocity = all[momentum] / all[of_mass];
  double const relative = kind[energy] - 2.0 * velocity * kind[momentum] + velocity * velocity * kind[of_mass];
  return std::max(0.0, relative) / degrees;
}

}  // namespace

void TemperatureByKind::begin(Snapshot const& start) {
  std::vector<KindOfDisk> const of_rows = kinds_of_rows(start.agents);
  std::vector<KindOfDisk> const kinds = few_kinds_of(start, of_rows);
  has_fixed_ = count_of_moving(start) < start.count();
  kinds_ = kinds.size() < 2 || kinds.size() > max_kinds ? 0 : kinds.size();
  reset(temperature_columns(kinds_));
  if (kinds_ == 0) return;
  kind_of_ = start.attached<std::uint32_t>(
      [&](std::size_t i) { return static_cast<std::uint32_t>(std::ranges::find(kinds, of_rows[i]) - kinds.begin()); });
}

void TemperatureByKind::sample(Snapshot const& now, std::span<double> row, bool counts_for_average) {
  auto const mass = now.agents.column<Mass>();
  auto const velocity_x = now.agents.column<VelocityX>();
  auto const velocity_y = now.agents.column<VelocityY>();
  auto const ids = now.agents.ids();
  MobileAgents const mobile(now.agents);
  std::vector<ExactSum> of_all((kinds_ + 1) * motion_sums);
  std::array<std::vector<std::size_t>, max_kinds + 1> rows;
  for (std::size_t i = 0; i < now.agents.size(); ++i) {
    if (!mobile.has(i)) continue;
    rows[0].push_back(i);
    if (kinds_ == 0) continue;
    std::uint32_t const* const kind = kind_of_.find(ids[i], i);
    if (kind != nullptr && *kind < kinds_) rows[1 + *kind].push_back(i);
  }
  std::vector<MotionOfKind> motion(kinds_ + 1);
  for (std::size_t kind = 0; kind <= kinds_; ++kind) {
    std::array<ExactSum, motion_sums> sums;
    add_terms(sums, rows[kind].size(), [&](std::size_t k) {
      std::size_t const i = rows[kind][k];
      double const x = mass[i] * velocity_x[i];
      double const y = mass[i] * velocity_y[i];
      return std::array{1.0, mass[i], x, y, x * velocity_x[i], y * velocity_y[i]};
    });
    std::ranges::copy(sums, of_all.begin() + static_cast<std::ptrdiff_t>(kind * motion_sums));
  }
  now.sum(of_all);
  for (std::size_t s = 0; s < of_all.size(); ++s) motion[s / motion_sums][s % motion_sums] = of_all[s].value();
  bool const keeps_x = now.box.is_periodic_x() && !has_fixed_;
  bool const keeps_y = now.box.is_periodic_y() && !has_fixed_;
  for (std::size_t kind = 0; kind <= kinds_; ++kind) {
    row[2 * kind] = temperature_along(keeps_x, motion[kind], motion[0], of_momentum_x, of_energy_x).value_or(no_value);
    row[2 * kind + 1] =
        temperature_along(keeps_y, motion[kind], motion[0], of_momentum_y, of_energy_y).value_or(no_value);
  }
  if (!counts_for_average) return;
  for (std::size_t column = 0; column < row.size(); ++column) {
    if (!std::isnan(row[column])) average(column, row[column]);
  }
}

}  // namespace gridlock
