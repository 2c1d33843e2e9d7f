// A whole state that ranks, here threads, advance together.
#pragma once

#include <cstddef>
#include <cstdint>
#include <mutex>
#include <vector>

#include "gridlock/core/detail/rows_in_order.hpp"
#include "gridlock/engine/engine.hpp"
#include "gridlock/parallel/detail/row_division.hpp"
#include "thread_ranks.hpp"

namespace gridlock::test {

/// Rows of a state in the order of the Ids, as many for each rank.
class RowsOfRanks {
 public:
  RowsOfRanks(State& state, std::size_t ranks)
      : state_(state), order_(rows_in_order(state.agents.ids())), rows_(RowDivision::even(order_.size(), ranks)) {}

  [[nodiscard]] State part(std::size_t rank) const {
    State part{.box = state_.box, .agents = {}, .clock = state_.clock, .seed = state_.seed};
    LargeArray<Id> ids;
    Disks::AllValues values;
    for (std::uint64_t place = rows_.first(rank); place < rows_.end(rank); ++place) {
      ids.push_back(state_.agents.ids()[order_[place]]);
      values.resize(ids.size());
      values.copy(ids.size() - 1, state_.agents.values(), order_[place]);
    }
    part.agents.become(ids, values);
    return part;
  }
  void take_back(std::size_t /*rank*/, State const& part) {
    std::scoped_lock const lock(mutex_);
    for (std::size_t k = 0; k < part.agents.size(); ++k) {
      std::size_t const row = state_.agents.index_of(part.agents.ids()[k]);
      copy<X, Y, VelocityX, VelocityY, Radius, Mass, ImageX, ImageY>(row, part.agents, k);
    }
    state_.box = part.box;
    state_.clock = part.clock;
  }

 private:
  template <class... Columns>
  void copy(std::size_t to, Disks const& disks, std::size_t from) {
    ((state_.agents.column<Columns>()[to] = disks.column<Columns>()[from]), ...);
  }

  State& state_;
  std::vector<std::uint32_t> order_;
  RowDivision rows_;
  std::mutex mutex_;
};

/// Advances a state by the engine of the settings on ranks. Throws what it throws; what was done until then is whole.
inline void advance_on_ranks(EngineSettings const& settings, ThreadRanks& ranks, State& state, Counters& counters,
                             StopCondition const& stop) {
  State before = state;
  RowsOfRanks const start(before, ranks.count());
  RowsOfRanks end(state, ranks.count());
  Counters const counters_before = counters;
  ranks.run([&](Communicator& here) {
    State own = start.part(here.rank());
    EngineSettings of_rank = settings;
    of_rank.processes = here;
    Counters counted = counters_before;
    auto const take_back = [&] {
      end.take_back(here.rank(), own);
      if (here.rank() == 0) counters = counted;
    };
    try {
      make_engine(of_rank, own)->advance(own, counted, stop);
    } catch (...) {
      take_back();
      throw;
    }
    take_back();
  });
}

}  // namespace gridlock::test
