#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <stdexcept>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "gridlock/model/detail/shared_model_engine.hpp"
#include "gridlock/model/model_engine.hpp"
#include "gridlock/simulation/register_model.hpp"
#include "thread_ranks.hpp"

namespace gridlock::test {

/// Helping ranks know a model by its name as long as this lives.
template <class Model>
class KnownModel {
 public:
  KnownModel() { register_model<Model>(); }
  ~KnownModel() { forget_model(Model::name); }
  KnownModel(KnownModel const&) = delete;
  KnownModel& operator=(KnownModel const&) = delete;
};

inline std::vector<std::uint64_t> all_of(Counters const& counters) {
  std::vector<std::uint64_t> words{counters.moves, counters.halted_moves, counters.pair_collisions,
                                   word_of(counters.pair_virial)};
  for (std::size_t wall = 0; wall < 4; ++wall) {
    words.insert(words.end(), {counters.wall_hits[wall], word_of(counters.wall_impulse[wall])});
  }
  return words;
}

/// A world after some steps, and why they ended early, if they did.
template <class Model>
struct EndedWorld {
  World<Model> world;
  Counters counters;
  std::string failure;
  FreeNames names;  ///< of those who are born next
};

template <class Model>
World<Model> started(Model const& model, Box const& box, std::uint64_t seed) {
  World<Model> world{.box = box, .seed = seed};
  start_agents(model, world);
  return world;
}

template <class Model>
EndedWorld<Model> advance(Model const& model, World<Model> world, StopCondition const& stop,
                          ModelEngineSettings settings) {
  EndedWorld<Model> ended{.world = std::move(world), .counters = {}, .failure = {}, .names = {}};
  try {
    ModelEngine<Model>(model, ended.world.box, settings).advance(ended.world, ended.counters, stop);
  } catch (std::exception const& error) {
    ended.failure = error.what();
  }
  ended.names = ended.world.agents.free_names();
  return ended;
}

/// Some of the agents for each rank.
template <class Model>
World<Model> part_of(World<Model> const& world, Communicator const& ranks) {
  AgentRows<typename World<Model>::Agents> rows;
  for (std::size_t row = 0; row < world.agents.size(); ++row) {
    if (directory_of(world.agents.ids()[row], ranks.count()) != ranks.rank()) continue;
    rows.ids.push_back(world.agents.ids()[row]);
    rows.values.resize(rows.ids.size());
    rows.values.copy(rows.ids.size() - 1, world.agents.values(), row);
  }
  sort_agents(rows);
  World<Model> part{.box = world.box, .agents = {}, .clock = world.clock, .seed = world.seed};
  part.agents.become(rows.ids, rows.values);
  return part;
}

/// A world on so many ranks, of which the agents go on from where they are; `ended` says how.
template <class Model>
void continue_on_ranks(Model const& model, EndedWorld<Model>& ended, StopCondition const& stop, ThreadRanks& ranks,
                       std::uint64_t threads) {
  std::vector<World<Model>> parts(ranks.count());
  EndedWorld<Model> const before =
      std::exchange(ended, {.world = {}, .counters = ended.counters, .failure = {}, .names = ended.names});
  try {
    ranks.run([&](Communicator& here) {
      bool const is_root = here.rank() == 0;
      World<Model>& own = parts[here.rank()] = part_of(before.world, here);
      own.events = before.world.events;
      if (is_root) own.agents.names_of_all() = before.names;
      Counters counters = before.counters;
      auto const note_end = [&] {
        if (!is_root) return;
        ended.counters = counters;
        ended.names = own.agents.names_of_all();
      };
      try {
        SharedModelEngine<Model>(model, here, threads).advance(own, counters, stop);
      } catch (...) {
        note_end();
        throw;
      }
      note_end();
    });
  } catch (std::exception const& error) {
    ended.failure = error.what();
  }
  AgentRows<typename World<Model>::Agents> all;
  for (World<Model> const& part : parts) {
    for (std::size_t row = 0; row < part.agents.size(); ++row) {
      all.ids.push_back(part.agents.ids()[row]);
      all.values.resize(all.ids.size());
      all.values.copy(all.ids.size() - 1, part.agents.values(), row);
    }
  }
  ended.world = {.box = before.world.box,
                 .agents = {},
                 .clock = parts[0].clock,
                 .seed = before.world.seed,
                 .events = parts[0].events};
  ended.world.agents.become(all.ids, all.values);
}

template <class Model>
EndedWorld<Model> advance_on_ranks(Model const& model, World<Model> world, StopCondition const& stop, std::size_t ranks,
                                   std::uint64_t threads) {
  FreeNames names = world.agents.free_names();
  EndedWorld<Model> ended{.world = std::move(world), .counters = {}, .failure = {}, .names = std::move(names)};
  ThreadRanks all(ranks);
  continue_on_ranks(model, ended, stop, all, threads);
  return ended;
}

/// All that a checkpoint holds, but for the order of the rows.
template <class Model>
std::vector<std::uint64_t> all_of(EndedWorld<Model> const& ended) {
  World<Model> const& world = ended.world;
  std::vector<std::uint64_t> words(world.agents.ids().begin(), world.agents.ids().end());
  std::ranges::sort(words);
  words.insert(words.end(), {hash(world), world.clock.step, word_of(world.clock.time), ended.names.slots()});
  words.insert(words.end(), world.events.begin(), world.events.end());
  words.insert(words.end(), ended.names.free().begin(), ended.names.free().end());
  std::vector<std::uint64_t> const counted = all_of(ended.counters);
  words.insert(words.end(), counted.begin(), counted.end());
  return words;
}

template <class Model>
void expect_same(EndedWorld<Model> const& one, EndedWorld<Model> const& many, std::string const& what) {
  ASSERT_EQ(one.failure, many.failure) << what;
  ASSERT_EQ(hash(one.world), hash(many.world)) << what;
  ASSERT_EQ(all_of(one), all_of(many)) << what;
}

/// On ranks, steps end where they are asked to and where the question fails, and what was done until then is whole.
template <class Model>
void expect_to_be_whole_where_it_ends(Model const& model, World<Model> const& start) {
  for (bool const throws : {false, true}) {
    int asked = 0;
    auto const should_continue = [&] {
      if (++asked == 3 && throws) throw std::runtime_error("no more paper");
      return asked < 3;
    };
    EndedWorld const many =
        advance_on_ranks(model, start, {.step = 1'000'000, .should_continue = should_continue}, 3, 1);
    EXPECT_EQ(many.failure, throws ? "no more paper" : "");
    EXPECT_GT(many.world.clock.step, 0U);
    EXPECT_EQ(all_of(advance(model, start, {.step = many.world.clock.step}, {})), all_of(many));
  }
}

}  // namespace gridlock::test
