#include "exact.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <memory>
#include <span>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "engine/exact/dynamics.hpp"
#include "engine/heading_columns.hpp"
#include "gridlock/core/detail/rows_in_order.hpp"
#include "gridlock/core/detail/thread_pool.hpp"
#include "gridlock/core/error.hpp"
#include "gridlock/grid/validate.hpp"

namespace gridlock {

namespace {

/// A periodic box must be wider than two distances at contact, or a disk could touch another from both sides at once.
void require_room_for_images(State const& state) {
  if (state.agents.size() < 2) return;
  double const needed = side_for_images(state);
  if (state.box.shortest_period() > needed) return;
  throw Error({.what = fmt::format("in a periodic box of {} × {} a disk could touch two images of the same partner; "
                                   "these disks need sides above {:.6g}",
                                   state.box.width(), state.box.height(), needed),
               .hint = "use a larger box, smaller disks or box.edge = \"wall\"",
               .key = "engine.kind"});
}

/// Throws Error for a disk that touches two walls at once: the walls would hand it back and forth without end.
void require_room_between_walls(State const& state, double rounding) {
  if (state.box.is_periodic()) return;
  double const room_x = state.box.is_periodic_x() ? std::numeric_limits<double>::infinity() : state.box.width();
  double const room_y = state.box.is_periodic_y() ? std::numeric_limits<double>::infinity() : state.box.height();
  for (std::size_t i = 0; i < state.agents.size(); ++i) {
    double const diameter = 2.0 * state.agents.column<Radius>()[i];
    Vector const v = velocity(state.agents, i);
    bool const is_stuck_in_x = v.x != 0.0 && room_x - diameter <= rounding;
    bool const is_stuck_in_y = v.y != 0.0 && room_y - diameter <= rounding;
    if (!is_stuck_in_x && !is_stuck_in_y) continue;
    throw Error(
        {.what = fmt::format("disk {} of diameter {} touches two opposite walls of the box of {} × {} and moves "
                             "({}, {}): it would bounce without end while no time passes",
                             state.agents.ids()[i], diameter, state.box.width(), state.box.height(), v.x, v.y),
         .hint = "use a larger box or a smaller disk, or let it move along the walls only",
         .key = "disks"});
  }
}

/// Throws Error for masses that differ so much that rounding matters. Collisions share the energy, so a disk of small
/// mass becomes fast. A path is computed from the start of an epoch, in which a disk of the root mean square speed
/// crosses two cells; a disk that is s times as fast overlaps by up to s · 4 · 2⁻⁵³ · 2 cells. Runs show a tenth of
/// this bound: 1.3 · 10⁻¹² contact distances at s = 2 · 10⁴.
void require_masses_of_like_size(State const& state) {
  constexpr double max_speed_ratio = 1000.0;
  auto const masses = state.agents.column<Mass>();
  if (masses.empty()) return;
  double squared_speeds = 0.0;
  for (std::size_t i = 0; i < state.agents.size(); ++i) squared_speeds += squared_length(velocity(state.agents, i));
  double const lightest = *std::ranges::min_element(masses);
  double heaviest = lightest;
  for (double const mass : masses) heaviest = is_fixed(mass) ? heaviest : std::max(heaviest, mass);
  double const square_of_ratio = 2.0 * kinetic_energy(state.agents) / (lightest * squared_speeds);
  if (!(square_of_ratio > max_speed_ratio * max_speed_ratio)) return;
  throw Error(
      {.what = fmt::format("with masses from {:.6g} to {:.6g} collisions would make the lightest disks {:.3g} "
                           "times as fast as the others are now; above {} times overlaps are more than rounding",
                           lightest, heaviest, std::sqrt(square_of_ratio), max_speed_ratio),
       .hint = "use masses less than a million times apart",
       .key = "disks.species"});
}

/// Returns the mean of 2 kT/m; fixed disks add nothing.
double thermal_speed_squared(State const& state, double temperature) {
  double sum = 0.0;  // in the order of the Ids
  for (std::uint32_t const row : rows_in_order(state.agents.ids())) sum += 1.0 / state.agents.column<Mass>()[row];
  return 2.0 * temperature * sum / static_cast<double>(state.agents.size());
}

/// Returns the headings of all disks of a frame, where that of a fixed disk is (0, 0); nothing if `of_moving` are not
/// those of its disks that move.
std::vector<Vector> headings_of_all(std::span<Vector const> of_moving, FrameSource const& frame) {
  if (of_moving.empty()) return {};
  auto const masses = std::get<std::vector<double>>(frame.values(*frame.find(Mass::name), 0, frame.size()));
  auto const is_moving = [](double mass) { return !is_fixed(mass); };
  if (static_cast<std::size_t>(std::ranges::count_if(masses, is_moving)) != of_moving.size()) return {};
  std::vector<Vector> headings(masses.size());
  std::size_t next = 0;
  for (std::size_t i = 0; i < masses.size(); ++i) {
    if (is_moving(masses[i])) headings[i] = of_moving[next++];
  }
  return headings;
}

/// The least side of an oblique box in distances at contact. With two, disks would have no room around their places.
constexpr double contacts_in_oblique_box = 2.1;

/// The least number of disks for threads: with fewer, every disk of a strip would be near its border.
constexpr std::size_t min_disks_to_share = 5000;

}  // namespace

double side_for_images(State const& state) {
  double const contacts = state.box.is_oblique() ? contacts_in_oblique_box : 2.0;
  return contacts * largest_contact_distance(state.agents.column<Radius>());
}

void require_exact_start(State const& state) {
  double const rounding = rounding_of_contact(state);
  validate(state, {.overlap = rounding, .beyond_walls = rounding});
  require_room_for_images(state);
  require_room_between_walls(state, rounding);
  require_masses_of_like_size(state);
}

EngineRecord exact_record() {
  return {.name = "exact",
          .documentation = "goes from collision to collision without a time step",
          .has_time_step = false,
          .uses_threads = true,
          .has_free_flight = true,
          .has_oblique_boxes = true,
          .bytes_per_disk = 340.0,
          .bytes_per_disk_of_threads = 310.0,
          .bytes_per_disk_of_checkpoint = 163.0,
          .unused_because_of =
              [](EngineSettings const& /*settings*/, std::string_view setting) {
                bool const is_used = setting == "kind" || setting == "time_step" || setting == "speed" ||
                                     setting == "audit_every" || setting == "threads";
                return std::string_view(is_used ? "" : "kind");
              },
          .cost_of_move = [](EngineSettings const& /*settings*/, State const& /*state*/) { return 1.0; },
          .make = [](EngineSettings const& settings, State const& state) -> std::unique_ptr<Engine> {
            return std::make_unique<ExactEngine>(settings, state);
          }};
}

ExactEngine::ExactEngine(EngineSettings const& settings, State const& state)
    : audit_every_(settings.audit_every),
      duration_(step_duration(settings, state)),
      thread_count_(settings.threads),
      thermostat_settings_(resolved(settings.thermostat, state)),
      collisions_(settings.collisions),
      gravity_(settings.gravity.acceleration()),
      walls_(settings.walls),
      propulsion_(settings.propulsion) {
  ExactEngine::require_valid(state);
}

ExactEngine::~ExactEngine() = default;

void ExactEngine::require_valid(State const& state) const {
  require_exact_start(state);
  require_room_beside_walls(state, walls_);
  static_cast<void>(exact::losses_for(collisions_, state.agents));
}

std::vector<Count> ExactEngine::counts(State const& state, Counters const& counters) const {
  std::vector<Count> counts = Engine::counts(state, counters);
  if (collisions_.contact_time > 0.0) counts.push_back({"elastic_contacts", elastic_contacts()});
  std::ranges::move(audits(), std::back_inserter(counts));
  return counts;
}

std::vector<Count> ExactEngine::audits() const {
  if (audit_every_ == 0) return {};
  return {{"audits", made_audits()}, {"audits_for_missed_events", audits_for_missed_events()}};
}

bool ExactEngine::is_as_left(State const& state) const { return dynamics_ != nullptr && left_.is(state); }

void ExactEngine::start_from(State& state) {
  require_valid(state);
  earlier_audits_ = made_audits();
  earlier_contacts_ = elastic_contacts();
  if (thermostat_settings_.kind != ThermostatKind::none) {
    thermostat_.emplace(thermostat_settings_, propulsion_, state.seed);
    thermostat_->start_from(state);
  }
  make_dynamics(state);
  start_time_ = state.clock.time;
  next_step_time_ = state.clock.time + duration_;
  expect_kick();
  ask_for_reports();
}

void ExactEngine::report_collisions(ReportCollision report) {
  report_ = std::move(report);
  if (dynamics_ != nullptr) ask_for_reports();
}

void ExactEngine::ask_for_reports() {
  if (report_) dynamics_->report_collisions(report_, start_time_);
}

void ExactEngine::make_dynamics(State const& state) {
  dynamics_ = nullptr;  // the old memory is freed before the new is allocated
  // Kicks of single disks come too often for threads to fly apart.
  bool const can_share = thermostat_settings_.kind != ThermostatKind::andersen;
  if (threads_ == nullptr && can_share && state.agents.size() >= min_disks_to_share) {
    threads_ = std::make_unique<ThreadPool>(thread_count_);
  }
  std::vector<Obstacle> const walls = obstacles_of(walls_);
  exact::DynamicsOptions options{.sharing = {.threads = threads_.get()},
                                 .gravity = gravity_,
                                 .losses = exact::losses_for(collisions_, state.agents),
                                 .walls = walls};
  if (thermostat_) {
    options.thermal_speed_squared =
        thermal_speed_squared(state, *thermostat_settings_.temperature) + propulsion_.speed * propulsion_.speed;
  }
  dynamics_ = std::make_unique<exact::Dynamics>(state, options);
}

void ExactEngine::advance(State& state, Counters& counters, StopCondition const& stop_condition) {
  if (state.agents.empty()) return;
  if (!is_as_left(state)) start_from(state);
  bool const ends_by_collisions_only =
      stop_condition.step == StopCondition{}.step && !std::isfinite(stop_condition.time);
  if (ends_by_collisions_only && !dynamics_->can_collide()) {
    throw RunFailure("no two disks can ever collide, so the collisions asked for would never come");
  }
  while (!stop_condition.is_reached(state.clock, counters.pair_collisions)) {
    double const target = next_target(state.clock, stop_condition);
    bool is_at_target = false;
    try {
      is_at_target = dynamics_->run(target - start_time_, stop_condition.pair_collisions, audit_every_, counters,
                                    stop_condition.should_continue);
    } catch (RunFailure const&) {
      leave_at_last_event(state, target);
      throw;
    }
    if (!is_at_target) {
      bool const is_interrupted = counters.pair_collisions < stop_condition.pair_collisions;
      // The clock stays short of the target too, or the rest of the step would be taken for done.
      leave_at_last_event(state, is_interrupted ? std::nextafter(target, state.clock.time) : target);
      return;
    }
    bool const ends_step = pass_steps_until(target, state.clock);
    if (target >= next_kick_time()) thermostat_->kick(*dynamics_, start_time_, counters);
    if (ends_step && stop_condition.stops_here()) break;
  }
  dynamics_->write(state.clock.time - start_time_, state);
  left_.remember(state);
}

/// The time at which the next step ends. Where threads share the work, the time of the last step that ends within the
/// window in which strips fly independently.
double ExactEngine::next_target(Clock const& clock, StopCondition const& stop_condition) const {
  double const end_of_window = clock.time + dynamics_->window();
  double target = next_step_time_;
  for (std::uint64_t step = clock.step + 1; step < stop_condition.step && target + duration_ <= end_of_window; ++step) {
    target += duration_;
  }
  return std::min({target, stop_condition.time, next_kick_time()});
}

void ExactEngine::expect_kick() {
  if (thermostat_ && thermostat_->is_brownian()) dynamics_->expect_kick(thermostat_->next_time() - start_time_);
}

double ExactEngine::next_kick_time() const {
  return thermostat_ ? thermostat_->next_time() : std::numeric_limits<double>::infinity();
}

/// Moves the clock to this time. Returns whether a step ends there.
bool ExactEngine::pass_steps_until(double time, Clock& clock) {
  clock.time = time;
  bool ends_step = false;
  while (next_step_time_ <= time) {
    ends_step = next_step_time_ == time;
    ++clock.step;
    next_step_time_ += duration_;
  }
  return ends_step;
}

void ExactEngine::give_frame(FrameSource const& of_world, UseFrame const& use) const {
  std::span<Vector const> of_moving;
  if (thermostat_) of_moving = thermostat_->headings();
  give_frame_with_headings(propulsion_, headings_of_all(of_moving, of_world), of_world, use);
}

std::uint64_t ExactEngine::made_audits() const {
  return earlier_audits_ + (dynamics_ == nullptr ? 0 : dynamics_->audits());
}

std::uint64_t ExactEngine::elastic_contacts() const {
  return earlier_contacts_ + (dynamics_ == nullptr ? 0 : dynamics_->elastic_contacts());
}

std::uint64_t ExactEngine::audits_for_missed_events() const {
  return dynamics_ != nullptr && dynamics_->looks_for_missed_events() ? made_audits() : 0;
}

void ExactEngine::leave_at_last_event(State& state, double latest) {
  // The clock counts the steps up to the last event, as it would with one thread, which stops at each step.
  while (next_step_time_ - start_time_ < dynamics_->last_event()) {
    ++state.clock.step;
    next_step_time_ += duration_;
  }
  state.clock.time = std::min({start_time_ + dynamics_->last_event(), next_step_time_, latest});
  dynamics_->write_at_last_event(state);
  left_.remember(state);
}

void ExactEngine::serialize(Archive& archive, State const& state) {
  bool has_started = dynamics_ != nullptr;
  archive.visit("has_started", has_started);
  if (archive.is_restoring() && has_started) {
    if (thermostat_settings_.kind != ThermostatKind::none) {
      thermostat_.emplace(thermostat_settings_, propulsion_, state.seed);
    }
    make_dynamics(state);
  }
  if (archive.is_restoring() && !has_started) dynamics_ = nullptr;
  if (!has_started) return;
  if (audit_every_ > 0) {
    std::uint64_t all_audits = made_audits();
    archive.visit("audits", all_audits);
    if (archive.is_restoring()) earlier_audits_ = all_audits;
  }
  if (collisions_.contact_time > 0.0) {
    std::uint64_t all_contacts = elastic_contacts();
    archive.visit("elastic_contacts", all_contacts);
    if (archive.is_restoring()) earlier_contacts_ = all_contacts;
  }
  archive.visit("start_time", start_time_);
  archive.visit("next_step_time", next_step_time_);
  serialize_inside(archive, "dynamics", [&] { dynamics_->serialize(archive); });
  if (thermostat_) {
    serialize_inside(archive, "thermostat", [&] { thermostat_->serialize(archive, state); });
    if (archive.is_restoring()) expect_kick();
  }
  ask_for_reports();
  left_.remember(state);
}

}  // namespace gridlock
