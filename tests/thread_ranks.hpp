#pragma once

#include <chrono>
#include <condition_variable>
#include <deque>
#include <exception>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "gridlock/core/detail/message.hpp"
#include "gridlock/parallel/communicator.hpp"
#include "gridlock/parallel/detail/tasks.hpp"
#include "simulation/help.hpp"

namespace gridlock::test {

/// Ranks that are threads of one process.
class ThreadRanks {
 public:
  explicit ThreadRanks(std::size_t count) : count_(count) {}

  /// Calls lead(ranks) for rank 0, while the others help.
  void run(std::function<void(Communicator&)> const& lead) {
    std::vector<std::thread> threads;
    for (std::size_t rank = 1; rank < count_; ++rank) {
      threads.emplace_back([this, rank] {
        OneRank helper(*this, rank);
        help(helper);
      });
    }
    OneRank leader(*this, 0);
    std::exception_ptr failure;
    try {
      lead(leader);
    } catch (...) {
      failure = std::current_exception();
    }
    release_helpers(leader);
    for (std::thread& thread : threads) thread.join();
    if (failure) std::rethrow_exception(failure);
  }

  /// Calls work(ranks) for every rank. An exception of one ends the program.
  void run_on_all(std::function<void(Communicator&)> const& work) {
    std::vector<std::thread> threads;
    for (std::size_t rank = 0; rank < count_; ++rank) {
      threads.emplace_back([this, rank, &work] {
        OneRank here(*this, rank);
        work(here);
      });
    }
    for (std::thread& thread : threads) thread.join();
  }

  [[nodiscard]] std::size_t count() const { return count_; }
  /// Messages sent so far.
  [[nodiscard]] std::size_t messages() const { return messages_; }

 private:
  class OneRank final : public Communicator {
   public:
    OneRank(ThreadRanks& all, std::size_t rank) : all_(all), rank_(rank) {}
    [[nodiscard]] std::size_t rank() const override { return rank_; }
    [[nodiscard]] std::size_t count() const override { return all_.count_; }
    void send(std::size_t to, Message message) override { all_.put(rank_, to, std::move(message)); }
    Message receive(std::size_t from) override { return all_.take(from, rank_); }
    [[nodiscard]] Traffic traffic() const override { return {}; }
    [[nodiscard]] double seconds() const override {
      return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
    }
    [[nodiscard]] std::size_t count_on_machine() const override { return all_.count_; }
    [[nodiscard]] bool is_stop_asked() const override { return false; }
    void ask_to_stop() override {}
    [[noreturn]] void abandon(std::string const& /*why*/) override { std::terminate(); }

   private:
    ThreadRanks& all_;
    std::size_t rank_;
  };

  void put(std::size_t from, std::size_t to, Message message) {
    {
      std::scoped_lock const lock(mutex_);
      ++messages_;
      boxes_[{from, to}].push_back(std::move(message));
    }
    has_come_.notify_all();
  }
  Message take(std::size_t from, std::size_t to) {
    std::unique_lock lock(mutex_);
    std::deque<Message>& box = boxes_[{from, to}];
    has_come_.wait(lock, [&] { return !box.empty(); });
    Message message = std::move(box.front());
    box.pop_front();
    return message;
  }

  std::size_t count_;
  std::mutex mutex_;
  std::condition_variable has_come_;
  std::map<std::pair<std::size_t, std::size_t>, std::deque<Message>> boxes_;
  std::size_t messages_ = 0;
};

}  // namespace gridlock::test
