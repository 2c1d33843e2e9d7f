#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <vector>

#include "engine/exact/calendar.hpp"
#include "engine/exact/fetch_pipeline.hpp"
#include "engine/exact/moving_disk.hpp"
#include "engine/exact/prediction.hpp"
#include "engine/exact/slot_grid.hpp"
#include "gridlock/core/detail/large_array.hpp"
#include "gridlock/core/disks.hpp"
#include "gridlock/engine/engine.hpp"

namespace gridlock::exact {

struct SavedDisks;

/// Hard disks in free flight from event to event: the exact dynamics of a state, in a layout of its own.
///
/// Times are counted from the state it was made of. Inside, they are counted from the start of an epoch, a power of two
/// long in which a disk crosses a few cells, so that positions and event times keep their digits however long the run is.
/// At the end of an epoch every disk's centre moves on to the new zero of time.
/// Contract: a valid state; a periodic box at least two largest diameters wide and high.
class Dynamics {
 public:
  explicit Dynamics(State const& state);

  /// Handles every event up to `elapsed`, or until the counters reach `pair_collisions`, or until `should_continue`,
  /// asked every `events_per_look` events and after each audit, says no; says whether it got to `elapsed`.
  /// Errors: RunFailure where an audit, due every `audit_every` pair collisions, finds what must not be, and where
  /// collisions without end keep the time from passing.
  bool run(double elapsed, std::uint64_t pair_collisions, std::uint64_t audit_every, Counters& counters,
           std::function<bool()> const& should_continue = {});
  static constexpr std::uint64_t events_per_look = std::uint64_t{1} << 14;

  /// The time of the last event handled, in this epoch.
  [[nodiscard]] double now() const { return now_; }
  /// The time of the last event handled.
  [[nodiscard]] double last_event() const { return epoch_start_ + now_; }

  /// Whether waiting for a collision can make sense: at least two disks, and one of them moves.
  [[nodiscard]] bool can_collide() const { return size_ > 1 && epoch_length_ > 0.0; }

  /// Writes positions at time `elapsed`, but not before the last event, velocities and images into the state it was made
  /// of.
  void write(double elapsed, State& state) const { write_at(std::max(elapsed - epoch_start_, now_), state); }
  /// The same at the exact time of the last event, for which the time of a long run has not enough digits: a disk that
  /// has just collided touches its partner, and does not overlap it.
  void write_at_last_event(State& state) const { write_at(now_, state); }

  /// Throws RunFailure where two disks, or a disk and a wall, overlap by more than 1e-12 diameters, or, for up to 2000
  /// disks, where a collision would be missed: a pair that comes to overlap before either disk's own event.
  void audit() const;
  /// How many audits run() has made, all of which found nothing.
  [[nodiscard]] std::uint64_t audits() const { return audits_; }
  /// Whether audits look for missed collisions too.
  [[nodiscard]] bool looks_for_missed_events() const;

  /// Serializes the disks as they fly and the events they wait for; restored into a dynamics of the state that was written
  /// at the same time. Which memory a disk lies in is not serialized: the trajectory does not depend on it.
  void serialize(Archive& archive);

  /// The disks as they are, for tests that damage them.
  [[nodiscard]] LargeArray<MovingDisk>& disks() { return disks_; }
  [[nodiscard]] std::size_t size() const { return size_; }
  /// What predictions read, for tests that compare implementations.
  [[nodiscard]] PredictionInput const& prediction_input() const { return prediction_input_; }

 private:
  void read_disks(State const& state);
  void choose_epoch();
  [[nodiscard]] std::vector<Index> disks_by_id_index() const;
  void start_epoch();
  void sort_disks_by_cell();
  void refresh_prediction_input();

  void restore(Archive const& archive, SavedDisks const& saved);

  ScheduledEvent const* next_event();
  void fetch_ahead();
  void handle(Index i, Counters& counters);
  void collide(Index i, Index j, Counters& counters);
  void hit_or_cross_vertical_border(MovingDisk& disk, Index i, Counters& counters);
  void hit_or_cross_horizontal_border(MovingDisk& disk, Index i, Counters& counters);
  void schedule(Index i, Prediction const& next);

  void write_at(double time, State& state) const;

  void require_time_to_pass();
  void audit_overlaps() const;
  void audit_missed_events() const;
  [[nodiscard]] Id id_of(Index i) const { return ids_.empty() ? disks_[i].id_index : ids_[disks_[i].id_index]; }
  [[nodiscard]] double radius_of(Index i) const { return radius_.empty() ? equal_radius_ : radius_[i]; }
  [[nodiscard]] double mass_of(Index i) const { return mass_.empty() ? equal_mass_ : mass_[i]; }

  Box box_;
  std::size_t size_ = 0;
  LargeArray<MovingDisk> disks_;  // and one more behind them that no prediction ever chooses
  SlotGrid grid_;
  Calendar calendar_;
  PredictionInput prediction_input_{};
  Predictor predictor_{};

  // Empty while all disks are equal.
  std::vector<double> radius_;
  std::vector<double> mass_;
  double equal_radius_ = 0.0;
  double equal_mass_ = 0.0;

  struct Image {
    std::int32_t x;
    std::int32_t y;
  };
  LargeArray<Image> image_;
  std::vector<Id> ids_;  // by id index; empty where the Ids are the indices
  std::vector<std::uint32_t>
      row_of_;  // row in the state, by id index; empty where the rows are in the order of the Ids

  bool fetches_ahead_ = false;  // the disks are too many for the cache
  std::uint32_t seen_bucket_ = 0;
  FetchPipeline pipeline_;
  double now_ = 0.0;           // time of the last event, in this epoch
  double epoch_length_ = 0.0;  // 0 when nothing moves
  double epoch_start_ = 0.0;
  std::uint64_t epoch_ = 0;
  std::uint64_t expected_events_ = 0;
  std::uint64_t audits_ = 0;

  /// Since when it is watched whether time passes. Only a run that fails depends on it, so it is not serialized.
  struct Watch {
    std::uint64_t epoch = 0;
    double now = 0.0;
    std::uint64_t looks = 0;
    std::vector<std::uint32_t> collision_counts;  ///< by id index; empty where there is no suspicion yet
  };
  Watch watch_;
};

}  // namespace gridlock::exact
