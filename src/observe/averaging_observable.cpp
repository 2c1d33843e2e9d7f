#include "gridlock/observe/averaging_observable.hpp"

#include <utility>

namespace gridlock {

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
