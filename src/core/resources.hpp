#pragma once

#include <cstddef>
#include <filesystem>

namespace gridlock {

/// The cores and the memory that the operating system grants this process. Other code must not ask for them itself: the
/// whole machine has more than a job, a container or `taskset` grants.
///
/// Limits of control groups (cgroups, version 1 or 2) are those of the process's group and of all groups around it,
/// read from `root`/proc and `root`/sys; a test passes a root of its own.

/// Returns the number of cores on which threads of this process can run at the same time, at least 1. It is that of the
/// affinity mask, at most the processor time that control groups grant, rounded up to whole cores.
/// Cost: some 50 µs, because files are read at every call.
std::size_t usable_cores(std::filesystem::path const& root = "/");

/// Returns the processor time that control groups grant, in cores (quota over period); infinite without a limit.
double granted_cores(std::filesystem::path const& root = "/");

/// Returns the bytes that control groups leave; unused page cache counts as free. Infinite without a limit.
double granted_memory(std::filesystem::path const& root = "/");

}  // namespace gridlock
