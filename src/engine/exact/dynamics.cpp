#include "engine/exact/dynamics.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "engine/exact/moving_rows.hpp"
#include "engine/exact/saved_disks.hpp"
#include "engine/exact/strips.hpp"
#include "gridlock/core/detail/rows_in_order.hpp"

namespace gridlock::exact {

namespace {

/// Epochs after which disks are sorted in memory by cell again; a disk stays near its cell for many collisions.
constexpr std::uint64_t epochs_per_sort = 8;

/// An epoch is doubled while disks have fewer hits in it than `few_hits_in_epoch`, on average, and halved above
/// `many_hits_in_epoch`: then predicting all events anew costs little, and the calendar stays small.
constexpr std::uint64_t few_hits_in_epoch = 24;
constexpr std::uint64_t many_hits_in_epoch = 64;
/// An epoch ends early at this number of hits for each disk, where disks come together quickly.
constexpr std::uint64_t max_hits_in_epoch = 1024;

/// In one epoch a disk of the root mean square speed crosses at most this many largest diameters or, in a dilute gas,
/// mean distances between disks: long paths have larger rounding errors. The limits are lower where some disks are more
/// than `moderate_speed` times as fast as others, or are small and touch at small distances.
constexpr double max_diameters_in_epoch = 16.0;
constexpr double max_distances_in_epoch = 4.0;
constexpr double moderate_speed = 4.0;
constexpr double min_diameters_in_epoch = 2.0;

std::uint8_t kind_in(Kinds const& kinds, Disks const& disks, std::size_t row) {
  std::pair const kind{disks.column<Radius>()[row], disks.column<Mass>()[row]};
  return static_cast<std::uint8_t>(std::ranges::lower_bound(kinds, kind) - kinds.begin());
}

}  // namespace

Dynamics::Dynamics(State const& state, DynamicsOptions const& options)
    : Flight(state.box), thermal_speed_squared_(options.thermal_speed_squared), sharing_(options.sharing) {
  gravity_ = options.gravity;
  losses_ = options.losses;
  size_of_cells_ = options.size_of_cells;
  lists_.wish = options.lists;
  read_disks(state);
  read_obstacles(state, options.walls);
  if (losses_.contact_time > 0.0) last_contact_.resize(size_, -never);
  if (options.rate != 0.0) start_growing(options.rate);
  choose_epoch();
  renew_lists(0.0);
  make_room_in_cells(0.0);
  sort_disks_by_cell(0.0);
  refresh_prediction_input();
  predict_all(0.0);
  expected_events_ = 32 * size_;
  choose_fetching();
  open_calendar();
}

Dynamics::~Dynamics() = default;

void Dynamics::read_disks(State const& state) {
  Disks const& disks = state.agents;
  std::vector<std::uint32_t> rows = moving_rows(disks);
  auto const radius = disks.column<Radius>();
  auto const mass = disks.column<Mass>();
  size_ = rows.size();
  disks_in_box_ = size_;
  if (size_ > 0) {
    equal_radius_ = radius[rows.front()];
    equal_mass_ = mass[rows.front()];
  }
  bool const is_mixture = std::ranges::any_of(
      rows, [&](std::uint32_t row) { return radius[row] != equal_radius_ || mass[row] != equal_mass_; });
  disks_.reserve(size_ + 1);
  image_.reserve(size_);
  Kinds const kinds = losses_.kinds > 1 ? kinds_of(disks) : Kinds{};
  double mean_mass = 0.0;  // summed in the order of the Ids
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
    if (!kinds.empty()) kind_.push_back(kind_in(kinds, disks, row));
    mean_squared_radius_ += radius[row] * radius[row] / static_cast<double>(size_);
    mean_mass += mass[row] / static_cast<double>(size_);
  }
  if (size_ > 0) {
    auto const radius_of_row = [&](std::uint32_t row) { return radius[row]; };
    smallest_radius_ = radius[std::ranges::min(rows, {}, radius_of_row)];
    largest_radius_ = radius[std::ranges::max(rows, {}, radius_of_row)];
    double const speed_of_lightest = std::sqrt(mean_mass / *std::ranges::min_element(mass));
    double const distance = std::sqrt(box_.area() / static_cast<double>(size_)) / (2.0 * largest_radius_);
    double const diameters = std::max(max_diameters_in_epoch, max_distances_in_epoch * distance) *
                             std::min(1.0, moderate_speed / speed_of_lightest) * (smallest_radius_ / largest_radius_);
    diameters_in_epoch_ = std::max(min_diameters_in_epoch, diameters);
  }
  disks_.push_back({.event_time = -never, .partner = vertical_border});
  if (is_mixture) radius_.push_back(0.0);
  if (size_ > 0 && disks.ids()[rows.back()] != size_ - 1) {
    for (std::uint32_t const row : rows) ids_.push_back(disks.ids()[row]);
  }
  if (size_ < disks.size() || !std::ranges::is_sorted(rows)) row_of_ = std::move(rows);
}

