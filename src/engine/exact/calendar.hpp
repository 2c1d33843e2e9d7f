#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "engine/exact/count_earlier.hpp"
#include "engine/exact/moving_disk.hpp"
#include "gridlock/core/detail/large_array.hpp"

namespace gridlock::exact {

/// An event of a disk in the calendar.
struct ScheduledEvent {
  double time;
  Index disk;
  std::uint32_t next;  ///< index of the next event of the same bucket
};

/// Calendar queue (R. Brown, Commun. ACM 31, 1220, 1988): the events of one epoch [0, length), handed out in the order
/// of (time, id index of the disk).
///
///     epoch   ├────────────┼────────────┼────────────┤   groups: unsorted, in chunks of memory
///     group                ├─┼─┼─┼─┼─┼─┼─┤               buckets of the open group: short lists
///     bucket                   ├┤                        the open bucket: sorted, a few events
///
/// An event is written at the end of its group, dealt into buckets when the group opens, and sorted when its
/// bucket opens: three sequential passes without a tree, a search or a removal. A void event stays until its time and
/// is dropped then, because its disk waits for an event at another time.
/// Events at or after the end of the epoch are not stored: they are predicted again when the next epoch opens.
/// Cost: O(1) amortised while a bucket holds a few events.
class Calendar {
 public:
  /// Starts an empty epoch. `expected` is about the number of events that will be scheduled in it, `disks` the number
  /// of disks. Both change the cost, never the order.
  void open(double length, std::uint64_t expected, std::uint64_t disks);

  /// Schedules an event. Contract: it is no earlier than the last event that next() returned.
  void add(double time, Index disk, MovingDisk const* disks) {
    if (!(time < length_)) return;
    ++made_;
    auto const bucket = static_cast<std::uint32_t>(time * buckets_per_time_);
    if (bucket <= open_bucket_ && is_open_) {
      add_to_open_bucket(time, disk, disks);
    } else if (bucket >> bucket_bits_ == open_group_) {
      deal({time, disk, 0}, bucket);
    } else {
      add_to_group(bucket >> bucket_bits_, time, disk);
    }
  }

  /// Returns the next event without removing it, or nullptr at the end of the epoch. The event may be void.
  ScheduledEvent const* next(MovingDisk const* disks) {
    for (;;) {
      bool const has_late = !late_.empty();
      if (cursor_ < due_count_) {
        if (has_late && is_before(late_.front(), due_[cursor_], disks)) return &late_.front();
        return &due_[cursor_];
      }
      if (has_late) return &late_.front();
      if (!open_next_bucket(disks)) return nullptr;
    }
  }

  /// Removes the event that next() returned.
  void pop(ScheduledEvent const* handed_out, MovingDisk const* disks) {
    if (cursor_ < due_count_ && handed_out == &due_[cursor_]) {
      ++cursor_;
    } else {
      pop_late(disks);
    }
  }

  /// Returns the disk of the event `events` after the next one in the open bucket; no_disk where there is none.
  [[nodiscard]] Index disk_after_next(std::size_t events) const {
    return cursor_ + events < due_count_ ? due_[cursor_ + events].disk : no_disk;
  }

  /// The index of the open bucket in the epoch.
  [[nodiscard]] std::uint32_t open_bucket() const { return open_bucket_; }

  /// Calls visit(disk, time) for each event of the bucket `ahead` after the open one, if it is in the same group.
  template <class Visit>
  void for_each_ahead(std::uint32_t ahead, Visit visit) const {
    std::uint32_t const bucket = open_bucket_ + ahead;
    if (bucket >> bucket_bits_ != open_group_) return;
    std::uint32_t place = bucket_heads_[bucket & bucket_mask_];
    for (; place != none; place = dealt_[place].next) visit(dealt_[place].disk, dealt_[place].time);
  }

  /// Number of events scheduled since open().
  [[nodiscard]] std::uint64_t made() const { return made_; }

 private:
  static constexpr std::uint32_t none = 0xFFFFFFFFU;
  static constexpr std::uint32_t chunk_size = 31;

  struct Chunk {
    ScheduledEvent entries[chunk_size];
    std::uint32_t next;
  };

  static bool is_before(ScheduledEvent const& a, ScheduledEvent const& b, MovingDisk const* disks) {
    if (a.time != b.time) return a.time < b.time;
    return disks[a.disk].id_index < disks[b.disk].id_index;
  }
  void deal(ScheduledEvent event, std::uint32_t bucket) {
    std::uint32_t& head = bucket_heads_[bucket & bucket_mask_];
    event.next = head;
    head = static_cast<std::uint32_t>(dealt_.size());
    dealt_.push_back(event);
  }
  void add_to_open_bucket(double time, Index disk, MovingDisk const* disks);
  void add_to_group(std::uint32_t group, double time, Index disk);
  void pop_late(MovingDisk const* disks);
  bool open_next_bucket(MovingDisk const* disks);
  void make_room_for_found();
  void sort_due(MovingDisk const* disks);
  bool sort_due();
  bool open_next_group();
  std::uint32_t new_chunk(std::uint32_t next);

  /// The newest chunk of a group and the number of events in it; older chunks are full. The number is here and not in
  /// the chunk, so that a new event touches one cache line of its group.
  struct Tail {
    std::uint32_t chunk = none;
    std::uint32_t count = chunk_size;
  };

  double length_ = 0.0;
  double buckets_per_time_ = 0.0;
  std::uint64_t made_ = 0;
  std::uint32_t bucket_bits_ = 0;  // binary logarithm of the buckets in a group
  std::uint32_t bucket_mask_ = 0;  // buckets in a group minus one
  std::uint32_t open_group_ = 0;
  std::uint32_t open_bucket_ = 0;
  bool is_open_ = false;     // whether the group open_group_ has been dealt into buckets
  std::vector<Tail> tails_;  // one tail for each group
  LargeArray<Chunk> chunks_;
  std::vector<std::uint32_t> free_chunks_;
  std::vector<std::uint32_t> bucket_heads_;
  std::vector<ScheduledEvent> dealt_;
  CountEarlier count_earlier_ = count_earlier_kernel(target());
  std::vector<ScheduledEvent> found_;  // events of the open bucket, unsorted
  std::vector<ScheduledEvent> due_;    // events of the open bucket, sorted: the first due_count_; cursor_ is the next
  std::size_t due_count_ = 0;
  std::size_t cursor_ = 0;
  std::vector<ScheduledEvent> late_;  // heap of the events scheduled for the open bucket after it was opened
};

}  // namespace gridlock::exact
