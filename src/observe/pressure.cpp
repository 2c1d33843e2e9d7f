#include "observe/pressure.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "observe/motion.hpp"

namespace gridlock {

namespace {

// Indices of columns. Columns of walls exist in walled boxes only; single walls are in the order of Counters.
constexpr std::size_t virial_column = 0;
constexpr std::size_t compressibility_column = 1;
constexpr std::size_t all_walls_column = 2;
constexpr std::size_t first_wall_column = 3;
constexpr std::array<char const*, 4> wall_names{"left", "right", "bottom", "top"};

bool is_upright(std::size_t wall) { return wall == Counters::left || wall == Counters::right; }
bool has_wall(Box const& box, std::size_t wall) {
  return is_upright(wall) ? !box.is_periodic_x() : !box.is_periodic_y();
}

std::vector<ColumnInfo> columns_for(Box const& box) {
  std::vector<ColumnInfo> columns{
      {"virial_pressure", "mass / time²", "Pressure from kinetic energy and pair impulses, over the whole area."},
      {"compressibility_factor", "", "Z = virial pressure · area / (N kT)."}};
  if (box.is_periodic()) return columns;
  columns.push_back({"wall_pressure", "mass / time²", "Impulse per time and length on all walls."});
  for (std::size_t wall = 0; wall < wall_names.size(); ++wall) {
    std::string const name = wall_names[wall];
    if (!has_wall(box, wall)) continue;
    columns.push_back(
        {"wall_pressure_" + name, "mass / time²", "Impulse per time and length on the " + name + " wall."});
  }
  return columns;
}

}  // namespace

void Pressure::begin(Snapshot const& start) {
  has_walls_ = start.box.has_walls();
  reset(columns_for(start.box));
  last_ = start.counters;
  last_time_ = start.clock.time;
}

void Pressure::sample(Snapshot const& now, std::span<double> row, bool counts_for_average) {
  Box const& box = now.box;
  double const duration = now.clock.time - last_time_;
  double const virial = now.counters.pair_virial - last_.pair_virial;
  std::array<double, 4> impulse{};
  for (std::size_t wall = 0; wall < 4; ++wall)
    impulse[wall] = now.counters.wall_impulse[wall] - last_.wall_impulse[wall];
  last_ = now.counters;
  last_time_ = now.clock.time;

  std::ranges::fill(row, no_value);
  if (!(duration > 0.0)) return;
  auto const set = [&](std::size_t column, double value, double weight) {
    row[column] = value;
    if (counts_for_average) average(column, value, weight);
  };
  if (auto const kt = measured_temperature(now)) {
    double const thermal = static_cast<double>(count_of_moving(now)) * *kt;
    set(virial_column, (thermal + 0.5 * virial / duration) / box.area(), duration);
    if (thermal > 0.0) set(compressibility_column, 1.0 + 0.5 * virial / (thermal * duration), thermal * duration);
  }
  if (!has_walls_) return;
  double const walls = 2.0 * ((box.is_periodic_y() ? 0.0 : box.width()) + (box.is_periodic_x() ? 0.0 : box.height()));
  set(all_walls_column, (impulse[0] + impulse[1] + impulse[2] + impulse[3]) / (duration * walls), duration);
  std::size_t column = first_wall_column;
  for (std::size_t wall = 0; wall < 4; ++wall) {
    if (!has_wall(box, wall)) continue;
    double const length = is_upright(wall) ? box.height() : box.width();
    set(column++, impulse[wall] / (duration * length), duration);
  }
}

void Pressure::serialize(Archive& archive) {
  AveragingObservable::serialize(archive);
  serialize_inside(archive, "last", [&] { gridlock::serialize(archive, last_); });
  archive.visit("last_time", last_time_);
}

}  // namespace gridlock
