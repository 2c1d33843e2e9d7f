#include "drawing/labels.hpp"

#include <algorithm>
#include <iterator>
#include <utility>
#include <vector>

#include "gridlock/observe/observable.hpp"

namespace gridlock {

namespace {

constexpr std::pair<std::string_view, std::string_view> known_labels[] = {
    {"time", "time t"},
    {"mean_displacement", "mean displacement / side"},
    {"mean_squared_displacement", "mean squared displacement ⟨Δr²⟩ / length²"},
    {"compressibility_factor", "compressibility factor Z"},
    {"virial_pressure", "virial pressure / (mass / time²)"},
    {"wall_pressure", "wall pressure / (mass / time²)"},
    {"collision_rate", "collisions of a disk / time⁻¹"},
    {"halted_fraction", "share of halted moves"},
    {"disks.packing_fraction", "packing fraction φ"},
    {"disks.count", "number of disks N"},
    {"engine.cells", "cells a side k"},
    {"engine.time_step", "time step / (diameters per greatest speed)"},
    {"run.steps", "time steps"},
};

}  // namespace

std::string axis_label(std::string_view name) {
  auto const found = std::ranges::find(known_labels, name, [](auto const& label) { return label.first; });
  if (found != std::end(known_labels)) return std::string(found->second);
  std::string words(name.substr(name.rfind('.') + 1));  // npos + 1 is 0
  std::ranges::replace(words, '_', ' ');
  return words;
}

bool is_of_model(std::string_view name) {
  static std::vector<ColumnInfo> const observed = observed_columns();
  return std::ranges::find(observed, name, &ColumnInfo::name) == observed.end();
}

}  // namespace gridlock
