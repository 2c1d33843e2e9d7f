#include "gridlock/observe/detail/attached.hpp"

#include <gtest/gtest.h>

#include <cstddef>
#include <vector>

#include "gridlock/core/disks.hpp"
#include "thread_ranks.hpp"

namespace gridlock {
namespace {

using test::ThreadRanks;

/// Agents with these Ids, for one process.
Population<X, Y> agents_with(LargeArray<Id> ids) {
  Population<X, Y>::AllValues values;
  values.resize(ids.size());
  for (std::size_t row = 0; row < ids.size(); ++row) values.put(row, {0.25 * static_cast<double>(ids[row]), 0.5});
  Population<X, Y> agents;
  agents.become(ids, values);
  return agents;
}

TEST(Attached, FollowsAgentsToOtherProcessesAndKeepsTheValuesOfThoseThatDied) {
  constexpr Id all = 60;
  auto const has_died = [](Id id) { return id == 7 || id == 31; };
  for (std::size_t const count : {1U, 2U, 3U, 5U}) {
    ThreadRanks(count).run([&](Communicator& here) {
      AllProcesses const processes = here;
      AttachedColumns columns;
      LargeArray<Id> ids;
      for (Id id = here.rank(); id < all; id += count) ids.push_back(id);
      Population<X, Y> const before = agents_with(ids);
      auto const x = before.column<X>();
      Attached<double> const attached(columns, AgentsView(before), [&](std::size_t row) { return x[row]; });
      // Twice, so that those that died are looked for again; newborn have no value.
      for (Id const width : {Id{20}, Id{7}}) {
        LargeArray<Id> own;
        for (Id id = 0; id < all + 10; ++id) {
          if ((id / width) % count == here.rank() && !has_died(id)) own.push_back(id);
        }
        columns.migrate(processes, own);
        for (std::size_t row = 0; row < own.size(); ++row) {
          double const* const value = attached.find(own[row], row);
          ASSERT_EQ(value != nullptr, own[row] < all) << own[row];
          if (value != nullptr) EXPECT_EQ(*value, 0.25 * static_cast<double>(own[row]));
        }
        EXPECT_EQ(processes.sum(attached.agents().size()), all);
      }
    });
  }
}

}  // namespace
}  // namespace gridlock
