#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/exact/calendar.hpp"
#include "engine/exact/fetch_pipeline.hpp"
#include "engine/exact/losses.hpp"
#include "engine/exact/moving_disk.hpp"
#include "engine/exact/near_places.hpp"
#include "engine/exact/neighbours.hpp"
#include "engine/exact/prediction.hpp"
#include "engine/exact/scale.hpp"
#include "engine/exact/slot_grid.hpp"
#include "engine/obstacles.hpp"
#include "gridlock/core/box.hpp"
#include "gridlock/core/detail/large_array.hpp"
#include "gridlock/engine/engine.hpp"

namespace gridlock::exact {

/// Whether disks have lists of neighbours or search the cells around them; it changes nothing but the cost.
enum class Lists {
  where_they_pay,  ///< where lists are faster: in dense systems and in mixtures
  always,
  not_at_all,
};

/// How far ahead records of coming events are prefetched, so that they are in the first cache when they are due.
enum class Fetching {
  nothing,  ///< all disks fit into the first cache
  near,     ///< all disks are in the second or third cache
  far,      ///< disks are in main memory
};

/// Disks of similar size, in a grid whose cells are as wide as the largest needs.
struct SizeClass {
  double largest_radius;
  SlotGrid grid;
};

/// Signed number of times that a disk has crossed a periodic box in x and y.
struct Image {
  std::int32_t x;
  std::int32_t y;
};

/// Hard disks in free flight from event to event within one epoch: all disks of a system, or those of a strip of it.
/// The class finds and handles the next event; derived classes choose the epochs and count the events.
class Flight {
 public:
  /// The time of the last event handled, in this epoch.
  [[nodiscard]] double now() const { return now_; }
  [[nodiscard]] std::size_t size() const { return size_; }
  /// The disks, for tests that damage them.
  [[nodiscard]] LargeArray<MovingDisk>& disks() { return disks_; }
  /// The memory that predictions read, for tests that compare implementations.
  [[nodiscard]] PredictionInput const& prediction_input() const { return prediction_input_; }

 protected:
  friend class Strip;
  friend class Strips;

  explicit Flight(Box const& box) : box_(box) {}
  ~Flight() = default;
  Flight(Flight const&) = default;
  Flight& operator=(Flight const&) = default;

  /// Takes over these disks of `whole` with their properties, but not its cells, lists and events.
  void take_part(Flight const& whole, std::span<Index const> disks);
  void predict_all(double time);
  void predict_all_at_zero();
  void complete_predictions(double time);
  void sort_disks_by_cell(double time);
  void refresh_prediction_input();
  void open_calendar();
  [[nodiscard]] std::vector<Index> disks_by_id_index() const;

  /// Returns the next valid event of this epoch, or nullptr where there is none.
  ScheduledEvent const* next_event() {
    while (ScheduledEvent const* const next = calendar_.next(disks_.data())) {
      if (disks_[next->disk].event_time == next->time) return next;
      calendar_.pop(next, disks_.data());
    }
    return nullptr;
  }
  /// Removes the next event from the calendar; its time becomes the present time.
  ScheduledEvent take(ScheduledEvent const* next) {
    ScheduledEvent const due = *next;
    calendar_.pop(next, disks_.data());
    now_ = due.time;
    fetch_for_events_to_come();
    return due;
  }
  /// Handles the event of disk i, which is due now. The observer is told of it by one of
  ///     pair_collided(i, j, virial)         wall_hit(i, side, impulse)
  ///     fixed_disk_hit(i, virial)           inner_wall_hit(i, impulse)
  ///     border_reached(i)
  template <bool grows, class Observer>
  void handle(Index i, Observer& observer);
  /// Stores the next event of disk i, which was predicted at the time of the last event.
  void schedule(Index i, Prediction const& next);

  [[nodiscard]] bool is_growing() const { return growth_.scale.rate != 0.0; }
  [[nodiscard]] std::span<double const> radii() const { return std::span(radius_).first(radius_.empty() ? 0 : size_); }
  [[nodiscard]] double radius_of(Index i) const { return radius_.empty() ? equal_radius_ : radius_[i]; }
  [[nodiscard]] double mass_of(Index i) const { return mass_.empty() ? equal_mass_ : mass_[i]; }

