#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <vector>

#include "engine/exact/flight.hpp"
#include "gridlock/core/detail/thread_pool.hpp"
#include "gridlock/core/disks.hpp"
#include "gridlock/engine/engine.hpp"

namespace gridlock::exact {

struct SavedDisks;
class Strips;
struct StripPlan;

/// Among whom the work is shared; nothing but the cost depends on it. Disks that grow fly on one thread.
struct Sharing {
  ThreadPool* threads = nullptr;   ///< nullptr or a pool of one: nobody
  bool wherever_possible = false;  ///< and not only where it pays
  double caution = 1.0;            ///< at the beginning: of so many times as much as usual are there copies
};

/// How a dynamics goes.
struct DynamicsOptions {
  double rate = 0.0;           ///< every radius is R · (1 + rate · t); 0: constant
  double size_of_cells = 1.0;  ///< in sides of the smallest that will do; nothing but the cost depends on it
  Lists lists = Lists::where_they_pay;
  Sharing sharing = {};
};

/// Where a growth stops: at whichever comes first.
struct EndOfGrowth {
  double scale = std::numeric_limits<double>::infinity();                     ///< by which all radii have grown
  std::uint64_t pair_collisions = std::numeric_limits<std::uint64_t>::max();  ///< of the counters
  std::uint64_t hits = std::numeric_limits<std::uint64_t>::max();             ///< of disks, one or two more
};

/// Hard disks in free flight from event to event: the exact dynamics of a state, in a layout of its own.
///
/// Times are counted from the state it was made of. Inside, they are counted from the start of an epoch, a power of two
/// long in which a disk crosses a few cells, so that positions and event times keep their digits however long the run
/// is. At the end of an epoch every disk's centre moves on to the new zero of time, and every event is predicted anew.
/// Where disks collide so often that an epoch would hold too many events, it is cut. Epochs depend on nothing but the
/// motion: the trajectory has the same bits with any cells and with lists of neighbours.
///
/// Disks may grow while they fly, all in proportion: radius · (1 + rate · t).
/// Contract: a valid state; a periodic box wider and higher than two distances at contact, also when the disks have
/// grown.
class Dynamics final : public Flight {
 public:
  explicit Dynamics(State const& state, DynamicsOptions const& options = {});
  ~Dynamics();

  /// Handles every event up to `elapsed`, or until the counters reach `pair_collisions`, or until `should_continue`,
  /// asked every `events_per_look` events and after each audit, says no; says whether it got to `elapsed`.
  /// Errors: RunFailure where an audit, due every `audit_every` pair collisions, finds what must not be, and where
  /// collisions without end keep the time from passing.
  bool run(double elapsed, std::uint64_t pair_collisions, std::uint64_t audit_every, Counters& counters,
           std::function<bool()> const& should_continue = {});
  static constexpr std::uint64_t events_per_look = std::uint64_t{1} << 14;

  /// The same for disks that grow; says whether it got to the scale.
  bool grow(EndOfGrowth const& end, std::uint64_t audit_every, Counters& counters,
            std::function<bool()> const& should_continue = {});
  /// How often a disk was hit, by a wall or by another, which is a hit for both.
  [[nodiscard]] std::uint64_t hits() const { return hits_; }
  /// Begins a new epoch at the last event, and multiplies all velocities: often enough, some tens of collisions a disk
  /// apart, to keep the calendar small. Contract: the disks grow.
  void renew(double factor_of_velocities = 1.0);
  /// Writes the state as write() does, at the time at which the radii have grown by `scale`. Contract: grow() has said
  /// that it got there.
  void write_grown(double scale, State& state) const { write_at(growth_.scale.time_of(scale), scale, state); }

  /// The time, since the state it was made of, at which they have.
  [[nodiscard]] double time_of(double scale) const {
    return epoch_start_ + (epoch_start_rest_ + growth_.scale.time_of(scale));
  }

  /// Time and collisions since the last call of begin_measurement(), while the disks grow.
  struct Measurement {
    double time = 0.0;
    double virial = 0.0;  ///< of pairs, and of walls as Σ R |Δp|
  };
  [[nodiscard]] Measurement measurement() const { return {growth_.measured_time + now_, growth_.measured_virial}; }
  void begin_measurement() {
    growth_.measured_time = -now_;
    growth_.measured_virial = 0.0;
  }
  /// By which factor the radii have grown.
  [[nodiscard]] double scale() const { return growth_.scale.at(now_); }

  /// The time of the last event handled.
  [[nodiscard]] double last_event() const { return epoch_start_ + (epoch_start_rest_ + now_); }

  /// Whether waiting for a collision can make sense: at least two disks, and one of them moves.
  [[nodiscard]] bool can_collide() const { return size_ > 1 && epoch_length_ > 0.0; }

