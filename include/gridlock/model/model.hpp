#pragma once

#include <cstddef>
#include <initializer_list>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "gridlock/core/disks.hpp"
#include "gridlock/core/setting.hpp"
#include "gridlock/core/vector.hpp"
#include "gridlock/model/model_engine.hpp"

namespace gridlock {

/// What a model measures of its world at one time: names and numbers, the same names at every time.
///
/// ```cpp
/// Observations now;
/// now.add("temperature", 1.5, "Mean kinetic energy.");
/// double const value = now.entries().front().value;
/// ```
class Observations {
 public:
  struct Entry {
    std::string name;
    double value = 0.0;
    std::string documentation;
  };

  void add(std::string_view name, double value, std::string_view documentation = {}) {
    entries_.push_back({std::string(name), value, std::string(documentation)});
  }

  /// How many agents have the number 0, 1, 2 … in a column: one entry for each name.
  template <class Column, class Agents>
  void add_counts(Agents const& agents, std::initializer_list<std::string_view> names) {
    add_counts<Column>(agents, std::span(names.begin(), names.size()));
  }
  /// The same under the names that the column itself gives to its numbers, Column::value_names.
  template <class Column, class Agents>
  void add_counts(Agents const& agents) {
    add_counts<Column>(agents, std::span<std::string_view const>(Column::value_names));
  }
  template <class Column, class Agents>
  void add_counts(Agents const& agents, std::span<std::string_view const> names) {
    std::vector<double> counts(names.size());
    for (auto const group : agents.template column<Column>()) {
      auto const k = static_cast<std::size_t>(group);
      if (k < counts.size()) counts[k] += 1.0;
    }
    add_each(names, counts, "Agents of this kind.");
  }

  /// The mean of measure(row) over the agents of each kind; not a number for a kind without agents.
  template <class Column, class Agents, class Measure>
  void add_means(Agents const& agents, std::initializer_list<std::string_view> names, Measure measure) {
    std::vector<double> sums(names.size());
    std::vector<double> counts(names.size());
    for (std::size_t row = 0; row < agents.size(); ++row) {
      auto const k = static_cast<std::size_t>(agents.template column<Column>()[row]);
      if (k >= sums.size()) continue;
      sums[k] += measure(row);
      counts[k] += 1.0;
    }
    for (std::size_t k = 0; k < sums.size(); ++k) sums[k] /= counts[k];
    add_each({names.begin(), names.size()}, sums, "Mean over the agents of this kind.");
  }

  [[nodiscard]] std::vector<Entry> const& entries() const { return entries_; }

 private:
  void add_each(std::span<std::string_view const> names, std::vector<double> const& values,
                std::string_view documentation) {
    std::size_t k = 0;
    for (std::string_view const name : names) add(name, values[k++], documentation);
  }

  std::vector<Entry> entries_;
};

/// What a model needs is all in here: ModelEngine says what a model is.
///
/// ```cpp
/// struct Walkers {
///   static constexpr std::string_view name = "walkers";
///   static constexpr std::string_view documentation = "Points that walk at random.";
///   static constexpr Schedule schedule = Schedule::synchronous;
///   using Agents = Population<X, Y>;
///   double cutoff() const { return 0.1; }
///   double time_step() const { return 1.0; }
///   void start(World<Walkers>& world) const { world.agents.add(0.5, 0.5); }
///   void turn(Turn<Walkers>& self) const {
///     RandomStream random = self.random();
///     self.move_by(0.01 * random.in_unit_disk());
///   }
///   void observe(World<Walkers> const& world, Observations& observations) const {
///     observations.add("agents", static_cast<double>(world.agents.size()));
///   }
/// };
/// ```

}  // namespace gridlock
