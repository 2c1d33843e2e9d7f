#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "gridlock/core/agents_view.hpp"
#include "gridlock/core/detail/exact_sum.hpp"
#include "gridlock/core/population.hpp"
#include "gridlock/core/vector.hpp"
#include "gridlock/grid/cell_layout.hpp"
#include "gridlock/grid/detail/cell_window.hpp"

namespace gridlock {

/// A value and how many agents have it.
struct CountedValue {
  double value = 0.0;
  std::uint64_t agents = 0;
};

/// Adds a value that is not below the last one.
inline void add_counted(std::vector<CountedValue>& values, CountedValue const& next) {
  if (!values.empty() && values.back().value == next.value) {
    values.back().agents += next.agents;
  } else {
    values.push_back(next);
  }
}

/// Points of some cells of the box, and after them those of the cells around.
struct PointsOfCells {
  std::vector<double> x;
  std::vector<double> y;
  std::size_t own = 0;  ///< how many lie in the cells themselves
  CellWindow window;    ///< of all their cells
};

/// What was noted for an agent.
struct NotedVector {
  Id id = 0;
  Vector value;
};

/// The agents of other ranks, where the agents of a world are divided among ranks: each has some, and keeps them.
/// Every function is called by all ranks together, in the same order; all get the same numbers.
class OtherAgents {
 public:
  OtherAgents() = default;
  OtherAgents(OtherAgents const&) = delete;
  OtherAgents& operator=(OtherAgents const&) = delete;
  virtual ~OtherAgents() = default;

  /// How many agents all ranks have.
  [[nodiscard]] virtual std::size_t count_of_all() const = 0;

  /// Each number becomes the sum of those of all ranks.
  virtual void add_up(std::span<ExactSum> sums) const = 0;
  virtual void add_up(std::span<std::uint64_t> counts) const = 0;
  /// The least of the values of all ranks.
  [[nodiscard]] virtual double least(double value) const = 0;
  /// The values of all ranks in rising order, each once. Contract: those given are in rising order.
  [[nodiscard]] virtual std::vector<CountedValue> merge(std::vector<CountedValue> values) const = 0;

  /// All points of some cells of the layout, whole rows or columns of it, and those of the cells around as far as the cutoff reaches;
  /// every point is among the own ones of one rank. (x[i], y[i]) are the points of this rank.
  [[nodiscard]] virtual PointsOfCells points_of_cells(CellLayout const& layout, double cutoff,
                                                      std::span<double const> x, std::span<double const> y) const = 0;

  /// What was noted for the agents of this rank, whichever ranks have it: see home_of().
  [[nodiscard]] virtual std::vector<NotedVector> at_home(std::vector<NotedVector> noted) const = 0;
};

/// How many agents there are, on all ranks; without others those of the view.
inline std::size_t count_of_all(AgentsView const& agents, OtherAgents const* others) {
  return others == nullptr ? agents.size() : others->count_of_all();
}

}  // namespace gridlock