  /// Writes positions at time `elapsed`, but not before the last event, velocities and images into the state it was
  /// made of, and radii if they grow.
  void write(double elapsed, State& state) const {
    double const time = std::max(elapsed - epoch_start_, now_);
    write_at(time, growth_.scale.at(time), state);
  }
  /// The same at the exact time of the last event, for which the time of a long run has not enough digits: a disk that
  /// has just collided touches its partner, and does not overlap it.
  void write_at_last_event(State& state) const { write_at(now_, scale(), state); }

  /// Throws RunFailure where two disks, or a disk and a wall, overlap by more than 1e-12 diameters, or, for up to 2000
  /// disks, where a collision would be missed: a pair that comes to overlap before either disk's own event.
  void audit() const;
  /// How many audits run() has made, all of which found nothing.
  [[nodiscard]] std::uint64_t audits() const { return audits_; }
  /// Whether audits look for missed collisions too.
  [[nodiscard]] bool looks_for_missed_events() const;

  /// For how long strips of the box fly apart before they are compared; 0 while one thread does all.
  [[nodiscard]] double window() const;
  /// Windows of time in which threads shared the work, and how many of them one of them had to repeat.
  struct WindowCount {
    std::uint64_t flown = 0;
    std::uint64_t given_up = 0;
  };
  [[nodiscard]] WindowCount const& windows() const { return windows_; }

  /// Serializes the disks as they fly and the events they wait for; restored into a dynamics of the state that was
  /// written at the same time. Which memory a disk lies in is not serialized: the trajectory does not depend on it.
  void serialize(Archive& archive);

 private:
  void read_disks(State const& state);
  void choose_epoch();
  void end_epoch(bool may_share);
  /// Shared among threads where disks are known to be hit so often, and where that pays.
  void begin_epoch(double zero, double length, double factor_of_velocities = 1.0, double hits_per_time = 0.0);
  void move_zero_of_time(double zero);
  [[nodiscard]] double longest_epoch() const;
  void cut_epoch();

  void restore(Archive const& archive, SavedDisks const& saved);

  /// Why a run ends: the time has come; there are collisions enough, or it is to end; the epoch is over; or the same is
  /// to go on on another number of threads.
  enum class End { time, early, epoch, sharing };
  template <bool grows, class TimeToStop, class HasEnough>
  End run_until(TimeToStop time_to_stop, HasEnough has_enough, std::uint64_t audit_every, Counters& counters,
                std::function<bool()> const& should_continue);

  // On several threads: sharing.cpp.
  [[nodiscard]] bool share_epoch(double hits_per_time, bool is_sort_due);
  End run_shared(double elapsed, std::uint64_t pair_collisions, std::uint64_t audit_every, Counters& counters,
                 std::function<bool()> const& should_continue);
  void end_sharing();
  void adapt_caution(double slack);
  [[nodiscard]] StripPlan plan_strips() const;
  [[nodiscard]] std::uint64_t events_made() const;
  [[nodiscard]] static std::uint64_t collisions_to_go(std::uint64_t pair_collisions, std::uint64_t audit_every,
                                                      Counters const& counters);
  [[nodiscard]] std::uint64_t collisions_worth_sharing() const { return 8 * size_; }

  // Of disks that grow: growing.cpp.
  void start_growing(double rate);
  void serialize_growth(Archive& archive);

  // Checkpoints of cells and lists: saved_cells.cpp.
  void serialize_lists(Archive& archive);
  void restore_grid(Archive const& archive, std::vector<std::uint64_t> const& cells);
  void restore_cells(Archive const& archive, SavedDisks const& saved);

  void write_at(double time, double scale, State& state) const;

  void require_time_to_pass();
  void audit_overlaps() const;
  void audit_missed_events() const;
  [[nodiscard]] Id id_of(Index i) const { return ids_.empty() ? disks_[i].id_index : ids_[disks_[i].id_index]; }

  std::vector<Id> ids_;  // by id index; empty where the Ids are the indices
  std::vector<std::uint32_t>
      row_of_;  // row in the state, by id index; empty where the rows are in the order of the Ids

  double diameters_in_epoch_ = 0.0;  // at most
  double epoch_start_ = 0.0;
  double epoch_start_rest_ = 0.0;  // what is too small to be added to it
  std::uint64_t epoch_ = 0;
  std::uint64_t hits_before_epoch_ = 0;
  std::uint64_t audits_ = 0;

  Sharing sharing_;
  WindowCount windows_;
  double hits_per_time_ = 0.0;      // of each disk, in the epoch before
  std::unique_ptr<Strips> strips_;  // nullptr while one thread does all

  /// Since when it is watched whether time passes. Only a run that fails depends on it, so it is not serialized.
  struct Watch {
    double passed = 0.0;  ///< up to the start of the epoch
    double now = 0.0;
    std::uint64_t looks = 0;
    std::vector<std::uint32_t> collision_counts;  ///< by id index; empty where there is no suspicion yet
  };
  Watch watch_;
};

}  // namespace gridlock::exact
