#pragma once

#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <exception>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

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

/// A world after some steps, and why they ended early, if they did.
template <class Model>
struct EndedWorld {
  World<Model> world;
  Counters counters;
  std::string failure;
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
  EndedWorld<Model> ended{.world = std::move(world), .counters = {}, .failure = {}};
  try {
    ModelEngine<Model>(model, ended.world.box, settings).advance(ended.world, ended.counters, stop);
  } catch (std::exception const& error) {
    ended.failure = error.what();
  }
  return ended;
}

template <class Model>
EndedWorld<Model> advance_on_ranks(Model const& model, World<Model> world, StopCondition const& stop, std::size_t ranks,
                                   std::uint64_t threads) {
  EndedWorld<Model> ended;
  ThreadRanks(ranks).run(
      [&](Ranks& leader) { ended = advance(model, std::move(world), stop, {.threads = threads, .ranks = &leader}); });
  return ended;
}

/// All that a checkpoint holds, the order of the rows and the names that are free included.
template <class Model>
std::vector<std::uint64_t> all_of(World<Model> const& world) {
  std::vector<std::uint64_t> words{hash(world), world.clock.step, word_of(world.clock.time)};
  words.insert(words.end(), world.agents.ids().begin(), world.agents.ids().end());
  words.insert(words.end(), world.events.begin(), world.events.end());
  typename World<Model>::Agents agents = world.agents;
  for (int n = 0; n < 20; ++n) {
    words.push_back(
        std::apply([&](auto... value) { return agents.add(value...); }, typename World<Model>::Agents::Values{}));
  }
  return words;
}

inline std::vector<std::uint64_t> all_of(Counters const& counters) {
  std::vector<std::uint64_t> words{counters.moves, counters.halted_moves, counters.pair_collisions,
                                   word_of(counters.pair_virial)};
  for (std::size_t wall = 0; wall < 4; ++wall) {
    words.insert(words.end(), {counters.wall_hits[wall], word_of(counters.wall_impulse[wall])});
  }
  return words;
}

template <class Model>
void expect_same(EndedWorld<Model> const& one, EndedWorld<Model> const& many, std::string const& what) {
  ASSERT_EQ(one.failure, many.failure) << what;
  ASSERT_EQ(hash(one.world), hash(many.world)) << what;
  ASSERT_EQ(all_of(one.world), all_of(many.world)) << what;
  ASSERT_EQ(all_of(one.counters), all_of(many.counters)) << what;
}

}  // namespace gridlock::test
