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

/// How a box is cut into strips, one above the other.
struct StripPlan {
  std::size_t count = 0;  ///< of strips; 0: they do not pay
  double window = 0.0;    ///< the time for which they fly apart
  double checked = 0.0;   ///< how deep the copies are compared that each has of its neighbours' disks
  double flown = 0.0;     ///< how deep they fly up to the end of a window
  double reach = 0.0;     ///< how deep they are right when a window begins
  double margin = 0.0;    ///< how far disks may get in an epoch: so much deeper are there copies
};

/// The lowest and the highest of some heights.
struct Extent {
  double lowest = std::numeric_limits<double>::infinity();
  double highest = -std::numeric_limits<double>::infinity();

  void include(double y) {
    lowest = y < lowest ? y : lowest;
    highest = y > highest ? y : highest;
  }
};

/// The disks of a strip, which fly here alone, and copies of those around it, which fly here and in their own strip.
///
/// Disks beyond the copies are not there, so that the outermost fly wrongly, and those they hit, and so on inwards:
/// disk by disk, as slowly as disks collide. As long as no copy that a disk of the strip may meet has been reached, the
/// strip is right. Heights are counted from the middle of the strip, to the nearest image.
class alignas(128) Strip final : public Flight {  // no two share a cache line
 public:
  explicit Strip(Box const& box) : Flight(box) {}

  /// Takes its disks and copies from the whole, as they are at this time; `owner` and `place` are told where the disks
  /// of the strip are.
  void load(Flight const& whole, StripPlan const& plan, std::size_t self, double time,
            std::vector<std::uint16_t>& owner, std::vector<Index>& place);
  /// Says how high its disks reach at the start of a window; then, when all have said so, gets ready for it.
  [[nodiscard]] Extent const& extent() const { return extent_; }
  void prepare(Flight const& whole, Extent const& below, Extent const& above, double time);
  /// Flies to the end of the window.
  void fly(double start, double end);
  /// Returns whether each copy of another strip's disk that took part in events here moved as the disk itself did. To
  /// be called when every strip has flown.
  [[nodiscard]] bool agrees_with(std::vector<Strip> const& strips, std::vector<std::uint16_t> const& owner,
                                 std::vector<Index> const& place);
  /// Copies the disks that this strip owns into `whole`, which has those of all strips.
  void hand_over(Flight& whole) const;

  /// An event of its disks in the window that is counted: a collision of two with its virial, or a hit of a wall with
  /// its impulse.
  struct Counted {
    double time;
    double amount;
  };
  static constexpr std::size_t kinds_of_counts = 5;  ///< collisions, and hits of each wall
  /// Those from `start` on and before `end`, in the order of time.
  [[nodiscard]] std::span<Counted const> counted(std::size_t kind, double start, double end) const;
  [[nodiscard]] bool has_none(std::size_t kind) const { return counted_[kind].empty(); }
  [[nodiscard]] std::uint64_t moves() const { return moves_; }
  [[nodiscard]] std::uint64_t own_hits() const { return own_hits_; }
  [[nodiscard]] std::uint64_t events_made() const { return calendar_.made(); }
  [[nodiscard]] double last_event() const { return last_event_; }
  [[nodiscard]] bool has_events() { return next_event() != nullptr; }
  /// How much deeper than those that count were the copies that went wrong.
  [[nodiscard]] double slack() const { return slack_; }

  /// Where in the window its disks have been: all, and those that the copies compared by the strips below and above are
  /// not of.
  [[nodiscard]] Extent const& been() const { return been_; }
  [[nodiscard]] double lowest_unchecked() const { return lowest_unchecked_; }
  [[nodiscard]] double highest_unchecked() const { return highest_unchecked_; }

 private:
  struct Observer;
  // Marks of a disk of the strip: the strip below has a copy, and compares it after the window.
  static constexpr std::uint8_t copied_below = 1;
  static constexpr std::uint8_t copied_above = 2;
  static constexpr std::uint8_t checked_below = 4;
  static constexpr std::uint8_t checked_above = 8;
  static constexpr std::uint8_t is_checked = 16;  ///< of a copy

  [[nodiscard]] double height_of(Index i, double time) const;
  [[nodiscard]] double depth_of(Index copy, double time) const;
  void note(Index i, double height);
  void renew_copies(Flight const& whole, double time);
  void copy(Flight const& whole, Index i);

  double middle_ = 0.0;
  double period_ = 0.0;          // of heights; infinity between walls
  std::size_t own_ = 0;          // disks; behind them the copies
  std::vector<Index> original_;  // in the whole
  std::vector<std::uint8_t> marks_;
  std::vector<double> heights_;  // of its disks where a window begins or ends
  std::vector<Index> renewed_;
  StripPlan plan_;
  Extent extent_;

  // Of the window.
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

/// A flight shared among threads: the box is cut into strips, each of which flies by itself for a window of time.
///
///     ──────────────── ┐             Before a window each strip takes copies of the disks near it. After it the copies that its
///      strip 1         │ copies      disks may have met are compared with what became of the originals: the same bits mean that both
///     ─ ─ ─ ─ ─ ─ ─ ─  ┤ of 1's      strips saw the same collisions. Then the window is good. Else it is given up, and one
///      strip 0         │ in 0        thread flies it.
///
/// The proof: take the first moment at which a disk in its own strip does what it would not do in the whole. Up to then
/// all disks in their own strips were right, and so were all copies that agree with them at the end. At this moment it
/// either meets a copy, which must be one of those compared, or does not meet a disk of which it had no such copy,
/// which then was nearer than the two strips' unchecked disks have been to each other. Both are looked at. So bits do
/// not depend on the strips.
class Strips {
 public:
  explicit Strips(ThreadPool& threads) : threads_(threads) {}

  /// How many of which height pay, for disks that are hit `hits_per_time` times each on average; `caution` widens
  /// everything.
  static StripPlan plan(Flight const& whole, std::size_t threads, double hits_per_time, double caution,
                        bool wherever_possible);

  /// Takes all disks.
  void begin(Flight const& whole, StripPlan const& plan, double time);
  /// Flies to `end`, at most a window later, hands all disks back and counts what happened; or changes nothing and says
  /// no.
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
  std::vector<std::uint16_t> owner_;  // of each disk of the whole
  std::vector<Index> place_;          // in its strip
};

}  // namespace gridlock::exact
