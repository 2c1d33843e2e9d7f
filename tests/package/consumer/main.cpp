// The ten lines of C++ of the README, built against the installed package.
#include <cstdio>

#include "gridlock/run/simulate.hpp"

int main() {
  gridlock::Configuration configuration;
  configuration.disks = {.count = 100, .packing_fraction = 0.5, .start = gridlock::StartKind::triangular};
  configuration.run.steps = 200;
  gridlock::RunResult const result = gridlock::simulate(gridlock::set_up(configuration));
  std::printf("%llu collisions, state hash %016llx\n", static_cast<unsigned long long>(result.tally.pair_collisions),
              static_cast<unsigned long long>(gridlock::hash(result.state)));
  return result.ending == gridlock::Ending::finished && result.tally.pair_collisions > 0 ? 0 : 1;
}
