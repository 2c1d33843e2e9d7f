#include "observe/cluster_sizes.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "gridlock/observe/clusters.hpp"
#include "gridlock/parallel/detail/collectives.hpp"
#include "observe/mobile.hpp"

namespace gridlock {

namespace {

/// A disk in a message.
struct SentDisk {
  double x;
  double y;
  double radius;
};

/// Returns the mobile disks of all processes, in no certain order.
std::vector<SentDisk> mobile_disks_of_all(Snapshot const& now) {
  auto const x = now.agents.column<X>();
  auto const y = now.agents.column<Y>();
  auto const radius = now.agents.column<Radius>();
  MobileAgents const mobile(now.agents);
  std::vector<SentDisk> disks;
  for (std::size_t i = 0; i < now.agents.size(); ++i) {
    if (mobile.has(i)) disks.push_back({x[i], y[i], radius[i]});
  }
  Communicator& processes = now.processes.communicator();
  if (processes.count() == 1) return disks;
  std::vector<Message> const messages = all_gather(processes, message_of_all(std::span<SentDisk const>(disks)));
  disks.clear();
  for (Message const& message : messages) {
    std::vector<SentDisk> const some = MessageReader(message).rest<SentDisk>();
    disks.insert(disks.end(), some.begin(), some.end());
  }
  return disks;
}

/// Returns the sizes of all clusters, the largest first.
std::vector<std::uint64_t> cluster_sizes_of(Snapshot const& now, double cutoff) {
  std::vector<double> x, y, radius;
  for (SentDisk const& disk : mobile_disks_of_all(now)) {
    x.push_back(disk.x);
    y.push_back(disk.y);
    radius.push_back(disk.radius);
  }
  return sizes_of_clusters(cluster_of_each(now.box, x, y, radius, cutoff));
}

/// Returns the largest size of the range that begins with a size.
std::uint64_t last_of_range(std::uint64_t first) { return first <= 8 ? first : first + first / 4 - 1; }

/// Returns the place of the range of a size.
std::size_t range_of(std::uint64_t size) {
  std::size_t range = 0;
  for (std::uint64_t first = 1; last_of_range(first) < size; first = last_of_range(first) + 1) ++range;
  return range;
}

}  // namespace

void ClusterSizes::begin(Snapshot const&) {
  reset({{"largest_cluster_fraction", "", "Share of the disks that are in the largest cluster."},
         {"mean_cluster_size", "disks", "Number of disks over number of clusters; a lone disk is a cluster of 1."}});
  schedule_.reset();
  clusters_.clear();
  shares_.clear();
}

void ClusterSizes::sample(Snapshot const& now, std::span<double> row, bool counts_for_average) {
  std::ranges::fill(row, no_value);
  if (!schedule_.is_due(counts_for_average)) return;
  std::vector<std::uint64_t> const sizes = cluster_sizes_of(now, cutoff_);
  if (sizes.empty()) return;
  std::uint64_t disks = 0;
  for (std::uint64_t const size : sizes) disks += size;
  auto const all = static_cast<double>(disks);
  row[0] = static_cast<double>(sizes.front()) / all;
  row[1] = all / static_cast<double>(sizes.size());
  if (!counts_for_average) return;
  average(0, row[0]);
  average(1, row[1]);
  std::vector<double> clusters(range_of(sizes.front()) + 1, 0.0);
  std::vector<double> members(clusters.size(), 0.0);
  for (std::uint64_t const size : sizes) {
    std::size_t const range = range_of(size);
    clusters[range] += 1.0;
    members[range] += static_cast<double>(size);
  }
  for (double& share : members) share /= all;
  clusters_.add(clusters);
  shares_.add(members);
}

std::vector<Distribution> ClusterSizes::distributions() const {
  if (clusters_.entries().empty()) return {};
  std::vector<std::vector<double>> values(5);
  std::uint64_t first = 1;
  for (std::size_t range = 0; range < clusters_.entries().size(); ++range) {
    Estimate const clusters = *clusters_.entries()[range].estimate();
    values[0].push_back(static_cast<double>(first));
    values[1].push_back(clusters.value);
    values[2].push_back(clusters.error.value_or(no_value));
    values[3].push_back(shares_.entries()[range].estimate()->value);
    values[4].push_back(static_cast<double>(last_of_range(first)));
    first = last_of_range(first) + 1;
  }
  return {
      {.name = "cluster_sizes",
       .columns =
           {{.name = "size", .unit = "disks", .documentation = "Smallest size of the range.", .is_count = true},
            {"clusters", "", "Mean number of clusters with a size in the range."},
            {"error", "", "One standard error of the number of clusters, from blocks of samples."},
            {"share_of_disks", "", "Share of all disks that are in these clusters."},
            {.name = "largest_size", .unit = "disks", .documentation = "Largest size of the range.", .is_count = true}},
       .columns_of_values = std::move(values)}};
}

void ClusterSizes::serialize(Archive& archive) {
  AveragingObservable::serialize(archive);
  schedule_.serialize(archive);
  clusters_.serialize(archive, "clusters");
  shares_.serialize(archive, "shares");
  archive.require(clusters_.entries().size() == shares_.entries().size(), "the ranges of sizes differ in number");
}

}  // namespace gridlock
