#include "simulation/help.hpp"

#include <fmt/format.h>

#include <string>

#include "engine/tiled/on_ranks.hpp"
#include "gridlock/core/error.hpp"
#include "gridlock/simulation/detail/model_kind.hpp"

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
    State own{.box = Box(1.0, 1.0, Edge::wall)};
    while (true) {
      Ranks::Bytes const bytes = ranks.receive(0);
      MessageReader message(bytes);
      switch (message.next<TaskOfRanks>()) {
        case TaskOfRanks::steps_of_disks:
          tiled::take_part(ranks, message, own);
          break;
        case TaskOfRanks::steps_of_model:
          take_part_in_model(ranks, message);
          break;
        case TaskOfRanks::leave:
          return;
      }
    }
  });
}

}  // namespace gridlock
