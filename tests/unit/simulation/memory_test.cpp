#include "simulation/memory.hpp"

#include <gtest/gtest.h>

namespace gridlock {
namespace {

double bytes_per_disk(char const* engine, double seconds_between_checkpoints, bool keeps_last = false,
                      std::uint64_t threads = 1) {
  Configuration configuration;
  configuration.disks.count = 1'000'000;
  configuration.run.steps = 0;
  configuration.engine.kind = engine;
  configuration.checkpoint.every_seconds = seconds_between_checkpoints;
  configuration.checkpoint.keep_last = keeps_last;
  configuration.engine.threads = threads;
  return expected_memory(configuration) / 1e6;
}

TEST(ExpectedMemory, CountsTheCheckpointsOfEachEngine) {
  EXPECT_DOUBLE_EQ(bytes_per_disk("tiled", 0.0), 232.0);
  EXPECT_DOUBLE_EQ(bytes_per_disk("tiled", 60.0), 251.0);
  EXPECT_DOUBLE_EQ(bytes_per_disk("tiled", 0.0, true), 251.0) << "the last one is kept";
  EXPECT_DOUBLE_EQ(bytes_per_disk("stepped", 60.0), 223.0);
  EXPECT_GT(bytes_per_disk("exact", 60.0), bytes_per_disk("exact", 0.0) + 100.0);
  EXPECT_DOUBLE_EQ(bytes_per_disk("exact", 0.0, false, 2), bytes_per_disk("exact", 0.0) + 310.0);
}

}  // namespace
}  // namespace gridlock
