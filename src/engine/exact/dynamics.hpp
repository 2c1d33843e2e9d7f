#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <span>
#include <vector>

#include "engine/exact/flight.hpp"
#include "engine/exact/kicked_disks.hpp"
#include "gridlock/core/detail/thread_pool.hpp"
#include "gridlock/core/disks.hpp"
#include "gridlock/engine/engine.hpp"

namespace gridlock::exact {

struct SavedDisks;
class Strips;
struct StripPlan;

/// How threads share the work; it changes nothing but the cost. Growing disks fly on one thread.
struct Sharing {
  ThreadPool* threads = nullptr;   ///< nullptr or a pool of one thread: the work is not shared
  bool wherever_possible = false;  ///< true: also where sharing is slower
  double caution = 1.0;            ///< factor of the depth of copies in strips, at the start of the run
};

/// Options of a dynamics.
struct DynamicsOptions {
  double rate = 0.0;           ///< growth rate: every radius is R · (1 + rate · t); 0 for constant radii
  double size_of_cells = 1.0;  ///< side of the cells over the smallest side allowed; it changes only the cost
  Lists lists = Lists::where_they_pay;
  Sharing sharing = {};
  double thermal_speed_squared = 0.0;  ///< the mean squared speed after kicks; 0: there are none
  Vector gravity = {};                 ///< acceleration of all disks that move
  Losses losses = {};
  std::span<Obstacle const> walls = {};  ///< walls inside the box
};

/// Limits of a growth, which stops at the first that it reaches.
struct EndOfGrowth {
  double scale = std::numeric_limits<double>::infinity();                     ///< factor by which all radii have grown
  std::uint64_t pair_collisions = std::numeric_limits<std::uint64_t>::max();  ///< limit of the counters
  std::uint64_t hits = std::numeric_limits<std::uint64_t>::max();             ///< hits of disks; the growth may stop
                                                                              ///< limit of the hits of disks
};

/// Hard disks in free flight from event to event: the exact dynamics of a state, in a layout of its own. Disks of
/// infinite mass are obstacles, which never move; all numbers below are of the other disks.
///
/// Times are counted from the state that the dynamics was made of. Internally they are counted from the start of an
/// epoch, so that positions and event times keep their digits however long the run is. The length of an epoch is a
/// power of two; a disk crosses a few cells in it. At its end every centre moves to its position at the new start, and
/// every event is predicted anew. An epoch in which disks collide too often is ended early. Epochs depend on the motion
/// alone: the trajectory has the same bits with any cells and with lists of neighbours.
///
/// Disks may grow while they fly, all in proportion: radius · (1 + rate · t).
/// Contract: a valid state; a periodic box wider and higher than two distances at contact, also when the disks have
/// grown.
class Dynamics final : public Flight {
 public:
  explicit Dynamics(State const& state, DynamicsOptions const& options = {});
  ~Dynamics();

  /// Handles events up to time `elapsed`, until the counters reach `pair_collisions`, or until `should_continue`
  /// returns false; it is called every `events_per_look` events and after each audit. Returns whether `elapsed` was
  /// reached.
  /// Errors: RunFailure where an audit, made every `audit_every` pair collisions, finds an overlap or a missed event,
  /// and where collisions without end keep the time from passing.
  bool run(double elapsed, std::uint64_t pair_collisions, std::uint64_t audit_every, Counters& counters,
           std::function<bool()> const& should_continue = {});
  static constexpr std::uint64_t events_per_look = std::uint64_t{1} << 14;

  /// Handles events of growing disks until `end`, else as run(). Returns whether the radii have grown by `end.scale`.
  bool grow(EndOfGrowth const& end, std::uint64_t audit_every, Counters& counters,
            std::function<bool()> const& should_continue = {});
  /// Number of hits of disks: a wall hit counts once, a pair collision twice.
  [[nodiscard]] std::uint64_t hits() const { return hits_; }
  /// Number of collisions that lost nothing because a disk had collided less than Losses::contact_time before.
  [[nodiscard]] std::uint64_t elastic_contacts() const { return elastic_contacts_; }
  /// Begins a new epoch at the last event and multiplies all velocities. To keep the calendar small, call it every few
  /// tens of collisions per disk. Contract: the disks grow.
  void renew(double factor_of_velocities = 1.0);
  /// Writes the state as write() does, when the radii have grown by `scale`. Contract: grow() has reached this scale.
  void write_grown(double scale, State& state) const { write_at(growth_.scale.time_of(scale), scale, state); }

