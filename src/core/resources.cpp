#include "core/resources.hpp"

#if defined(__linux__)
#include <sched.h>
#endif

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <fstream>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

namespace gridlock {

namespace {

namespace fs = std::filesystem;

constexpr double without_limit = std::numeric_limits<double>::infinity();
/// Version 1 of cgroups writes "no limit" as the largest multiple of a page in 63 bits.
constexpr double more_than_any_memory = 0x1p60;

bool is_listed(std::string_view controllers, std::string_view controller) {
  while (!controllers.empty()) {
    std::size_t const comma = controllers.find(',');
    if (controllers.substr(0, comma) == controller) return true;
    controllers.remove_prefix(comma == std::string_view::npos ? controllers.size() : comma + 1);
  }
  return false;
}

/// Adds the directories of `group` below a mount and of all groups around it.
void add_groups(fs::path const& mount, fs::path const& group, std::vector<fs::path>& groups) {
  fs::path inner = fs::path("/" / group).lexically_normal().relative_path();
  for (; !inner.empty(); inner = inner.parent_path()) groups.push_back(mount / inner);
  groups.push_back(mount);
}

/// Returns directories that may hold limits of a controller. A line of the file is "number:controllers:group"; version
/// 2 names no controllers. In a container the mount may begin at the group: then only the outer directories exist.
std::vector<fs::path> groups_with(std::string_view controller, fs::path const& root) {
  fs::path const mounts = root / "sys/fs/cgroup";
  std::vector<fs::path> groups;
  std::ifstream file(root / "proc/self/cgroup");
  for (std::string line; std::getline(file, line);) {
    std::size_t const first = line.find(':');
    std::size_t const second = first == std::string::npos ? first : line.find(':', first + 1);
    if (second == std::string::npos) continue;
    std::string const controllers = line.substr(first + 1, second - first - 1);
    std::string const group = line.substr(second + 1);
    if (controllers.empty()) {
      add_groups(mounts, group, groups);
      add_groups(mounts / "unified", group, groups);
    } else if (is_listed(controllers, controller)) {
      add_groups(mounts / controllers, group, groups);
      add_groups(mounts / controller, group, groups);
    }
  }
  return groups;
}

/// Returns the numbers at the start of a file; none where the file is missing or begins with a word, such as "max".
std::vector<double> numbers_in(fs::path const& path) {
  std::ifstream file(path);
  std::vector<double> numbers;
  for (double number = 0.0; file >> number;) numbers.push_back(number);
  return numbers;
}

std::optional<double> number_in(fs::path const& path) {
  std::vector<double> const numbers = numbers_in(path);
  return numbers.empty() ? std::nullopt : std::optional(numbers.front());
}

/// Returns the number after a name in a file of lines "name number".
double entry_of(fs::path const& path, std::string_view name) {
  std::ifstream file(path);
  double number = 0.0;
  for (std::string word; file >> word >> number;) {
    if (word == name) return number;
  }
  return 0.0;
}

/// Returns the bytes left below a limit; infinite where the files are missing or set none.
double left_of(fs::path const& limit, fs::path const& used, fs::path const& statistics, std::string_view unused_cache) {
  auto const most = number_in(limit);
  if (!most || *most >= more_than_any_memory) return without_limit;
  double const in_use = number_in(used).value_or(0.0) - entry_of(statistics, unused_cache);
  return std::max(0.0, *most - std::max(0.0, in_use));
}

/// Returns the number of cores in the calling thread's affinity mask; nothing where the system does not report it.
std::optional<std::size_t> cores_of_mask() {
#if defined(__linux__)
  // The kernel refuses a mask with bits for fewer cores than it knows.
  for (std::size_t room = 1024; room <= 1U << 20U; room *= 2) {
    std::unique_ptr<cpu_set_t, void (*)(cpu_set_t*)> const mask(CPU_ALLOC(room), [](cpu_set_t* m) { CPU_FREE(m); });
    if (!mask) return std::nullopt;
    if (sched_getaffinity(0, CPU_ALLOC_SIZE(room), mask.get()) == 0) {
      return static_cast<std::size_t>(CPU_COUNT_S(CPU_ALLOC_SIZE(room), mask.get()));
    }
    if (errno != EINVAL) break;
  }
#endif
  return std::nullopt;
}

}  // namespace

double granted_cores(fs::path const& root) {
  double cores = without_limit;
  for (fs::path const& group : groups_with("cpu", root)) {
    std::vector<double> quota = numbers_in(group / "cpu.max");
    if (quota.empty()) {
      auto const of_version_1 = number_in(group / "cpu.cfs_quota_us");
      auto const period = number_in(group / "cpu.cfs_period_us");
      if (of_version_1 && period) quota = {*of_version_1, *period};
    }
    // Version 1 writes −1 for no limit.
    if (quota.size() == 2 && quota[0] > 0.0 && quota[1] > 0.0) cores = std::min(cores, quota[0] / quota[1]);
  }
  return cores;
}

std::size_t usable_cores(fs::path const& root) {
  std::size_t const cores = cores_of_mask().value_or(std::thread::hardware_concurrency());
  double const granted = std::ceil(granted_cores(root));
  return std::max<std::size_t>(1, granted < static_cast<double>(cores) ? static_cast<std::size_t>(granted) : cores);
}

double granted_memory(fs::path const& root) {
  double bytes = without_limit;
  for (fs::path const& group : groups_with("memory", root)) {
    bytes = std::min({bytes,
                      left_of(group / "memory.max", group / "memory.current", group / "memory.stat", "inactive_file"),
                      left_of(group / "memory.limit_in_bytes", group / "memory.usage_in_bytes", group / "memory.stat",
                              "total_inactive_file")});
  }
  return bytes;
}

}  // namespace gridlock
