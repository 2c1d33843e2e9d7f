#pragma once

#include <cstddef>
#include <tuple>
#include <type_traits>

#include "gridlock/core/detail/large_array.hpp"

namespace gridlock {

/// The values of many agents without their Ids: a contiguous column for each property, all of the same length.
template <class... Columns>
class ColumnSet {
 public:
  [[nodiscard]] std::size_t size() const { return size_of<Columns...>(); }

  void resize(std::size_t rows) { (values<Columns>().resize(rows), ...); }

  /// Copies row `from` of `other` to row `to`. Threads may copy to different rows at the same time.
  void copy(std::size_t to, ColumnSet const& other, std::size_t from) {
    ((values<Columns>()[to] = other.template values<Columns>()[from]), ...);
  }

  /// Calls visit(values) for each column.
  template <class Visit>
  void for_each_column(Visit visit) {
    (visit(values<Columns>()), ...);
  }
  template <class Visit>
  void for_each_column(Visit visit) const {
    (visit(values<Columns>()), ...);
  }
  void put(std::size_t to, std::tuple<typename Columns::type...> const& row) {
    std::apply([&](auto... value) { ((values<Columns>()[to] = value), ...); }, row);
  }

  template <class Column>
  [[nodiscard]] LargeArray<typename Column::type>& values() {
    static_assert(has<Column>, "these agents have no such column: name it in Population<...>");
    // Without this branch the compiler would add many errors from std::get to that of the assertion.
    if constexpr (has<Column>) return std::get<Storage<Column>>(columns_).values;
  }
  template <class Column>
  [[nodiscard]] LargeArray<typename Column::type> const& values() const {
    static_assert(has<Column>, "these agents have no such column: name it in Population<...>");
    if constexpr (has<Column>) return std::get<Storage<Column>>(columns_).values;
  }

 private:
  template <class Column>
  static constexpr bool has = (std::is_same_v<Column, Columns> || ...);

  /// A type of its own for each tag, so that std::get can tell columns of equal type apart.
  template <class Column>
  struct Storage {
    LargeArray<typename Column::type> values;
  };

  template <class First, class... Others>
  [[nodiscard]] std::size_t size_of() const {
    return values<First>().size();
  }

  std::tuple<Storage<Columns>...> columns_;
};

}  // namespace gridlock
