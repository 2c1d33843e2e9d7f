#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>

namespace gridlock {

/// A fixed number of threads that share work, part by part.
///
/// The threads are std::thread, which ThreadSanitizer can check. More threads than cores are allowed, so that tests
/// compare the bits for any number of threads on any machine.
class ThreadPool {
 public:
  /// Starts threads − 1 threads; the calling thread is the last one. `threads` = 0 means one thread for each core.
  /// Errors: Error if the system cannot start the threads.
  explicit ThreadPool(std::uint64_t threads);
  ~ThreadPool();
  ThreadPool(ThreadPool const&) = delete;
  ThreadPool& operator=(ThreadPool const&) = delete;

  [[nodiscard]] std::size_t size() const { return size_; }

  /// Calls carry_out(part) once for every part below `parts`, from any thread, and returns when all calls have ended.
  /// Errors: if calls throw, all parts are still done, and then the exception of the lowest part is thrown.
  void for_each(std::size_t parts, std::function<void(std::size_t)> const& carry_out);

 private:
  class Crew;
  std::size_t size_;
  std::unique_ptr<Crew> crew_;  ///< the threads besides the calling one; nullptr if there are none
};

}  // namespace gridlock
