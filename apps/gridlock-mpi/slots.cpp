#include "slots.hpp"

#include <algorithm>

namespace gridlock::mpi {

Slots::Slots(std::size_t count, MakeRun make) : make_(std::move(make)) {
  threads_.reserve(count);
  for (std::size_t k = 0; k < count; ++k) threads_.emplace_back([this] { work(); });
}

Slots::~Slots() {
  {
    std::scoped_lock const lock(mutex_);
    is_closed_ = true;
  }
  is_changed_.notify_all();
  for (std::thread& thread : threads_) thread.join();
}

void Slots::give(CrewJob const& job) {
  {
    std::scoped_lock const lock(mutex_);
    jobs_.push_back(job);
    shares_.push_back({job.run, 0.0});
  }
  is_changed_.notify_one();
}

std::optional<Slots::Done> Slots::take_done() {
  std::scoped_lock const lock(mutex_);
  if (done_.empty()) return std::nullopt;
  Done done = std::move(done_.front());
  done_.pop_front();
  return done;
}

std::vector<Slots::Share> Slots::shares() {
  std::scoped_lock const lock(mutex_);
  return shares_;
}

void Slots::work() {
  std::unique_lock lock(mutex_);
  for (;;) {
    is_changed_.wait(lock, [this] { return is_closed_ || !jobs_.empty(); });
    if (jobs_.empty()) return;
    CrewJob const job = jobs_.front();
    jobs_.pop_front();
    auto const of_this_run = [&] { return std::ranges::find(shares_, job.run, &Share::run); };
    lock.unlock();
    std::string outcome = make_(job, [&](double share) {
      std::scoped_lock const guard(mutex_);
      of_this_run()->share = share;
      return !is_stopped_;
    });
    lock.lock();
    shares_.erase(of_this_run());
    done_.push_back({job.run, std::move(outcome)});
  }
}

}  // namespace gridlock::mpi
