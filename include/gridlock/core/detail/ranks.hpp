#pragma once

#include <cassert>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <exception>
#include <new>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

namespace gridlock {

/// What a rank has sent to others, and how long it has waited for them.
struct Traffic {
  std::uint64_t messages = 0;
  std::uint64_t bytes = 0;
  double seconds_waiting = 0.0;
};

/// Processes that share one run. Every function is called from one thread of each; what one rank sends to another
/// arrives in the order in which it was sent.
class Ranks {
 public:
  Ranks() = default;
  Ranks(Ranks const&) = delete;
  Ranks& operator=(Ranks const&) = delete;
  virtual ~Ranks() = default;

  using Bytes = std::vector<std::byte>;

  /// The number of this process; 0 leads.
  [[nodiscard]] virtual std::size_t rank() const = 0;
  [[nodiscard]] virtual std::size_t count() const = 0;
  /// Sends a message and does not wait until it has arrived.
  virtual void send(std::size_t to, Bytes message) = 0;
  /// Waits for the next message of a rank.
  virtual Bytes receive(std::size_t from) = 0;
  /// What each rank gives, by rank. All call it; each sends and receives ⌈log₂ ranks⌉ messages.
  [[nodiscard]] std::vector<Bytes> gather_for_all(Bytes own);

  /// Of this rank.
  [[nodiscard]] virtual Traffic traffic() const = 0;
  /// Seconds since some moment.
  [[nodiscard]] virtual double seconds() const = 0;
  /// How many of the ranks share the machine of this one, itself included.
  [[nodiscard]] virtual std::size_t count_on_machine() const = 0;
  /// Agents have taken that many turns here: for a simulator of clusters, which has to be told what was computed.
  virtual void note_turns(std::uint64_t /*turns*/) {}
  /// Whether this process has been asked to stop.
  [[nodiscard]] virtual bool is_stop_asked() const = 0;
  /// Another rank has been asked.
  virtual void ask_to_stop() = 0;
  /// Ends all ranks, where this one cannot go on and others wait for it.
  [[noreturn]] virtual void abandon(std::string const& why) = 0;

  /// What the leader knows of the traffic of each rank: as of the end of the last steps that they took together.
  [[nodiscard]] std::vector<Traffic> const& traffic_of_ranks() const { return traffic_of_ranks_; }
  void note_traffic(std::size_t rank, Traffic const& traffic) {
    if (traffic_of_ranks_.size() <= rank) traffic_of_ranks_.resize(rank + 1);
    traffic_of_ranks_[rank] = traffic;
  }

 private:
  std::vector<Traffic> traffic_of_ranks_;
};

/// Writes values into a message.
class MessageWriter {
 public:
  template <class Value>
  void add(Value const& value) {
    add_all(std::span(&value, 1));
  }
  template <class Value, std::size_t extent>
  void add_all(std::span<Value, extent> values) {
    static_assert(std::is_trivially_copyable_v<Value>);
    if (values.empty()) return;
    std::size_t const begin = bytes_.size();
    bytes_.resize(begin + values.size_bytes());
    std::memcpy(bytes_.data() + begin, values.data(), values.size_bytes());
  }
  void add_text(std::string_view text) {
    add(std::uint64_t{text.size()});
    add_all(std::span<char const>(text));
  }
  /// Values at these places of an array.
  template <class Value>
  void add_chosen(Value const* values, std::span<std::uint32_t const> places) {
    static_assert(std::is_trivially_copyable_v<Value>);
    std::size_t at = bytes_.size();
    bytes_.resize(at + places.size() * sizeof(Value));
    for (std::uint32_t const place : places) {
      std::memcpy(bytes_.data() + at, values + place, sizeof(Value));
      at += sizeof(Value);
    }
  }
  void reserve(std::size_t bytes) { bytes_.reserve(bytes); }
  [[nodiscard]] Ranks::Bytes take() { return std::move(bytes_); }

 private:
  Ranks::Bytes bytes_;
};

/// Reads them in the same order.
class MessageReader {
 public:
  explicit MessageReader(Ranks::Bytes const& bytes) : bytes_(bytes) {}

  template <class Value>
  [[nodiscard]] Value next() {
    Value value;
    read_into(std::span(&value, 1));
    return value;
  }
  template <class Value>
  void read_into(std::span<Value> values) {
    static_assert(std::is_trivially_copyable_v<Value>);
    assert(at_ + values.size_bytes() <= bytes_.size());
    if (!values.empty()) std::memcpy(static_cast<void*>(values.data()), bytes_.data() + at_, values.size_bytes());
    at_ += values.size_bytes();
  }
  [[nodiscard]] bool is_at_end() const { return at_ == bytes_.size(); }
  [[nodiscard]] std::string next_text() {
    std::string text(next<std::uint64_t>(), '\0');
    read_into(std::span<char>(text));
    return text;
  }
  template <class Value>
  [[nodiscard]] std::vector<Value> next_values(std::size_t count) {
    std::vector<Value> values(count);
    read_into(std::span(values));
    return values;
  }
  /// As many as are left.
  template <class Value>
  [[nodiscard]] std::vector<Value> rest() {
    std::vector<Value> values((bytes_.size() - at_) / sizeof(Value));
    read_into(std::span(values));
    return values;
  }

