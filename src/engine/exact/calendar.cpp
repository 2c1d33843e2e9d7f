#include "engine/exact/calendar.hpp"

#include <algorithm>
#include <bit>

namespace gridlock::exact {

namespace {

constexpr std::uint64_t per_bucket = 8;
constexpr std::uint64_t most_buckets = std::uint64_t{1} << 30;

}  // namespace

void Calendar::open(double length, std::uint64_t expected, std::uint64_t disks) {
  // A power of two of buckets in an epoch whose length is one, so that the bucket of a time is found without rounding.
  std::uint64_t const buckets =
      std::bit_ceil(std::clamp<std::uint64_t>(expected / per_bucket, std::uint64_t{1} << bucket_bits_, most_buckets));
  length_ = length;
  buckets_per_time_ = static_cast<double>(buckets) / length;
  made_ = 0;
  tails_.assign(buckets >> bucket_bits_, Tail{});
  bucket_heads_.assign(std::size_t{1} << bucket_bits_, none);
  // Room for each disk's event and two void ones, so that it never grows: growing would need it twice for a short time.
  // What is not used is not touched, and costs nothing.
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
  std::uint32_t const buckets = 1U << bucket_bits_;
  due_count_ = 0;
  cursor_ = 0;
  for (;;) {
    if (is_open_) {
      ++open_bucket_;
      if (open_bucket_ % buckets == 0 && !open_next_group()) return false;
    }
    is_open_ = true;
    std::uint32_t& head = bucket_heads_[open_bucket_ % buckets];
    for (std::uint32_t place = head; place != none; place = dealt_[place].next) {
      if (due_count_ == due_.size()) due_.resize(2 * due_.size() + 16);
      // Whether an event is void is a coin toss, so it is overwritten rather than branched around.
      due_[due_count_] = dealt_[place];
      due_count_ += disks[dealt_[place].disk].event_time == dealt_[place].time ? 1 : 0;
    }
    head = none;
    if (due_count_ > 0) break;
  }
  sort_due(disks);
  return true;
}

void Calendar::sort_due(MovingDisk const* disks) {
  auto const order = [disks](ScheduledEvent const& a, ScheduledEvent const& b) { return is_before(a, b, disks); };
  ScheduledEvent* const first = due_.data();
  if (due_count_ > 32) {
    std::sort(first, first + due_count_, order);
    return;
  }
  for (std::size_t k = 1; k < due_count_; ++k) {
    ScheduledEvent const inserted = first[k];
    std::size_t place = k;
    for (; place > 0 && order(inserted, first[place - 1]); --place) first[place] = first[place - 1];
    first[place] = inserted;
  }
}

bool Calendar::open_next_group() {
  if (open_group_ + 1 == tails_.size()) {
    --open_bucket_;  // stay in the last bucket: asking again gives the same answer
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