void Dynamics::read_obstacles(State const& state, std::span<Obstacle const> walls) {
  std::vector<Obstacle> obstacles(walls.begin(), walls.end());
  Disks const& disks = state.agents;
  Kinds const kinds = losses_.kinds > 1 ? kinds_of(disks) : Kinds{};
  for (std::uint32_t const row : rows_in_order(disks.ids())) {
    Vector const p = position(disks, row);
    if (!is_fixed(disks, row)) continue;
    std::uint8_t const kind = kinds.empty() ? std::uint8_t{0} : kind_in(kinds, disks, row);
    obstacles.push_back({.from = p, .to = p, .radius = disks.column<Radius>()[row], .kind = kind});
  }
  all_obstacles_ = Obstacles(box_, obstacles, largest_radius_);
  if (!all_obstacles_.empty()) obstacles_ = &all_obstacles_;
}

/// Returns the longest epoch allowed. It depends on the motion alone: the squared speeds count as if they were summed
/// in the order of the Ids, which is not the order in memory.
double Dynamics::longest_epoch() const {
  auto const squared_speed = [this](Index i) {
    return disks_[i].velocity_x * disks_[i].velocity_x + disks_[i].velocity_y * disks_[i].velocity_y;
  };
  double sum = 0.0;
  for (Index i = 0; i < size_; ++i) sum += squared_speed(i);
  // Any order gives a sum between these limits, and mostly all give the same power of two.
  double const rounding = static_cast<double>(size_) * std::numeric_limits<double>::epsilon() * sum;
  double const longest = longest_epoch_with(sum + rounding);
  if (longest == longest_epoch_with(sum - rounding)) return longest;
  sum = 0.0;
  for (Index const i : disks_by_id_index()) sum += squared_speed(i);
  return longest_epoch_with(sum);
}

double Dynamics::longest_epoch_with(double squared_speeds) const {
  // Kicks make disks that happen to be slow as fast as others, and so does a fall through a diameter.
  double const diameter = 2.0 * largest_radius_ * growth_.scale.at_zero;
  double const squared_speed_of_fall = 2.0 * std::sqrt(squared_length(gravity_)) * diameter;
  double const least = std::max(thermal_speed_squared_, squared_speed_of_fall);
  squared_speeds = std::max(squared_speeds, least * static_cast<double>(size_));
  if (!(squared_speeds > 0.0)) return 0.0;
  double const crossing = diameter / std::sqrt(squared_speeds / static_cast<double>(size_));
  return power_of_two_below((is_growing() ? 2.0 : diameters_in_epoch_) * crossing);
}

void Dynamics::choose_epoch() {
  longest_epoch_ = longest_epoch();
  epoch_length_ = is_growing() ? longest_epoch_ : longest_epoch_ / max_diameters_in_epoch;
}

namespace {

/// Counts the events of all disks.
struct Observer {
  Counters& counters;

  void pair_collided(Index /*i*/, Index /*j*/, double virial) {
    ++counters.pair_collisions;
    counters.pair_virial += virial;
  }
  void wall_hit(Index /*i*/, Side side, double impulse) {
    auto const wall = static_cast<std::size_t>(side);
    ++counters.wall_hits[wall];
    counters.wall_impulse[wall] += impulse;
  }
  void fixed_disk_hit(Index i, double virial) { pair_collided(i, i, virial); }
  void inner_wall_hit(Index /*i*/, double impulse) {
    ++counters.inner_wall_hits;
    counters.inner_wall_impulse += impulse;
  }
  void border_reached(Index /*i*/) {}
};

}  // namespace

bool Dynamics::run(double elapsed, std::uint64_t pair_collisions, std::uint64_t audit_every, Counters& counters,
                   std::function<bool()> const& should_continue) {
  if (epoch_length_ == 0.0) return true;  // no disk moves, so no event will come
  auto const has_enough = [&] { return counters.pair_collisions >= pair_collisions; };
  for (;;) {
    End const end = strips_ != nullptr ? run_shared(elapsed, pair_collisions, audit_every, counters, should_continue)
                                       : run_until<false>([&] { return elapsed - epoch_start_; }, has_enough,
                                                          audit_every, counters, should_continue);
    if (end == End::time) return true;
    if (end == End::early) return false;
    if (end == End::epoch) {
      if (may_be_kicked(elapsed)) return true;
      end_epoch(collisions_to_go(pair_collisions, audit_every, counters) > collisions_worth_sharing());
    }
  }
}

