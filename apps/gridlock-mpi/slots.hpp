#pragma once

#include <atomic>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "workspace/sweep_crew.hpp"

namespace gridlock::mpi {

/// Threads that carry out runs, so that the main thread can exchange messages with other ranks meanwhile.
class Slots {
 public:
  struct Done {
    std::uint64_t run;
    std::string outcome;
  };
  struct Share {
    std::uint64_t run;
    double share;
  };

  Slots(std::size_t count, MakeRun make);
  /// Waits for the end of current runs.
  ~Slots();
  Slots(Slots const&) = delete;
  Slots& operator=(Slots const&) = delete;

  [[nodiscard]] std::size_t count() const { return threads_.size(); }
  void give(CrewJob const& job);
  /// Returns a run that has ended, once for each run; nothing if there is none.
  std::optional<Done> take_done();
  /// Returns the finished fractions of current runs.
  [[nodiscard]] std::vector<Share> shares();
  /// Makes runs stop after their current chunk.
  void stop() { is_stopped_ = true; }

 private:
  void work();

  MakeRun make_;
  std::mutex mutex_;
  std::condition_variable is_changed_;
  std::deque<CrewJob> jobs_;
  std::deque<Done> done_;
  std::vector<Share> shares_;
  bool is_closed_ = false;
  std::atomic<bool> is_stopped_ = false;
  std::vector<std::thread> threads_;
};

}  // namespace gridlock::mpi
