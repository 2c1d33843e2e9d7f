#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "engine/exact/flight.hpp"
#include "gridlock/core/detail/thread_pool.hpp"
#include "gridlock/engine/engine.hpp"

namespace gridlock::exact {

/// The division of a box into strips, one above the other. Depths are distances from a strip's own disks.
struct StripPlan {
  std::size_t count = 0;  ///< number of strips; 0 where one thread is faster
  double window = 0.0;    ///< time for which strips fly independently
  double checked = 0.0;   ///< depth up to which a strip's copies are compared with their originals
  double flown = 0.0;     ///< depth up to which copies fly at the end of a window
  double reach = 0.0;     ///< depth up to which copies are right when a window begins
  double margin = 0.0;    ///< largest displacement of a disk in an epoch, by which copies are deeper than `reach`
};

/// The lowest and the highest of a set of heights.
struct Extent {
  double lowest = std::numeric_limits<double>::infinity();
  double highest = -std::numeric_limits<double>::infinity();

  void include(double y) {
    lowest = y < lowest ? y : lowest;
    highest = y > highest ? y : highest;
  }
};

/// The disks that a strip owns, and copies of the disks around it, which other strips own.
///
/// Disks beyond the copies are missing, so that the outermost copies fly wrongly, then those they hit, and so on
/// inwards, disk by disk. The strip's own disks are right as long as no copy that they may meet has gone wrong. Heights
/// are counted from the middle of the strip, to the nearest image.
class alignas(128) Strip final : public Flight {  // aligned, so that no two strips share a cache line
 public:
  explicit Strip(Box const& box) : Flight(box) {}

  /// Copies its disks and those around from `whole`; writes this strip to `owner` and the index here to `place` of each
  /// own disk.
  void load(Flight const& whole, StripPlan const& plan, std::size_t self, double time,
            std::vector<std::uint16_t>& owner, std::vector<Index>& place);
  /// The heights of its disks at the start of a window; prepare() needs those of the adjacent strips.
  [[nodiscard]] Extent const& extent() const { return extent_; }
  void prepare(Flight const& whole, Extent const& below, Extent const& above, double time);
  /// Flies to the end of the window.
  void fly(double start, double end);
  /// Returns whether copies that took part in events here moved as their originals. Contract: every strip has flown.
  [[nodiscard]] bool agrees_with(std::vector<Strip> const& strips, std::vector<std::uint16_t> const& owner,
                                 std::vector<Index> const& place);
  /// Copies the disks that this strip owns to `whole`.
  void hand_over(Flight& whole) const;

  /// An event of the strip's disks that is counted: a pair collision with its virial, or a wall hit with its impulse.
  struct Counted {
    double time;
    double amount;
  };
  /// Pair collisions, hits of each of the four walls, and hits of walls inside the box.
  static constexpr std::size_t kinds_of_counts = 6;
  /// Returns the events of one kind from `start` on and before `end`, in the order of time.
  [[nodiscard]] std::span<Counted const> counted(std::size_t kind, double start, double end) const;
  [[nodiscard]] bool has_none(std::size_t kind) const { return counted_[kind].empty(); }
  [[nodiscard]] std::uint64_t moves() const { return moves_; }
  [[nodiscard]] std::uint64_t own_hits() const { return own_hits_; }
  [[nodiscard]] std::uint64_t events_made() const { return calendar_.made(); }
  [[nodiscard]] double last_event() const { return last_event_; }
  [[nodiscard]] bool has_events() { return next_event() != nullptr; }
  /// The smallest depth of a wrong copy minus the depth of the copies that are compared.
  [[nodiscard]] double slack() const { return slack_; }

  /// The heights at which its disks were in the window; below, of disks that the adjacent strips do not compare.
  [[nodiscard]] Extent const& been() const { return been_; }
  [[nodiscard]] double lowest_unchecked() const { return lowest_unchecked_; }
  [[nodiscard]] double highest_unchecked() const { return highest_unchecked_; }

