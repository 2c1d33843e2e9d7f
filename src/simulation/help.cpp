#include "simulation/help.hpp"

#include <fmt/format.h>

#include <string>

#include "gridlock/core/error.hpp"
#include "gridlock/simulation/detail/model_kind.hpp"
#include "simulation/divided_simulation.hpp"

namespace gridlock {

namespace {

void take_part_in_model(Ranks& ranks, MessageReader& message) {
  std::string const name = message.next_text();
  ModelKinds const kinds = known_models();
  ModelKind const* const kind = kinds.find(name);
  if (kind == nullptr) throw RunFailure(fmt::format("this rank knows no model {}: all must be the same program", name));
  kind->take_part(ranks, message);
}

}  // namespace

void help(Ranks& ranks) {
  do_or_abandon(ranks, [&] {
    RunHelper run(ranks);
    while (true) {
      Ranks::Bytes const bytes = ranks.receive(0);
      MessageReader message(bytes);
      auto const task = message.next<TaskOfRanks>();
      if (task == TaskOfRanks::leave) return;
      if (task == TaskOfRanks::steps_of_model) {
        take_part_in_model(ranks, message);
      } else {
        run.carry_out(task, message);
      }
    }
  });
}

}  // namespace gridlock
