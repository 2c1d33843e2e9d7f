#include "gridlock/core/thread_team.hpp"

#include <algorithm>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

namespace gridlock {

namespace {

constexpr std::uint64_t most_threads = 1024;

std::size_t number_of(std::uint64_t threads) {
  if (threads == 0) return std::max(1U, std::thread::hardware_concurrency());
  return static_cast<std::size_t>(std::min(threads, most_threads));
}

}  // namespace

/// Everything is guarded by one mutex: parts are chunks of work of many microseconds, so that nobody waits for it long.
class ThreadTeam::Crew {
 public:
  explicit Crew(std::size_t members) {
    for (std::size_t k = 0; k < members; ++k) members_.emplace_back([this] { wait_for_work(); });
  }
  ~Crew() {
    {
      std::scoped_lock const lock(mutex_);
      is_dismissed_ = true;
    }
    work_has_come_.notify_all();
    for (std::thread& member : members_) member.join();
  }
  Crew(Crew const&) = delete;
  Crew& operator=(Crew const&) = delete;

  void carry_out_all(std::size_t parts, std::function<void(std::size_t)> const& carry_out) {
    std::unique_lock lock(mutex_);
    carry_out_ = &carry_out;
    next_ = 0;
    end_ = parts;
    failed_part_ = parts;
    work_has_come_.notify_all();
    take_parts(lock);
    all_is_done_.wait(lock, [this] { return busy_ == 0; });
    end_ = 0;
    next_ = 0;
    if (failure_) std::rethrow_exception(std::exchange(failure_, nullptr));
  }

 private:
  void wait_for_work() {
    std::unique_lock lock(mutex_);
    while (true) {
      work_has_come_.wait(lock, [this] { return is_dismissed_ || next_ < end_; });
      if (is_dismissed_) return;
      take_parts(lock);
      if (busy_ == 0) all_is_done_.notify_one();
    }
  }

  void take_parts(std::unique_lock<std::mutex>& lock) {
    while (next_ < end_) {
      std::size_t const part = next_++;
      ++busy_;
      lock.unlock();
      std::exception_ptr failure;
      try {
        (*carry_out_)(part);
      } catch (...) {
        failure = std::current_exception();
      }
      lock.lock();
      --busy_;
      if (failure && part < failed_part_) {
        failed_part_ = part;
        failure_ = failure;
      }
    }
  }

  std::mutex mutex_;
  std::condition_variable work_has_come_;
  std::condition_variable all_is_done_;
  std::function<void(std::size_t)> const* carry_out_ = nullptr;
  std::size_t next_ = 0;
  std::size_t end_ = 0;
  std::size_t busy_ = 0;  ///< parts in work
  std::size_t failed_part_ = 0;
  std::exception_ptr failure_;
  bool is_dismissed_ = false;
  std::vector<std::thread> members_;
};

ThreadTeam::ThreadTeam(std::uint64_t threads) : size_(number_of(threads)) {
  if (size_ > 1) crew_ = std::make_unique<Crew>(size_ - 1);
}

ThreadTeam::~ThreadTeam() = default;

void ThreadTeam::for_each(std::size_t parts, std::function<void(std::size_t)> const& carry_out) {
  if (!crew_ || parts < 2) {
    for (std::size_t part = 0; part < parts; ++part) carry_out(part);
    return;
  }
  crew_->carry_out_all(parts, carry_out);
}

}  // namespace gridlock
