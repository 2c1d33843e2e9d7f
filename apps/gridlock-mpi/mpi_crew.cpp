#include "mpi_crew.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstring>
#include <deque>
#include <optional>
#include <string_view>
#include <thread>
#include <type_traits>
#include <utility>
#include <vector>

#include "gridlock/core/error.hpp"
#include "slots.hpp"

namespace gridlock::mpi {

namespace {

/// The kind of a message; ready to leaves go to the leader.
enum Tag : int {
  ready,    // a rank can carry out runs; content: how many at a time
  outcome,  // a run has ended; content: its index and encoded outcome
  share,    // content: a run's index and the fraction that is done
  asks_to_stop,
  leaves,  // last message of a rank
  job,
  stop,
  release,  // no further run comes
};

using namespace std::chrono_literals;

/// Pause between looks for messages; a rank that looks without a pause would take a core from the runs.
constexpr auto nap = 2ms;
constexpr auto between_reports = 500ms;
constexpr std::size_t longest_failure = 2000;

void wait_asleep(MPI_Request& request) {
  for (int is_done = 0; is_done == 0;) {
    MPI_Test(&request, &is_done, MPI_STATUS_IGNORE);
    if (is_done == 0) std::this_thread::sleep_for(nap);
  }
}

/// The data that a rank sends to the leader in meet().
struct Arrival {
  std::uint64_t plan_hash = 0;
  std::uint64_t processes_of_run = 1;
  std::array<char, longest_failure> failure{};  // empty if the rank is ready
};

/// The decision of the leader in meet(), which all ranks receive.
struct Verdict {
  enum Kind : std::uint64_t { all_are_ready, cannot_take_part, is_of_another_plan };
  Kind kind = all_are_ready;
  std::array<char, longest_failure> text{};
};

/// Returns the decision of the leader, whose own data are `own`.
Verdict judge(std::vector<Arrival> const& all, Arrival const& own) {
  Verdict verdict;
  std::string text;
  for (std::size_t rank = 0; rank < all.size() && text.empty(); ++rank) {
    std::string_view const why = all[rank].failure.data();
    if (!why.empty()) {
      verdict.kind = Verdict::cannot_take_part;
      text = fmt::format("rank {} cannot take part: {}", rank, why);
    } else if (all[rank].plan_hash != own.plan_hash || all[rank].processes_of_run != own.processes_of_run) {
      verdict.kind = Verdict::is_of_another_plan;
      text = fmt::format("rank {} has read another plan or command line", rank);
    }
  }
  text.copy(verdict.text.data(), longest_failure - 1);
  return verdict;
}

void send(int to, Tag tag, void const* data, std::size_t bytes) {
  MPI_Send(data, static_cast<int>(bytes), MPI_BYTE, to, tag, MPI_COMM_WORLD);
}
template <class Value>
void send(int to, Tag tag, Value const& value) {
  static_assert(std::is_trivially_copyable_v<Value>);
  send(to, tag, &value, sizeof(Value));
}

struct Message {
  int from;
  Tag tag;
  std::vector<char> bytes;

