#include "engine/exact/calendar.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <utility>

namespace gridlock::exact {

namespace {

/// Largest mean number of events in a bucket, void events included; it is at least half of this.
constexpr std::uint64_t per_bucket = 24;
constexpr std::uint64_t max_buckets = std::uint64_t{1} << 30;
/// Whether an event falls into the open group decides how it is stored. With few disks and large groups nearly all next
/// events do, with many disks and small groups nearly none: a processor guesses both cases right.
constexpr std::uint64_t few_disks = 3000;
constexpr std::uint32_t bits_of_large_group = 11;
constexpr std::uint32_t bits_of_small_group = 6;
/// Buckets with more events than this are sorted by comparisons, not by counting.
constexpr std::size_t max_counted = 64;

}  // namespace

void Calendar::open(double length, std::uint64_t expected, std::uint64_t disks) {
  bucket_bits_ = disks <= few_disks ? bits_of_large_group : bits_of_small_group;
  bucket_mask_ = (1U << bucket_bits_) - 1U;
  // The number of buckets in an epoch is a power of two, so that the bucket of a time is found without rounding.
  std::uint64_t const buckets =
      std::bit_ceil(std::clamp<std::uint64_t>(expected / per_bucket, std::uint64_t{bucket_mask_} + 1, max_buckets));
  length_ = length;
  buckets_per_time_ = static_cast<double>(buckets) / length;
  made_ = 0;
  tails_.assign(buckets >> bucket_bits_, Tail{});
  bucket_heads_.assign(std::size_t{bucket_mask_} + 1, none);
  // Memory is reserved for each disk's event and two void ones, because growing would need twice the memory for a
  // moment. Reserved memory that is never written costs nothing.
  chunks_.reserve(3 * disks / chunk_size + tails_.size());
  free_chunks_.clear();
  chunks_.clear();
  dealt_.clear();
  due_count_ = 0;
  late_.clear();
  cursor_ = 0;
  open_group_ = 0;
  open_bucket_ = 0;
  is_open_ = false;
}

void Calendar::add_to_open_bucket(double time, Index disk, MovingDisk const* disks) {
  late_.push_back({time, disk, 0});
  std::ranges::push_heap(late_, [disks](auto const& a, auto const& b) { return is_before(b, a, disks); });
}

void Calendar::pop_late(MovingDisk const* disks) {
  std::ranges::pop_heap(late_, [disks](auto const& a, auto const& b) { return is_before(b, a, disks); });
  late_.pop_back();
}

std::uint32_t Calendar::new_chunk(std::uint32_t next) {
  std::uint32_t chunk = 0;
  if (free_chunks_.empty()) {
    chunk = static_cast<std::uint32_t>(chunks_.size());
    chunks_.emplace_back();
  } else {
    chunk = free_chunks_.back();
    free_chunks_.pop_back();
  }
  chunks_[chunk].next = next;
  return chunk;
}

void Calendar::add_to_group(std::uint32_t group, double time, Index disk) {
  Tail& tail = tails_[group];
  if (tail.count == chunk_size) tail = {new_chunk(tail.chunk), 0};
  chunks_[tail.chunk].entries[tail.count++] = {time, disk, 0};
}

bool Calendar::open_next_bucket(MovingDisk const* disks) {
  due_count_ = 0;
  cursor_ = 0;
  for (;;) {
    if (is_open_) {
      ++open_bucket_;
      if ((open_bucket_ & bucket_mask_) == 0 && !open_next_group()) return false;
    }
    is_open_ = true;
    std::uint32_t& head = bucket_heads_[open_bucket_ & bucket_mask_];
    for (std::uint32_t place = head; place != none; place = dealt_[place].next) {
      if (due_count_ == found_.size()) make_room_for_found();
      // A void event is overwritten by the next: a branch would be guessed wrong half of the time.
      found_[due_count_] = dealt_[place];
      due_count_ += disks[dealt_[place].disk].event_time == dealt_[place].time ? 1 : 0;
    }
    head = none;
    if (due_count_ > 0) break;
  }
  sort_due(disks);
  return true;
}

void Calendar::make_room_for_found() {
  found_.resize(2 * found_.size() + 64);
  due_.resize(found_.size());
}

void Calendar::sort_due(MovingDisk const* disks) {
  auto const comes_first = [disks](ScheduledEvent const& a, ScheduledEvent const& b) { return is_before(a, b, disks); };
  if (due_count_ > max_counted) {
    std::copy_n(found_.begin(), due_count_, due_.begin());
    std::sort(due_.data(), due_.data() + due_count_, comes_first);
  } else if (!sort_due()) {
    // After a draw of all velocities two disks wait for most collisions, at the same time. Only their order is open.
    for (std::size_t k = 1; k < due_count_; ++k) {
      for (std::size_t j = k; j > 0 && comes_first(due_[j], due_[j - 1]); --j) std::swap(due_[j], due_[j - 1]);
    }
  }
}

/// Sorts the events by the number of earlier events. Returns false where two have the same time: they are side by side
/// then, in any order.
bool Calendar::sort_due() {
  std::array<double, max_counted> times;
  std::array<std::uint64_t, max_counted> places;
  std::size_t const batches = (due_count_ + times_per_batch - 1) / times_per_batch;
  std::fill_n(times.begin() + static_cast<std::ptrdiff_t>((batches - 1) * times_per_batch), times_per_batch, never);
  for (std::size_t k = 0; k < due_count_; ++k) times[k] = found_[k].time;
  count_earlier_(times.data(), batches, places.data());
  std::uint64_t sum = 0;
  for (std::size_t k = 0; k < due_count_; ++k) {
    due_[places[k]] = found_[k];
    sum += places[k];
  }
  if (sum == due_count_ * (due_count_ - 1) / 2) return true;
  std::uint64_t taken = 0;
  static_assert(max_counted <= 64);
  for (std::size_t k = 0; k < due_count_; ++k) {
    std::uint64_t const place = places[k] + static_cast<std::uint64_t>(std::countr_one(taken >> places[k]));
    taken |= std::uint64_t{1} << place;
    due_[place] = found_[k];
  }
  return false;
}

bool Calendar::open_next_group() {
  if (open_group_ + 1 == tails_.size()) {
    --open_bucket_;  // stay in the last bucket, so that a later call finds the end again
    return false;
  }
  ++open_group_;
  dealt_.clear();
  std::uint32_t count = tails_[open_group_].count;
  for (std::uint32_t chunk = tails_[open_group_].chunk; chunk != none; chunk = chunks_[chunk].next) {
    for (std::uint32_t k = 0; k < count; ++k) {
      ScheduledEvent const& event = chunks_[chunk].entries[k];
      deal(event, static_cast<std::uint32_t>(event.time * buckets_per_time_));
    }
    free_chunks_.push_back(chunk);
    count = chunk_size;
  }
  tails_[open_group_] = {};
  return true;
}

}  // namespace gridlock::exact