  [[nodiscard]] Vector position_at(Index i, double time) const { return centre_at(disks_[i], gravity_, time); }
  [[nodiscard]] bool falls() const { return gravity_ != Vector{}; }
  /// Returns whether collisions or gravity change the kinetic energy.
  [[nodiscard]] bool changes_energy() const { return losses_.exist || falls(); }
  [[nodiscard]] bool has_lists() const { return !lists_.places.empty(); }

  [[nodiscard]] double elapsed_at_last_event() const { return epoch_start_ + (epoch_start_rest_ + now_); }

  void choose_fetching();

  // Functions in impacts.cpp:
  /// Returns the first event of disk i: the one predicted at this time without obstacles, or a hit of an obstacle.
  [[nodiscard]] Prediction first_of_obstacles(Index i, Prediction const& next, double time) const;
  /// Reflects disk i from the obstacle that it touches. Returns the virial for a fixed disk, the impulse for a wall.
  double reflect_from(Obstacle const& obstacle, Index i);
  /// Returns 1 + e of a collision now of disk i and of disk j, or of a wall or obstacle where j is i.
  double bounce_of(Index i, Index j, double restitution);
  [[nodiscard]] std::size_t kind_of(Index i) const { return kind_.empty() ? 0 : kind_[i]; }
  [[nodiscard]] double restitution_of(std::size_t a, std::size_t b) const {
    return losses_.of_pairs[a * losses_.kinds + b];
  }

  // Functions in cells.cpp:
  void make_room_in_cells(double time);
  void lay_cells(CellLayout const& layout, double time);
  void lay_cells_by_size();
  [[nodiscard]] CellLayout layout_for(double side) const;
  [[nodiscard]] double disks_in_nine_cells(double side) const;
  [[nodiscard]] SlotGrid& grid_of(Index i) { return size_classes_[class_of(i)].grid; }
  [[nodiscard]] std::size_t class_of(Index i) const;
  [[nodiscard]] Cell cell_of(Index i, double time) const;
  [[nodiscard]] double reach_in_cells() const;
  void move_to_cell(Index i, Cell const& cell, double time);
  void send_guests_home(Cell const& cell, double time);
  template <class Visit>
  void for_each_run_around(Vector place, double radius, double scale, double more, Visit visit) const;

  // Functions in lists.cpp:
  void renew_lists(double time);
  void end_lists();
  [[nodiscard]] bool wants_lists() const;
  [[nodiscard]] double packing_fraction() const;
  [[nodiscard]] double room_for_lists() const;
  [[nodiscard]] double room_in_oblique_box(double max_scale) const;
  [[nodiscard]] double reach_with(double room, double scale) const;
  [[nodiscard]] bool is_inside(Place const& place) const;
  void find_all_neighbours();
  void find_neighbours(Index i, bool tells_them);
  [[nodiscard]] std::span<Index const> collect_neighbours(Index i);
  void write_list(Index i, std::span<Index const> names);
  void tell(Index other, Index i);
  void take_new_place(Index i, double time);

  Box box_;
  std::size_t size_ = 0;
  LargeArray<MovingDisk> disks_;  // disks, and behind them the spare disk, which no prediction ever chooses
  LargeArray<Cell> cells_;
  std::vector<SizeClass> size_classes_;  // the largest disks first; a single class where there are no lists
  Calendar calendar_;
  PredictionInput prediction_input_{};
  Predictor predictor_{};

  // These arrays are empty while all disks are equal.
  std::vector<double> radius_;  // radii, and behind them that of the spare disk: predictions read it
  std::vector<double> mass_;
  double equal_radius_ = 0.0;
  double equal_mass_ = 0.0;

  LargeArray<Image> image_;

  Fetching fetching_ = Fetching::nothing;
  std::uint32_t seen_bucket_ = 0;
  FetchPipeline pipeline_;
  double now_ = 0.0;               // time of the last event in this epoch
  double epoch_start_ = 0.0;       // counted from the state that the dynamics was made of
  double epoch_start_rest_ = 0.0;  // rounding error of epoch_start_, added separately
  double epoch_length_ = 0.0;      // 0 when no disk moves
  double longest_epoch_ = 0.0;
  std::uint64_t expected_events_ = 0;
  std::uint64_t hits_ = 0;