  /// Returns the time at which the radii have grown by `scale`, counted from the state that the dynamics was made of.
  [[nodiscard]] double time_of(double scale) const {
    return epoch_start_ + (epoch_start_rest_ + growth_.scale.time_of(scale));
  }

  /// Time and collisions since the last call of begin_measurement(), while the disks grow.
  struct Measurement {
    double time = 0.0;
    double virial = 0.0;  ///< sum of distance · |Δp| over pair collisions and of R · |Δp| over wall hits
  };
  [[nodiscard]] Measurement measurement() const { return {growth_.measured_time + now_, growth_.measured_virial}; }
  void begin_measurement() {
    growth_.measured_time = -now_;
    growth_.measured_virial = 0.0;
  }
  /// The factor by which the radii have grown.
  [[nodiscard]] double scale() const { return growth_.scale.at(now_); }

  /// The velocity that a kick gives to a disk.
  using VelocityOf = std::function<Vector(Id id, std::uint32_t id_index, double mass)>;
  /// Writes the velocities that a kick gives to these disks.
  using VelocitiesOf = std::function<void(KickedDisks const& disks, std::span<Vector> velocities)>;
  /// Gives all disks new velocities at the time `elapsed`, to which run() has come, and begins an epoch that ends at
  /// `next`, the time of the next kick, at the latest. Contract: nothing grows; run() is not asked for times after
  /// `next` before that kick.
  void kick_all(double elapsed, double next, VelocitiesOf const& velocities_of);
  /// Calls visit(Id, id index, centre) for each disk at the time `elapsed`, to which run() has come, in any order. In a
  /// periodic box the centre is that of a disk that was never moved to the other side.
  void visit_disks(double elapsed, std::function<void(Id, std::uint32_t, Vector)> const& visit) const;
  /// Gives one disk a new velocity at the time `elapsed`, to which run() has come. Returns its Id.
  /// Contract: one thread, and nothing grows.
  Id kick(double elapsed, std::uint32_t id_index, VelocityOf const& velocity_of);
  /// Epochs end at the next kick of all disks, which is at this time, at the latest.
  void expect_kick(double elapsed) { next_kick_ = elapsed; }

  /// The time of the last event handled, counted from the state that the dynamics was made of.
  [[nodiscard]] double last_event() const { return elapsed_at_last_event(); }
  /// Calls report() at each pair collision from now on, while one thread does all the work; `start` is the time at
  /// which the dynamics was made. Contract: `report` outlives the dynamics.
  void report_collisions(ReportCollision const& report, double start);

  /// Returns whether a collision can ever come: there are at least two disks, and one moves.
  [[nodiscard]] bool can_collide() const {
    return (size_ > 1 || (size_ == 1 && !all_obstacles_.empty())) && epoch_length_ > 0.0;
  }

  /// Writes positions at time `elapsed` (no earlier than the last event), velocities, images, and the radii of growing
  /// disks into the state that the dynamics was made of.
  void write(double elapsed, State& state) const {
    double const time = std::max(elapsed - epoch_start_, now_);
    write_at(time, growth_.scale.at(time), state);
  }
  /// Writes the state at the exact time of the last event; a clock of a long run has too few digits for that time.
  /// Disks that have just collided touch and do not overlap.
  void write_at_last_event(State& state) const { write_at(now_, scale(), state); }

  /// Looks for faults. Errors: RunFailure where two disks, or a disk and a wall, overlap by more than 1e-12 diameters,
  /// or, for up to 2000 disks, where a collision would be missed: a pair overlaps before either disk's own event.
  void audit() const;
  /// The number of audits that run() has made without finding a fault.
  [[nodiscard]] std::uint64_t audits() const { return audits_; }
  /// Returns whether audits look for missed collisions too.
  [[nodiscard]] bool looks_for_missed_events() const;

