#include "observe/local_density.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <span>
#include <utility>
#include <vector>

#include "gridlock/core/error.hpp"
#include "observe/mobile.hpp"

namespace gridlock {

namespace {

/// Sums over all mobile agents.
struct MobileSizes {
  double count = 0.0;
  double diameters = 0.0;
  double areas = 0.0;
};

MobileSizes sizes_of_mobile(Snapshot const& now) {
  MobileAgents const mobile(now.agents);
  std::span<double const> radius;
  if (now.agents.has<Radius>()) radius = now.agents.column<Radius>();
  auto const [count, diameters, areas] = now.sum([&](std::size_t i) {
    double const one = mobile.has(i) ? 1.0 : 0.0;
    double const r = radius.empty() ? 0.0 : one * radius[i];
    return std::array{one, 2.0 * r, std::numbers::pi * r * r};
  });
  return {count, diameters, areas};
}

/// Returns how many cells of about this length fit into a side.
std::uint64_t cells_along(double side, double length) {
  return static_cast<std::uint64_t>(std::clamp(std::round(side / length), 1.0, 0x1p31));
}

/// Returns how many mobile agents of all processes are in each cell of a grid, row by row.
std::vector<std::uint64_t> counts_of_cells(Snapshot const& now, std::uint64_t columns, std::uint64_t rows) {
  auto const x = now.agents.column<X>();
  auto const y = now.agents.column<Y>();
  MobileAgents const mobile(now.agents);
  auto const place_along = [](double position, double side, std::uint64_t cells) {
    auto const count = static_cast<double>(cells);
    return static_cast<std::uint64_t>(std::clamp(std::floor(position / side * count), 0.0, count - 1.0));
  };
  std::vector<std::uint64_t> counts(columns * rows, 0);
  for (std::size_t i = 0; i < now.agents.size(); ++i) {
    if (!mobile.has(i)) continue;
    ++counts[place_along(y[i], now.box.height(), rows) * columns + place_along(x[i], now.box.width(), columns)];
  }
  now.counts(counts);
  return counts;
}

}  // namespace

void LocalDensity::begin(Snapshot const& start) {
  reset({{"local_density_mean", "agents", "Mean number of agents in a cell of the grid of the local density."},
         {"local_density_variance_ratio", "",
          "Variance over mean of the number of agents in a cell: above 2.5 dense and dilute regions coexist."}});
  schedule_.reset();
  shares_.clear();
  MobileSizes const sizes = sizes_of_mobile(start);
  double const spacing = std::sqrt(start.box.area() / std::max(1.0, sizes.count));
  double const length = side_ * (sizes.diameters > 0.0 ? sizes.diameters / sizes.count : spacing);
  columns_ = cells_along(start.box.width(), length);
  rows_ = cells_along(start.box.height(), length);
  if (columns_ * rows_ > max_cells) {
    throw Error({.what = fmt::format("the local density would have a grid of {} × {} cells", columns_, rows_),
                 .hint = fmt::format("use a larger observe.local_density_side, for at most {} cells", max_cells),
                 .key = "observe.local_density_side"});
  }
  share_of_disk_ =
      sizes.areas > 0.0 ? sizes.areas / sizes.count * static_cast<double>(columns_ * rows_) / start.box.area() : 0.0;
}

void LocalDensity::sample(Snapshot const& now, std::span<double> row, bool counts_for_average) {
  std::ranges::fill(row, no_value);
  if (!schedule_.is_due(counts_for_average)) return;
  std::vector<std::uint64_t> const counts = counts_of_cells(now, columns_, rows_);
  std::uint64_t agents = 0;
  std::vector<double> shares;
  double const share_of_cell = 1.0 / static_cast<double>(counts.size());
  for (std::uint64_t const count : counts) {
    agents += count;
    if (count >= shares.size()) shares.resize(count + 1, 0.0);
    shares[count] += 1.0;
  }
  if (agents == 0) return;
  double const mean = static_cast<double>(agents) * share_of_cell;
  double squares = 0.0;
  for (std::size_t count = 0; count < shares.size(); ++count) {
    shares[count] *= share_of_cell;
    double const deviation = static_cast<double>(count) - mean;
    squares += shares[count] * deviation * deviation;
  }
  row[0] = mean;
  row[1] = squares / mean;
  if (!counts_for_average) return;
  average(0, row[0]);
  average(1, row[1]);
  shares_.add(shares);
}

std::vector<Distribution> LocalDensity::distributions() const {
  if (shares_.entries().empty()) return {};
  bool const has_radius = share_of_disk_ > 0.0;
  std::vector<std::vector<double>> values(has_radius ? 4 : 3);
  for (std::size_t count = 0; count < shares_.entries().size(); ++count) {
    Estimate const share = *shares_.entries()[count].estimate();
    values[0].push_back(static_cast<double>(count));
    values[1].push_back(share.value);
    values[2].push_back(share.error.value_or(no_value));
    if (has_radius) values[3].push_back(static_cast<double>(count) * share_of_disk_);
  }
  std::vector<ColumnInfo> columns{
      {.name = "agents_in_cell", .unit = "agents", .documentation = "Number of agents in a cell.", .is_count = true},
      {"share_of_cells", "", "Share of the cells that hold so many agents."},
      {"error", "", "One standard error of the share, from blocks of samples."}};
  if (has_radius) {
    columns.push_back({"packing_fraction", "", "That number times the mean area of a disk, over the area of a cell."});
  }
  return {{.name = "local_density", .columns = std::move(columns), .columns_of_values = std::move(values)}};
}

void LocalDensity::serialize(Archive& archive) {
  AveragingObservable::serialize(archive);
  schedule_.serialize(archive);
  shares_.serialize(archive, "shares");
}

}  // namespace gridlock
