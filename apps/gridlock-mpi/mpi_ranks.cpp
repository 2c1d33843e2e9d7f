#include "mpi_ranks.hpp"

#include <sched.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <span>
#include <thread>
#include <utility>

namespace gridlock::mpi {

namespace {

/// A message has two parts, each with its own tag; a short message has only the first part.
constexpr int tag = 0;
constexpr int tag_of_rest = 1;
/// Maximum size of the first part. A receive of this size is posted before the message is sent, so that the part
/// arrives during computation, without a query of its length and without another copy.
constexpr std::size_t bytes_of_first_part = std::size_t{1} << 15;

/// Maximum size of messages that were sent and not yet received, in bytes.
constexpr std::size_t max_bytes_sending = std::size_t{1} << 26;

/// Waits between tests: at first without a pause, then by yielding the core, and after some milliseconds asleep. A rank
/// that waits long, for example for a file, thus leaves the core to other processes.
class Patience {
 public:
  void wait() {
    constexpr int tries_at_full_speed = 200;
    constexpr std::chrono::milliseconds before_sleep(5);
    constexpr std::chrono::microseconds nap(100);
    if (++tries_ < tries_at_full_speed) return;
    if (Clock::now() - begin_ < before_sleep) {
      sched_yield();
    } else {
      std::this_thread::sleep_for(nap);
    }
  }

 private:
  using Clock = std::chrono::steady_clock;
  Clock::time_point begin_ = Clock::now();
  int tries_ = 0;
};

}  // namespace

MpiRanks::MpiRanks(MPI_Comm communicator, std::size_t count_on_machine, RanksHooks hooks)
    : count_on_machine_(count_on_machine), hooks_(std::move(hooks)) {
  MPI_Comm_dup(communicator, &ranks_communicator_);
  int number = 0;
  MPI_Comm_rank(ranks_communicator_, &number);
  rank_ = static_cast<std::size_t>(number);
  MPI_Comm_size(ranks_communicator_, &number);
  count_ = static_cast<std::size_t>(number);
  receiving_.resize(count_);
}

MpiRanks::~MpiRanks() {
  Patience patience;
  while (!sending_.empty()) {
    forget_sent();
    patience.wait();
  }
  for (Receiving& next : receiving_) {
    if (next.first_part == nullptr) continue;
    MPI_Cancel(&next.request);
    MPI_Wait(&next.request, MPI_STATUS_IGNORE);
  }
  MPI_Comm_free(&ranks_communicator_);
}

void MpiRanks::forget_sent() {
  while (!sending_.empty()) {
    int has_left = 0;
    MPI_Test(&sending_.front().request, &has_left, MPI_STATUS_IGNORE);
    if (has_left == 0) return;
    bytes_sending_ -= sending_.front().message.size();
    sending_.pop_front();
  }
}

void MpiRanks::send(std::size_t to, Message message) {
  note_work(0, message.size());
  forget_sent();
  Patience patience;
  while (!sending_.empty() && bytes_sending_ + message.size() > max_bytes_sending) {
    patience.wait();
    forget_sent();
  }
  ++traffic_.messages;
  traffic_.bytes += message.size();
  bytes_sending_ += message.size();
  auto const isend = [&](std::span<std::byte const> part, int part_tag) {
    MPI_Request request = MPI_REQUEST_NULL;
    MPI_Isend(part.data(), static_cast<int>(part.size()), MPI_BYTE, static_cast<int>(to), part_tag, ranks_communicator_,
              &request);
    return request;
  };
  std::span<std::byte const> const all(message);
  MPI_Request request = isend(all.first(std::min(all.size(), bytes_of_first_part)), tag);
  if (all.size() >= bytes_of_first_part) {
    sending_.push_back({.request = request, .message = {}});
    request = isend(all.subspan(bytes_of_first_part), tag_of_rest);
  }
  sending_.push_back({.request = request, .message = std::move(message)});
}

Message MpiRanks::receive(std::size_t from) {
  Receiving& next = receiving_[from];
  if (next.first_part == nullptr) {
    next.first_part = std::make_unique_for_overwrite<std::byte[]>(bytes_of_first_part);
    post_receive(from);
  }
  double const begin = MPI_Wtime();
  Message message(wait_for_first_part(next.request));
  if (!message.empty()) std::memcpy(message.data(), next.first_part.get(), message.size());
  post_receive(from);
  if (message.size() == bytes_of_first_part) receive_rest(from, message);
  traffic_.seconds_waiting += MPI_Wtime() - begin;
  note_work(0, message.size());
  forget_sent();
  return message;
}

void MpiRanks::post_receive(std::size_t from) {
  MPI_Irecv(receiving_[from].first_part.get(), static_cast<int>(bytes_of_first_part), MPI_BYTE, static_cast<int>(from),
            tag, ranks_communicator_, &receiving_[from].request);
}

/// Waits for the first part of a message; returns its size in bytes.
std::size_t MpiRanks::wait_for_first_part(MPI_Request& request) const {
  MPI_Status status;
  if (hooks_.waits_in_mpi) {
    MPI_Wait(&request, &status);
  } else {
    Patience patience;
    for (int has_come = 0; has_come == 0;) {
      MPI_Test(&request, &has_come, &status);
      if (has_come == 0) patience.wait();
    }
  }
  int bytes = 0;
  MPI_Get_count(&status, MPI_BYTE, &bytes);
  return static_cast<std::size_t>(bytes);
}

/// Receives the second part, which was sent together with the first.
void MpiRanks::receive_rest(std::size_t from, Message& message) const {
  auto const source = static_cast<int>(from);
  MPI_Status status;
  MPI_Probe(source, tag_of_rest, ranks_communicator_, &status);
  int bytes = 0;
  MPI_Get_count(&status, MPI_BYTE, &bytes);
  message.resize(message.size() + static_cast<std::size_t>(bytes));
  MPI_Recv(message.data() + bytes_of_first_part, bytes, MPI_BYTE, source, tag_of_rest, ranks_communicator_,
           MPI_STATUS_IGNORE);
}

void MpiRanks::abandon(std::string const& why) {
  hooks_.complain(why);
  MPI_Abort(MPI_COMM_WORLD, EXIT_FAILURE);
  std::abort();  // MPI_Abort is not declared [[noreturn]]
}

}  // namespace gridlock::mpi
