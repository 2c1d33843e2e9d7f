#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <tuple>
#include <type_traits>
#include <vector>

#include "gridlock/core/detail/counters_of_step.hpp"
#include "gridlock/core/detail/message.hpp"
#include "gridlock/model/detail/share.hpp"
#include "gridlock/model/detail/tiled_share.hpp"
#include "gridlock/parallel/communicator.hpp"
#include "gridlock/parallel/detail/collectives.hpp"
#include "gridlock/parallel/detail/steps_together.hpp"

namespace gridlock {

/// What one rank has in the steps of a model.
template <class Model>
using ShareOf = std::conditional_t<Model::schedule == Schedule::tiled, TiledModelShare<Model>, ModelShare<Model>>;

/// What ranks say of some steps that they have begun together.
struct AnswerOfShare {
  bool is_stop_asked = false;
  std::optional<FailedTurn> failure;     ///< the first, in the order of one process
  std::vector<CountersOfStep> counters;  ///< of each step, where turns keep counters

  void add(AnswerOfShare const& others) {
    is_stop_asked = is_stop_asked || others.is_stop_asked;
    bool const is_earlier = others.failure && failure && place_of(*others.failure) < place_of(*failure);
    if (others.failure && (!failure || is_earlier)) failure = others.failure;
    for (std::size_t step = 0; step < counters.size(); ++step) counters[step].add(others.counters[step]);
  }

  [[nodiscard]] Message message() const {
    MessageWriter message;
    message.add(is_stop_asked);
    message.add(failure.has_value());
    if (failure) {
      message.add(failure->cell);
      message.add(failure->agent);
      message.add_text(failure->reason);
    }
    for (CountersOfStep const& of_step : counters) of_step.write(message);
    return message.take();
  }
  static AnswerOfShare read(Message const& bytes) {
    MessageReader message(bytes);
    AnswerOfShare answer{.is_stop_asked = message.next<bool>(), .failure = {}, .counters = {}};
    if (message.next<bool>()) {
      FailedTurn& failure = answer.failure.emplace();
      failure.cell = message.next<std::uint64_t>();
      failure.agent = message.next<Id>();
      failure.reason = message.next_text();
    }
    while (!message.is_at_end()) answer.counters.push_back(CountersOfStep::read(message));
    return answer;
  }

 private:
  static std::tuple<std::uint64_t, Id> place_of(FailedTurn const& failure) { return {failure.cell, failure.agent}; }
};

/// Takes so many steps together with all other ranks, or as many as there are before a turn fails. `failure` is the
/// first of all ranks. All call it.
template <class Share>
StepsTaken take_steps(Communicator& ranks, Share& share, std::uint64_t steps, Counters& counters,
                      std::optional<FailedTurn>& failure) {
  std::uint64_t begun = 0;
  while (begun < steps && share.take_step()) ++begun;
  AnswerOfShare const own{
      .is_stop_asked = ranks.is_stop_asked(), .failure = share.failure(), .counters = share.take_counters()};
  AnswerOfShare const all =
      AnswerOfShare::read(all_reduce(ranks, own.message(), [](Message const& left, Message const& right) {
        AnswerOfShare answer = AnswerOfShare::read(left);
        answer.add(AnswerOfShare::read(right));
        return answer.message();
      }));
  if (all.is_stop_asked) ranks.ask_to_stop();
  failure = all.failure;
  StepsTaken const taken{.whole = begun - (failure ? 1 : 0), .has_failed = failure.has_value()};
  for (std::uint64_t step = 0; step < taken.whole && step < all.counters.size(); ++step) {
    all.counters[step].add_to(counters);
  }
  return taken;
}

}  // namespace gridlock
