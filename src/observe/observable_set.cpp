#include "gridlock/observe/detail/observable_set.hpp"

#include <algorithm>
#include <iterator>
#include <string>
#include <utility>

namespace gridlock {

void ObservableSet::add(std::unique_ptr<Observable> observable) {
  std::vector<ColumnInfo> const taken = columns();
  std::vector<ColumnInfo> const added = observable->columns();
  bool const is_taken = std::ranges::any_of(added, [&](ColumnInfo const& column) {
    return std::ranges::find(taken, column.name, &ColumnInfo::name) != taken.end();
  });
  if (!is_taken) entries_.push_back({std::move(observable), added.size()});
}

std::vector<ColumnInfo> ObservableSet::columns() const {
  std::vector<ColumnInfo> columns;
  for (Entry const& entry : entries_) std::ranges::move(entry.observable->columns(), std::back_inserter(columns));
  return columns;
}

void ObservableSet::sample(Snapshot const& now, std::span<double> row, bool counts_for_average) {
  for (Entry const& entry : entries_) {
    entry.observable->sample(now, row.first(entry.width), counts_for_average);
    row = row.subspan(entry.width);
  }
}

void ObservableSet::collided(PairCollision const& collision) {
  for (Entry const& entry : entries_) entry.observable->collided(collision);
}

std::vector<NamedEstimate> ObservableSet::results() const {
  std::vector<NamedEstimate> results;
  for (Entry const& entry : entries_) std::ranges::move(entry.observable->results(), std::back_inserter(results));
  return results;
}

std::vector<Distribution> ObservableSet::distributions() const {
  std::vector<Distribution> distributions;
  for (Entry const& entry : entries_) {
    std::ranges::move(entry.observable->distributions(), std::back_inserter(distributions));
  }
  return distributions;
}

void ObservableSet::serialize(Archive& archive) {
  for (std::size_t k = 0; k < entries_.size(); ++k) {
    serialize_inside(archive, "observable_" + std::to_string(k), [&] { entries_[k].observable->serialize(archive); });
  }
}

}  // namespace gridlock
