#include "engine/exact/calendar.hpp"

#include <algorithm>
#include <bit>

namespace gridlock::exact {

namespace {

constexpr std::uint64_t per_slice = 8;
constexpr std::uint64_t most_slices = std::uint64_t{1} << 30;

}  // namespace

void Calendar::open(double length, std::uint64_t expected, std::uint64_t disks) {
  // A power of two of slices in an epoch whose length is one, so that the slice of a time is found without rounding.
  std::uint64_t const slices =
      std::bit_ceil(std::clamp<std::uint64_t>(expected / per_slice, std::uint64_t{1} << slice_bits_, most_slices));
  length_ = length;
  slices_per_time_ = static_cast<double>(slices) / length;
  made_ = 0;
  tails_.assign(slices >> slice_bits_, Tail{});
  slice_heads_.assign(std::size_t{1} << slice_bits_, none);
  // Room for each disk's appointment and two void ones, so that it never grows: growing would need it twice for a moment.
  // What is not used is not touched, and costs nothing.
  chunks_.reserve(3 * disks / chunk_size + tails_.size());
  free_chunks_.clear();
  chunks_.clear();
  dealt_.clear();
  due_count_ = 0;
  late_.clear();
  cursor_ = 0;
  open_chapter_ = 0;
  open_slice_ = 0;
  is_open_ = false;
}

void Calendar::add_to_open_slice(double time, Index disk, MovingDisk const* disks) {
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

void Calendar::add_to_chapter(std::uint32_t chapter, double time, Index disk) {
  Tail& tail = tails_[chapter];
  if (tail.count == chunk_size) tail = {new_chunk(tail.chunk), 0};
  chunks_[tail.chunk].entries[tail.count++] = {time, disk, 0};
}

bool Calendar::open_next_slice(MovingDisk const* disks) {
  std::uint32_t const slices = 1U << slice_bits_;
  due_count_ = 0;
  cursor_ = 0;
  for (;;) {
    if (is_open_) {
      ++open_slice_;
      if (open_slice_ % slices == 0 && !open_next_chapter()) return false;
    }
    is_open_ = true;
    std::uint32_t& head = slice_heads_[open_slice_ % slices];
    for (std::uint32_t place = head; place != none; place = dealt_[place].next) {
      if (due_count_ == due_.size()) due_.resize(2 * due_.size() + 16);
      // Whether an appointment is void is a coin toss, so it is overwritten rather than branched around.
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
  auto const order = [disks](Appointment const& a, Appointment const& b) { return is_before(a, b, disks); };
  Appointment* const first = due_.data();
  if (due_count_ > 32) {
    std::sort(first, first + due_count_, order);
    return;
  }
  for (std::size_t k = 1; k < due_count_; ++k) {
    Appointment const inserted = first[k];
    std::size_t place = k;
    for (; place > 0 && order(inserted, first[place - 1]); --place) first[place] = first[place - 1];
    first[place] = inserted;
  }
}

bool Calendar::open_next_chapter() {
  if (open_chapter_ + 1 == tails_.size()) {
    --open_slice_;  // stay in the last slice: asking again gives the same answer
    return false;
  }
  ++open_chapter_;
  dealt_.clear();
  std::uint32_t count = tails_[open_chapter_].count;
  for (std::uint32_t chunk = tails_[open_chapter_].chunk; chunk != none; chunk = chunks_[chunk].next) {
    for (std::uint32_t k = 0; k < count; ++k) {
      Appointment const& appointment = chunks_[chunk].entries[k];
      deal(appointment, static_cast<std::uint32_t>(appointment.time * slices_per_time_));
    }
    free_chunks_.push_back(chunk);
    count = chunk_size;
  }
  tails_[open_chapter_] = {};
  return true;
}

}  // namespace gridlock::exact