  // Numbers of the whole system:
  std::size_t disks_in_box_ = 0;
  double size_of_cells_ = 1.0;
  double smallest_radius_ = 0.0;
  double largest_radius_ = 0.0;
  double mean_squared_radius_ = 0.0;  // summed in the order of the Ids

  struct ListsOfNeighbours {
    Lists wish = Lists::where_they_pay;
    LargeArray<Neighbours> neighbours;  // empty while cells are searched
    std::vector<LongList> long_lists;
    std::vector<Index> unused;  // indices of long lists that are free
    LargeArray<Place> places;
    double room = 0.0;                   // largest distance from a place in x and in y
    std::vector<Index> around, to_tell;  // scratch buffers of the search
    double max_scale = 1.0;              // largest scale of the radii for which the lists are valid
  };
  ListsOfNeighbours lists_;
  NearPlaces near_places_ = near_places_for(target());

  struct Growth {
    Scale scale;
    double measured_time = 0.0;  // time up to the start of the epoch
    double measured_virial = 0.0;
  };
  Growth growth_;

  Vector gravity_;
  Losses losses_;
  std::vector<std::uint8_t> kind_;        // kind in losses_; empty where there is one
  LargeArray<double> last_contact_;       // time of the last collision in this epoch; empty without contact_time
  std::uint64_t elastic_contacts_ = 0;    // collisions that lost nothing because of contact_time
  Obstacles const* obstacles_ = nullptr;  // nullptr where there are none

  struct Reporting {
    ReportCollision const* report = nullptr;  // nullptr where nobody asks for collisions
    double start = 0.0;                       // clock of the state that the dynamics was made of
  };
  Reporting reporting_;

