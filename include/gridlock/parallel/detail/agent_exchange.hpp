#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <functional>
#include <span>
#include <tuple>
#include <utility>
#include <vector>

#include "gridlock/core/detail/large_array.hpp"
#include "gridlock/core/detail/rows_in_order.hpp"
#include "gridlock/core/population.hpp"
#include "gridlock/parallel/detail/all_processes.hpp"
#include "gridlock/parallel/detail/row_division.hpp"

namespace gridlock {

/// Returns the process that keeps record of an agent. It depends on the Id alone, so that every process knows it, and
/// each process has about equally many agents.
inline std::size_t directory_of(Id id, std::size_t processes) {
  return static_cast<std::size_t>(id & 0xFFFFFFFFU) % processes;
}

/// The rows that exchange_rows() sends, and functions for the rows that arrive.
struct RowsOfBytes {
  std::size_t count = 0;
  std::size_t bytes_of_row = 0;
  std::function<std::size_t(std::size_t row)> process_of;  ///< the process to which a row is sent
  std::function<void(std::size_t row, std::byte* to)> write;
  std::function<void(std::uint64_t count)> reserve;  ///< called with the number of rows that arrive
  std::function<void(std::byte const* row)> read;    ///< called with each row that arrives
};

/// Sends each row to its process, and reads the rows that other processes sent. All processes call it.
void exchange_rows(AllProcesses processes, RowsOfBytes const& rows);

/// Returns the Ids of `rows`, where `division` numbers the rows of all processes, and `own` has the Ids of the rows of
/// this process. All processes call it, each for the rows it needs. Cost: two rounds of messages.
std::vector<Id> ids_of_rows(AllProcesses processes, RowDivision const& division, std::span<Id const> own,
                            std::span<std::uint32_t const> rows);

/// One value of bytes_of_value bytes for each of some agents.
struct ValuesOfAgents {
  std::size_t bytes_of_value = 0;
  std::vector<Id> ids;
  std::vector<std::byte> values;

  void add(Id id, void const* value) {
    ids.push_back(id);
    values.resize(values.size() + bytes_of_value);
    std::memcpy(values.data() + values.size() - bytes_of_value, value, bytes_of_value);
  }
};

/// Sends values of agents that are in other processes to those processes, and receives values for the agents `wait` of
/// this process. The value of an agent that no process has stays here. All processes call it.
void send_to_owners(AllProcesses processes, std::span<Id const> wait, ValuesOfAgents& values);

template <class... Values>
constexpr std::size_t bytes_of_values(std::tuple<Values...> const* /*values*/) {
  return (sizeof(Values) + ... + 0);
}

/// Rows of agents in any order.
template <class Agents>
struct AgentRows {
  LargeArray<Id> ids;
  typename Agents::AllValues values;
};

/// Sends the agent of each row to process_of(row), and returns the agents that arrive. All processes call it.
template <class Agents, class ProcessOf>
AgentRows<Agents> exchanged_agents(AllProcesses processes, std::span<Id const> ids,
                                   typename Agents::AllValues const& values, ProcessOf process_of) {
  AgentRows<Agents> arrived;
  exchange_rows(processes,
                {.count = ids.size(),
                 .bytes_of_row = sizeof(Id) + bytes_of_values(static_cast<typename Agents::Values const*>(nullptr)),
                 .process_of = process_of,
                 .write =
                     [&](std::size_t row, std::byte* to) {
                       std::byte* at = to;
                       auto const put = [&](auto const& value) {
                         std::memcpy(at, &value, sizeof(value));
                         at += sizeof(value);
                       };
                       put(ids[row]);
                       values.for_each_column([&](auto const& column) { put(column[row]); });
                     },
                 .reserve =
                     [&](std::uint64_t count) {
                       // One eighth more, for newborns and the agents of the rim: else the arrays would double when
                       // they grow.
                       std::uint64_t const room = count + count / 8;
                       arrived.ids.reserve(room);
                       arrived.values.for_each_column([&](auto& column) { column.reserve(room); });
                     },
                 .read =
                     [&](std::byte const* from) {
                       std::byte const* at = from;
                       auto const add = [&](auto& column) {
                         column.emplace_back();
                         std::memcpy(&column.back(), at, sizeof(column.back()));
                         at += sizeof(column.back());
                       };
                       add(arrived.ids);
                       arrived.values.for_each_column(add);
                     }});
  return arrived;
}

/// Sorts agents by their Ids.
template <class Agents>
void sort_agents(AgentRows<Agents>& agents) {
  std::vector<std::uint32_t> const rows = rows_in_order(agents.ids);
  AgentRows<Agents> sorted;
  sorted.ids.resize(rows.size());
  sorted.values.resize(rows.size());
  for (std::size_t place = 0; place < rows.size(); ++place) {
    sorted.ids[place] = agents.ids[rows[place]];
    sorted.values.copy(place, agents.values, rows[place]);
  }
  agents = std::move(sorted);
}

/// Divides the agents among the processes in about equal numbers, sorted by their Ids. Agents with the same Id go to
/// the same process. All processes call it.
template <class Agents>
void scatter(AllProcesses processes, AgentRows<Agents>& agents) {
  agents = exchanged_agents<Agents>(processes, agents.ids, agents.values,
                                    [&](std::size_t row) { return directory_of(agents.ids[row], processes.count()); });
  sort_agents(agents);
}

}  // namespace gridlock
