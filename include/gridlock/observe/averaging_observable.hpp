#pragma once

#include <cstddef>
#include <vector>

#include "gridlock/observe/block_average.hpp"
#include "gridlock/observe/observable.hpp"

namespace gridlock {

/// An observable whose every column is averaged over the samples that count: a derived class only measures.
///
/// ```cpp
/// struct Crowding : AveragingObservable {
///   Requirements requirements(Box const&) const override { return {}; }
///   void begin(Snapshot const&) override { reset({{"crowding", "1/length²", "Agents per area."}}); }
///   void sample(Snapshot const& now, std::span<double> row, bool counts_for_average) override {
///     row[0] = static_cast<double>(now.agents.size()) / now.box.area();
///     if (counts_for_average) average(0, row[0]);
///   }
/// };
/// ```
class AveragingObservable : public Observable {
 public:
  [[nodiscard]] std::vector<ColumnInfo> columns() const override { return columns_; }
  /// One estimate per column that ever had a value that counted.
  [[nodiscard]] std::vector<NamedEstimate> results() const override;

  /// Serializes the averages; a derived class with more to serialize adds that.
  void serialize(Archive& archive) override { gridlock::serialize(archive, "averages", averages_); }

 protected:
  /// Sets the columns and forgets all averages; for begin().
  void reset(std::vector<ColumnInfo> columns);

  /// Adds one finite value of a column to its average.
  void average(std::size_t column, double value, double weight = 1.0) { averages_[column].add(value, weight); }

  [[nodiscard]] BlockAverage const& average_of(std::size_t column) const { return averages_[column]; }

 private:
  std::vector<ColumnInfo> columns_;
  std::vector<BlockAverage> averages_;
};

}  // namespace gridlock