 private:
  void fetch_for_events_to_come() {
    if (fetching_ == Fetching::far) fetch_far();
    if (fetching_ == Fetching::near) fetch_near();
  }
  void fetch_far();
  void fetch_near();
  template <class Observer>
  void collide(Index i, Index j, Observer& observer);
  void report_collision(Index i, Index j, Vector separation, double impulse_per_length) const;
  template <class Observer>
  void reach_border(Index i, BorderEvent const& event, Observer& observer);
  template <class Observer>
  void hit_wall(Index i, Side wall, Observer& observer);
  void cross_into_next_cell(Index i, Side side);
  void cross_edge(Index i, Side side);
  void move_sideways(Index i, double shift);
};

template <bool grows, class Observer>
void Flight::handle(Index i, Observer& observer) {
  MovingDisk& disk = disks_[i];
  if (disk.partner >= first_obstacle) {
    if (disk.partner < vertical_border) {
      Obstacle const& obstacle = (*obstacles_)[disk.partner - first_obstacle];
      observer.border_reached(i);
      double const amount = reflect_from(obstacle, i);
      obstacle.is_disk() ? observer.fixed_disk_hit(i, amount) : observer.inner_wall_hit(i, amount);
    } else {
      reach_border(
          i,
          grows ? border_event_growing(prediction_input_, i) : border_event(prediction_input_, i, disk.partner, now_),
          observer);
    }
  } else if (disks_[disk.partner].collision_count == disk.partner_collision_count) {
    Index const j = disk.partner;
    collide(i, j, observer);
    // Both predictions are made before either is stored, so that the processor works on the two at once.
    PairPrediction const next = predictor_.pair(prediction_input_, i, j, now_);
    schedule(i, next.of_i);
    schedule(j, next.of_j);
    return;
  }
  schedule(i, predictor_.one(prediction_input_, i, now_));
}

inline void Flight::schedule(Index i, Prediction const& without_obstacles) {
  MovingDisk& disk = disks_[i];
  Prediction next = without_obstacles;
  if (obstacles_ != nullptr) [[unlikely]]
    next = first_of_obstacles(i, next, now_);
  disk.event_time = next.time;
  disk.partner = next.partner;
  disk.partner_collision_count =
      disks_[std::min<std::size_t>(next.partner, size_)].collision_count;  // the spare disk's count for a border
  calendar_.add(next.time, i, disks_.data());
}

/// Lets disks i and j collide by the rule of turn.hpp at the time of contact, in the frame in which the two rims rest:
/// the velocity v along the line of centres becomes −e v + (1 + e) a. The centre at the start of the epoch moves so
/// that the path does not jump: x + v·now stays the same. The bits do not depend on which of the two disks is i.
template <class Observer>
void Flight::collide(Index i, Index j, Observer& observer) {
  MovingDisk& a = disks_[i];
  MovingDisk& b = disks_[j];
  double const w_x = b.velocity_x - a.velocity_x;
  double const w_y = b.velocity_y - a.velocity_y;
  auto const [d_x, d_y] = box_.displacement_inside({}, {(b.x - a.x) + w_x * now_, (b.y - a.y) + w_y * now_});
  double const mass_a = mass_of(i);
  double const mass_b = mass_of(j);
  double const sum = radius_of(i) + radius_of(j);
  double const contact = sum * growth_.scale.at(now_);
  double const growth = sum * growth_.scale.rate;
  double const squared_distance = d_x * d_x + d_y * d_y;
  double const approach = (w_x * d_x + w_y * d_y) - growth * contact;
  double const bounce = losses_.exist ? bounce_of(i, j, restitution_of(kind_of(i), kind_of(j))) : 2.0;
  double const along = bounce * approach / ((mass_a + mass_b) * squared_distance);
  double const along_a = mass_b * along;
  double const along_b = mass_a * along;
  if (reporting_.report != nullptr) [[unlikely]]
    report_collision(i, j, {d_x, d_y}, -(mass_a * mass_b) * along);
  change_velocity(a, along_a * d_x, along_a * d_y, now_);
  change_velocity(b, -along_b * d_x, -along_b * d_y, now_);
  double const virial = -(mass_a * mass_b) * along * squared_distance;
  hits_ += 2;
  growth_.measured_virial += virial;
  observer.pair_collided(i, j, virial);
}

template <class Observer>
void Flight::reach_border(Index i, BorderEvent const& event, Observer& observer) {
  observer.border_reached(i);
  switch (event.border) {
    case Border::of_place:
      take_new_place(i, now_);
      break;
    case Border::wall:
      hit_wall(i, event.side, observer);
      break;
    case Border::of_cell:
      cross_into_next_cell(i, event.side);
      break;
    case Border::edge:
      if (!has_lists()) cross_into_next_cell(i, event.side);
      cross_edge(i, event.side);
      break;
  }
}

/// Reflects disk i from a resting wall that its rim, growing at speed a, meets: v becomes −e v plus (1 + e) a, inwards.
template <class Observer>
void Flight::hit_wall(Index i, Side side, Observer& observer) {
  MovingDisk& disk = disks_[i];
  bool const is_vertical = side == Side::left || side == Side::right;
  double const inwards = side == Side::left || side == Side::bottom ? 1.0 : -1.0;
  double const radius = radius_of(i);
  Vector const v = velocity_at(disk, gravity_, now_);
  double const velocity = is_vertical ? v.x : v.y;
  double const change =
      bounce_of(i, i, losses_.of_walls[kind_of(i)]) * (inwards * radius * growth_.scale.rate - velocity);
  change_velocity(disk, is_vertical ? change : 0.0, is_vertical ? 0.0 : change, now_);
  ++hits_;
  double const impulse = mass_of(i) * std::abs(change);
  growth_.measured_virial += radius * growth_.scale.at(now_) * impulse;
  observer.wall_hit(i, side, impulse);
}

/// Calls visit(slots) for runs of slots that together hold all disks which a disk at this place can touch with radii at
/// `scale`; the errors of the two places add up to at most `more`.
template <class Visit>
void Flight::for_each_run_around(Vector place, double radius, double scale, double more, Visit visit) const {
  for (SizeClass const& like_disks : size_classes_) {
    // A factor above 1 covers rounding.
    double const reach =
        (radius + like_disks.largest_radius) * scale * (1.0 + 1e-6) + more + like_disks.grid.largest_margin();
    like_disks.grid.for_each_run(place - Vector{reach, reach}, place + Vector{reach, reach}, visit);
  }
}

}  // namespace gridlock::exact
