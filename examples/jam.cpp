// Sixty-four soft disks of two sizes are quenched and decompressed to the packing fraction at which they jam.
#include <cstdio>

#include "gridlock/lattice/start.hpp"
#include "gridlock/protocol/protocol.hpp"

int main() {
  gridlock::DisksSettings const disks{.count = 64,
                                      .packing_fraction = 0.5,
                                      .start = gridlock::StartKind::uniform,
                                      .species = {{.fraction = 0.5}, {.fraction = 0.5, .size_ratio = 1.4}}};
  gridlock::State state = gridlock::make_start(gridlock::Box(1.0, 1.0, gridlock::Edge::periodic), disks, 1);
  gridlock::Protocol protocol(
      {.stages = {{.kind = "quench", .packing_fraction = 0.86}, {.kind = "decompress", .until_pressure = 1e-8}}},
      state);
  protocol.advance(state);
  for (gridlock::PressureLevel const& level : protocol.results().back().levels) {
    std::printf("packing fraction %.6f  pressure %.2e  contacts %.3f\n", level.packing_fraction, level.pressure,
                level.contact_number);
  }
  std::printf("jams at %.6f\n", *protocol.results().back().jamming_packing_fraction);
}
