#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "gridlock/core/agents_view.hpp"
#include "gridlock/core/box.hpp"
#include "gridlock/core/detail/large_array.hpp"
#include "gridlock/core/disks.hpp"
#include "gridlock/core/population.hpp"
#include "gridlock/core/world.hpp"

namespace gridlock::python {

/// The values of one column.
using ColumnValues =
    std::variant<LargeArray<double>, LargeArray<std::int32_t>, LargeArray<std::uint32_t>, LargeArray<std::uint64_t>>;

/// A column that is named at run time.
struct TableColumn {
  std::string name;
  ColumnValues values;
};

/// Agents whose columns are known at run time only: x and y, and others by name. Otherwise a Population, with the same
/// Ids, the same hash and the same frames as one with these columns.
class AgentTable {
 public:
  AgentTable() = default;
  /// `columns` without values: what the agents have besides x and y.
  explicit AgentTable(std::vector<TableColumn> columns) : others_(std::move(columns)) {}

  [[nodiscard]] std::size_t size() const { return places_.size(); }
  [[nodiscard]] std::span<Id const> ids() const { return places_.ids(); }
  [[nodiscard]] std::span<double> x() { return places_.column<X>(); }
  [[nodiscard]] std::span<double> y() { return places_.column<Y>(); }
  [[nodiscard]] std::span<double const> x() const { return places_.column<X>(); }
  [[nodiscard]] std::span<double const> y() const { return places_.column<Y>(); }
  [[nodiscard]] std::vector<TableColumn> const& others() const { return others_; }

  /// Adds agents: x, y and, for each other column, as many values of its type.
  void add(std::span<double const> x, std::span<double const> y, std::vector<ColumnValues> const& others);
  /// Removes the agents of these Ids, one after the other.
  void remove(std::span<Id const> ids);
  /// Puts row rows[k] at place k.
  void reorder(std::span<std::uint32_t const> rows);
  /// Takes over the values of a table of the same agents in the same order.
  void take_values(AgentTable const& table);

  [[nodiscard]] AgentsView view() const;
  [[nodiscard]] std::vector<NamedColumn> columns();
  [[nodiscard]] std::uint64_t sum_of_hashes() const;
  void serialize(Archive& archive);
  [[nodiscard]] std::shared_ptr<void> release();
  /// See has_vectors_side_by_side(). What has pointers into the columns must not be left.
  void put_vectors_side_by_side();

  operator AgentsView() const { return view(); }  // NOLINT(google-explicit-constructor): as a Population is

 private:
  Population<X, Y> places_;
  std::vector<TableColumn> others_;
};

// What a World asks of its agents.
inline std::vector<NamedColumn> columns_of(AgentTable& agents) { return agents.columns(); }
inline std::uint64_t sum_of_hashes(AgentTable const& agents) { return agents.sum_of_hashes(); }
inline std::uint64_t hash(Box const& box, Clock const& clock, std::uint64_t seed, AgentTable const& agents) {
  return hash_of_world(box, clock, seed, agents.size(), agents.sum_of_hashes());
}

}  // namespace gridlock::python
