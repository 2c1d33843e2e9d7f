// What a checkpoint may hold: the bytes of a file as they are, and as the content of a file whose checksum is right, which
// only a mistake of ours or an attack can produce. The first byte says which engine is restored.

#include "gridlock/io/checkpoint.hpp"

#include <xxhash.h>

#include <cstddef>
#include <cstdint>
#include <string>

#include "gridlock/core/error.hpp"
#include "gridlock/run/simulate.hpp"

namespace {

using namespace gridlock;

void restore(std::string const& bytes, char const* engine) {
  Configuration configuration;
  configuration.disks = {.count = 4, .packing_fraction = 0.3};
  configuration.engine.kind = engine;
  configuration.run.steps = 100;
  configuration.observe.pair_correlation_bins = 3;
  configuration.observe.speed_bins = 3;
  gridlock::Setup setup = set_up(configuration);
  RunPlan const plan = plan_of(setup);
  DiskSimulation simulation(std::move(setup));
  Run run(simulation, plan);
  try {
    from_checkpoint(bytes, "fuzz", [&](Archive& archive) { run.serialize(archive); });
    static_cast<void>(run.record());
  } catch (Error const&) {
  }
}

/// The bytes as the content of a checkpoint file.
std::string with_header(std::string const& content) {
  std::string bytes = to_checkpoint([](Archive&) {}).substr(0, 16);
  XXH128_canonical_t checksum;
  XXH128_canonicalFromHash(&checksum, XXH3_128bits(content.data(), content.size()));
  bytes.append(reinterpret_cast<char const*>(checksum.digest), sizeof checksum.digest);
  return bytes + content;
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