 private:
  struct Observer;
  // Marks of a disk. The strip below has a copy of it, and compares the copy after the window; the same above.
  static constexpr std::uint8_t copied_below = 1;
  static constexpr std::uint8_t copied_above = 2;
  static constexpr std::uint8_t checked_below = 4;
  static constexpr std::uint8_t checked_above = 8;
  static constexpr std::uint8_t is_checked = 16;  ///< mark of a copy that is compared

  [[nodiscard]] double height_of(Index i, double time) const;
  [[nodiscard]] double depth_of(Index copy, double time) const;
  void note(Index i, double height);
  void renew_copies(Flight const& whole, double time);
  void copy(Flight const& whole, Index i);

  double middle_ = 0.0;
  double period_ = 0.0;          // height of the periodic box; infinity between walls
  std::size_t own_ = 0;          // number of own disks; copies follow behind them
  std::vector<Index> original_;  // index in the whole
  std::vector<std::uint8_t> marks_;
  std::vector<double> heights_;  // heights of own disks at the start or the end of a window
  std::vector<Index> renewed_;
  StripPlan plan_;
  Extent extent_;

  // Numbers of the present window:
  double end_ = 0.0;
  Extent been_;
  double lowest_unchecked_ = 0.0;
  double highest_unchecked_ = 0.0;
  bool is_wrong_ = false;
  double slack_ = 0.0;
  std::array<std::vector<Counted>, kinds_of_counts> counted_;
  std::uint64_t moves_ = 0;
  std::uint64_t own_hits_ = 0;
  double last_event_ = 0.0;
};

/// A flight shared among threads: the box is divided into strips that fly independently for a window of time.
///
///     ──────────────── ┐         Before a window each strip copies the disks near it. After the window the copies that
///      strip 1         │ copies  its disks may have met are compared with the originals: the same bits mean that both
///     ─ ─ ─ ─ ─ ─ ─ ─  ┤ of 1's  strips saw the same collisions, and the window is valid. Otherwise it is discarded,
///      strip 0         │ in 0    and one thread flies it.
///
/// Proof: take the first time at which a disk in its own strip moves otherwise than it would in the whole. Until then
/// all disks in their own strips were right, and so were all copies that agree with their originals at the end. At this
/// time the disk either meets a copy, which then is one of those compared, or does not meet a disk of which the strip
/// had no compared copy. That disk then was nearer than uncompared disks of the two strips ever came. Both cases are
/// checked, so the bits do not depend on the strips.
class Strips {
 public:
  explicit Strips(ThreadPool& threads) : threads_(threads) {}

  /// Returns the number and size of strips that are faster than one thread, for disks with `hits_per_time` hits each on
  /// average; `caution` is a factor of all depths.
  static StripPlan plan(Flight const& whole, std::size_t threads, double hits_per_time, double caution,
                        bool wherever_possible);

  /// Divides the disks of `whole` among strips.
  void begin(Flight const& whole, StripPlan const& plan, double time);
  /// Flies to `end`, at most a window later, writes all disks back and counts the events. Returns false, and changes
  /// nothing, where the strips do not agree.
  [[nodiscard]] bool fly(Flight& whole, double end, Counters& counters);

  [[nodiscard]] double time() const { return time_; }
  [[nodiscard]] StripPlan const& plan() const { return plan_; }
  [[nodiscard]] std::uint64_t hits_in_window() const;
  [[nodiscard]] std::uint64_t moves_in_window() const;
  [[nodiscard]] std::uint64_t events_made() const;
  [[nodiscard]] double last_event() const;
  [[nodiscard]] double slack() const;
  [[nodiscard]] bool has_events();

 private:
  [[nodiscard]] bool are_apart(std::size_t below, std::size_t above) const;
  [[nodiscard]] bool count_window(double start, double end, Counters& counters);

  ThreadPool& threads_;
  StripPlan plan_;
  double time_ = 0.0;
  double contact_ = 0.0;
  double height_ = 0.0;
  bool is_periodic_ = false;
  std::vector<Strip> strips_;
  std::vector<std::vector<Strip::Counted>> slices_;
  std::vector<std::uint16_t> owner_;  // strip that owns each disk of the whole
  std::vector<Index> place_;          // index of each disk in the strip that owns it
};

}  // namespace gridlock::exact
