#pragma once

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <exception>
#include <functional>
#include <iostream>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "gridlock/core/detail/message.hpp"
#include "gridlock/parallel/communicator.hpp"

namespace gridlock::test {

/// Ranks that are threads of one process.
class ThreadRanks {
 public:
  explicit ThreadRanks(std::size_t count) : count_(count) {}

  /// Calls work(ranks) for every rank, each in a thread of its own. Throws what rank 0 has thrown; a rank that fails
  /// while others wait for it ends the program.
  void run(std::function<void(Communicator&)> const& work) {
    std::vector<std::exception_ptr> failures(count_);
    std::vector<std::thread> threads;
    for (std::size_t rank = 0; rank < count_; ++rank) {
      threads.emplace_back([this, rank, &work, &failures] {
        OneRank here(*this, rank);
        try {
          work(here);
        } catch (std::exception const& failure) {
          failures[rank] = std::current_exception();
          if (count_ > 1 && !here.have_all_failed()) here.abandon(failure.what());
        }
      });
    }
    for (std::thread& thread : threads) thread.join();
    for (std::exception_ptr const& failure : failures) {
      EXPECT_EQ(failure == nullptr, failures[0] == nullptr) << "some ranks have failed";
    }
    if (failures[0]) std::rethrow_exception(failures[0]);
  }

  [[nodiscard]] std::size_t count() const { return count_; }
  /// From now on this rank has been asked to stop, as by a signal.
  void ask_to_stop(std::size_t rank) { asked_to_stop_ = static_cast<int>(rank); }
  /// Whether the root knows that some rank has been asked to stop.
  [[nodiscard]] bool does_root_stop() const { return does_root_stop_; }
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
    [[nodiscard]] bool is_stop_asked() const override { return all_.asked_to_stop_ == static_cast<int>(rank_); }
    void ask_to_stop() override {
      if (rank_ == 0) all_.does_root_stop_ = true;
    }
    [[noreturn]] void abandon(std::string const& why) override {
      std::cerr << "rank " << rank_ << " of " << all_.count_ << " fails alone: " << why << std::endl;
      std::terminate();
    }

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
  std::atomic<int> asked_to_stop_ = -1;
  std::atomic<bool> does_root_stop_ = false;
  std::mutex mutex_;
  std::condition_variable has_come_;
  std::map<std::pair<std::size_t, std::size_t>, std::deque<Message>> boxes_;
  std::size_t messages_ = 0;
};

}  // namespace gridlock::test
