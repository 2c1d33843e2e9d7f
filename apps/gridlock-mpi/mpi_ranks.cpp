#include "mpi_ranks.hpp"

#include <sched.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <numeric>
#include <thread>
#include <utility>

namespace gridlock::mpi {

namespace {

constexpr int tag = 0;

/// Room that a rank has for messages that nobody has received yet.
constexpr std::size_t most_bytes_sending = std::size_t{1} << 26;

/// What a rank gives to all at once; only where one gives more there is a second round. Open MPI hands 50 KB in all or more from rank to
/// rank all around, and less in a number of rounds that grows with the logarithm of the ranks.
constexpr std::size_t bytes_of_first_round = 192;

/// A few microseconds at full speed, then between other processes of this core, and in the end asleep: a rank that waits for
/// a file to be written, or shares its core, takes nobody's time.
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

/// The first round of what a rank gives to all.
struct FirstRound {
  std::uint64_t bytes;
  std::array<std::byte, bytes_of_first_round - sizeof(std::uint64_t)> data;
};
static_assert(sizeof(FirstRound) == bytes_of_first_round);

}  // namespace

MpiRanks::MpiRanks(MPI_Comm communicator, std::size_t count_on_machine, RanksHooks hooks)
    : count_on_machine_(count_on_machine), hooks_(std::move(hooks)) {
  MPI_Comm_dup(communicator, &ranks_communicator_);
  int number = 0;
  MPI_Comm_rank(ranks_communicator_, &number);
  rank_ = static_cast<std::size_t>(number);
  MPI_Comm_size(ranks_communicator_, &number);
  count_ = static_cast<std::size_t>(number);
}

MpiRanks::~MpiRanks() {
  Patience patience;
  while (!sending_.empty()) {
    forget_sent();
    patience.wait();
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

void MpiRanks::send(std::size_t to, Bytes message) {
  note_work(0, message.size());
  forget_sent();
  Patience patience;
  while (!sending_.empty() && bytes_sending_ + message.size() > most_bytes_sending) {
    patience.wait();
    forget_sent();
  }
  ++traffic_.messages;
  traffic_.bytes += message.size();
  bytes_sending_ += message.size();
  sending_.push_back({.request = MPI_REQUEST_NULL, .message = std::move(message)});
  Sending& sending = sending_.back();
  MPI_Isend(sending.message.data(), static_cast<int>(sending.message.size()), MPI_BYTE, static_cast<int>(to), tag,
            ranks_communicator_, &sending.request);
}

Ranks::Bytes MpiRanks::receive(std::size_t from) {
  double const begin = MPI_Wtime();
  auto const source = static_cast<int>(from);
  int const bytes = wait_for_message(source);
  Bytes message(static_cast<std::size_t>(bytes));
  MPI_Recv(message.data(), bytes, MPI_BYTE, source, tag, ranks_communicator_, MPI_STATUS_IGNORE);
  traffic_.seconds_waiting += MPI_Wtime() - begin;
  note_work(0, message.size());
  forget_sent();
  return message;
}

/// Returns its bytes. One thread alone receives, so that no other takes what has been found.
int MpiRanks::wait_for_message(int from) {
  MPI_Status status;
  if (hooks_.waits_in_mpi) {
    MPI_Probe(from, tag, ranks_communicator_, &status);
  } else {
    Patience patience;
    for (int has_come = 0; has_come == 0;) {
      MPI_Iprobe(from, tag, ranks_communicator_, &has_come, &status);
      if (has_come == 0) patience.wait();
    }
  }
  int bytes = 0;
  MPI_Get_count(&status, MPI_BYTE, &bytes);
  return bytes;
}

/// Calls a function of MPI that all ranks call, which waits in MPI, or the one that returns at once and is asked again and again.
template <class Blocking, class Nonblocking, class... Arguments>
void MpiRanks::meet(Blocking blocking, Nonblocking nonblocking, Arguments... arguments) {
  if (hooks_.waits_in_mpi) {
    blocking(arguments..., ranks_communicator_);
    return;
  }
  MPI_Request request = MPI_REQUEST_NULL;
  nonblocking(arguments..., ranks_communicator_, &request);
  Patience patience;
  for (int is_done = 0; is_done == 0;) {
    MPI_Test(&request, &is_done, MPI_STATUS_IGNORE);
    if (is_done == 0) patience.wait();
  }
}

std::vector<Ranks::Bytes> MpiRanks::gather_for_all(Bytes own) {
  FirstRound first{.bytes = own.size(), .data = {}};
  if (!own.empty()) std::memcpy(first.data.data(), own.data(), std::min(own.size(), first.data.size()));
  std::vector<FirstRound> of_all(count_);
  double const begin = MPI_Wtime();
  meet(MPI_Allgather, MPI_Iallgather, &first, static_cast<int>(sizeof first), MPI_BYTE, of_all.data(),
       static_cast<int>(sizeof first), MPI_BYTE);
  traffic_.seconds_waiting += MPI_Wtime() - begin;
  ++traffic_.messages;
  traffic_.bytes += sizeof first;
  std::vector<Bytes> messages;
  for (FirstRound const& of_rank : of_all) {
    messages.emplace_back(of_rank.data.begin(), of_rank.data.begin() + static_cast<std::ptrdiff_t>(std::min(
                                                                           of_rank.bytes, of_rank.data.size())));
  }
  if (std::ranges::all_of(of_all, [](FirstRound const& round) { return round.bytes <= round.data.size(); }))
    return messages;

  std::vector<int> sizes;
  for (FirstRound const& of_rank : of_all) sizes.push_back(static_cast<int>(of_rank.bytes));
  std::vector<int> begins(count_);
  std::exclusive_scan(sizes.begin(), sizes.end(), begins.begin(), 0);
  Bytes all(static_cast<std::size_t>(begins.back() + sizes.back()));
  // By way of rank 0: Open MPI would hand so many bytes from rank to rank, all around.
  double const second_begin = MPI_Wtime();
  auto const bytes_of_all = static_cast<int>(all.size());
  meet(MPI_Gatherv, MPI_Igatherv, own.data(), sizes[rank_], MPI_BYTE, all.data(), sizes.data(), begins.data(), MPI_BYTE,
       0);
  meet(MPI_Bcast, MPI_Ibcast, all.data(), bytes_of_all, MPI_BYTE, 0);
  traffic_.seconds_waiting += MPI_Wtime() - second_begin;
  ++traffic_.messages;
  traffic_.bytes += own.size();
  for (std::size_t rank = 0; rank < count_; ++rank) {
    messages[rank].assign(all.begin() + begins[rank], all.begin() + begins[rank] + sizes[rank]);
  }
  return messages;
}

void MpiRanks::abandon(std::string const& why) {
  hooks_.complain(why);
  MPI_Abort(MPI_COMM_WORLD, EXIT_FAILURE);
  std::abort();  // MPI_Abort does not say that it never returns
}

}  // namespace gridlock::mpi
