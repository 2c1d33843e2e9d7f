#include "gridlock/core/detail/thread_pool.hpp"

#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <exception>
#include <limits>
#include <mutex>
#include <string>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

#include "core/resources.hpp"
#include "gridlock/core/error.hpp"

namespace gridlock {

namespace {

constexpr std::uint64_t max_threads = 1024;

/// Threads stay awake for this long: to fall asleep and wake takes some 50 µs, as long as a small round of work.
constexpr std::chrono::microseconds awake_for(100);

std::size_t number_of(std::uint64_t threads) {
  if (threads == 0) return usable_cores();
  return static_cast<std::size_t>(std::min(threads, max_threads));
}

/// Returns the number of usable cores, read once: reading it takes longer than starting the threads of a short job.
std::size_t cores_at_first() {
  static std::size_t const cores = usable_cores();
  return cores;
}

void pause() {
#if defined(__x86_64__)
  __builtin_ia32_pause();
#endif
}

}  // namespace

/// Parts are divided into ranges, one for each thread and always the same for the same number of parts, so that a
/// thread finds in its cache what it wrote before. A thread that has finished its range takes parts of others.
///
///     caller   open ── own range, others' ── close ── nobody inside? ── return
///     member        enter, is it open? ── own range, others' ── leave
///
/// A member enters before it reads whether the work is open, and the caller closes it before it reads who is inside: so
/// at least one of the two sees the other.
class ThreadPool::Crew {
 public:
  explicit Crew(std::size_t members) : ranges_(members + 1), stays_awake_(members < cores_at_first()) {
    members_.reserve(members);
    try {
      for (std::size_t k = 0; k < members; ++k) members_.emplace_back([this, k] { wait_for_work(k + 1); });
    } catch (std::system_error const& error) {
      dismiss();
      throw Error({.what = std::to_string(members + 1) + " threads cannot be started: after " +
                           std::to_string(members_.size() + 1) + " the system says \"" + error.code().message() + "\"",
                   .hint = "ask for fewer (engine.threads, -j), or have the limits on processes and memory raised",
                   .key = "engine.threads"});
    } catch (...) {
      dismiss();
      throw;
    }
  }
  ~Crew() { dismiss(); }
  Crew(Crew const&) = delete;
  Crew& operator=(Crew const&) = delete;

  void carry_out_all(std::size_t parts, std::function<void(std::size_t)> const& carry_out) {
    carry_out_ = &carry_out;
    for (std::size_t k = 0; k < ranges_.size(); ++k) {
      ranges_[k].next = parts * k / ranges_.size();
      ranges_[k].end = parts * (k + 1) / ranges_.size();
    }
    is_open_ = true;
    ++calls_;
    calls_.notify_all();
    take_parts(0);
    is_open_ = false;
    for (std::size_t inside = inside_; inside != 0; inside = inside_) wait_while(inside_, inside);
    failed_part_ = std::numeric_limits<std::size_t>::max();
    if (failure_) std::rethrow_exception(std::exchange(failure_, nullptr));
  }

 private:
  /// The next part and the end of a thread's range, on a cache line of its own, because every thread writes to its own.
  struct alignas(64) Range {
    std::atomic<std::size_t> next = 0;
    std::size_t end = 0;
  };

  void dismiss() {
    if (process_ != getpid()) {
      // After a fork the threads exist in the parent only. Joining them could join other threads of this process, to
      // which the system may give the same names. So they are not joined, and their memory is not freed.
      // cppcheck-suppress leakReturnValNotUsed
      static_cast<void>(new std::vector<std::thread>(std::move(members_)));
      return;
    }
    is_dismissed_ = true;
    ++calls_;
    calls_.notify_all();
    for (std::thread& member : members_) member.join();
  }

  void wait_for_work(std::size_t self) {
    std::uint64_t seen = 0;
    while (true) {
      wait_while(calls_, seen);
      // Read before is_dismissed_: a dismissal after this line is one more call, which the member then notices.
      seen = calls_;
      if (is_dismissed_) return;
      ++inside_;
      if (is_open_) take_parts(self);
      if (--inside_ == 0) inside_.notify_one();
    }
  }

  /// Waits until `number` differs from `known`.
  template <class Number>
  void wait_while(std::atomic<Number> const& number, Number known) const {
    if (stays_awake_) {
      auto const start = std::chrono::steady_clock::now();
      do {
        for (int n = 0; n < 50; ++n) {
          if (number != known) return;
          pause();
        }
      } while (std::chrono::steady_clock::now() - start < awake_for);
    }
    number.wait(known);
  }

  void take_parts(std::size_t self) {
    for (std::size_t k = 0; k < ranges_.size(); ++k) {
      Range& range = ranges_[(self + k) % ranges_.size()];
      for (std::size_t part = range.next++; part < range.end; part = range.next++) take(part);
    }
  }

  void take(std::size_t part) {
    try {
      (*carry_out_)(part);
    } catch (...) {
      std::scoped_lock const lock(failure_mutex_);
      if (part < failed_part_) {
        failed_part_ = part;
        failure_ = std::current_exception();
      }
    }
  }

  std::atomic<std::uint64_t> calls_ = 0;
  std::atomic<bool> is_open_ = false;
  std::atomic<bool> is_dismissed_ = false;
  std::atomic<std::size_t> inside_ = 0;  ///< number of members that may be working
  std::function<void(std::size_t)> const* carry_out_ = nullptr;
  std::vector<Range> ranges_;
  bool stays_awake_;  ///< false where threads share a core
  std::mutex failure_mutex_;
  std::size_t failed_part_ = std::numeric_limits<std::size_t>::max();
  std::exception_ptr failure_;
  pid_t process_ = getpid();
  std::vector<std::thread> members_;
};

ThreadPool::ThreadPool(std::uint64_t threads) : size_(number_of(threads)) {
  if (size_ > 1) crew_ = std::make_unique<Crew>(size_ - 1);
}

ThreadPool::~ThreadPool() = default;

void ThreadPool::for_each(std::size_t parts, std::function<void(std::size_t)> const& carry_out) {
  if (crew_ && parts > 1) {
    crew_->carry_out_all(parts, carry_out);
    return;
  }
  std::exception_ptr failure;
  for (std::size_t part = 0; part < parts; ++part) {
    try {
      carry_out(part);
    } catch (...) {
      if (!failure) failure = std::current_exception();
    }
  }
  if (failure) std::rethrow_exception(failure);
}

}  // namespace gridlock
