#pragma once

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "gridlock/core/agents_view.hpp"
#include "gridlock/core/detail/large_array.hpp"
#include "gridlock/core/disks.hpp"
#include "gridlock/core/error.hpp"

namespace gridlock::python {

namespace nb = nanobind;

/// Returns whether an array over both components of a position or velocity would span only memory of columns.
///
/// NumPy assumes that such an array shares all memory in between. A copy that NumPy allocated there would seem to
/// overlap, so NumPy would copy again without end.
inline bool has_vectors_side_by_side(std::vector<NamedColumn> const& columns) {
  auto const memory_of = [&](std::string_view name) -> void const* {
    auto const found = std::ranges::find(columns, name, &NamedColumn::name);
    if (found == columns.end()) return nullptr;
    return std::visit([](auto values) -> void const* { return values.empty() ? nullptr : values.data(); },
                      found->values);
  };
  auto const are_together = [&](std::string_view first, std::string_view second) {
    void const* const one = memory_of(first);
    void const* const other = memory_of(second);
    return one == nullptr || other == nullptr || are_side_by_side(one, other);
  };
  return are_together(X::name, Y::name) && are_together(VelocityX::name, VelocityY::name);
}

/// Lends columns to Python as arrays without a copy, and tracks whether Python still holds one.
class ColumnLender {
 public:
  /// Returns whether arrays were lent since the last call of take_back().
  [[nodiscard]] bool has_lent() const { return memory_ != nullptr; }
  /// Returns whether Python still holds a lent array.
  [[nodiscard]] bool is_held() const { return memory_.use_count() > 1; }

  /// Ends the loan. Arrays that Python still holds keep their present values: `release` moves the columns to a copy and
  /// returns the old memory.
  template <class Release>
  void take_back(Release release) {
    if (is_held()) memory_->released = release();
    memory_.reset();
  }

  /// Returns a column as an array; `named` are all columns.
  nb::object column(std::vector<NamedColumn> const& named, std::string const& name) {
    return std::visit([&](auto values) { return array_of(values.data(), {values.size()}, {1}); },
                      find(named, name).values);
  }
  /// Returns a column as a read-only array.
  nb::object column_to_read(std::vector<NamedColumn> const& named, std::string const& name) {
    return std::visit(
        [&](auto values) {
          using Value = typename decltype(values)::element_type;
          return array_of(static_cast<Value const*>(values.data()), {values.size()}, {1});
        },
        find(named, name).values);
  }
  /// Returns two columns of equal type as an array of shape (N, 2), whose stride is the distance of the columns in
  /// memory. See has_vectors_side_by_side().
  nb::object columns(std::vector<NamedColumn> const& named, std::string const& first, std::string const& second) {
    NamedColumn const& a = find(named, first);
    NamedColumn const& b = find(named, second);
    return std::visit(
        [&](auto values) {
          auto const others = std::get<decltype(values)>(b.values);
          return array_of(values.data(), {values.size(), 2}, {1, others.data() - values.data()});
        },
        a.values);
  }
  /// Returns numbers in rows as an array of shape (rows, columns), one that Python may write only if `Value` is not
  /// const.
  template <class Value>
  nb::object rows_of(Value* data, std::size_t rows, std::size_t columns) {
    return array_of(data, {rows, columns}, {static_cast<std::int64_t>(columns), 1});
  }
  /// Returns the Ids as a read-only array.
  nb::object ids(std::span<Id const> ids) {
    return nb::cast(nb::ndarray<nb::numpy, Id const>(ids.data(), {ids.size()}, keeper()), nb::rv_policy::reference);
  }

 private:
  /// Owns released memory of columns for the arrays that still refer to it.
  struct Memory {
    std::shared_ptr<void> released;
  };

  static NamedColumn const& find(std::vector<NamedColumn> const& named, std::string const& name) {
    std::string names;
    for (NamedColumn const& column : named) {
      if (column.name == name) return column;
      names += (names.empty() ? "" : ", ") + std::string(column.name);
    }
    throw Error({.what = "the agents have no column " + name, .hint = "they have " + names});
  }
  nb::capsule keeper() {
    if (!memory_) memory_ = std::make_shared<Memory>();
    return {new std::shared_ptr<Memory>(memory_),
            [](void* memory) noexcept { delete static_cast<std::shared_ptr<Memory>*>(memory); }};
  }
  template <class Value>
  nb::object array_of(Value* data, std::initializer_list<std::size_t> shape,
                      std::initializer_list<std::int64_t> strides) {
    return nb::cast(nb::ndarray<nb::numpy, Value>(data, shape, keeper(), strides), nb::rv_policy::reference);
  }

  std::shared_ptr<Memory> memory_;  ///< held by each array lent since the last take_back()
};

}  // namespace gridlock::python
