#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "engine/exact/moving_disk.hpp"
#include "gridlock/core/large_array.hpp"

namespace gridlock::exact {

/// Who is due when.
struct Appointment {
  double time;
  Index disk;
  std::uint32_t next;  ///< place of the next appointment of the same slice
};

/// The events of one epoch [0, length), handed out in the order of (time, rank of the disk).
///
///     epoch   ├────────────┼────────────┼────────────┤   chapters: unsorted, in chunks of memory
///     chapter              ├─┼─┼─┼─┼─┼─┼─┤               slices of the open chapter: short lists
///     slice                    ├┤                        the open slice: sorted, a few appointments
///
/// An appointment is written at the end of its chapter, dealt into slices when the chapter opens, and sorted when its
/// slice opens: three sequential passes, no tree, no search and no removal. One that became void stays until its time
/// and is dropped then, because its disk waits for another time.
/// Appointments at or after the end of the epoch are not kept; whoever opens the next epoch makes them again.
/// Cost: O(1) amortised while a slice holds a few appointments.
class Calendar {
 public:
  /// Starts an empty epoch. `expected` is about how many appointments will be made in it, `disks` how many disks make
  /// them: numbers that change the cost, never the order.
  void open(double length, std::uint64_t expected, std::uint64_t disks);

  /// Makes an appointment, not before the last one handed out.
  void add(double time, Index disk, MovingDisk const* disks) {
    if (!(time < length_)) return;
    ++made_;
    auto const slice = static_cast<std::uint32_t>(time * slices_per_time_);
    if (slice <= open_slice_ && is_open_) {
      add_to_open_slice(time, disk, disks);
    } else if (slice >> slice_bits_ == open_chapter_) {
      deal({time, disk, 0}, slice);
    } else {
      add_to_chapter(slice >> slice_bits_, time, disk);
    }
  }

  /// The next appointment without removing it, or nullptr at the end of the epoch. It may be void.
  Appointment const* next(MovingDisk const* disks) {
    for (;;) {
      bool const has_late = !late_.empty();
      if (cursor_ < due_count_) {
        if (has_late && is_before(late_.front(), due_[cursor_], disks)) return &late_.front();
        return &due_[cursor_];
      }
      if (has_late) return &late_.front();
      if (!open_next_slice(disks)) return nullptr;
    }
  }

  /// Removes the appointment that next() pointed to.
  void pop(Appointment const* handed_out, MovingDisk const* disks) {
    if (cursor_ < due_count_ && handed_out == &due_[cursor_]) {
      ++cursor_;
    } else {
      pop_late(disks);
    }
  }

  /// Which slice of the epoch is open.
  [[nodiscard]] std::uint32_t open_slice() const { return open_slice_; }

  /// Calls visit(disk, time) for the appointments `ahead` slices after the open one, as far as they are in this chapter.
  template <class Visit>
  void for_each_ahead(std::uint32_t ahead, Visit visit) const {
    std::uint32_t const slice = open_slice_ + ahead;
    if (slice >> slice_bits_ != open_chapter_) return;
    std::uint32_t place = slice_heads_[slice & ((1U << slice_bits_) - 1)];
    for (; place != none; place = dealt_[place].next) visit(dealt_[place].disk, dealt_[place].time);
  }

  /// Appointments made since open().
  [[nodiscard]] std::uint64_t made() const { return made_; }

 private:
  static constexpr std::uint32_t none = 0xFFFFFFFFU;
  static constexpr std::uint32_t slice_bits_ = 9;  // slices per chapter: the open one fits in the second cache
  static constexpr std::uint32_t chunk_size = 31;

  struct Chunk {
    Appointment entries[chunk_size];
    std::uint32_t next;
  };

  static bool is_before(Appointment const& a, Appointment const& b, MovingDisk const* disks) {
    if (a.time != b.time) return a.time < b.time;
    return disks[a.disk].rank < disks[b.disk].rank;
  }
  void deal(Appointment appointment, std::uint32_t slice) {
    std::uint32_t& head = slice_heads_[slice & ((1U << slice_bits_) - 1)];
    appointment.next = head;
    head = static_cast<std::uint32_t>(dealt_.size());
    dealt_.push_back(appointment);
  }
  void add_to_open_slice(double time, Index disk, MovingDisk const* disks);
  void add_to_chapter(std::uint32_t chapter, double time, Index disk);
  void pop_late(MovingDisk const* disks);
  bool open_next_slice(MovingDisk const* disks);
  void sort_due(MovingDisk const* disks);
  bool open_next_chapter();
  std::uint32_t new_chunk(std::uint32_t next);

  /// The newest chunk of a chapter, and how many appointments are in it; the older ones are full. The count stands here
  /// and not in the chunk, so that a new appointment touches one line of memory of its chapter.
  struct Tail {
    std::uint32_t chunk = none;
    std::uint32_t count = chunk_size;
  };

  double length_ = 0.0;
  double slices_per_time_ = 0.0;
  std::uint64_t made_ = 0;
  std::uint32_t open_chapter_ = 0;
  std::uint32_t open_slice_ = 0;
  bool is_open_ = false;     // whether open_slice_ has been opened
  std::vector<Tail> tails_;  // by chapter
  LargeArray<Chunk> chunks_;
  std::vector<std::uint32_t> free_chunks_;
  std::vector<std::uint32_t> slice_heads_;
  std::vector<Appointment> dealt_;
  std::vector<Appointment> due_;  // the open slice, sorted: the first due_count_, of which cursor_ is the next
  std::size_t due_count_ = 0;
  std::size_t cursor_ = 0;
  std::vector<Appointment> late_;  // a heap of those made for the open slice after it was opened
};

}  // namespace gridlock::exact
