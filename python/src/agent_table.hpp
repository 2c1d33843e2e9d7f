#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
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
  std::vector<std::uint32_t> kinds = {};  ///< the kinds of agents that have it, in ascending order; empty for all

  [[nodiscard]] bool is_of(std::size_t kind) const;
};

/// The rows from the first to before the end.
struct RowSpan {
  std::size_t first = 0;
  std::size_t end = 0;

  [[nodiscard]] std::size_t count() const { return end - first; }

  friend bool operator==(RowSpan const&, RowSpan const&) = default;
};

/// Agents with columns that are known only at run time: x, y, and others by name. It behaves as a Population with these
/// columns, with the same Ids, hash and frames.
///
/// The rows of agents of several kinds are in the order of their kinds, which the column `kind` has. A column that only
/// some kinds have holds their values alone, in the order of their rows: it takes no memory for other agents. In frames
/// and for observables it is 0 for them.
class AgentTable {
 public:
  static constexpr char const* kind_column = "kind";

  AgentTable() = default;
  /// `columns` are the columns besides x and y, without values. The first is `kind` if there are several kinds.
  explicit AgentTable(std::vector<TableColumn> columns, std::size_t kinds = 1)
      : others_(std::move(columns)), counts_(kinds) {}

  [[nodiscard]] std::size_t size() const { return places_.size(); }
  [[nodiscard]] std::span<Id const> ids() const { return places_.ids(); }
  [[nodiscard]] bool contains(Id id) const { return places_.contains(id); }
  /// Returns the row of an agent. Contract: it lives.
  [[nodiscard]] std::size_t index_of(Id id) const { return places_.index_of(id); }
  [[nodiscard]] std::span<double> x() { return places_.column<X>(); }
  [[nodiscard]] std::span<double> y() { return places_.column<Y>(); }
  [[nodiscard]] std::span<double const> x() const { return places_.column<X>(); }
  [[nodiscard]] std::span<double const> y() const { return places_.column<Y>(); }
  [[nodiscard]] std::vector<TableColumn> const& others() const { return others_; }

  [[nodiscard]] std::size_t kinds() const { return counts_.size(); }
  /// Returns how many agents of each kind there are.
  [[nodiscard]] std::vector<std::size_t> const& counts() const { return counts_; }
  /// Returns the rows of the agents of a kind, of all without one.
  [[nodiscard]] RowSpan rows_of(std::optional<std::size_t> kind) const;
  /// Returns the places in a column of the values of the agents of a kind; none if the kind does not have it.
  [[nodiscard]] RowSpan places_in(TableColumn const& column, std::size_t kind) const;
  /// Returns whether the column `kind` is what it was: the order of the rows depends on it.
  [[nodiscard]] bool has_kinds_in_order() const;

  /// Adds agents of a kind. For x, y and each other column that the kind has it takes an array of equal length and of
  /// the column's type; other arrays are empty, and that of `kind` is not used.
  /// Returns their Ids.
  std::vector<Id> add(std::size_t kind, std::span<double const> x, std::span<double const> y,
                      std::vector<ColumnValues> const& others);
  /// Removes the agents with these Ids, in this order.
  void remove(std::span<Id const> ids);
  /// Moves the agent of row rows[k] to row k, but agents of several kinds behind those of the kinds before theirs.
  void reorder(std::span<std::uint32_t const> rows);

  /// Returns all columns with one value for each agent; those of some kinds are copied for it.
  [[nodiscard]] AgentsView view() const;
  /// Frees the memory of what view() has copied. Invalidates all views.
  void forget_view() { expanded_.clear(); }
  /// Returns all columns; those of some kinds have fewer values than there are agents.
  [[nodiscard]] std::vector<NamedColumn> columns();
  [[nodiscard]] std::uint64_t sum_of_hashes() const;
  void serialize(Archive& archive);
  [[nodiscard]] std::shared_ptr<void> release();
  /// Allocates x and y side by side, see has_vectors_side_by_side(). Invalidates all pointers into the columns.
  void put_vectors_side_by_side();

  operator AgentsView() const { return view(); }  // NOLINT(google-explicit-constructor): as a Population is

 private:
  void remove_by_last_row(std::span<Id const> ids);
  void remove_in_order(std::span<Id const> ids);
  void reorder_places(std::span<std::uint32_t const> rows);
  /// Returns the places in a column of the values of rows, which are in the order of the kinds.
  [[nodiscard]] std::vector<std::uint32_t> places_of(TableColumn const& column,
                                                     std::span<std::uint32_t const> rows) const;
  [[nodiscard]] std::span<std::uint32_t const> kind_of_rows() const {
    return std::get<LargeArray<std::uint32_t>>(others_[0].values);
  }
  template <class Values>
  std::span<typename Values::value_type const> expand(TableColumn const& column, Values const& values,
                                                      ColumnValues& expanded) const;
  void count_kinds(Archive& archive);

  Population<X, Y> places_;
  std::vector<TableColumn> others_;
  std::vector<std::size_t> counts_ = {0};       ///< of the agents of each kind
  mutable std::vector<ColumnValues> expanded_;  ///< for views: columns of some kinds with a value for each agent
};

// These functions are what World requires of its agents.
inline std::vector<NamedColumn> columns_of(AgentTable& agents) { return agents.columns(); }
inline std::uint64_t sum_of_hashes(AgentTable const& agents) { return agents.sum_of_hashes(); }
inline std::uint64_t hash(Box const& box, Clock const& clock, std::uint64_t seed, AgentTable const& agents) {
  return hash_of_world(box, clock, seed, agents.size(), agents.sum_of_hashes());
}

}  // namespace gridlock::python
