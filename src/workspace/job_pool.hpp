#pragma once

#include <tbb/task_arena.h>
#include <tbb/task_group.h>

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <functional>
#include <mutex>
#include <numeric>
#include <optional>
#include <utility>
#include <vector>

#include "core/resources.hpp"

namespace gridlock {

/// Returns the number of cores for `threads` simultaneous runs; 0 means all available cores. More threads than cores
/// would only wait, and oneTBB would print a warning.
inline int jobs_for(unsigned threads) {
  int const cores = static_cast<int>(usable_cores());
  return threads == 0 ? cores : std::min(static_cast<int>(threads), cores);
}

/// A pool of threads that carry out runs; each free thread takes the longest run that is left.
///
/// Results do not depend on the number of threads if each call of carry_out(run) writes only to its own data.
class JobPool {
 public:
  using OnProgress = std::function<bool(double fraction, std::size_t finished)>;

  /// `work` is the work of each run in any unit, for order and progress. Any thread may call on_progress, but only one
  /// at a time; if it returns false, no further run begins and report() returns false.
  JobPool(std::vector<double> work, OnProgress on_progress)
      : work_(std::move(work)), done_(work_.size(), 0.0), on_progress_(std::move(on_progress)) {
    order_.resize(work_.size());
    std::iota(order_.begin(), order_.end(), std::size_t{0});
    std::ranges::stable_sort(order_, std::ranges::greater{}, [&](std::size_t run) { return work_[run]; });
    all_work_ = std::accumulate(work_.begin(), work_.end(), 0.0);
  }

  /// Calls carry_out(run) for every run, on `threads` cores (0: all).
  template <class CarryOut>
  void run_all(unsigned threads, CarryOut carry_out) {
    tbb::task_arena arena(jobs_for(threads));
    arena.execute([&] {
      tbb::task_group group;
      for (int member = 0; member < arena.max_concurrency(); ++member) {
        group.run([&] {
          while (auto const run = take()) {
            // A thread that waits within a run must not start another run, which might wait for the first.
            tbb::this_task_arena::isolate([&] { carry_out(*run); });
            finish(*run);
          }
        });
      }
      group.wait();
    });
  }

  /// Returns the longest run not yet taken; nothing if none is left or the pool is stopped.
  [[nodiscard]] std::optional<std::size_t> take() {
    std::size_t const next = next_++;
    return next < order_.size() && !is_stopped_ ? std::optional(order_[next]) : std::nullopt;
  }

  /// Records that a run has ended.
  void finish(std::size_t run) {
    ++finished_;
    report(run, 1.0);
  }

  [[nodiscard]] bool is_stopped() const { return is_stopped_; }

  /// Records the finished fraction of a run; returns whether to continue.
  bool report(std::size_t run, double share) {
    std::scoped_lock const lock(mutex_);
    done_[run] = work_[run] * share;
    if (on_progress_ && !is_stopped_) {
      double const done = std::accumulate(done_.begin(), done_.end(), 0.0);
      if (!on_progress_(all_work_ > 0.0 ? done / all_work_ : 1.0, finished_)) is_stopped_ = true;
    }
    return !is_stopped_;
  }

 private:
  std::vector<double> work_;
  std::vector<double> done_;
  std::vector<std::size_t> order_;
  OnProgress on_progress_;
  double all_work_ = 0.0;
  std::atomic<std::size_t> next_ = 0;
  std::atomic<std::size_t> finished_ = 0;
  std::atomic<bool> is_stopped_ = false;
  std::mutex mutex_;
};

}  // namespace gridlock
