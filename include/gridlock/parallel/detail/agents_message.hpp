#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

#include "gridlock/core/detail/large_array.hpp"
#include "gridlock/core/detail/message.hpp"
#include "gridlock/core/population.hpp"

namespace gridlock {

/// Adds rows of agents to a message: their Ids, then their values column by column.
template <class AllValues>
void add_agents(MessageWriter& message, Id const* ids, AllValues const& values, std::span<std::uint32_t const> rows) {
  message.add_chosen(ids, rows);
  values.for_each_column([&](auto const& column) { message.add_chosen(column.data(), rows); });
}

/// Reads `count` agents from a message, and appends them to `ids` and `values`.
template <class AllValues>
void append_agents(MessageReader& message, std::size_t count, LargeArray<Id>& ids, AllValues& values) {
  std::size_t const before = ids.size();
  ids.resize(before + count);
  message.read_into(std::span(ids).subspan(before));
  values.resize(before + count);
  values.for_each_column([&](auto& column) { message.read_into(std::span(column).subspan(before)); });
}

/// Agents that have arrived in messages from other ranks. A message has the number of agents, then add_agents().
template <class Agents>
class ArrivedAgents {
 public:
  using AllValues = typename Agents::AllValues;

  void add(Message const& bytes) {
    MessageReader message(bytes);
    append_agents(message, message.next<std::uint64_t>(), ids_, values_);
  }

  /// Writes the arrived agents to the rows `dropped`, which are sorted, and then behind the last row. Moves last rows
  /// into dropped rows that remain.
  void put_into(LargeArray<Id>& ids, AllValues& values, std::span<std::uint32_t const> dropped) const {
    std::size_t next = 0;
    for (; next < ids_.size() && next < dropped.size(); ++next) put(ids, values, dropped[next], next);
    std::size_t rows = ids.size();
    if (next < ids_.size()) {
      ids.resize(rows + ids_.size() - next);
      values.resize(ids.size());
      for (; next < ids_.size(); ++next) put(ids, values, rows++, next);
      return;
    }
    for (std::span<std::uint32_t const> gaps = dropped.subspan(next); !gaps.empty(); --rows) {
      if (gaps.back() == rows - 1) {
        gaps = gaps.first(gaps.size() - 1);
        continue;
      }
      ids[gaps.front()] = ids[rows - 1];
      values.copy(gaps.front(), values, rows - 1);
      gaps = gaps.subspan(1);
    }
    ids.resize(rows);
    values.resize(rows);
  }

 private:
  void put(LargeArray<Id>& ids, AllValues& values, std::size_t row, std::size_t arrived) const {
    ids[row] = ids_[arrived];
    values.copy(row, values_, arrived);
  }

  LargeArray<Id> ids_;
  AllValues values_;
};

}  // namespace gridlock
