#include "core/resources.hpp"

#include <gtest/gtest.h>
#include <sched.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>
#include <thread>

#include "gridlock/core/detail/thread_pool.hpp"
#include "unit/io/temporary_directory.hpp"

namespace gridlock {
namespace {

/// A file system of a container.
class Container {
 public:
  void write(std::string const& file, std::string const& text) const {
    std::filesystem::path const path = root() / file;
    std::filesystem::create_directories(path.parent_path());
    std::ofstream(path) << text;
  }
  [[nodiscard]] std::filesystem::path root() const { return directory_.path(); }

 private:
  TemporaryDirectory directory_;
};

TEST(Resources, WithoutControlGroupsHaveNoLimitButTheMachine) {
  Container const container;
  EXPECT_TRUE(std::isinf(granted_cores(container.root())));
  EXPECT_TRUE(std::isinf(granted_memory(container.root())));
  EXPECT_GE(usable_cores(container.root()), 1U);
}

TEST(Resources, OfVersion2AreTheLeastOfAllGroupsAroundTheProcess) {
  Container const container;
  container.write("proc/self/cgroup", "0::/jobs/mine\n");
  container.write("sys/fs/cgroup/jobs/mine/cpu.max", "max 100000\n");
  container.write("sys/fs/cgroup/jobs/cpu.max", "150000 100000\n");
  container.write("sys/fs/cgroup/cpu.max", "800000 100000\n");
  EXPECT_EQ(granted_cores(container.root()), 1.5);
  container.write("sys/fs/cgroup/jobs/mine/cpu.max", "20000 100000\n");
  EXPECT_EQ(granted_cores(container.root()), 0.2);
  EXPECT_EQ(usable_cores(container.root()), 1U) << "a part of a core counts as one";
}

TEST(Resources, OfVersion2LeaveTheMemoryThatIsNotInUse) {
  Container const container;
  container.write("proc/self/cgroup", "0::/\n");
  container.write("sys/fs/cgroup/memory.max", "1000000\n");
  container.write("sys/fs/cgroup/memory.current", "700000\n");
  container.write("sys/fs/cgroup/memory.stat", "anon 300000\nfile 400000\nactive_file 50000\ninactive_file 350000\n");
  EXPECT_EQ(granted_memory(container.root()), 650000.0);
  container.write("sys/fs/cgroup/memory.max", "max\n");
  EXPECT_TRUE(std::isinf(granted_memory(container.root())));
}

TEST(Resources, OfVersion1StandWithTheirControllers) {
  Container const container;
  container.write("proc/self/cgroup", "5:memory:/docker/1\n4:cpu,cpuacct:/docker/1\n3:cpuset:/\n0::/\n");
  // A container sees its own group at the mount.
  container.write("sys/fs/cgroup/cpu,cpuacct/cpu.cfs_quota_us", "300000\n");
  container.write("sys/fs/cgroup/cpu,cpuacct/cpu.cfs_period_us", "100000\n");
  container.write("sys/fs/cgroup/memory/docker/1/memory.limit_in_bytes", "5000\n");
  container.write("sys/fs/cgroup/memory/docker/1/memory.usage_in_bytes", "4000\n");
  container.write("sys/fs/cgroup/memory/docker/1/memory.stat",
                  "cache 3000\ninactive_file 1\ntotal_inactive_file 500\n");
  container.write("sys/fs/cgroup/memory/memory.limit_in_bytes", "9223372036854771712\n");
  EXPECT_EQ(granted_cores(container.root()), 3.0);
  EXPECT_EQ(granted_memory(container.root()), 1500.0);
  container.write("sys/fs/cgroup/cpu,cpuacct/cpu.cfs_quota_us", "-1\n");
  EXPECT_TRUE(std::isinf(granted_cores(container.root())));
}

TEST(Resources, ThatAreSpentAreNoLessThanNothing) {
  Container const container;
  container.write("proc/self/cgroup", "0::/\n");
  container.write("sys/fs/cgroup/memory.max", "1000\n");
  container.write("sys/fs/cgroup/memory.current", "1200\n");
  EXPECT_EQ(granted_memory(container.root()), 0.0);
}

TEST(UsableCores, FollowTheAffinityMaskSoThatAThreadPoolHasNoMoreThreads) {
  // In a thread of its own, which takes the mask with it when it ends.
  std::size_t cores = 0;
  std::size_t pool_size = 0;
  std::thread([&] {
    cpu_set_t mask;
    ASSERT_EQ(sched_getaffinity(0, sizeof mask, &mask), 0);
    int first = 0;
    while (!CPU_ISSET(first, &mask)) ++first;
    CPU_ZERO(&mask);
    CPU_SET(first, &mask);
    ASSERT_EQ(sched_setaffinity(0, sizeof mask, &mask), 0);
    cores = usable_cores();
    pool_size = ThreadPool(0).size();
  }).join();
  EXPECT_EQ(cores, 1U);
  EXPECT_EQ(pool_size, 1U);
}

}  // namespace
}  // namespace gridlock
