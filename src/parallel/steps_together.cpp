#include "gridlock/parallel/detail/steps_together.hpp"

#include <tuple>

namespace gridlock {

namespace {

Message message_of_answer(AnswerOfSteps const& answer) {
  MessageWriter message;
  message.add(answer.is_stop_asked);
  message.add(answer.failure.has_value());
  if (answer.failure) {
    message.add(answer.failure->cell);
    message.add(answer.failure->agent);
    message.add_text(answer.failure->reason);
  }
  for (CountersOfStep const& of_step : answer.counters) of_step.write(message);
  return message.take();
}

AnswerOfSteps answer_in(Message const& bytes) {
  MessageReader message(bytes);
  AnswerOfSteps answer{.is_stop_asked = message.next<bool>(), .failure = {}, .counters = {}};
  if (message.next<bool>()) {
    FailedTurn& failure = answer.failure.emplace();
    failure.cell = message.next<std::uint64_t>();
    failure.agent = message.next<Id>();
    failure.reason = message.next_text();
  }
  while (!message.is_at_end()) answer.counters.push_back(CountersOfStep::read(message));
  return answer;
}

void add(AnswerOfSteps& answer, AnswerOfSteps const& others) {
  auto const place_of = [](FailedTurn const& failure) { return std::tuple(failure.cell, failure.agent); };
  answer.is_stop_asked = answer.is_stop_asked || others.is_stop_asked;
  bool const is_earlier = others.failure && answer.failure && place_of(*others.failure) < place_of(*answer.failure);
  if (others.failure && (!answer.failure || is_earlier)) answer.failure = others.failure;
  for (std::size_t step = 0; step < answer.counters.size(); ++step) answer.counters[step].add(others.counters[step]);
}

}  // namespace

AnswerOfSteps answer_of_all(Communicator& ranks, AnswerOfSteps const& own) {
  AnswerOfSteps all =
      answer_in(all_reduce(ranks, message_of_answer(own), [](Message const& left, Message const& right) {
        AnswerOfSteps answer = answer_in(left);
        add(answer, answer_in(right));
        return message_of_answer(answer);
      }));
  if (all.is_stop_asked) ranks.ask_to_stop();
  return all;
}

}  // namespace gridlock
