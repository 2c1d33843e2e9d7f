#pragma once

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <type_traits>
#include <vector>

#include "gridlock/core/agents_view.hpp"
#include "gridlock/core/archive.hpp"
#include "gridlock/core/population.hpp"
#include "gridlock/observe/detail/id_index.hpp"
#include "gridlock/parallel/detail/agent_homes.hpp"

namespace gridlock {

/// A value for each agent that was there at one time, such as its site at the start: it is found again by the Id of the
/// agent, wherever its row is by then.
/// Cost: that of an IdIndex.
template <class Value>
class Attached {
 public:
  static_assert(std::is_trivially_copyable_v<Value>);

  Attached() = default;
  /// Attaches value_of(row) to each agent.
  template <class ValueOf>
  Attached(AgentsView const& agents, ValueOf value_of) : agents_(agents.ids()), values_(agents.size()) {
    for (std::size_t row = 0; row < values_.size(); ++row) values_[agents_.place_of_row(row)] = value_of(row);
  }

  /// The value of the agent that is in `row` now; nullptr for an agent that was not there then.
  [[nodiscard]] Value const* find(Id id, std::size_t row) const {
    std::size_t const place = agents_.place_of(id, row);
    return place == IdIndex::not_found ? nullptr : &values_[place];
  }
  [[nodiscard]] IdIndex const& agents() const { return agents_; }

  /// Serializes the Ids, and makes room for their values.
  void serialize_ids(Archive& archive) {
    agents_.serialize(archive);
    if (archive.is_restoring()) values_.resize(agents_.size());
  }
  /// Serializes one member of all values, in the order of the rows of then.
  template <class Member>
  void serialize_member(Archive& archive, char const* name, Member Value::*member) {
    std::vector<Member> column(values_.size());
    for (std::size_t row = 0; row < column.size(); ++row) column[row] = values_[agents_.place_of_row(row)].*member;
    archive.visit_rows(name, column);
    if (!archive.is_restoring()) return;
    archive.require(column.size() == values_.size(), "not every agent has a value");
    for (std::size_t row = 0; row < column.size(); ++row) values_[agents_.place_of_row(row)].*member = column[row];
  }

  /// The values go to the processes that have the agents now. All call it.
  void migrate(AllProcesses processes) {
    struct Entry {
      Id id;
      Value value;
    };
    std::vector<Entry> arrived;
    exchange_rows(processes,
                  {.count = values_.size(),
                   .bytes_of_row = sizeof(Entry),
                   .process_of = [&](std::size_t k) { return home_of(agents_.id_at(k), processes.count()); },
                   .write =
                       [&](std::size_t k, std::byte* to) {
                         Entry const entry{agents_.id_at(k), values_[k]};
                         std::memcpy(to, &entry, sizeof(entry));
                       },
                   .reserve = [&](std::uint64_t count) { arrived.reserve(count); },
                   .read = [&](std::byte const* from) { std::memcpy(&arrived.emplace_back(), from, sizeof(Entry)); }});
    std::ranges::sort(arrived, {}, &Entry::id);
    std::vector<Id> ids;
    values_.clear();
    for (Entry const& entry : arrived) {
      ids.push_back(entry.id);
      values_.push_back(entry.value);
    }
    agents_ = IdIndex(ids);
  }

 private:
  IdIndex agents_;
  std::vector<Value> values_;  ///< in the order of the Ids
};

}  // namespace gridlock
