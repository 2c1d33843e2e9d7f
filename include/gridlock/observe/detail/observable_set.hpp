#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "gridlock/observe/observable.hpp"

namespace gridlock {

/// All that is measured of one world: its columns side by side, its results one after the other.
class ObservableSet {
 public:
  /// Adds an observable that has begun, unless one that is there has a column of the same name: the first one is kept.
  void add(std::unique_ptr<Observable> observable);

  [[nodiscard]] std::vector<ColumnInfo> columns() const;
  /// Contract: row.size() == columns().size().
  void sample(Snapshot const& now, std::span<double> row, bool counts_for_average);
  [[nodiscard]] std::vector<NamedEstimate> results() const;
  [[nodiscard]] std::vector<Distribution> distributions() const;
  void serialize(Archive& archive);

 private:
  struct Entry {
    std::unique_ptr<Observable> observable;
    std::size_t width;  ///< columns
  };
  std::vector<Entry> entries_;
};

}  // namespace gridlock
