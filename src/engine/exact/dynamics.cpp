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

/// An epoch with more events than this, for each disk and in looks, is cut, so that its calendar stays small; the ones after it
/// have about as many as the least.
constexpr std::uint64_t most_events_in_epoch = 1024;
constexpr std::uint64_t least_events_in_epoch = 64;
constexpr std::uint64_t most_looks_in_epoch = 64;
constexpr std::uint64_t least_looks_in_epoch = 4;

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

Dynamics::Dynamics(State const& state, GrowthOfRadii const& growth) : box_(state.box), size_(state.agents.size()) {
  read_disks(state);
  choose_epoch();
  if (growth.rate != 0.0) start_growing(growth);
  refresh_prediction_input();
  sort_disks_by_cell();
  std::vector<Index> in_memory(size_);
  std::iota(in_memory.begin(), in_memory.end(), Index{0});
  predict_all(in_memory);
  expected_events_ = 32 * size_;
  fetches_ahead_ = size_ * sizeof(MovingDisk) > largest_cached;
  start_epoch();
}

/// From the zero of the epoch on. The order decides which of two disks waits for the collision of both.
void Dynamics::predict_all(std::span<Index const> order) {
  for (Index const i : order) disks_[i].event_time = never;
  for (Index const i : order) {
    Prediction const first = predictor_.one(prediction_input_, i, 0.0, no_disk);
    disks_[i].event_time = first.time;
    disks_[i].partner = first.partner;
    if (first.partner < vertical_border) disks_[i].partner_collision_count = disks_[first.partner].collision_count;
  }
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
  double const cutoff = 2.0 * radius_range(disks).largest;
  grid_ = SlotGrid(size_ > 0 ? layout_for_cutoff(box_, cutoff, size_) : CellLayout(box_, 1, 1), box_);
  disks_.reserve(size_ + 1);
  image_.reserve(size_);
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
            .partner = vertical_border,
            .partner_collision_count = 0,
            .collision_count = 0,
            .column = grid_.column_of(p.x),
            .row = grid_.row_of(p.y),
            .id_index = id_index};
    grid_.insert(id_index, disk.column, disk.row);
    image_.push_back({disks.column<ImageX>()[row], disks.column<ImageY>()[row]});
    if (is_mixture) {
      radius_.push_back(radius[row]);
      mass_.push_back(mass[row]);
    }
  }
  disks_.push_back({.event_time = -never, .partner = vertical_border});
  if (size_ > 0 && disks.ids()[rows.back()] != size_ - 1) {
    for (std::uint32_t const row : rows) ids_.push_back(disks.ids()[row]);
  }
  if (!std::ranges::is_sorted(rows)) row_of_ = std::move(rows);
}

void Dynamics::refresh_prediction_input() {
  prediction_input_ = {.disks = disks_.data(),
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
                       .last_hit = is_growing() ? growth_.last_hit.data() : nullptr,
                       .scale = growth_.scale,
                       .neighbours = growth_.neighbours.empty() ? nullptr : growth_.neighbours.data(),
                       .places = growth_.places.empty() ? nullptr : growth_.places.data(),
                       .room = growth_.room};
  predictor_ = fastest_predictor(prediction_input_);
}

void Dynamics::choose_epoch() {
  double squared_speeds = 0.0;
  for (std::size_t i = 0; i < size_; ++i) {
    squared_speeds += disks_[i].velocity_x * disks_[i].velocity_x + disks_[i].velocity_y * disks_[i].velocity_y;
  }
  if (!(squared_speeds > 0.0)) return;
  double const cell = std::max(box_.width() / grid_.columns(), box_.height() / grid_.rows());
  longest_epoch_ = power_of_two_below(2.0 * cell / std::sqrt(squared_speeds / static_cast<double>(size_)));
  epoch_length_ = longest_epoch_;
}

void Dynamics::start_epoch() {
  calendar_.open(epoch_length_, expected_events_, size_);
  for (Index i = 0; i < size_; ++i) calendar_.add(disks_[i].event_time, i, disks_.data());
}

/// Puts disks of neighbouring cells next to one another in memory, so that a prediction finds its candidates in few
/// cache lines and pages. The trajectory does not depend on it.
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
  for (MovingDisk& disk : disks_) {
    if (disk.partner < vertical_border) disk.partner = new_name[disk.partner];
  }
  if (!radius_.empty()) {
    permute(radius_, new_name);
    permute(mass_, new_name);
  }
  permute(image_, new_name);
  permute(disks_, std::move(new_name));  // the last may use it up
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
  auto const has_enough = [&] { return counters.pair_collisions >= end.pair_collisions || growth_.hits >= end.hits; };
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
    if (is_look_due) look();
    if ((is_look_due || is_audit_due) && should_continue && !should_continue()) return false;
  }
  return false;
}

