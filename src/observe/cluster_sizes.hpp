#pragma once

#include <cstdint>
#include <vector>

#include "gridlock/core/disks.hpp"
#include "gridlock/observe/observable.hpp"
#include "observe/list_average.hpp"
#include "observe/structure_schedule.hpp"

namespace gridlock {

/// The sizes of the clusters of mobile disks, as cluster_of_each() finds them: two disks are in one cluster if their
/// centres are nearer than `cutoff` times the sum of their radii, or if a chain of such pairs joins them.
///
///     largest_cluster_fraction = disks in the largest cluster / N        pure number, 1 if all are in one
///     mean_cluster_size        = N / number of clusters                  disks; a lone disk is a cluster of 1
///
/// The distribution "cluster_sizes" has a row for each range of sizes, single sizes up to 8 and then ranges that grow
/// by a quarter: the mean number of clusters of those sizes in a sample, with its error from blocks of samples, and the
/// share of all disks that are in them. Disks of infinite mass are fixed, and belong to no cluster.
/// Measured in every `every`-th sample (StructureSchedule).
/// Cost: about 0.5 µs a disk. If several processes share the run, each gets the centres of all disks (24 bytes each)
/// and finds all clusters, so that the cost does not fall with the number of processes.
/// Source: D. Stauffer & A. Aharony, Introduction to Percolation Theory (1994), chapter 2.
class ClusterSizes final : public AveragingObservable {
 public:
  ClusterSizes(std::uint64_t every, double cutoff) : schedule_(every), cutoff_(cutoff) {}

  [[nodiscard]] Requirements requirements(Box const& /*box*/) const override {
    return {.columns = {X::name, Y::name, Radius::name}};
  }
  void begin(Snapshot const& start) override;
  void sample(Snapshot const& now, std::span<double> row, bool counts_for_average) override;
  [[nodiscard]] std::vector<Distribution> distributions() const override;
  void serialize(Archive& archive) override;

 private:
  StructureSchedule schedule_;
  double cutoff_;         ///< in sums of two radii
  ListAverage clusters_;  ///< number of clusters in each range of sizes
  ListAverage shares_;    ///< share of the disks that are in them
};

}  // namespace gridlock
