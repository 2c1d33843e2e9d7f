#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "gridlock/observe/observable.hpp"

namespace gridlock {

/// All observables of one world: their columns side by side, their results one after the other.
class ObservableSet {
 public:
  /// Adds an observable after its begin(), unless an observable of the set has a column of the same name.
  void add(std::unique_ptr<Observable> observable);

  [[nodiscard]] std::vector<ColumnInfo> columns() const;
  /// Contract: row.size() == columns().size().
  void sample(Snapshot const& now, std::span<double> row, bool counts_for_average);
  /// Tells those observables that ask for reports.
  void collided(PairCollision const& collision);
  [[nodiscard]] std::vector<NamedEstimate> results() const;
  [[nodiscard]] std::vector<Distribution> distributions() const;
  void serialize(Archive& archive);

 private:
  struct Entry {
    std::unique_ptr<Observable> observable;
    std::size_t width;  ///< number of columns
  };
  std::vector<Entry> entries_;
};

}  // namespace gridlock