void Dynamics::look() {
  require_time_to_pass();
  ++looks_in_epoch_;
  bool const is_crowded =
      looks_in_epoch_ > most_looks_in_epoch && looks_in_epoch_ * events_per_look > most_events_in_epoch * size_;
  if (is_crowded && !is_growing()) cut_epoch();
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
  if (is_growing()) {
    begin_growing_epoch(epoch_length_, std::min(2.0 * epoch_length_, longest_growing_epoch()), 1.0);
    return;
  }
  bool const may_be_longer = looks_in_epoch_ <= 1 && epoch_length_ < longest_epoch_;
  move_zero_of_time(epoch_length_);
  if (may_be_longer) epoch_length_ *= 2.0;
  start_epoch();
}

/// Goes on with epochs of about a tenth of the events. They begin at a multiple of their length, so that event times are
/// reduced exactly.
void Dynamics::cut_epoch() {
  double const wanted =
      static_cast<double>(std::max(least_looks_in_epoch * events_per_look, least_events_in_epoch * size_));
  double const length = power_of_two_below(now_ * wanted / static_cast<double>(looks_in_epoch_ * events_per_look));
  if (!(length > 0.0)) return;  // no time has passed at all
  move_zero_of_time(std::floor(now_ / length) * length);
  epoch_length_ = length;
  start_epoch();
}

void Dynamics::move_zero_of_time(double zero) {
  for (std::size_t i = 0; i < size_; ++i) {
    MovingDisk& disk = disks_[i];
    disk.x += disk.velocity_x * zero;
    disk.y += disk.velocity_y * zero;
    disk.event_time -= zero;  // exact: the zero is a multiple of a power of two, and the time is not below it
  }
  ++epoch_;
  double const later = zero + epoch_start_rest_;
  double const start = epoch_start_ + later;
  epoch_start_rest_ = later - (start - epoch_start_);
  epoch_start_ = start;
  watch_.passed += zero;
  now_ -= zero;
  looks_in_epoch_ = 0;
  expected_events_ = calendar_.made();
  if (epoch_ % epochs_per_sort == 0 && growth_.neighbours.empty()) sort_disks_by_cell();
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
    pipeline_.step(disks_.data(), grid_, size_);
    pipeline_.step(disks_.data(), grid_, size_);
  } while (pipeline_.waiting() > most_waiting);
}

template <bool grows>
void Dynamics::handle(Index i, Counters& counters) {
  ++counters.moves;
  MovingDisk& disk = disks_[i];
  if (grows && disk.partner >= vertical_border) {
    hit_or_cross_growing(disk, i, counters);
  } else if (disk.partner == vertical_border) {
    hit_or_cross_vertical_border(disk, i, counters);
  } else if (disk.partner == horizontal_border) {
    hit_or_cross_horizontal_border(disk, i, counters);
  } else if (disks_[disk.partner].collision_count == disk.partner_collision_count) {
    Index const j = disk.partner;
    grows ? collide_growing(i, j, counters) : collide(i, j, counters);
    disk.event_time = never;
    disks_[j].event_time = never;
    // Both predictions before either is written down, so that the processor works on the two at once.
    PairPrediction const next = predictor_.pair(prediction_input_, i, j, now_);
    schedule(i, next.of_i);
    schedule(j, next.of_j);
    return;
  }
  disk.event_time = never;
  schedule(i, predictor_.one(prediction_input_, i, now_, no_disk));
}

void Dynamics::schedule(Index i, Prediction const& next) {
  MovingDisk& disk = disks_[i];
  disk.event_time = next.time;
  disk.partner = next.partner;
  disk.partner_collision_count =
      disks_[std::min<std::size_t>(next.partner, size_)].collision_count;  // of the spare disk for a border
  calendar_.add(next.time, i, disks_.data());
}

/// The elastic rule of turn.hpp, at the time of contact; the centre at the zero of time moves so that the path does not
/// jump: x + v·now stays what it was.
void Dynamics::collide(Index i, Index j, Counters& counters) {
  MovingDisk& a = disks_[i];
  MovingDisk& b = disks_[j];
  double const w_x = b.velocity_x - a.velocity_x;
  double const w_y = b.velocity_y - a.velocity_y;
  auto const [d_x, d_y] = box_.displacement_inside({}, {(b.x - a.x) + w_x * now_, (b.y - a.y) + w_y * now_});
  double const mass_a = mass_of(i);
  double const mass_b = mass_of(j);
  double const squared_distance = d_x * d_x + d_y * d_y;
  double const along = 2.0 * (w_x * d_x + w_y * d_y) / ((mass_a + mass_b) * squared_distance);
  double const along_a = mass_b * along;
  double const along_b = mass_a * along;
  change_velocity(a, along_a * d_x, along_a * d_y, now_);
  change_velocity(b, -along_b * d_x, -along_b * d_y, now_);
  ++counters.pair_collisions;
  counters.pair_virial -= mass_a * along_a * squared_distance;
}

