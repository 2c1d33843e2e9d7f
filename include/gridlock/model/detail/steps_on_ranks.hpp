#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <type_traits>

#include "gridlock/model/detail/share.hpp"
#include "gridlock/model/detail/tiled_share.hpp"
#include "gridlock/parallel/communicator.hpp"
#include "gridlock/parallel/detail/steps_together.hpp"

namespace gridlock {

/// The share of one rank in the steps of a model.
template <class Model>
using ShareOf = std::conditional_t<Model::schedule == Schedule::tiled, TiledModelShare<Model>, ModelShare<Model>>;

/// Takes so many steps together with all other ranks, or as many as there are before a turn fails. `failure` is the
/// first of all ranks. All call it.
template <class Share>
StepsTaken take_steps(Communicator& ranks, Share& share, std::uint64_t steps, Counters& counters,
                      std::optional<FailedTurn>& failure) {
  std::uint64_t begun = 0;
  while (begun < steps && share.take_step()) ++begun;
  AnswerOfSteps const all = answer_of_all(
      ranks, {.is_stop_asked = ranks.is_stop_asked(), .failure = share.failure(), .counters = share.take_counters()});
  failure = all.failure;
  StepsTaken const taken{.whole = begun - (failure ? 1 : 0), .has_failed = failure.has_value()};
  for (std::uint64_t step = 0; step < taken.whole && step < all.counters.size(); ++step) {
    all.counters[step].add_to(counters);
  }
  return taken;
}

}  // namespace gridlock