bool Dynamics::grow(EndOfGrowth const& end, std::uint64_t audit_every, Counters& counters,
                    std::function<bool()> const& should_continue) {
  auto const has_enough = [&] { return counters.pair_collisions >= end.pair_collisions || hits_ >= end.hits; };
  for (;;) {
    End const reached = run_until<true>([&] { return growth_.scale.time_of(end.scale); }, has_enough, audit_every,
                                        counters, should_continue);
    if (reached != End::epoch) return reached == End::time;
    end_epoch(false);
  }
}

template <bool grows, class TimeToStop, class HasEnough>
Dynamics::End Dynamics::run_until(TimeToStop time_to_stop, HasEnough has_enough, std::uint64_t audit_every,
                                  Counters& counters, std::function<bool()> const& should_continue) {
  Observer observer{counters};
  while (!has_enough()) {
    ScheduledEvent const* const next = next_event();
    if (next == nullptr) return End::epoch;
    if (next->time > time_to_stop()) return End::time;
    std::uint64_t const before = counters.pair_collisions;
    Index const disk = take(next).disk;
    ++counters.moves;
    handle<grows>(disk, observer);
    bool const is_audit_due =
        audit_every > 0 && counters.pair_collisions != before && counters.pair_collisions % audit_every == 0;
    if (is_audit_due) {
      audit();
      ++audits_;
    }
    // `moves` survives interruptions, so the callback is asked at the same events in every run.
    bool const is_look_due = counters.moves % events_per_look == 0;
    if (is_look_due) require_time_to_pass();
    if (!grows && hits_ - hits_before_epoch_ > max_hits_in_epoch * size_) [[unlikely]]
      cut_epoch();
    if ((is_look_due || is_audit_due) && should_continue && !should_continue()) return End::early;
  }
  return End::early;
}

/// Begins the next epoch, on several threads where `may_share` allows it and it is faster.
void Dynamics::end_epoch(bool may_share) {
  std::uint64_t const hits = hits_ - hits_before_epoch_;
  double const hits_per_time = static_cast<double>(hits) / (static_cast<double>(size_) * epoch_length_);
  double length = epoch_length_;
  if (is_growing()) {
    length = std::min(2.0 * length, longest_epoch());
  } else if (hits < few_hits_in_epoch * size_) {
    length = std::min(2.0 * length, longest_epoch_);
  } else if (hits >= many_hits_in_epoch * size_) {
    length *= 0.5;
  }
  begin_epoch(epoch_length_, length, 1.0, may_share ? hits_per_time : 0.0);
}

/// Ends the epoch now and continues with epochs of few hits.
void Dynamics::cut_epoch() {
  double const length = power_of_two_below(now_ * static_cast<double>(few_hits_in_epoch) / max_hits_in_epoch);
  if (!(length > 0.0)) return;  // no time has passed since the epoch began
  begin_epoch(now_, length);
}

void Dynamics::begin_epoch(double zero, double length, double factor_of_velocities, double hits_per_time) {
  double const duration = std::max(now_, std::min(zero, epoch_length_));
  move_zero_of_time(zero);
  for (std::size_t i = 0; i < size_; ++i) {
    disks_[i].last_hit = 0.0;
    disks_[i].velocity_x *= factor_of_velocities;
    disks_[i].velocity_y *= factor_of_velocities;
  }
  if (is_growing() || changes_energy()) longest_epoch_ = longest_epoch();
  length = std::min({length, longest_epoch_, next_kick_ - epoch_start_});
  expected_events_ = static_cast<std::uint64_t>(static_cast<double>(events_made()) * (length / duration));
  epoch_length_ = length;
  bool const is_sort_due = epoch_ % epochs_per_sort == 0;
  if (hits_per_time > 0.0 && share_epoch(hits_per_time, is_sort_due)) return;
  strips_ = nullptr;
  renew_lists(0.0);
  make_room_in_cells(0.0);
  if (is_sort_due) sort_disks_by_cell(0.0);
  refresh_prediction_input();
  predict_all(0.0);
  open_calendar();
}

