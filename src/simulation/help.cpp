#include "simulation/help.hpp"

#include "simulation/divided_simulation.hpp"

namespace gridlock {

void help(Communicator& ranks) {
  do_or_abandon(ranks, [&] {
    RunHelper run(ranks);
    while (true) {
      Message const bytes = ranks.receive(0);
      MessageReader message(bytes);
      auto const task = message.next<TaskOfRanks>();
      if (task == TaskOfRanks::leave) return;
      run.carry_out(task, message);
    }
  });
}

}  // namespace gridlock
