#pragma once

#include <tbb/task_arena.h>

#include "core/resources.hpp"

namespace gridlock {

/// Calls work(). Its parallel loops of oneTBB share the cores that this process may use, or those of the caller's arena
/// if these are fewer; oneTBB alone obeys the affinity mask, but not the limits of a container.
///
/// A thread that waits for the others takes no other work, such as another run of a sweep.
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
