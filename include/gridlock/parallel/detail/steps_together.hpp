#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <optional>
#include <string>
#include <vector>

#include "gridlock/core/counters.hpp"
#include "gridlock/core/detail/counters_of_step.hpp"
#include "gridlock/core/detail/message.hpp"
#include "gridlock/core/error.hpp"
#include "gridlock/core/world.hpp"
#include "gridlock/parallel/communicator.hpp"
#include "gridlock/parallel/detail/collectives.hpp"

namespace gridlock {

/// Chooses the number of steps between two checks of the stop condition by the root, for about 20 ms of computation.
class StepsBetweenLooks {
 public:
  explicit StepsBetweenLooks(Communicator const& ranks) : ranks_(ranks) {}

  [[nodiscard]] std::uint64_t steps() const { return steps_; }
  void begin() { begin_ = ranks_.seconds(); }
  void end(std::uint64_t steps_done) {
    constexpr double seconds_between_looks = 0.02;
    double const seconds = ranks_.seconds() - begin_;
    double const fitting = seconds_between_looks * static_cast<double>(steps_done) / (seconds + 1e-9);
    steps_ = static_cast<std::uint64_t>(std::clamp(fitting, 1.0, 100.0));
  }

 private:
  Communicator const& ranks_;
  std::uint64_t steps_ = 1;
  double begin_ = 0.0;
};

/// The steps taken between two checks of the stop condition.
struct StepsTaken {
  std::uint64_t whole = 0;
  bool has_failed = false;  ///< whether the next step has failed
};

/// The first turn that failed, in the order of turns in a run of one process, and the reason.
struct FailedTurn {
  std::uint64_t cell = 0;
  Id agent = 0;
  std::string reason;
};

/// The result of some steps on one rank, or on all ranks together.
struct AnswerOfSteps {
  bool is_stop_asked = false;            ///< whether a rank has been asked to stop
  std::optional<FailedTurn> failure;     ///< the first failure, in the order of turns in a run of one process
  std::vector<CountersOfStep> counters;  ///< one for each step; empty if turns keep no counters
};

/// Combines the results of all ranks. If one rank has been asked to stop, all are told. All ranks call it.
AnswerOfSteps answer_of_all(Communicator& ranks, AnswerOfSteps const& own);

/// Takes steps on all ranks until the stop condition holds; between blocks of steps the root alone asks it whether to
/// continue. take(n) takes n steps, or fewer if one fails, adds the counts of all ranks to the counters, and returns
/// the same result on all ranks. All ranks call it. Returns the exception that the stop condition threw on the root,
/// and a RunFailure on other ranks; nullptr if it threw none.
template <class Stop, class Take>
std::exception_ptr take_steps_together(Communicator& ranks, Clock& clock, double time_step, Counters const& counters,
                                       Stop const& stop, Take take) {
  struct Look {
    enum class Answer : std::uint64_t { goes_on, stops, has_failed } answer = Answer::goes_on;
    std::uint64_t steps = 1;
  };
  auto const steps_until_stop = [&](std::uint64_t most) {
    // A run with a length in collisions must check after every step.
    if (stop.pair_collisions != Stop().pair_collisions) most = 1;
    Clock coming = clock;
    std::uint64_t steps = 0;
    for (; steps < most && !stop.is_reached(coming, 0); ++steps) {
      ++coming.step;
      coming.time += time_step;
    }
    return steps;
  };
  StepsBetweenLooks looks(ranks);
  std::exception_ptr thrown;
  Look look;
  while (look.answer == Look::Answer::goes_on && !stop.is_reached(clock, counters.pair_collisions)) {
    looks.begin();
    StepsTaken const taken = take(steps_until_stop(look.steps));
    for (std::uint64_t step = 0; step < taken.whole; ++step) {
      ++clock.step;
      clock.time += time_step;
    }
    if (taken.has_failed) break;
    looks.end(taken.whole);
    if (ranks.rank() == 0) {
      try {
        look = {.answer = stop.stops_here() ? Look::Answer::stops : Look::Answer::goes_on, .steps = looks.steps()};
      } catch (...) {
        thrown = std::current_exception();
        look.answer = Look::Answer::has_failed;
      }
    }
    look = MessageReader(broadcast(ranks, message_of(look))).next<Look>();
  }
  ranks.note_agreement(look.answer == Look::Answer::has_failed);
  if (look.answer == Look::Answer::has_failed && !thrown) {
    thrown = std::make_exception_ptr(RunFailure("rank 0 has failed between two steps"));
  }
  return thrown;
}

/// Gathers the traffic of all ranks on the root. All ranks call it.
inline void note_traffic_of_all(Communicator& ranks) {
  std::vector<Message> const traffic = gather(ranks, message_of(ranks.traffic()));
  for (std::size_t rank = 0; rank < traffic.size(); ++rank) {
    ranks.note_traffic(rank, MessageReader(traffic[rank]).next<Traffic>());
  }
}

}  // namespace gridlock
