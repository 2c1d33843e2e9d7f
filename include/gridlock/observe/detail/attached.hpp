#pragma once

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <memory>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

#include "gridlock/core/agents_view.hpp"
#include "gridlock/core/archive.hpp"
#include "gridlock/core/detail/large_array.hpp"
#include "gridlock/core/population.hpp"
#include "gridlock/observe/detail/id_index.hpp"
#include "gridlock/parallel/detail/agent_exchange.hpp"

namespace gridlock {

/// Values of agents, which move with their agents from process to process.
class AttachedColumn {
 public:
  AttachedColumn() = default;
  AttachedColumn(AttachedColumn const&) = delete;
  AttachedColumn& operator=(AttachedColumn const&) = delete;
  virtual ~AttachedColumn() = default;

  /// Sends the values to the processes that have the agents now; `own` are the Ids of this process, in order. All
  /// processes call it. Cost: a comparison for each agent, and messages for agents that have moved to other processes.
  virtual void migrate(AllProcesses processes, std::span<Id const> own) = 0;
};

/// All columns attached to the agents of a simulation; a column is removed when its Attached objects are destroyed.
class AttachedColumns {
 public:
  void add(std::weak_ptr<AttachedColumn> column) { columns_->push_back(std::move(column)); }
  /// Calls AttachedColumn::migrate() of every column.
  void migrate(AllProcesses processes, std::span<Id const> own) const {
    std::erase_if(*columns_, [](std::weak_ptr<AttachedColumn> const& column) { return column.expired(); });
    if (processes.count() == 1) return;
    for (auto const& column : *columns_) column.lock()->migrate(processes, own);
  }

 private:
  std::shared_ptr<std::vector<std::weak_ptr<AttachedColumn>>> columns_ =
      std::make_shared<std::vector<std::weak_ptr<AttachedColumn>>>();
};

/// A value for each agent alive at one time, such as its site at the start. find() returns the value by the Id of the
/// agent, even if its row has changed.
/// Cost: that of an IdIndex.
template <class Value>
class Attached {
 public:
  static_assert(std::is_trivially_copyable_v<Value>);

  Attached() = default;
  /// Attaches value_of(row) to each agent.
  template <class ValueOf>
  Attached(AttachedColumns columns, AgentsView const& agents, ValueOf value_of) : Attached(std::move(columns)) {
    column_->agents = IdIndex(agents.ids());
    column_->values.resize(agents.size());
    for (std::size_t row = 0; row < agents.size(); ++row) {
      column_->values[column_->agents.place_of_row(row)] = value_of(row);
    }
  }
  /// Attaches no values yet.
  explicit Attached(AttachedColumns columns) { columns.add(column_); }

  /// Returns the value of the agent that is in `row` now; nullptr for an agent that had not been born then.
  [[nodiscard]] Value const* find(Id id, std::size_t row) const {
    std::size_t const place = column_->agents.place_of(id, row);
    return place == IdIndex::not_found ? nullptr : &column_->values[place];
  }
  [[nodiscard]] IdIndex const& agents() const { return column_->agents; }

  /// Serializes the Ids, and allocates memory for their values.
  void serialize_ids(Archive& archive) {
    column_->agents.serialize(archive);
    if (archive.is_restoring()) column_->values.resize(column_->agents.size());
  }
  /// Serializes one member of all values, in the order of the rows when they were attached.
  template <class Member, class Record>
  requires std::is_same_v<Record, Value>
  void serialize_member(Archive& archive, char const* name, Member Record::*member) {
    auto const& agents = column_->agents;
    LargeArray<Value>& values = column_->values;
    std::vector<Member> column(values.size());
    for (std::size_t row = 0; row < column.size(); ++row) column[row] = values[agents.place_of_row(row)].*member;
    archive.visit_rows(name, column);
    if (!archive.is_restoring()) return;
    archive.require(column.size() == values.size(), "not every agent has a value");
    for (std::size_t row = 0; row < column.size(); ++row) values[agents.place_of_row(row)].*member = column[row];
  }

 private:
  struct Entry {
    Id id;
    Value value;
  };
  struct Column final : AttachedColumn {
    IdIndex agents;
    LargeArray<Value> values;  ///< one value for each Id, in order

    void migrate(AllProcesses processes, std::span<Id const> own) override {
      LargeArray<Entry> kept;
      kept.reserve(values.size());
      std::vector<Id> wait;
      ValuesOfAgents moving{.bytes_of_value = sizeof(Value), .ids = {}, .values = {}};
      std::size_t row = 0;
      for (std::size_t place = 0; place < values.size(); ++place) {
        Id const id = agents.id_at(place);
        for (; row < own.size() && own[row] < id; ++row) wait.push_back(own[row]);
        bool const is_here = row < own.size() && own[row] == id;
        row += is_here ? 1 : 0;
        is_here ? kept.push_back({id, values[place]}) : moving.add(id, &values[place]);
      }
      wait.insert(wait.end(), own.begin() + static_cast<std::ptrdiff_t>(row), own.end());
      if (processes.sum(moving.ids.size()) == 0) return;
      send_to_owners(processes, wait, moving);
      auto const first_come = static_cast<std::ptrdiff_t>(kept.size());
      for (std::size_t k = 0; k < moving.ids.size(); ++k) {
        std::memcpy(&kept.emplace_back(Entry{moving.ids[k], {}}).value, &moving.values[k * sizeof(Value)],
                    sizeof(Value));
      }
      // Agents that have stayed are in order; only the few that have arrived need sorting.
      std::ranges::sort(kept.begin() + first_come, kept.end(), {}, &Entry::id);
      std::inplace_merge(kept.begin(), kept.begin() + first_come, kept.end(),
                         [](Entry const& one, Entry const& other) { return one.id < other.id; });
      LargeArray<Id> ids;
      ids.reserve(kept.size());
      values.clear();
      for (Entry const& entry : kept) {
        ids.push_back(entry.id);
        values.push_back(entry.value);
      }
      agents = IdIndex(ids);
    }
  };

  std::shared_ptr<Column> column_ = std::make_shared<Column>();
};

}  // namespace gridlock
