#include "gridlock/parallel/detail/agreement.hpp"

#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "gridlock/core/detail/message.hpp"
#include "gridlock/core/error.hpp"
#include "gridlock/parallel/detail/collectives.hpp"

namespace gridlock {

namespace {

/// What is wrong, in a message; places in files are not known yet.
Message message_of_problems(std::optional<Error> const& error) {
  MessageWriter message;
  if (!error) return message.take();
  for (Problem const& problem : error->problems()) {
    for (std::string const& text : {problem.what, problem.hint, problem.key}) message.add_text(text);
  }
  return message.take();
}

}  // namespace

void agree_on_errors(Communicator& ranks, std::function<void()> const& work) {
  std::optional<Error> error;
  try {
    work();
  } catch (Error const& refused) {
    error = refused;
  }
  for (Message const& bytes : all_gather(ranks, message_of_problems(error))) {
    MessageReader message(bytes);
    std::vector<Problem> problems;
    while (!message.is_at_end()) {
      Problem problem;
      for (std::string* text : {&problem.what, &problem.hint, &problem.key}) *text = message.next_text();
      problems.push_back(std::move(problem));
    }
    if (!problems.empty()) throw Error(std::move(problems));
  }
}

std::string first_text_of_all(Communicator& ranks, std::string const& text) {
  for (Message const& bytes : all_gather(ranks, message_of_all(std::span<char const>(text)))) {
    if (!bytes.empty()) return {reinterpret_cast<char const*>(bytes.data()), bytes.size()};
  }
  return {};
}

}  // namespace gridlock
