// A hundred hard disks in a walled box: 200 steps of the paper's rule.
#include <cstdio>

#include "gridlock/simulation/simulate.hpp"

int main() {
  gridlock::Configuration configuration;
  configuration.disks = {.count = 100, .packing_fraction = 0.5, .start = gridlock::StartKind::triangular};
  configuration.run.steps = 200;
  gridlock::RunResult const result = gridlock::simulate(gridlock::set_up(configuration));
  std::printf("%zu samples, state hash %016llx\n", result.series.row_count(),
              static_cast<unsigned long long>(gridlock::hash(result.world)));
}
