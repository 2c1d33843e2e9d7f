#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "study/replica_set.hpp"

namespace gridlock {

/// One quantity measured in both orders from the same starts, and without a time step.
struct TurnOrderComparison {
  Estimate by_id;
  Estimate by_tile;
  Estimate reference;
  Estimate difference;  ///< tiled minus stepped, mean and error over the pairs of runs from one start
  std::size_t seeds = 0;

  [[nodiscard]] double error() const;
  [[nodiscard]] bool is_known() const;
  /// In standard errors of two independent means.
  [[nodiscard]] double deviation() const;
  /// Whether chance explains it in less than 0.3 % of all cases.
  [[nodiscard]] bool differs() const;
  /// The same from start to start, which is sharper: what the two orders share of a start's own pressure drops out.
  [[nodiscard]] double deviation_pairwise() const;
  [[nodiscard]] bool differs_pairwise() const;
  /// The smallest difference from start to start that would count, of the value of `stepped`.
  [[nodiscard]] double resolution() const;
  /// Of the value of `stepped`.
  [[nodiscard]] Estimate relative_difference() const;
  /// Of the value without a time step.
  [[nodiscard]] double distance_from_reference() const;
};

/// All that is compared for one start, density and time step.
struct TurnOrderRow {
  StartKind start = StartKind::square;
  Edge edge = Edge::wall;
  double packing_fraction = 0.0;
  double time_step = 0.0;
  std::vector<double> times;                       ///< in diameters per v_max
  std::vector<TurnOrderComparison> displacements;  ///< at the times; about the centre in a periodic box
  std::vector<TurnOrderComparison> centres;        ///< how far the centre has come, at the times
  TurnOrderComparison whole;                       ///< mean displacement at the end, the centre's included
  std::vector<TurnOrderComparison> rates;  ///< pressure on the walls, Z, collisions; of no seeds where there is none
};

/// What follows from the comparisons, in words: which differ with each step, how much, whether a shorter step takes it away,
/// and how far the centre travels in a periodic box.
std::vector<std::string> conclusions_from(std::vector<TurnOrderRow> const& rows, std::vector<double> const& time_steps);

}  // namespace gridlock
