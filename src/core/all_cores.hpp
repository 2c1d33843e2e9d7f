#pragma once

#include <tbb/task_arena.h>

#include "core/resources.hpp"

namespace gridlock {

/// Calls work(), whose parallel loops of oneTBB then share the cores that this process may use, or those of the arena
/// that the caller is in where these are fewer. oneTBB by itself follows the affinity mask, but no limit of a
/// container.
///
/// A thread that waits for the others takes up no work from outside, such as another run of a sweep.
template <class Work>
void on_all_cores(Work const& work) {
  int const cores = static_cast<int>(usable_cores());
  if (tbb::this_task_arena::max_concurrency() <= cores) {
    tbb::this_task_arena::isolate(work);
  } else {
    tbb::task_arena(cores).execute(work);
  }
}

}  // namespace gridlock
