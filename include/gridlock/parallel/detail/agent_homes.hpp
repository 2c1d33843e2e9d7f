#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <tuple>
#include <utility>
#include <vector>

#include "gridlock/core/detail/large_array.hpp"
#include "gridlock/core/detail/rows_in_order.hpp"
#include "gridlock/core/population.hpp"
#include "gridlock/parallel/communicator.hpp"
#include "gridlock/parallel/detail/exchange.hpp"

namespace gridlock {

/// The rank on which an agent is between steps, where agents come and go: a function of its name, so that everybody
/// knows it, what is noted for an agent stays where it is, and each rank has about as many, however far the population
/// grows.
inline std::size_t home_of(Id id, std::size_t ranks) { return static_cast<std::size_t>(id & 0xFFFFFFFFU) % ranks; }

/// How many agents come to this rank, where each sends so many to each rank. All call it.
std::uint64_t count_of_arrivals(Communicator& ranks, std::vector<std::uint64_t> leaving);

/// Cuts all agents in the order of their Ids into a block for each rank, of as many each: the first Id of each block.
/// `own` are those of this rank, in order. All call it. Cost: a round of messages for each bit of the largest Id.
std::vector<Id> first_ids_of_blocks(Communicator& ranks, std::span<Id const> own);

template <class... Values>
constexpr std::size_t bytes_of_values(std::tuple<Values...> const* /*values*/) {
  return (sizeof(Values) + ... + 0);
}

/// An agent in a message.
template <class Agents>
struct SentAgent {
  static constexpr std::size_t bytes = bytes_of_values(static_cast<typename Agents::Values const*>(nullptr));

  Id id;
  std::array<std::byte, bytes> values;
};

/// Rows of agents without an order.
template <class Agents>
struct AgentRows {
  LargeArray<Id> ids;
  typename Agents::AllValues values;
};

/// Each rank sends its agents to where they belong, rank_of(row), and gets those that have come. All call it.
template <class Agents, class RankOf>
AgentRows<Agents> exchanged_agents(Communicator& ranks, std::span<Id const> ids,
                                   typename Agents::AllValues const& values, RankOf rank_of) {
  AgentRows<Agents> arrived;
  std::vector<std::uint64_t> leaving(ranks.count(), 0);
  for (std::size_t row = 0; row < ids.size(); ++row) ++leaving[rank_of(row)];
  std::uint64_t const count = count_of_arrivals(ranks, std::move(leaving));
  // With room for those of a rim and for newborn: an array that grows is doubled.
  std::uint64_t const room = count + count / 8;
  arrived.ids.reserve(room);
  arrived.values.for_each_column([&](auto& column) { column.reserve(room); });
  exchange_values<SentAgent<Agents>>(
      ranks, ids.size(),
      [&](std::size_t row, auto give) {
        SentAgent<Agents> agent{.id = ids[row], .values = {}};
        std::byte* at = agent.values.data();
        values.for_each_column([&](auto const& column) {
          std::memcpy(at, &column[row], sizeof(column[row]));
          at += sizeof(column[row]);
        });
        give(rank_of(row), agent);
      },
      [&](SentAgent<Agents> const& agent) {
        arrived.ids.push_back(agent.id);
        std::byte const* at = agent.values.data();
        arrived.values.for_each_column([&](auto& column) {
          column.emplace_back();
          std::memcpy(&column.back(), at, sizeof(column.back()));
          at += sizeof(column.back());
        });
      });
  return arrived;
}

/// Puts agents in the order of their Ids.
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

/// Brings agents home, in the order of their Ids. All call it.
template <class Agents>
void bring_home(Communicator& ranks, AgentRows<Agents>& agents) {
  agents = exchanged_agents<Agents>(ranks, agents.ids, agents.values,
                                    [&](std::size_t row) { return home_of(agents.ids[row], ranks.count()); });
  sort_agents(agents);
}

}  // namespace gridlock
