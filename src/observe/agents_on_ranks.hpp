#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "gridlock/core/detail/ranks.hpp"
#include "gridlock/observe/detail/other_agents.hpp"

namespace gridlock {

/// OtherAgents by messages.
///
/// Sums are added along a tree, so that a rank sends and receives a few messages, of the size of the sums. For searches each rank gets
/// a slab of cells, cut across the longer side of the box, by the number of agents: it gets about as many agents as it has, and
/// those of a rim. No rank gets all but where the rim is as wide as the box.
class AgentsOnRanks final : public OtherAgents {
 public:
  /// `count` is the number of agents of all ranks.
  AgentsOnRanks(Ranks& ranks, std::size_t count) : ranks_(ranks), count_(count) {}

  [[nodiscard]] std::size_t count_of_all() const override { return count_; }
  void add_up(std::span<ExactSum> sums) const override;
  void add_up(std::span<std::uint64_t> counts) const override;
  [[nodiscard]] double least(double value) const override;
  [[nodiscard]] std::vector<CountedValue> merge(std::vector<CountedValue> values) const override;
  [[nodiscard]] PointsOfCells points_of_cells(CellLayout const& layout, double cutoff, std::span<double const> x,
                                              std::span<double const> y) const override;
  [[nodiscard]] std::vector<NotedVector> at_home(std::vector<NotedVector> noted) const override;

 private:
  Ranks& ranks_;
  std::size_t count_;
};

}  // namespace gridlock
