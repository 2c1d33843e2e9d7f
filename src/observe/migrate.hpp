#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "gridlock/observe/detail/attached.hpp"
#include "gridlock/parallel/detail/agent_homes.hpp"
#include "gridlock/parallel/detail/exchange.hpp"

namespace gridlock {

template <class Value>
void Attached<Value>::migrate(Communicator& processes) {
  struct Entry {
    Id id;
    Value value;
  };
  std::vector<Entry> arrived;
  exchange_values<Entry>(
      processes, values_.size(),
      [&](std::size_t place, auto give) {
        Id const id = agents_.id_at(place);
        give(home_of(id, processes.count()), Entry{id, values_[place]});
      },
      [&](Entry const& entry) { arrived.push_back(entry); });
  std::ranges::sort(arrived, {}, &Entry::id);
  std::vector<Id> ids;
  values_.clear();
  for (Entry const& entry : arrived) {
    ids.push_back(entry.id);
    values_.push_back(entry.value);
  }
  agents_ = IdIndex(ids);
}

}  // namespace gridlock
