#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>

namespace gridlock {

/// Threads that wait for work together and share it out, part by part.
///
/// Plain threads of the standard library, so that ThreadSanitizer sees all of what they do. More threads than cores are
/// allowed: bits can be compared on any machine.
class ThreadPool {
 public:
  /// 0: one for each core. The calling thread is one of them.
  /// Errors: Error where the system starts no more threads.
  explicit ThreadPool(std::uint64_t threads);
  ~ThreadPool();
  ThreadPool(ThreadPool const&) = delete;
  ThreadPool& operator=(ThreadPool const&) = delete;

  [[nodiscard]] std::size_t size() const { return size_; }

  /// Calls carry_out(part) once for every part below `parts`, from any thread, and returns when all are done.
  /// Errors: the exception of the lowest part that threw one is thrown on, when all others are done too, whatever the
  /// number of threads.
  void for_each(std::size_t parts, std::function<void(std::size_t)> const& carry_out);

 private:
  class Crew;
  std::size_t size_;
  std::unique_ptr<Crew> crew_;  ///< the other threads; none in a pool of one
};

}  // namespace gridlock
