#pragma once

#include <cstdint>
#include <functional>
#include <string_view>
#include <type_traits>
#include <vector>

#include "gridlock/core/archive.hpp"

namespace gridlock {

/// Serializes one number of each item as a column: with a name for each number, names would take more memory than
/// numbers. `number` is a member, or a function that returns a reference. Only the length of a column sets the number
/// of items: `count` of a damaged file can be anything.
template <class Item, class Number>
void serialize_column(Archive& archive, std::string_view name, std::uint64_t count, std::vector<Item>& items,
                      Number number) {
  std::vector<std::remove_cvref_t<std::invoke_result_t<Number&, Item&>>> values;
  if (!archive.is_restoring()) {
    for (Item& item : items) values.push_back(std::invoke(number, item));
  }
  archive.visit(name, values);
  archive.require(values.size() == count, "the columns of a table differ in length");
  items.resize(count);
  for (std::size_t k = 0; k < count; ++k) std::invoke(number, items[k]) = values[k];
}

}  // namespace gridlock
