// What a checkpoint may hold: the bytes of a file as they are, and as the content of a file whose checksum is right,
// which only a mistake of ours or an attack can produce. The first byte says which engine is restored.

#include "io/checkpoint.hpp"

#include <cstddef>
#include <cstdint>
#include <string>

#include "checkpoint_header.hpp"
#include "gridlock/core/error.hpp"
#include "gridlock/simulation/simulate.hpp"

namespace {

using namespace gridlock;
using gridlock::test::with_header;

void restore(std::string const& bytes, char const* engine) {
  Configuration configuration;
  configuration.disks = {.count = 4, .packing_fraction = 0.3};
  configuration.engine.kind = engine;
  configuration.run.steps = 100;
  configuration.observe.pair_correlation_bins = 3;
  configuration.observe.speed_bins = 3;
  gridlock::Setup setup = set_up(configuration);
  RunPlan const plan = plan_of(setup);
  Simulation& simulation = *setup.simulation;
  Run run(simulation, plan);
  try {
    from_checkpoint(bytes, "fuzz", [&](Archive& archive) { run.serialize(archive); });
    static_cast<void>(run.record());
  } catch (Error const&) {
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(std::uint8_t const* data, std::size_t size) {
  if (size == 0) return 0;
  std::string const content(reinterpret_cast<char const*>(data) + 1, size - 1);
  char const* const engine = data[0] % 2 == 0 ? "stepped" : "exact";
  restore(content, engine);
  restore(with_header(content), engine);
  return 0;
}
