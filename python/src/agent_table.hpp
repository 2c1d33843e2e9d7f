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

/// The values of a column, of one of the types of columns.
using ColumnValues =
    std::variant<LargeArray<double>, LargeArray<std::int32_t>, LargeArray<std::uint32_t>, LargeArray<std::uint64_t>>;

/// A column whose name and type are known only at run time.
struct TableColumn {
  std::string name;
  ColumnValues values;
};

/// Agents with columns that are known only at run time: x, y, and others by name. It behaves as a Population with these
/// columns, with the same Ids, hash and frames.
class AgentTable {
 public:
  AgentTable() = default;
  /// `columns` are the columns besides x and y, without values.
  explicit AgentTable(std::vector<TableColumn> columns) : others_(std::move(columns)) {}

  [[nodiscard]] std::size_t size() const { return places_.size(); }
  [[nodiscard]] std::span<Id const> ids() const { return places_.ids(); }
  [[nodiscard]] std::span<double> x() { return places_.column<X>(); }
  [[nodiscard]] std::span<double> y() { return places_.column<Y>(); }
  [[nodiscard]] std::span<double const> x() const { return places_.column<X>(); }
  [[nodiscard]] std::span<double const> y() const { return places_.column<Y>(); }
  [[nodiscard]] std::vector<TableColumn> const& others() const { return others_; }

  /// Adds agents. For x, y and each other column it takes an array of equal length and of the column's type.
  void add(std::span<double const> x, std::span<double const> y, std::vector<ColumnValues> const& others);
  /// Removes the agents with these Ids, in this order.
  void remove(std::span<Id const> ids);
  /// Moves the agent of row rows[k] to row k.
  void reorder(std::span<std::uint32_t const> rows);
  /// Copies the values of a table with the same agents in the same order.
  void take_values(AgentTable const& table);

  [[nodiscard]] AgentsView view() const;
  [[nodiscard]] std::vector<NamedColumn> columns();
  [[nodiscard]] std::uint64_t sum_of_hashes() const;
  void serialize(Archive& archive);
  [[nodiscard]] std::shared_ptr<void> release();
  /// Allocates x and y side by side, see has_vectors_side_by_side(). Invalidates all pointers into the columns.
  void put_vectors_side_by_side();

  operator AgentsView() const { return view(); }  // NOLINT(google-explicit-constructor): as a Population is

 private:
  Population<X, Y> places_;
  std::vector<TableColumn> others_;
};

// These functions are what World requires of its agents.
inline std::vector<NamedColumn> columns_of(AgentTable& agents) { return agents.columns(); }
inline std::uint64_t sum_of_hashes(AgentTable const& agents) { return agents.sum_of_hashes(); }
inline std::uint64_t hash(Box const& box, Clock const& clock, std::uint64_t seed, AgentTable const& agents) {
  return hash_of_world(box, clock, seed, agents.size(), agents.sum_of_hashes());
}

}  // namespace gridlock::python
