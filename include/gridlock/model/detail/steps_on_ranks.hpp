#pragma once

#include <cstddef>
#include <cstdint>
#include <exception>
#include <optional>
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>

#include "gridlock/core/detail/counters_of_step.hpp"
#include "gridlock/core/detail/message.hpp"
#include "gridlock/core/error.hpp"
#include "gridlock/engine/engine.hpp"
#include "gridlock/model/detail/share.hpp"
#include "gridlock/model/detail/tiled_share.hpp"
#include "gridlock/parallel/communicator.hpp"
#include "gridlock/parallel/detail/collectives.hpp"
#include "gridlock/parallel/detail/tasks.hpp"

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

/// Takes so many steps together with all other ranks, or as many as there are before a turn fails. Returns how many
/// were begun, and what all ranks say of them, for the leader.
template <class Share>
std::pair<std::uint64_t, AnswerOfShare> take_steps(Communicator& ranks, Share& share, std::uint64_t steps) {
  std::uint64_t begun = 0;
  while (begun < steps && share.take_step()) ++begun;
  AnswerOfShare const own{
      .is_stop_asked = ranks.is_stop_asked(), .failure = share.failure(), .counters = share.take_counters()};
  Message const all = reduce(ranks, own.message(), [](Message const& left, Message const& right) {
    AnswerOfShare answer = AnswerOfShare::read(left);
    answer.add(AnswerOfShare::read(right));
    return answer.message();
  });
  return {begun, ranks.rank() == 0 ? AnswerOfShare::read(all) : own};
}

/// What the leader tells all others before they take steps.
struct NextSteps {
  std::uint64_t steps = 0;            ///< 0: there are no more
  std::uint64_t does_last_count = 0;  ///< whether the last step counts, where there are no more
};

/// The leader's part of the steps of a share, from look to look at the stop condition.
template <class Share>
class LeadingSteps {
 public:
  LeadingSteps(Communicator& ranks, Share& share, Clock& clock, double time_step, Counters& counters)
      : ranks_(ranks), share_(share), clock_(clock), time_step_(time_step), counters_(counters) {}

  /// All ranks are back from their steps when it returns, whatever the stop condition has thrown.
  void run(StopCondition const& stop_condition) {
    StepsBetweenLooks looks(ranks_);
    while (!stop_condition.is_reached(clock_, counters_.pair_collisions)) {
      looks.begin();
      std::uint64_t const done = take(steps_until(stop_condition, looks.steps()));
      if (failure_) break;
      try {
        if (stop_condition.stops_here()) break;
      } catch (...) {
        thrown_ = std::current_exception();
        break;
      }
      looks.end(done);
    }
    tell({.steps = 0, .does_last_count = does_last_step_count() ? std::uint64_t{1} : 0});
  }

  [[nodiscard]] bool does_last_step_count() const { return !failure_; }

  /// Throws what the stop condition has thrown, or RunFailure for a turn that has failed.
  void require_good_end() const {
    if (thrown_) std::rethrow_exception(thrown_);
    if (failure_) throw RunFailure(failure_->reason);
  }

 private:
  void tell(NextSteps const& next) { static_cast<void>(broadcast(ranks_, message_of(next))); }

  /// How many steps may be taken before a look at the stop condition.
  [[nodiscard]] std::uint64_t steps_until(StopCondition const& stop, std::uint64_t most) const {
    // Who waits for collisions stops at the first step that has enough.
    if (stop.pair_collisions != StopCondition().pair_collisions) return 1;
    Clock clock = clock_;
    std::uint64_t steps = 0;
    while (steps < most && !stop.is_reached(clock, 0)) {
      advance(clock);
      ++steps;
    }
    return steps;
  }
  void advance(Clock& clock) const {
    ++clock.step;
    clock.time += time_step_;
  }

  /// Returns how many steps were taken.
  std::uint64_t take(std::uint64_t steps) {
    tell({.steps = steps});
    auto const [begun, all] = take_steps(ranks_, share_, steps);
    if (all.is_stop_asked) ranks_.ask_to_stop();
    failure_ = all.failure;
    std::uint64_t const whole = begun - (failure_ ? 1 : 0);
    for (std::uint64_t step = 0; step < whole; ++step) {
      advance(clock_);
      if (step < all.counters.size()) all.counters[step].add_to(counters_);
    }
    return whole;
  }

  Communicator& ranks_;
  Share& share_;
  Clock& clock_;
  double time_step_;
  Counters& counters_;
  std::exception_ptr thrown_;  ///< by the stop condition
  std::optional<FailedTurn> failure_;
};

/// The part of every other rank in them. Returns whether the last step counts.
template <class Share>
bool follow_steps(Communicator& ranks, Share& share) {
  while (true) {
    auto const next = MessageReader(broadcast(ranks, {})).template next<NextSteps>();
    if (next.steps == 0) return next.does_last_count != 0;
    take_steps(ranks, share, next.steps);
  }
}

}  // namespace gridlock