  /// The time for which strips of the box fly before they are compared; 0 while one thread does all the work.
  [[nodiscard]] double window() const;
  /// Windows of time that threads shared, and windows among them that one thread had to repeat.
  struct WindowCount {
    std::uint64_t flown = 0;
    std::uint64_t given_up = 0;
  };
  [[nodiscard]] WindowCount const& windows() const { return windows_; }

  /// Serializes the disks and their scheduled events. Restore them into a dynamics of the state that was written at the
  /// same time. The order of disks in memory is not saved: the trajectory does not depend on it.
  void serialize(Archive& archive);

 private:
  void read_disks(State const& state);
  void read_obstacles(State const& state, std::span<Obstacle const> walls);
  void choose_epoch();
  void end_epoch(bool may_share);
  /// Begins an epoch; threads share it if the expected hits per time of a disk make that faster.
  void begin_epoch(double zero, double length, double factor_of_velocities = 1.0, double hits_per_time = 0.0);
  void move_zero_of_time(double zero);
  [[nodiscard]] double longest_epoch() const;
  [[nodiscard]] double longest_epoch_with(double squared_speeds) const;
  void cut_epoch();

  void restore(Archive const& archive, SavedDisks const& saved);

  /// The reason why a run ends: `time` is reached; `early`, by a stop condition; the `epoch` is over; or `sharing`, the
  /// run continues on another number of threads.
  enum class End { time, early, epoch, sharing };
  template <bool grows, class TimeToStop, class HasEnough>
  End run_until(TimeToStop time_to_stop, HasEnough has_enough, std::uint64_t audit_every, Counters& counters,
                std::function<bool()> const& should_continue);

  // Functions in sharing.cpp, for several threads:
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

  // Functions in kicks.cpp, for thermostats:
  [[nodiscard]] bool may_be_kicked(double elapsed) const;
  void give_velocities(VelocitiesOf const& velocities_of);
  [[nodiscard]] Index disk_of(std::uint32_t id_index);

  // Functions in growing.cpp, for disks that grow:
  void start_growing(double rate);
  void serialize_growth(Archive& archive);

  // Functions in saved_cells.cpp, for checkpoints:
  void serialize_lists(Archive& archive);
  void restore_grid(Archive const& archive, std::vector<std::uint64_t> const& cells);
  void restore_cells(Archive const& archive, SavedDisks const& saved);

  void write_at(double time, double scale, State& state) const;
  void let_fall(double time);
  void serialize_contacts(Archive& archive);

  void require_time_to_pass();
  void audit_overlaps() const;
  void audit_obstacles(Index i) const;
  void audit_missed_events() const;
  [[nodiscard]] Id id_of(Index i) const { return ids_.empty() ? disks_[i].id_index : ids_[disks_[i].id_index]; }

  Obstacles all_obstacles_;
  std::vector<Id> ids_;  // Ids by id index; empty where each Id is its index
  std::vector<std::uint32_t>
      row_of_;  // row in the state, by id index; empty where the rows are in the order of the Ids

  double diameters_in_epoch_ = 0.0;  // largest number of diameters that a disk crosses in an epoch
  std::uint64_t epoch_ = 0;
  std::uint64_t hits_before_epoch_ = 0;
  std::uint64_t audits_ = 0;

  double thermal_speed_squared_ = 0.0;
  double next_kick_ = std::numeric_limits<double>::infinity();  // of all disks
  double time_since_sort_ = 0.0;                                // of epochs that kicks have ended
  std::vector<Index> disk_of_;                                  // by id index; out of date where disks have been sorted

  Sharing sharing_;
  WindowCount windows_;
  double hits_per_time_ = 0.0;      // hits of a disk per time in the previous epoch, on average
  std::unique_ptr<Strips> strips_;  // nullptr while one thread does all the work

  /// The observation whether time passes. It matters only to a run that fails, so it is not serialized.
  struct Watch {
    double passed = 0.0;  ///< time between the first look and the start of the epoch
    double now = 0.0;
    std::uint64_t looks = 0;
    std::vector<std::uint32_t> collision_counts;  ///< counts by id index; empty until a stall is suspected
  };
  Watch watch_;
};

}  // namespace gridlock::exact
