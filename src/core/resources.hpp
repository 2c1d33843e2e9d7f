#pragma once

#include <cstddef>
#include <filesystem>

namespace gridlock {

/// The cores and the memory that the operating system lets this process use. The one place that asks: cores and memory
/// of the whole machine are more than a job, a container or `taskset` grants.
///
/// Limits of control groups (cgroups, version 1 or 2) are those of the process's own group and of all groups around it,
/// by the files below `root`/proc and `root`/sys; a test puts its own there.

/// Cores that threads of this process can run on at the same time, at least 1: those of its affinity mask, and no more
/// than the processor time that its control groups grant, a part of a core counted as one.
/// Cost: some 50 µs, for files that are read anew every time.
std::size_t usable_cores(std::filesystem::path const& root = "/");

/// Processor time that the control groups grant, in cores (quota over period); infinite without a limit.
double granted_cores(std::filesystem::path const& root = "/");

/// Bytes that the control groups leave, where page cache that is not in use counts as free; infinite without a limit.
double granted_memory(std::filesystem::path const& root = "/");

}  // namespace gridlock