void Dynamics::move_zero_of_time(double zero) {
  for (std::size_t i = 0; i < size_; ++i) {
    disks_[i].x += disks_[i].velocity_x * zero;
    disks_[i].y += disks_[i].velocity_y * zero;
  }
  if (falls()) let_fall(zero);
  for (double& time : last_contact_) time -= zero;
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

void Dynamics::report_collisions(ReportCollision const& report, double start) {
  if (strips_ != nullptr) end_sharing();
  reporting_ = {.report = &report, .start = start};
}

/// Adds the motion by gravity to the positions and velocities at the start of the epoch.
void Dynamics::let_fall(double time) {
  Vector const fallen = fall(gravity_, time);
  for (std::size_t i = 0; i < size_; ++i) {
    disks_[i].x += fallen.x;
    disks_[i].y += fallen.y;
    disks_[i].velocity_x += gravity_.x * time;
    disks_[i].velocity_y += gravity_.y * time;
  }
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
    Vector p = box_.wrap(centre_at(disk, gravity_, t), crossed_x, crossed_y);
    Vector const v = velocity_at(disk, gravity_, t);
    // A disk at a wall may be outside the box by a rounding error.
    if (!box_.is_periodic_x()) p.x = std::clamp(p.x, radius[row], box_.width() - radius[row]);
    if (!box_.is_periodic_y()) p.y = std::clamp(p.y, radius[row], box_.height() - radius[row]);
    disks.column<X>()[row] = p.x;
    disks.column<Y>()[row] = p.y;
    disks.column<VelocityX>()[row] = v.x;
    disks.column<VelocityY>()[row] = v.y;
    disks.column<ImageX>()[row] = image_[i].x + crossed_x;
    disks.column<ImageY>()[row] = image_[i].y + crossed_y;
  }
}

void Dynamics::serialize(Archive& archive) {
  if (strips_ != nullptr) end_sharing();
  SavedDisks saved;
  for (Index const i : disks_by_id_index()) {
    MovingDisk const& disk = disks_[i];
    saved.x.push_back(disk.x);
    saved.y.push_back(disk.y);
    saved.velocity_x.push_back(disk.velocity_x);
    saved.velocity_y.push_back(disk.velocity_y);
    saved.event_time.push_back(disk.event_time);
    saved.last_hit.push_back(disk.last_hit);
    saved.partner.push_back(disk.partner < first_obstacle ? disks_[disk.partner].id_index : disk.partner);
    saved.partner_collision_count.push_back(disk.partner_collision_count);
    saved.collision_count.push_back(disk.collision_count);
    saved.column.push_back(has_lists() ? 0 : cells_[i].column);
    saved.row.push_back(has_lists() ? 0 : cells_[i].row);
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
  if (losses_.contact_time > 0.0) serialize_contacts(archive);
  serialize_lists(archive);
  if (archive.is_restoring()) restore(archive, saved);
}

void Dynamics::serialize_contacts(Archive& archive) {
  std::vector<double> times;
  std::vector<Index> const disks = disks_by_id_index();
  for (Index const i : disks) times.push_back(last_contact_[i]);
  archive.visit("last_contacts", times);
  if (!archive.is_restoring()) return;
  archive.require(times.size() == size_, "the engine has other disks than the state");
  for (std::size_t id_index = 0; id_index < size_; ++id_index) last_contact_[disks[id_index]] = times[id_index];
}

void Dynamics::restore(Archive const& archive, SavedDisks const& saved) {
  archive.require(saved.has_size(size_), "the engine has other disks than the state");
  std::vector<Index> const disks = disks_by_id_index();
  for (std::size_t id_index = 0; id_index < size_; ++id_index) {
    Index const partner = saved.partner[id_index];
    bool const is_obstacle = partner >= first_obstacle && partner - first_obstacle < all_obstacles_.size();
    archive.require((partner >= vertical_border || is_obstacle || partner < size_) &&
                        saved.event_time[id_index] >= now_ && std::isfinite(saved.last_hit[id_index]),
                    "a disk waits for an event that cannot be");
    MovingDisk& disk = disks_[disks[id_index]];
    disk = {.x = saved.x[id_index],
            .y = saved.y[id_index],
            .velocity_x = saved.velocity_x[id_index],
            .velocity_y = saved.velocity_y[id_index],
            .event_time = saved.event_time[id_index],
            .last_hit = saved.last_hit[id_index],
            .partner = partner < first_obstacle ? disks[partner] : partner,
            .partner_collision_count = saved.partner_collision_count[id_index],
            .collision_count = saved.collision_count[id_index],
            .id_index = disk.id_index};
    image_[disks[id_index]] = {saved.image_x[id_index], saved.image_y[id_index]};
  }
  restore_cells(archive, saved);
  refresh_prediction_input();
  pipeline_.clear();
  open_calendar();
}

}  // namespace gridlock::exact
