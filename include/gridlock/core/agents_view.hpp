#pragma once

#include <cassert>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "gridlock/core/population.hpp"

namespace gridlock {

/// The agents of a world of any model at one time, read only: their Ids, and their columns by tag.
///
/// A view is valid as long as no agent is born, dies or moves to another row. Cost: O(columns) to make a view, and to
/// look up a column; look up a column once, outside of loops.
///
/// ```cpp
/// #include "gridlock/core/disks.hpp"
///
/// Population<X, Y> points;
/// points.add(0.25, 0.5);
/// AgentsView const view(points);
/// std::span<double const> const x = view.column<X>();
/// bool const have_radii = view.has("radius");  // false
/// ```
class AgentsView {
 public:
  using Values = std::variant<std::span<double const>, std::span<std::int32_t const>, std::span<std::uint32_t const>,
                              std::span<std::uint64_t const>>;

  template <class... Columns>
  AgentsView(Population<Columns...> const& agents)  // NOLINT(google-explicit-constructor): agents convert to a view
      : ids_(agents.ids()), columns_{{Columns::name, agents.template column<Columns>()}...} {}
  /// Makes a view of agents whose columns are known at run time only. Contract: one value for each Id in every column.
  AgentsView(std::span<Id const> ids, std::vector<std::pair<std::string_view, Values>> columns)
      : ids_(ids), columns_(std::move(columns)) {}

  [[nodiscard]] std::size_t size() const { return ids_.size(); }
  [[nodiscard]] bool empty() const { return ids_.empty(); }
  [[nodiscard]] std::span<Id const> ids() const { return ids_; }

  /// Returns all columns with their names, in the order they are declared.
  [[nodiscard]] std::span<std::pair<std::string_view, Values> const> columns() const { return columns_; }
  /// Returns the names of all columns, in the order they are declared.
  [[nodiscard]] std::vector<std::string_view> names() const {
    std::vector<std::string_view> names;
    for (auto const& column : columns_) names.push_back(column.first);
    return names;
  }
  /// Returns whether the agents have a column named `name`.
  [[nodiscard]] bool has(std::string_view name) const {
    for (auto const& column : columns_) {
      if (column.first == name) return true;
    }
    return false;
  }
  template <class Column>
  [[nodiscard]] bool has() const {
    return find<Column>() != nullptr;
  }

  /// Returns the values of a column, one for each agent. Contract: the agents have the column (asserted).
  template <class Column>
  [[nodiscard]] std::span<typename Column::type const> column() const {
    auto const* const values = find<Column>();
    assert(values != nullptr);
    return *values;
  }

 private:
  template <class Column>
  [[nodiscard]] std::span<typename Column::type const> const* find() const {
    for (auto const& column : columns_) {
      if (column.first == Column::name) return std::get_if<std::span<typename Column::type const>>(&column.second);
    }
    return nullptr;
  }

  std::span<Id const> ids_;
  std::vector<std::pair<std::string_view, Values>> columns_;
};

/// A column whose values may be changed, with its name.
struct NamedColumn {
  std::string_view name;
  std::variant<std::span<double>, std::span<std::int32_t>, std::span<std::uint32_t>, std::span<std::uint64_t>> values;
};

/// Returns all columns of a population, in the order they are declared. They are valid as long as no agent is born,
/// dies or moves to another row.
template <class... Columns>
std::vector<NamedColumn> columns_of(Population<Columns...>& agents) {
  return {{Columns::name, agents.template column<Columns>()}...};
}

}  // namespace gridlock