  template <class Value>
  [[nodiscard]] Value value() const {
    Value value;
    std::memcpy(&value, bytes.data(), std::min(sizeof(Value), bytes.size()));
    return value;
  }
};

/// Returns a message that has arrived from any rank; nothing if there is none.
std::optional<Message> receive() {
  int has_come = 0;
  MPI_Status status;
  MPI_Iprobe(MPI_ANY_SOURCE, MPI_ANY_TAG, MPI_COMM_WORLD, &has_come, &status);
  if (has_come == 0) return std::nullopt;
  int bytes = 0;
  MPI_Get_count(&status, MPI_BYTE, &bytes);
  Message message{.from = status.MPI_SOURCE,
                  .tag = static_cast<Tag>(status.MPI_TAG),
                  .bytes = std::vector<char>(static_cast<std::size_t>(bytes))};
  MPI_Recv(message.bytes.data(), bytes, MPI_BYTE, message.from, message.tag, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
  return message;
}

/// Limits reports to one per between_reports.
class Clock {
 public:
  bool is_due() {
    auto const now = std::chrono::steady_clock::now();
    if (now < next_) return false;
    next_ = now + between_reports;
    return true;
  }

 private:
  std::chrono::steady_clock::time_point next_;
};

/// The loop of the leader, which assigns runs and receives outcomes.
class Leading {
 public:
  Leading(CrewLead const& lead, Slots& slots, std::function<bool()> const& is_stop_asked, std::vector<int> others)
      : lead_(lead), slots_(slots), is_stop_asked_(is_stop_asked), others_(std::move(others)) {
    for (std::size_t k = 0; k < slots.count(); ++k) free_.push_back(0);
  }

  void run() {
    while (true) {
      bool has_news = false;
      while (auto const message = receive()) {
        take(*message);
        has_news = true;
      }
      while (auto const done = slots_.take_done()) {
        finish(0, done->run, done->outcome);
        has_news = true;
      }
      if (clock_.is_due()) report_own();
      hand_out();
      if (working_ == 0 && has_none_left_) break;
      if (!has_news) std::this_thread::sleep_for(nap);
    }
    for (int const rank : others_) send(rank, release, nullptr, 0);
    // Messages that ranks sent before the release are received and ignored.
    for (std::size_t left = 0; left < others_.size();) {
      auto const message = receive();
      if (!message) std::this_thread::sleep_for(nap);
      if (message && message->tag == leaves) ++left;
    }
  }

 private:
  void take(Message const& message) {
    switch (message.tag) {
      case ready:
        for (auto k = message.value<std::uint64_t>(); k > 0; --k) free_.push_back(message.from);
        break;
      case outcome: {
        std::size_t const head = sizeof(std::uint64_t);
        finish(message.from, message.value<std::uint64_t>(),
               std::string(message.bytes.begin() + static_cast<std::ptrdiff_t>(head), message.bytes.end()));
        break;
      }
      case share: {
        auto const share = message.value<Slots::Share>();
        note(lead_.report(share.run, share.share));
        break;
      }
      case asks_to_stop:
        note(false);
        break;
      default:
        break;
    }
  }

  void finish(int rank, std::uint64_t run, std::string const& outcome) {
    lead_.finish(run, outcome);
    --working_;
    free_.push_back(rank);
  }

  /// Reports the runs of this rank and checks for a stop, even if no messages arrive.
  void report_own() {
    for (Slots::Share const& share : slots_.shares()) note(lead_.report(share.run, share.share));
    note(!is_stop_asked_());
  }

  void note(bool continues) {
    if (continues || is_stopping_) return;
    is_stopping_ = true;
    slots_.stop();
    for (int const rank : others_) send(rank, stop, nullptr, 0);
  }

  void hand_out() {
    if (is_stopping_) has_none_left_ = true;
    while (!free_.empty() && !has_none_left_) {
      auto const next = lead_.next();
      if (!next) {
        has_none_left_ = true;
        break;
      }
      int const rank = free_.front();
      free_.pop_front();
      ++working_;
      if (rank == 0) {
        slots_.give(*next);
      } else {
        send(rank, job, *next);
      }
    }
  }

  CrewLead const& lead_;
  Slots& slots_;
  std::function<bool()> const& is_stop_asked_;
  std::vector<int> others_;  // ranks other than 0 that carry out runs
  Clock clock_;
  std::deque<int> free_;  // the rank of each free slot, in order of waiting
  std::size_t working_ = 0;
  bool is_stopping_ = false;
  bool has_none_left_ = false;
};

}  // namespace

MpiCrew::MpiCrew(RanksHooks hooks) : hooks_(std::move(hooks)) {
  MPI_Comm_rank(MPI_COMM_WORLD, &rank_);
  MPI_Comm_size(MPI_COMM_WORLD, &ranks_);
  MPI_Comm here = MPI_COMM_NULL;
  MPI_Comm_split_type(MPI_COMM_WORLD, MPI_COMM_TYPE_SHARED, 0, MPI_INFO_NULL, &here);
  int ranks_here = 1;
  MPI_Comm_size(here, &ranks_here);
  MPI_Comm_free(&here);
  ranks_here_ = static_cast<std::size_t>(ranks_here);
}

void MpiCrew::set_processes_of_run(std::size_t count) {
  ranks_of_run_ = static_cast<int>(std::min(count, static_cast<std::size_t>(ranks_)));
}

void MpiCrew::meet(std::uint64_t plan_hash, std::string const& failure) {
  has_met_ = true;
  Arrival own{.plan_hash = plan_hash, .processes_of_run = processes_of_run()};
  failure.copy(own.failure.data(), longest_failure - 1);
  std::vector<Arrival> all(static_cast<std::size_t>(leads() ? ranks_ : 0));
  MPI_Request request = MPI_REQUEST_NULL;
  MPI_Igather(&own, sizeof(Arrival), MPI_BYTE, all.data(), sizeof(Arrival), MPI_BYTE, 0, MPI_COMM_WORLD, &request);
  wait_asleep(request);
  Verdict verdict;
  if (leads()) verdict = judge(all, own);
  MPI_Ibcast(&verdict, sizeof verdict, MPI_BYTE, 0, MPI_COMM_WORLD, &request);
  wait_asleep(request);
  // The rank that failed reports its own error.
  if (verdict.kind == Verdict::cannot_take_part && failure.empty()) throw RunFailure(verdict.text.data());
  if (verdict.kind == Verdict::is_of_another_plan) {
    throw Error({.what = verdict.text.data(), .hint = "all ranks must see the same files and options"});
  }
  is_working_ = verdict.kind == Verdict::all_are_ready;
  if (is_working_ && ranks_of_run_ > 1) form_groups();
}

void MpiCrew::form_groups() {
  MPI_Comm group = MPI_COMM_NULL;
  MPI_Comm_split(MPI_COMM_WORLD, rank_ / ranks_of_run_, rank_, &group);
  group_.emplace(group, ranks_here_, hooks_);
  MPI_Comm_free(&group);
}

void MpiCrew::part() { is_working_ = false; }

/// Returns a function that carries out a run together with the other ranks of this rank's group.
MakeRun MpiCrew::with_group(MakeRun const& make) {
  return [this, make](CrewJob const& job, ReportShare const& report) {
    static_cast<void>(processes().of_root(std::optional(job)));
    return make(job, report);
  };
}

/// Carries out the runs that the first rank of the group announces, until there are no more.
void MpiCrew::follow_group(MakeRun const& make) {
  while (auto const job = processes().of_root(std::optional<CrewJob>())) {
    static_cast<void>(make(*job, [](double) { return true; }));
  }
}

void MpiCrew::release_group() { static_cast<void>(processes().of_root(std::optional<CrewJob>())); }

void MpiCrew::lead(CrewLead const& lead) {
  std::vector<int> others;
  for (int rank = ranks_of_run_; rank < ranks_; rank += ranks_of_run_) others.push_back(rank);
  Slots slots(runs_at_a_time_, with_group(lead.make));
  Leading(lead, slots, hooks_.is_stop_asked, std::move(others)).run();
  release_group();
  part();
}

void MpiCrew::help(MakeRun const& make) {
  if (!processes().is_root()) {
    follow_group(make);
    part();
    return;
  }
  Slots slots(runs_at_a_time_, with_group(make));
  send(0, ready, std::uint64_t{slots.count()});
  Clock clock;
  bool has_asked_to_stop = false;
  for (bool is_released = false; !is_released;) {
    bool has_news = false;
    while (auto const message = receive()) {
      has_news = true;
      if (message->tag == job) slots.give(message->value<CrewJob>());
      if (message->tag == stop) slots.stop();
      if (message->tag == release) is_released = true;
    }
    while (auto const done = slots.take_done()) {
      has_news = true;
      std::string text(sizeof done->run, '\0');
      std::memcpy(text.data(), &done->run, sizeof done->run);
      text += done->outcome;
      send(0, outcome, text.data(), text.size());
    }
    if (hooks_.is_stop_asked() && !has_asked_to_stop) {
      has_asked_to_stop = true;
      send(0, asks_to_stop, nullptr, 0);
    }
    if (clock.is_due()) {
      for (Slots::Share const& of_run : slots.shares()) send(0, share, of_run);
    }
    if (!has_news) std::this_thread::sleep_for(nap);
  }
  send(0, leaves, nullptr, 0);
  release_group();
  part();
}

}  // namespace gridlock::mpi
