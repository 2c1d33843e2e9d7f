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

/// On how many cores `threads` runs at a time are carried out; 0: all that the process may use. More threads than cores
/// would only wait for one another, and oneTBB would complain about it on the terminal.
inline int jobs_for(unsigned threads) {
  int const cores = static_cast<int>(usable_cores());
  return threads == 0 ? cores : std::min(static_cast<int>(threads), cores);
}

/// A pool of threads that carry out many runs, each taking the next longest one as soon as it is free.
///
/// The results do not depend on the number of threads, as long as carry_out(run) writes to places of its own.
class JobPool {
 public:
  using OnProgress = std::function<bool(double fraction, std::size_t finished)>;

  /// `work` of each run in any unit, for the order and the progress. on_progress is called from any thread, one call at
  /// a time; returning false lets no further run begin and makes report() return false.
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
            // While it waits for work of its own, it must not take up another run, which might wait for this one.
            tbb::this_task_arena::isolate([&] { carry_out(*run); });
            finish(*run);
          }
        });
      }
      group.wait();
    });
  }

  /// The longest run that nobody has taken; nothing where there is none, or no further one is to begin.
  [[nodiscard]] std::optional<std::size_t> take() {
    std::size_t const next = next_++;
    return next < order_.size() && !is_stopped_ ? std::optional(order_[next]) : std::nullopt;
  }

  /// Notes that a run has ended.
  void finish(std::size_t run) {
    ++finished_;
    report(run, 1.0);
  }

  [[nodiscard]] bool is_stopped() const { return is_stopped_; }

  /// Notes that this share of a run is done; says whether it should continue.
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