void Dynamics::hit_or_cross_vertical_border(MovingDisk& disk, Index i, Counters& counters) {
  bool const is_rightwards = disk.velocity_x > 0.0;
  bool const is_last = disk.column == (is_rightwards ? grid_.columns() - 1 : 0);
  if (is_last && !box_.is_periodic()) {
    Counters::Wall const wall = is_rightwards ? Counters::right : Counters::left;
    ++counters.wall_hits[wall];
    counters.wall_impulse[wall] += 2.0 * mass_of(i) * std::abs(disk.velocity_x);
    disk.x += 2.0 * disk.velocity_x * now_;
    disk.velocity_x = -disk.velocity_x;
    ++disk.collision_count;
    return;
  }
  cross_vertical_border(disk, i, is_rightwards);
}

void Dynamics::cross_vertical_border(MovingDisk& disk, Index i, bool is_rightwards) {
  bool const is_last = disk.column == (is_rightwards ? grid_.columns() - 1 : 0);
  grid_.erase(i, disk.column, disk.row);
  disk.column += is_rightwards ? 1 : -1;
  if (is_last) {
    disk.column = is_rightwards ? 0 : grid_.columns() - 1;
    disk.x -= is_rightwards ? box_.width() : -box_.width();
    image_[i].x += is_rightwards ? 1 : -1;
  }
  grid_.insert(i, disk.column, disk.row);
  if (prediction_input_.capacity != grid_.capacity()) refresh_prediction_input();
}

void Dynamics::hit_or_cross_horizontal_border(MovingDisk& disk, Index i, Counters& counters) {
  bool const is_upwards = disk.velocity_y > 0.0;
  bool const is_last = disk.row == (is_upwards ? grid_.rows() - 1 : 0);
  if (is_last && !box_.is_periodic()) {
    Counters::Wall const wall = is_upwards ? Counters::top : Counters::bottom;
    ++counters.wall_hits[wall];
    counters.wall_impulse[wall] += 2.0 * mass_of(i) * std::abs(disk.velocity_y);
    disk.y += 2.0 * disk.velocity_y * now_;
    disk.velocity_y = -disk.velocity_y;
    ++disk.collision_count;
    return;
  }
  cross_horizontal_border(disk, i, is_upwards);
}

void Dynamics::cross_horizontal_border(MovingDisk& disk, Index i, bool is_upwards) {
  bool const is_last = disk.row == (is_upwards ? grid_.rows() - 1 : 0);
  grid_.erase(i, disk.column, disk.row);
  disk.row += is_upwards ? 1 : -1;
  if (is_last) {
    disk.row = is_upwards ? 0 : grid_.rows() - 1;
    disk.y -= is_upwards ? box_.height() : -box_.height();
    image_[i].y += is_upwards ? 1 : -1;
  }
  grid_.insert(i, disk.column, disk.row);
  if (prediction_input_.capacity != grid_.capacity()) refresh_prediction_input();
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
    saved.partner.push_back(disk.partner < vertical_border ? disks_[disk.partner].id_index : disk.partner);
    saved.partner_collision_count.push_back(disk.partner_collision_count);
    saved.collision_count.push_back(disk.collision_count);
    saved.column.push_back(disk.column);
    saved.row.push_back(disk.row);
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
  archive.visit("looks_in_epoch", looks_in_epoch_);
  archive.visit("expected_events", expected_events_);
  if (is_growing()) serialize_growth(archive);
  if (archive.is_restoring()) restore(archive, saved);
}

void Dynamics::restore(Archive const& archive, SavedDisks const& saved) {
  archive.require(saved.has_size(size_), "the engine has other disks than the state");
  std::vector<Index> const disks = disks_by_id_index();
  for (Index const i : disks) grid_.erase(i, disks_[i].column, disks_[i].row);
  for (std::size_t id_index = 0; id_index < size_; ++id_index) {
    Index const partner = saved.partner[id_index];
    bool const is_inside = saved.column[id_index] >= 0 && saved.column[id_index] < grid_.columns() &&
                           saved.row[id_index] >= 0 && saved.row[id_index] < grid_.rows();
    archive.require(is_inside && (partner >= vertical_border || partner < size_) && saved.event_time[id_index] >= now_,
                    "a disk waits for an event that cannot be");
    MovingDisk& disk = disks_[disks[id_index]];
    disk = {.x = saved.x[id_index],
            .y = saved.y[id_index],
            .velocity_x = saved.velocity_x[id_index],
            .velocity_y = saved.velocity_y[id_index],
            .event_time = saved.event_time[id_index],
            .partner = partner < vertical_border ? disks[partner] : partner,
            .partner_collision_count = saved.partner_collision_count[id_index],
            .collision_count = saved.collision_count[id_index],
            .column = saved.column[id_index],
            .row = saved.row[id_index],
            .id_index = disk.id_index};
    image_[disks[id_index]] = {saved.image_x[id_index], saved.image_y[id_index]};
    grid_.insert(disks[id_index], disk.column, disk.row);
  }
  if (!growth_.places.empty()) find_all_neighbours();
  refresh_prediction_input();
  pipeline_.clear();
  start_epoch();
}

}  // namespace gridlock::exact
