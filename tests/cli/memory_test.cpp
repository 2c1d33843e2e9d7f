#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>

#include <string>
#include <vector>

#include "program.hpp"

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define GRIDLOCK_IS_SANITIZED 1
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#define GRIDLOCK_IS_SANITIZED 1
#endif
#endif

namespace gridlock::test {
namespace {

constexpr int disks = 300'000;

/// The most memory, in bytes a disk, that a run held in a process of its own.
double max_bytes_per_disk(std::string const& engine, std::vector<std::string> const& more) {
  Workplace const workplace;
  std::vector<std::string> arguments{"run",     std::string(GRIDLOCK_SOURCE_DIR) + "/scenes/paper.toml",
                                     "--quiet", "--no-pictures",
                                     "-o",      "run",
                                     "--set",   "engine.kind=" + engine,
                                     "--set",   "disks.count=" + std::to_string(disks),
                                     "--set",   "run.steps=2",
                                     "--set",   "observe.every=2"};
  arguments.insert(arguments.end(), more.begin(), more.end());
  rusage usage{};
  Outcome const outcome = Process(GRIDLOCK_PROGRAM, arguments, workplace.path()).wait(&usage);
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  return 1024.0 * static_cast<double>(usage.ru_maxrss) / disks;
}

// docs/reference/performance.md has what a run of a million disks takes. Of these, the program and pages not full take
// about 100 bytes each. A second copy of the state, or of a checkpoint, is more than the room that is left.
TEST(Memory, OfARunStaysBelowWhatItsPartsNeed) {
#ifdef GRIDLOCK_IS_SANITIZED
  GTEST_SKIP() << "a sanitizer takes memory of its own";
#endif
  EXPECT_LT(max_bytes_per_disk("tiled", {"--set", "checkpoint.every_seconds=0", "--set", "checkpoint.keep_last=false"}),
            380.0);
  EXPECT_LT(max_bytes_per_disk("tiled", {"--set", "checkpoint.every_steps=1"}), 420.0);
  EXPECT_LT(max_bytes_per_disk("exact", {"--set", "checkpoint.every_steps=1"}), 700.0);
}

}  // namespace
}  // namespace gridlock::test
