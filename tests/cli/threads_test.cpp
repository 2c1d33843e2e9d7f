// How many threads the program uses where it may not use the whole machine.
#include <gtest/gtest.h>
#include <sched.h>

#include <string>
#include <vector>

#include "cli/program.hpp"

namespace {

using namespace gridlock::test;

std::string a_core_of_ours() {
  cpu_set_t mask;
  CPU_ZERO(&mask);
  sched_getaffinity(0, sizeof mask, &mask);
  int core = 0;
  while (core < CPU_SETSIZE - 1 && !CPU_ISSET(core, &mask)) ++core;
  return std::to_string(core);
}

Outcome on_one_core(std::vector<std::string> arguments, fs::path const& directory) {
  arguments.insert(arguments.begin(), {"-c", a_core_of_ours(), GRIDLOCK_PROGRAM});
  return Process("taskset", arguments, directory).wait();
}

constexpr char const* tiled = "disks.count = 100\nrun.steps = 20\nengine.kind = \"tiled\"\n";

TEST(Threads, OfARunAreAsManyAsTheCoresOfItsMask) {
  Workplace const workplace;
  write(workplace / "t.toml", tiled);
  Outcome const run = on_one_core({"run", "t.toml", "-o", "out", "--no-pictures"}, workplace.path());
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_NE(text_of(workplace / "out/run.log").find("on 1 thread\n"), std::string::npos)
      << text_of(workplace / "out/run.log");
  Outcome const more =
      on_one_core({"run", "t.toml", "-o", "more", "--no-pictures", "--set", "engine.threads=3"}, workplace.path());
  EXPECT_NE(text_of(workplace / "more/run.log").find("on 3 threads\n"), std::string::npos) << more.err;
}

TEST(Threads, OfASweepAreAsManyAsTheCoresOfItsMask) {
  Workplace const workplace;
  write(workplace / "t.toml", std::string(tiled) + "[sweep]\nrun.seed = [1]\n");
  Outcome const sweep = on_one_core({"sweep", "t.toml", "-o", "out"}, workplace.path());
  ASSERT_EQ(sweep.exit_code, 0) << sweep.err;
  EXPECT_NE(text_of(workplace / "out/runs/seed=1/config.resolved.toml").find("threads = 1\n"), std::string::npos);
}

}  // namespace
