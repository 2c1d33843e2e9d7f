#include "observe/rates.hpp"

#include <algorithm>
#include <utility>

namespace gridlock {

namespace {

// Indices of columns; the column after these exists in walled boxes only.
constexpr std::size_t collision_column = 0;
constexpr std::size_t free_time_column = 1;
constexpr std::size_t halted_column = 2;
constexpr std::size_t wall_column = 3;

}  // namespace

void Rates::begin(Snapshot const& start) {
  has_walls_ = start.box.has_walls();
  std::vector<ColumnInfo> columns{
      {"collision_rate", "1 / time", "Pair collisions per disk and time, each counted for both partners."},
      {"mean_free_time", "time", "Mean time between two pair collisions of a disk."},
      {.name = "halted_fraction",
       .unit = "",
       .documentation = "Fraction of the moves that ended at a wall or at another disk.",
       .former_name = "blocked_share"}};
  if (has_walls_) columns.push_back({"wall_hit_rate", "1 / time", "Wall hits per disk and time."});
  reset(std::move(columns));
  last_ = start.counters;
  last_time_ = start.clock.time;
}

void Rates::sample(Snapshot const& now, std::span<double> row, bool counts_for_average) {
  Counters const& counters = now.counters;
  auto const collisions = static_cast<double>(counters.pair_collisions - last_.pair_collisions);
  auto const wall_hits = static_cast<double>(counters.all_wall_hits() - last_.all_wall_hits());
  auto const halted = static_cast<double>(counters.halted_moves - last_.halted_moves);
  auto const turns = static_cast<double>(counters.moves - last_.moves);
  double const disk_time = static_cast<double>(now.count()) * (now.clock.time - last_time_);
  last_ = counters;
  last_time_ = now.clock.time;

  std::ranges::fill(row, no_value);
  if (disk_time > 0.0) {
    row[collision_column] = 2.0 * collisions / disk_time;
    if (collisions > 0.0) row[free_time_column] = disk_time / (2.0 * collisions);
    if (has_walls_) row[wall_column] = wall_hits / disk_time;
  }
  if (has_turns_ && turns > 0.0) row[halted_column] = halted / turns;
  if (!counts_for_average) return;
  if (disk_time > 0.0) {
    average(collision_column, row[collision_column], disk_time);
    if (has_walls_) average(wall_column, row[wall_column], disk_time);
  }
  if (has_turns_ && turns > 0.0) average(halted_column, row[halted_column], turns);
}

std::vector<NamedEstimate> Rates::results() const {
  std::vector<NamedEstimate> results = AveragingObservable::results();
  // Computed from the mean rate. A mean over the column would lack the intervals without collisions and be too short.
  auto const rate = average_of(collision_column).estimate();
  if (rate && rate->value > 0.0) {
    Estimate free_time{.value = 1.0 / rate->value, .error = std::nullopt};
    if (rate->error) free_time.error = *rate->error / (rate->value * rate->value);
    results.push_back({columns()[free_time_column].name, free_time, columns()[free_time_column].unit});
  }
  return results;
}

void Rates::serialize(Archive& archive) {
  AveragingObservable::serialize(archive);
  serialize_inside(archive, "last", [&] { gridlock::serialize(archive, last_); });
  archive.visit("last_time", last_time_);
}

}  // namespace gridlock
