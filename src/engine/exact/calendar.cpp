#include "engine/exact/calendar.hpp"

#include <algorithm>
#include <bit>

namespace gridlock::exact {

namespace {

constexpr std::uint64_t per_slice = 4;
constexpr std::uint64_t most_slices = std::uint64_t{1} << 30;

}  // namespace

void Calendar::open(double length, std::uint64_t expected) {
  // A power of two of slices in an epoch whose length is one, so that the slice of a time is found without rounding.
  std::uint64_t const slices =
      std::bit_ceil(std::clamp<std::uint64_t>(expected / per_slice, std::uint64_t{1} << slice_bits_, most_slices));
  length_ = length;
  slices_per_time_ = static_cast<double>(slices) / length;
  made_ = 0;
  chapter_heads_.assign(slices >> slice_bits_, none);
  slice_heads_.assign(std::size_t{1} << slice_bits_, none);
  free_chunks_.clear();
  chunks_.clear();
  dealt_.clear();
  due_.clear();
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
  chunks_[chunk].count = 0;
  chunks_[chunk].next = next;
  return chunk;
}

void Calendar::add_to_chapter(std::uint32_t chapter, double time, Index disk) {
  std::uint32_t& head = chapter_heads_[chapter];
  if (head == none || chunks_[head].count == chunk_size) head = new_chunk(head);
  Chunk& chunk = chunks_[head];
  chunk.entries[chunk.count++] = {time, disk, 0};
}

bool Calendar::open_next_slice(MovingDisk const* disks) {
  std::uint32_t const slices = 1U << slice_bits_;
  due_.clear();
  cursor_ = 0;
  for (;;) {
    if (is_open_) {
      ++open_slice_;
      if (open_slice_ % slices == 0 && !open_next_chapter()) return false;
    }
    is_open_ = true;
    std::uint32_t& head = slice_heads_[open_slice_ % slices];
    for (std::uint32_t place = head; place != none; place = dealt_[place].next) {
      Appointment const& appointment = dealt_[place];
      if (disks[appointment.disk].event_time == appointment.time) due_.push_back(appointment);
    }
    head = none;
    if (!due_.empty()) break;
  }
  std::ranges::sort(due_, [disks](auto const& a, auto const& b) { return is_before(a, b, disks); });
  return true;
}

bool Calendar::open_next_chapter() {
  if (open_chapter_ + 1 == chapter_heads_.size()) {
    --open_slice_;  // stay in the last slice: asking again gives the same answer
    return false;
  }
  ++open_chapter_;
  dealt_.clear();
  std::uint32_t& head = chapter_heads_[open_chapter_];
  for (std::uint32_t chunk = head; chunk != none; chunk = chunks_[chunk].next) {
    for (std::uint32_t k = 0; k < chunks_[chunk].count; ++k) {
      Appointment const& appointment = chunks_[chunk].entries[k];
      deal(appointment, static_cast<std::uint32_t>(appointment.time * slices_per_time_));
    }
    free_chunks_.push_back(chunk);
  }
  head = none;
  return true;
}

}  // namespace gridlock::exact