 private:
  Ranks::Bytes const& bytes_;
  std::size_t at_ = 0;
};

/// What the leader asks all others for: the first number of a message.
enum class TaskOfRanks : std::uint64_t {
  leave,
  steps_of_disks,
  // Of a run whose agents are divided.
  begin_run,
  observe_run,
  sample_run,
  hash_run,
  steps_from_homes,
  find_patience,
  arrange_frame,
  give_rows,
  forget_frame,
  write_rows,
  restore_rows,
  forget_run,
};

template <class Value>
Ranks::Bytes message_of(Value const& value) {
  MessageWriter message;
  message.add(value);
  return message.take();
}

template <class Value>
Ranks::Bytes message_of_all(std::span<Value const> values) {
  MessageWriter message;
  message.add_all(values);
  return message.take();
}

inline void send_to_others(Ranks& ranks, Ranks::Bytes const& message) {
  for (std::size_t rank = 1; rank < ranks.count(); ++rank) ranks.send(rank, message);
}

/// The leader says what is to be done before it does its own part of it.
inline void send_task(Ranks& ranks, TaskOfRanks task) { send_to_others(ranks, message_of(task)); }
template <class Order>
void send_task(Ranks& ranks, TaskOfRanks task, Order const& order) {
  MessageWriter message;
  message.add(task);
  message.add(order);
  send_to_others(ranks, message.take());
}
inline void send_task(Ranks& ranks, TaskOfRanks task, std::string const& text) {
  MessageWriter message;
  message.add(task);
  message.add_text(text);
  send_to_others(ranks, message.take());
}

/// Merges what all ranks give, for the leader; others get nothing. All call it. Rank r gets what ranks r + 1, r + 2, r + 4 … have merged, as
/// far as they are in its part of the tree, and gives it to the rank without its lowest bit: no rank receives more than ⌈log₂ ranks⌉ messages.
/// merge(left, right) returns both as one message, and the ranks of `right` follow those of `left`.
///
///     0 ◄─ 1    2 ◄─ 3        0 ◄─ 2        0 ◄─ 4
template <class Merge>
Ranks::Bytes merge_for_leader(Ranks& ranks, Ranks::Bytes own, Merge merge) {
  std::size_t const rank = ranks.rank();
  for (std::size_t step = 1; step < ranks.count(); step *= 2) {
    if ((rank & step) != 0) {
      ranks.send(rank - step, std::move(own));
      return {};
    }
    if (rank + step < ranks.count()) own = merge(std::move(own), ranks.receive(rank + step));
  }
  return own;
}

/// What the leader gives, for all, along the same tree the other way. All call it; what others give is ignored.
[[nodiscard]] Ranks::Bytes hand_down(Ranks& ranks, Ranks::Bytes of_leader);

/// What each rank gives, by rank, for the leader; others get nothing. All call it. Along the same tree.
[[nodiscard]] std::vector<Ranks::Bytes> gather_for_leader(Ranks& ranks, Ranks::Bytes own);

/// Merges what all ranks give, for all.
template <class Merge>
Ranks::Bytes merge_for_all(Ranks& ranks, Ranks::Bytes own, Merge merge) {
  return hand_down(ranks, merge_for_leader(ranks, std::move(own), merge));
}

/// Rank after rank adds what it has to sums, in the order of the ranks; all get them.
template <class Sums, class Add>
Sums add_in_order(Ranks& ranks, Sums sums, Add add) {
  std::size_t const rank = ranks.rank();
  std::size_t const last = ranks.count() - 1;
  if (rank > 0) sums = MessageReader(ranks.receive(rank - 1)).next<Sums>();
  add(sums);
  if (rank < last) {
    ranks.send(rank + 1, message_of(sums));
    return MessageReader(ranks.receive(last)).template next<Sums>();
  }
  for (std::size_t to = 0; to < last; ++to) ranks.send(to, message_of(sums));
  return sums;
}

/// The leader lets all others go, who wait for what it asks of them.
inline void release_helpers(Ranks& ranks) { send_to_others(ranks, message_of(TaskOfRanks::leave)); }

/// Others wait for a rank that fails here: they end with it.
template <class Work>
void do_or_abandon(Ranks& ranks, Work work) {
  try {
    work();
  } catch (std::bad_alloc const&) {
    ranks.abandon("not enough memory");
  } catch (std::exception const& error) {
    ranks.abandon(error.what());
  }
}

/// How many steps the leader lets all take before it looks up: for about 20 ms.
class StepsBetweenLooks {
 public:
  explicit StepsBetweenLooks(Ranks const& ranks) : ranks_(ranks) {}

  [[nodiscard]] std::uint64_t steps() const { return steps_; }
  void begin() { begin_ = ranks_.seconds(); }
  void end(std::uint64_t steps_done) {
    constexpr double seconds_between_looks = 0.02;
    double const seconds = ranks_.seconds() - begin_;
    double const fitting = seconds_between_looks * static_cast<double>(steps_done) / (seconds + 1e-9);
    steps_ = static_cast<std::uint64_t>(fitting < 1.0 ? 1.0 : fitting > 100.0 ? 100.0 : fitting);
  }

 private:
  Ranks const& ranks_;
  std::uint64_t steps_ = 1;
  double begin_ = 0.0;
};

}  // namespace gridlock
