#include "engine/exact/dynamics.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "engine/exact/saved_disks.hpp"
#include "gridlock/core/detail/rows_in_order.hpp"

namespace gridlock::exact {

namespace {

constexpr double never = std::numeric_limits<double>::infinity();

/// Epochs between two sorts of the disks in memory: a disk stays near its cell for many collisions.
constexpr std::uint64_t epochs_per_sort = 8;

/// Epochs become longer while disks are hit less often than the first, each on average, and shorter where they are hit more often
/// than the second: predicting every event anew costs little, and the calendar stays small.
constexpr std::uint64_t few_hits_in_epoch = 24;
constexpr std::uint64_t many_hits_in_epoch = 64;
/// Where disks come together so quickly that an epoch has more, it is cut.
constexpr std::uint64_t most_hits_in_epoch = 1024;

/// In one epoch a disk of the root mean square speed crosses no more than so many of the largest diameters or, in a dilute gas, of the
/// mean distances between disks: paths are computed from the zero of time, and are rounded the more the longer they are. Fewer where some disks are
/// more than four times as fast as others, because they are light, or are small and thus touch at a small distance.
constexpr double most_diameters_in_epoch = 16.0;
constexpr double most_distances_in_epoch = 4.0;
constexpr double moderate_speed = 4.0;
constexpr double least_diameters_in_epoch = 2.0;

/// Disks of no more than this many bytes stay in the second cache by themselves.
constexpr std::size_t largest_cached = std::size_t{1} << 20;

bool are_all_equal(std::span<double const> values) {
  return std::ranges::all_of(values, [&](double value) { return value == values.front(); });
}

/// Applies a permutation, element i going to place new_place[i], without a second array.
template <class Array>
void permute(Array& values, std::vector<Index> new_place) {
  for (Index i = 0; i < new_place.size(); ++i) {
    while (new_place[i] != i) {
      Index const place = new_place[i];
      std::swap(values[i], values[place]);
      std::swap(new_place[i], new_place[place]);
    }
  }
}

}  // namespace

Dynamics::Dynamics(State const& state, DynamicsOptions const& options)
    : box_(state.box), size_(state.agents.size()), size_of_cells_(options.size_of_cells) {
  lists_.wish = options.lists;
  read_disks(state);
  if (options.rate != 0.0) start_growing(options.rate);
  choose_epoch();
  make_room_in_cells();
  renew_lists();
  sort_disks_by_cell();
  refresh_prediction_input();
  predict_all();
  expected_events_ = 32 * size_;
  fetches_ahead_ = size_ * sizeof(MovingDisk) > largest_cached;
  start_epoch();
}

/// From the zero of the epoch on, whatever the order of the disks: of two that touch first each waits for it, and the first of the
/// two events is that of both.
void Dynamics::predict_all() {
  LargeArray<double> times(size_);
  for (Index i = 0; i < size_; ++i) disks_[i].event_time = never;
  for (Index i = 0; i < size_; ++i) {
    Prediction const first = predictor_.one(prediction_input_, i, 0.0);
    times[i] = first.time;
    disks_[i].partner = first.partner;
    if (first.partner < vertical_border) disks_[i].partner_collision_count = disks_[first.partner].collision_count;
  }
  for (Index i = 0; i < size_; ++i) disks_[i].event_time = times[i];
}

void Dynamics::read_disks(State const& state) {
  Disks const& disks = state.agents;
  std::vector<std::uint32_t> rows = rows_in_order(disks.ids());
  auto const radius = disks.column<Radius>();
  auto const mass = disks.column<Mass>();
  if (size_ > 0) {
    equal_radius_ = radius.front();
    equal_mass_ = mass.front();
  }
  bool const is_mixture = size_ > 0 && !(are_all_equal(radius) && are_all_equal(mass));
  disks_.reserve(size_ + 1);
  image_.reserve(size_);
  double mean_radius = 0.0;
  double mean_mass = 0.0;  // in the order of the Ids
  for (std::uint32_t id_index = 0; id_index < size_; ++id_index) {
    std::uint32_t const row = rows[id_index];
    Vector const p = position(disks, row);
    Vector const v = velocity(disks, row);
    MovingDisk& disk = disks_.emplace_back();
    disk = {.x = p.x,
            .y = p.y,
            .velocity_x = v.x,
            .velocity_y = v.y,
            .event_time = never,
            .last_hit = 0.0,
            .partner = vertical_border,
            .partner_collision_count = 0,
            .collision_count = 0,
            .id_index = id_index};
    image_.push_back({disks.column<ImageX>()[row], disks.column<ImageY>()[row]});
    if (is_mixture) {
      radius_.push_back(radius[row]);
      mass_.push_back(mass[row]);
    }
    mean_radius += radius[row] / static_cast<double>(size_);
    mean_mass += mass[row] / static_cast<double>(size_);
  }
  if (size_ > 0) {
    smallest_radius_ = radius_range(disks).smallest;
    largest_radius_ = radius_range(disks).largest;
    mean_radius_ = mean_radius;
    packing_fraction_ = packing_fraction_of(state);
    double const speed_of_lightest = std::sqrt(mean_mass / *std::ranges::min_element(mass));
    double const distance = std::sqrt(box_.area() / static_cast<double>(size_)) / (2.0 * largest_radius_);
    double const diameters = std::max(most_diameters_in_epoch, most_distances_in_epoch * distance) *
                             std::min(1.0, moderate_speed / speed_of_lightest) * (smallest_radius_ / largest_radius_);
    diameters_in_epoch_ = std::max(least_diameters_in_epoch, diameters);
  }
  disks_.push_back({.event_time = -never, .partner = vertical_border});
  if (size_ > 0 && disks.ids()[rows.back()] != size_ - 1) {
    for (std::uint32_t const row : rows) ids_.push_back(disks.ids()[row]);
  }
  if (!std::ranges::is_sorted(rows)) row_of_ = std::move(rows);
}

void Dynamics::refresh_prediction_input() {
  prediction_input_ = {.disks = disks_.data(),
                       .nobody = static_cast<Index>(size_),
                       .cells = cells_.data(),
                       .radius = radius_.empty() ? nullptr : radius_.data(),
                       .equal_radius = equal_radius_,
                       .slots = grid_.slots(),
                       .row_stride = grid_.row_stride(),
                       .capacity = grid_.capacity(),
                       .column_edges = grid_.column_edges(),
                       .row_edges = grid_.row_edges(),
                       .columns = grid_.columns(),
                       .rows = grid_.rows(),
                       .width = box_.width(),
                       .height = box_.height(),
                       .is_periodic = box_.is_periodic(),
                       .scale = growth_.scale,
                       .neighbours = lists_.neighbours.empty() ? nullptr : lists_.neighbours.data(),
                       .places = lists_.places.empty() ? nullptr : lists_.places.data(),
                       .room = lists_.room};
  predictor_ = fastest_predictor(prediction_input_);
}

/// From nothing but the motion, in the order of the Ids.
double Dynamics::longest_epoch() const {
  double squared_speeds = 0.0;
  for (Index const i : disks_by_id_index()) {
    squared_speeds += disks_[i].velocity_x * disks_[i].velocity_x + disks_[i].velocity_y * disks_[i].velocity_y;
  }
  if (!(squared_speeds > 0.0)) return 0.0;
  double const diameter = 2.0 * largest_radius_ * growth_.scale.at_zero;
  double const crossing = diameter / std::sqrt(squared_speeds / static_cast<double>(size_));
  return power_of_two_below((is_growing() ? 2.0 : diameters_in_epoch_) * crossing);
}

void Dynamics::choose_epoch() {
  longest_epoch_ = longest_epoch();
  epoch_length_ = is_growing() ? longest_epoch_ : longest_epoch_ / most_diameters_in_epoch;
}

void Dynamics::start_epoch() {
  calendar_.open(epoch_length_, expected_events_, size_);
  for (Index i = 0; i < size_; ++i) calendar_.add(disks_[i].event_time, i, disks_.data());
}

/// Puts disks of neighbouring cells next to one another in memory, so that a prediction finds its candidates in few
/// cache lines and pages. The trajectory does not depend on it.
/// Contract: all events are predicted anew.
void Dynamics::sort_disks_by_cell() {
  std::vector<Index> new_name(size_, no_disk);
  Index next = 0;
  for (std::int32_t row = 0; row < grid_.rows(); ++row) {
    for (std::int32_t column = 0; column < grid_.columns(); ++column) {
      Index const* const slots = grid_.slots_of(column, row);
      for (std::size_t k = 0; k < grid_.capacity(); ++k) {
        if (slots[k] != no_disk) new_name[slots[k]] = next++;
      }
    }
  }
  grid_.rename(new_name);
  if (!radius_.empty()) {
    permute(radius_, new_name);
    permute(mass_, new_name);
  }
  permute(image_, new_name);
  permute(cells_, new_name);
  if (!lists_.places.empty()) permute(lists_.places, new_name);
  permute(disks_, std::move(new_name));  // the last may use it up
  if (!lists_.places.empty()) find_all_neighbours();
}

bool Dynamics::run(double elapsed, std::uint64_t pair_collisions, std::uint64_t audit_every, Counters& counters,
                   std::function<bool()> const& should_continue) {
  if (epoch_length_ == 0.0) return true;  // nothing moves, nothing happens
  return run_until<false>([&] { return elapsed - epoch_start_; },
                          [&] { return counters.pair_collisions >= pair_collisions; }, audit_every, counters,
                          should_continue);
}

bool Dynamics::grow(EndOfGrowth const& end, std::uint64_t audit_every, Counters& counters,
                    std::function<bool()> const& should_continue) {
  auto const has_enough = [&] { return counters.pair_collisions >= end.pair_collisions || hits_ >= end.hits; };
  return run_until<true>([&] { return growth_.scale.time_of(end.scale); }, has_enough, audit_every, counters,
                         should_continue);
}

template <bool grows, class TimeToStop, class HasEnough>
bool Dynamics::run_until(TimeToStop time_to_stop, HasEnough has_enough, std::uint64_t audit_every, Counters& counters,
                         std::function<bool()> const& should_continue) {
  while (!has_enough()) {
    ScheduledEvent const* const next = next_event();
    if (next->time > time_to_stop()) return true;
    ScheduledEvent const due = *next;
    calendar_.pop(next, disks_.data());
    std::uint64_t const before = counters.pair_collisions;
    now_ = due.time;
    if (fetches_ahead_) fetch_ahead();
    handle<grows>(due.disk, counters);
    bool const is_audit_due =
        audit_every > 0 && counters.pair_collisions != before && counters.pair_collisions % audit_every == 0;
    if (is_audit_due) {
      audit();
      ++audits_;
    }
    // A count that outlives interruptions, so that the moments do not depend on them.
    bool const is_look_due = counters.moves % events_per_look == 0;
    if (is_look_due) require_time_to_pass();
    if (!grows && hits_ - hits_before_epoch_ > most_hits_in_epoch * size_) [[unlikely]]
      cut_epoch();
    if ((is_look_due || is_audit_due) && should_continue && !should_continue()) return false;
  }
  return false;
}

/// The next event that is still kept, of a later epoch where this one has none left.
ScheduledEvent const* Dynamics::next_event() {
  for (;;) {
    while (ScheduledEvent const* const next = calendar_.next(disks_.data())) {
      if (disks_[next->disk].event_time == next->time) return next;
      calendar_.pop(next, disks_.data());
    }
    end_epoch();
  }
}

void Dynamics::end_epoch() {
  std::uint64_t const hits = hits_ - hits_before_epoch_;
  double length = epoch_length_;
  if (is_growing()) {
    length = std::min(2.0 * length, longest_epoch());
  } else if (hits < few_hits_in_epoch * size_) {
    length = std::min(2.0 * length, longest_epoch_);
  } else if (hits >= many_hits_in_epoch * size_) {
    length *= 0.5;
  }
  begin_epoch(epoch_length_, length);
}

/// Continues with epochs of few hits.
void Dynamics::cut_epoch() {
  double const length = power_of_two_below(now_ * static_cast<double>(few_hits_in_epoch) / most_hits_in_epoch);
  if (!(length > 0.0)) return;  // no time has passed at all
  begin_epoch(now_, length);
}

void Dynamics::begin_epoch(double zero, double length, double factor_of_velocities) {
  double const duration = std::max(now_, std::min(zero, epoch_length_));
  move_zero_of_time(zero);
  for (std::size_t i = 0; i < size_; ++i) {
    disks_[i].last_hit = 0.0;
    disks_[i].velocity_x *= factor_of_velocities;
    disks_[i].velocity_y *= factor_of_velocities;
  }
  if (is_growing()) longest_epoch_ = longest_epoch();
  length = std::min(length, longest_epoch_);
  expected_events_ = static_cast<std::uint64_t>(static_cast<double>(calendar_.made()) * (length / duration));
  epoch_length_ = length;
  renew_lists();
  make_room_in_cells();
  if (epoch_ % epochs_per_sort == 0) sort_disks_by_cell();
  refresh_prediction_input();
  predict_all();
  start_epoch();
}

void Dynamics::move_zero_of_time(double zero) {
  for (std::size_t i = 0; i < size_; ++i) {
    disks_[i].x += disks_[i].velocity_x * zero;
    disks_[i].y += disks_[i].velocity_y * zero;
  }
  ++epoch_;
  double const later = zero + epoch_start_rest_;
  double const start = epoch_start_ + later;
  epoch_start_rest_ = later - (start - epoch_start_);
  epoch_start_ = start;
  watch_.passed += zero;
  now_ -= zero;
  growth_.scale.move_zero(zero);
  growth_.measured_time += zero;
  hits_before_epoch_ = hits_;
  pipeline_.clear();
}

/// Keeps the pipeline fed with the disks of a bucket to come, and moving: about two events are scheduled for each one
/// handled.
void Dynamics::fetch_ahead() {
  constexpr std::uint32_t buckets_ahead = 8;
  constexpr std::uint64_t most_waiting = 16;
  if (calendar_.open_bucket() != seen_bucket_) {
    seen_bucket_ = calendar_.open_bucket();
    std::uint64_t entered = 0;
    calendar_.for_each_ahead(buckets_ahead, [&](Index i, double time) {
      if (++entered <= most_waiting) pipeline_.enter(i, time);
    });
  }
  do {
    pipeline_.step(prediction_input_, grid_, size_);
    pipeline_.step(prediction_input_, grid_, size_);
  } while (pipeline_.waiting() > most_waiting);
}

template <bool grows>
void Dynamics::handle(Index i, Counters& counters) {
  ++counters.moves;
  MovingDisk& disk = disks_[i];
  if (disk.partner >= vertical_border) {
    reach_border(i,
                 grows ? border_event_growing(prediction_input_, i) : border_event(prediction_input_, i, disk.partner),
                 counters);
  } else if (disks_[disk.partner].collision_count == disk.partner_collision_count) {
    Index const j = disk.partner;
    collide(i, j, counters);
    // Both predictions before either is written down, so that the processor works on the two at once.
    PairPrediction const next = predictor_.pair(prediction_input_, i, j, now_);
    schedule(i, next.of_i);
    schedule(j, next.of_j);
    return;
  }
  schedule(i, predictor_.one(prediction_input_, i, now_));
}

void Dynamics::schedule(Index i, Prediction const& next) {
  MovingDisk& disk = disks_[i];
  disk.event_time = next.time;
  disk.partner = next.partner;
  disk.partner_collision_count =
      disks_[std::min<std::size_t>(next.partner, size_)].collision_count;  // of the spare disk for a border
  calendar_.add(next.time, i, disks_.data());
}

/// The elastic rule of turn.hpp, at the time of contact, in the frame in which the two rims rest: the velocity v along the line of
/// centres becomes −v + 2a. The centre at the zero of time moves so that the path does not jump: x + v·now stays what it was.
/// The bits do not depend on which of the two is i.
void Dynamics::collide(Index i, Index j, Counters& counters) {
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
  double const along = 2.0 * approach / ((mass_a + mass_b) * squared_distance);
  double const along_a = mass_b * along;
  double const along_b = mass_a * along;
  change_velocity(a, along_a * d_x, along_a * d_y, now_);
  change_velocity(b, -along_b * d_x, -along_b * d_y, now_);
  double const virial = -(mass_a * mass_b) * along * squared_distance;
  hits_ += 2;
  growth_.measured_virial += virial;
  ++counters.pair_collisions;
  counters.pair_virial += virial;
}

void Dynamics::reach_border(Index i, BorderEvent const& event, Counters& counters) {
  switch (event.border) {
    case Border::of_place:
      take_new_place(i);
      break;
    case Border::wall:
      hit_wall(i, event.side, counters);
      break;
    case Border::of_cell:
      cross_into_next_cell(i, event.side);
      break;
    case Border::edge:
      if (lists_.places.empty()) cross_into_next_cell(i, event.side);
      cross_edge(i, event.side);
      break;
  }
}

/// The wall rests, the rim comes to meet it: v becomes −v plus twice the speed of growth, inwards.
void Dynamics::hit_wall(Index i, Side side, Counters& counters) {
  MovingDisk& disk = disks_[i];
  bool const is_vertical = side == Side::left || side == Side::right;
  double const inwards = side == Side::left || side == Side::bottom ? 1.0 : -1.0;
  double const radius = radius_of(i);
  double const velocity = is_vertical ? disk.velocity_x : disk.velocity_y;
  double const change = 2.0 * (inwards * radius * growth_.scale.rate - velocity);
  change_velocity(disk, is_vertical ? change : 0.0, is_vertical ? 0.0 : change, now_);
  ++hits_;
  auto const wall = static_cast<std::size_t>(side);
  double const impulse = mass_of(i) * std::abs(change);
  ++counters.wall_hits[wall];
  counters.wall_impulse[wall] += impulse;
  growth_.measured_virial += radius * growth_.scale.at(now_) * impulse;
}

void Dynamics::cross_into_next_cell(Index i, Side side) {
  Cell& cell = cells_[i];
  grid_.erase(i, cell.column, cell.row);
  auto const next = [](std::int32_t index, std::int32_t step, std::int32_t count) {
    return index + step == count ? 0 : index + step < 0 ? count - 1 : index + step;
  };
  if (side == Side::left || side == Side::right) {
    cell.column = next(cell.column, side == Side::right ? 1 : -1, grid_.columns());
  } else {
    cell.row = next(cell.row, side == Side::top ? 1 : -1, grid_.rows());
  }
  grid_.insert(i, cell.column, cell.row);
  if (prediction_input_.capacity != grid_.capacity()) refresh_prediction_input();
}

/// A disk that leaves a periodic box goes on with another coordinate, which is rounded anew: as if it had been hit, events
/// predicted before are void, so that it does not matter when others looked at it.
void Dynamics::cross_edge(Index i, Side side) {
  MovingDisk& disk = disks_[i];
  std::int32_t const across = side == Side::right || side == Side::top ? 1 : -1;
  bool const is_vertical = side == Side::left || side == Side::right;
  double const shift = -across * (is_vertical ? box_.width() : box_.height());
  (is_vertical ? disk.x : disk.y) += shift;
  (is_vertical ? image_[i].x : image_[i].y) += across;
  ++disk.collision_count;
  if (lists_.places.empty()) return;
  (is_vertical ? lists_.places[i].x : lists_.places[i].y) += shift;
}

void Dynamics::write_at(double t, double scale, State& state) const {
  Disks& disks = state.agents;
  auto const radius = disks.column<Radius>();
  for (std::size_t i = 0; i < size_; ++i) {
    MovingDisk const& disk = disks_[i];
    std::size_t const row = row_of_.empty() ? disk.id_index : row_of_[disk.id_index];
    if (is_growing()) radius[row] = radius_[i] * scale;
    int crossed_x = 0;
    int crossed_y = 0;
    Vector p = box_.wrap({disk.x + disk.velocity_x * t, disk.y + disk.velocity_y * t}, crossed_x, crossed_y);
    if (!box_.is_periodic()) {
      // A disk at a wall may be out of the box by a rounding error that its path never sees.
      p.x = std::clamp(p.x, radius[row], box_.width() - radius[row]);
      p.y = std::clamp(p.y, radius[row], box_.height() - radius[row]);
    }
    disks.column<X>()[row] = p.x;
    disks.column<Y>()[row] = p.y;
    disks.column<VelocityX>()[row] = disk.velocity_x;
    disks.column<VelocityY>()[row] = disk.velocity_y;
    disks.column<ImageX>()[row] = image_[i].x + crossed_x;
    disks.column<ImageY>()[row] = image_[i].y + crossed_y;
  }
}

std::vector<Index> Dynamics::disks_by_id_index() const {
  std::vector<Index> disks(size_);
  for (Index i = 0; i < size_; ++i) disks[disks_[i].id_index] = i;
  return disks;
}

void Dynamics::serialize(Archive& archive) {
  SavedDisks saved;
  for (Index const i : disks_by_id_index()) {
    MovingDisk const& disk = disks_[i];
    saved.x.push_back(disk.x);
    saved.y.push_back(disk.y);
    saved.velocity_x.push_back(disk.velocity_x);
    saved.velocity_y.push_back(disk.velocity_y);
    saved.event_time.push_back(disk.event_time);
    saved.last_hit.push_back(disk.last_hit);
    saved.partner.push_back(disk.partner < vertical_border ? disks_[disk.partner].id_index : disk.partner);
    saved.partner_collision_count.push_back(disk.partner_collision_count);
    saved.collision_count.push_back(disk.collision_count);
    saved.column.push_back(cells_[i].column);
    saved.row.push_back(cells_[i].row);
    saved.image_x.push_back(image_[i].x);
    saved.image_y.push_back(image_[i].y);
  }
  saved.serialize(archive);
  archive.visit("now", now_);
  archive.visit("epoch", epoch_);
  archive.visit("epoch_length", epoch_length_);
  archive.visit("longest_epoch", longest_epoch_);
  archive.visit("epoch_start", epoch_start_);
  archive.visit("epoch_start_rest", epoch_start_rest_);
  archive.visit("hits", hits_);
  archive.visit("hits_before_epoch", hits_before_epoch_);
  archive.visit("expected_events", expected_events_);
  if (is_growing()) serialize_growth(archive);
  serialize_lists(archive);
  if (archive.is_restoring()) restore(archive, saved);
}

void Dynamics::restore(Archive const& archive, SavedDisks const& saved) {
  archive.require(saved.has_size(size_), "the engine has other disks than the state");
  std::vector<Index> const disks = disks_by_id_index();
  for (Index const i : disks) grid_.erase(i, cells_[i].column, cells_[i].row);
  for (std::size_t id_index = 0; id_index < size_; ++id_index) {
    Index const partner = saved.partner[id_index];
    bool const is_inside = saved.column[id_index] >= 0 && saved.column[id_index] < grid_.columns() &&
                           saved.row[id_index] >= 0 && saved.row[id_index] < grid_.rows();
    archive.require(is_inside && (partner >= vertical_border || partner < size_) &&
                        saved.event_time[id_index] >= now_ && std::isfinite(saved.last_hit[id_index]),
                    "a disk waits for an event that cannot be");
    MovingDisk& disk = disks_[disks[id_index]];
    disk = {.x = saved.x[id_index],
            .y = saved.y[id_index],
            .velocity_x = saved.velocity_x[id_index],
            .velocity_y = saved.velocity_y[id_index],
            .event_time = saved.event_time[id_index],
            .last_hit = saved.last_hit[id_index],
            .partner = partner < vertical_border ? disks[partner] : partner,
            .partner_collision_count = saved.partner_collision_count[id_index],
            .collision_count = saved.collision_count[id_index],
            .id_index = disk.id_index};
    cells_[disks[id_index]] = {saved.column[id_index], saved.row[id_index]};
    image_[disks[id_index]] = {saved.image_x[id_index], saved.image_y[id_index]};
    grid_.insert(disks[id_index], saved.column[id_index], saved.row[id_index]);
  }
  if (!lists_.places.empty()) find_all_neighbours();
  refresh_prediction_input();
  pipeline_.clear();
  start_epoch();
}

}  // namespace gridlock::exact
