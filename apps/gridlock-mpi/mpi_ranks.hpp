#pragma once

#include <mpi.h>

#include <cstddef>
#include <deque>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "gridlock/parallel/communicator.hpp"

namespace gridlock::mpi {

/// Functions of the program that ranks call, and how ranks wait for messages.
struct RanksHooks {
  std::function<bool()> is_stop_asked;               ///< whether this process was asked to stop
  std::function<void()> ask_to_stop;                 ///< requests a stop of this process
  std::function<void(std::string const&)> complain;  ///< prints why all ranks end
  // The next two serve a simulator of clusters:
  bool waits_in_mpi = false;                                            ///< waits in MPI_Wait, without pauses
  std::function<void(std::uint64_t turns, std::size_t bytes)> on_work;  ///< gets turns done and bytes sent or received
};

/// The ranks of a communicator, which share runs. They exchange messages in a duplicate of the communicator.
class MpiRanks final : public Communicator {
 public:
  MpiRanks(MPI_Comm communicator, std::size_t count_on_machine, RanksHooks hooks);
  ~MpiRanks() override;

  [[nodiscard]] std::size_t rank() const override { return rank_; }
  [[nodiscard]] std::size_t count() const override { return count_; }
  void send(std::size_t to, Message message) override;
  Message receive(std::size_t from) override;
  void note_turns(std::uint64_t turns) override { note_work(turns, 0); }
  [[nodiscard]] Traffic traffic() const override { return traffic_; }
  [[nodiscard]] double seconds() const override { return MPI_Wtime(); }
  [[nodiscard]] std::size_t count_on_machine() const override { return count_on_machine_; }
  [[nodiscard]] bool is_stop_asked() const override { return hooks_.is_stop_asked(); }
  void ask_to_stop() override { hooks_.ask_to_stop(); }
  [[noreturn]] void abandon(std::string const& why) override;

 private:
  struct Sending {
    MPI_Request request;
    Message message;  ///< empty if a second part follows
  };
  struct Receiving {
    std::unique_ptr<std::byte[]> first_part;  ///< buffer of the next message; null before the first message of a rank
    MPI_Request request = MPI_REQUEST_NULL;
  };

  void note_work(std::uint64_t turns, std::size_t bytes) const {
    if (hooks_.on_work) hooks_.on_work(turns, bytes);
  }
  void forget_sent();
  void post_receive(std::size_t from);
  [[nodiscard]] std::size_t wait_for_first_part(MPI_Request& request) const;
  void receive_rest(std::size_t from, Message& message) const;

  MPI_Comm ranks_communicator_ = MPI_COMM_NULL;
  std::size_t rank_ = 0;
  std::size_t count_ = 1;
  std::size_t count_on_machine_;
  RanksHooks hooks_;
  std::deque<Sending> sending_;  ///< messages that may not have been sent completely, in order
  std::size_t bytes_sending_ = 0;
  std::vector<Receiving> receiving_;  ///< one for each rank
  Traffic traffic_;
};

}  // namespace gridlock::mpi
