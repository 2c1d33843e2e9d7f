#include "gridlock/engine/growth.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>
#include <vector>

#include "core/temperature.hpp"
#include "engine/exact.hpp"
#include "engine/exact/dynamics.hpp"
#include "engine/exact/left_state.hpp"
#include "gridlock/core/detail/rows_in_order.hpp"
#include "gridlock/core/error.hpp"

namespace gridlock {

namespace {

/// Hits of each disk, on average, after which the events are sorted anew.
constexpr std::uint64_t hits_per_renewal = 32;

/// Least gap in last digits of the coordinates: enough digits to tell gaps apart.
constexpr double digits_of_gap = 16.0;

double closest_packing(State const& state) {
  auto const [smallest, largest] = radius_range(state.agents);
  return smallest == largest ? std::numbers::pi / std::sqrt(12.0) : 1.0;
}

/// The largest reduced pressure p: gaps, about a diameter over p wide, then have just enough digits.
double largest_pressure(State const& state) {
  double const last_digit = std::numeric_limits<double>::epsilon() * std::max(state.box.width(), state.box.height());
  return 2.0 * radius_range(state.agents).smallest / (digits_of_gap * last_digit);
}

/// Returns kT, summed in the order of the Ids, so that its bits do not depend on the order of the rows.
double temperature_by_id(State const& state) {
  std::vector<std::uint32_t> const rows = rows_in_order(state.agents.ids());
  if (std::ranges::is_sorted(rows)) return temperature(state).value_or(0.0);
  Disks sorted;
  for (std::uint32_t const row : rows) {
    Vector const v = velocity(state.agents, row);
    sorted.add(0.0, 0.0, v.x, v.y, state.agents.column<Radius>()[row], state.agents.column<Mass>()[row], 0, 0);
  }
  return temperature(state.box, sorted).value_or(0.0);
}

/// Returns the mass of the lightest, thus fastest, of the smallest disks.
double mass_of_smallest(Disks const& disks) {
  double const smallest = radius_range(disks).smallest;
  double mass = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < disks.size(); ++i) {
    if (disks.column<Radius>()[i] == smallest) mass = std::min(mass, disks.column<Mass>()[i]);
  }
  return mass;
}

/// Returns packing_fraction_of(), summed in the order of the Ids: the same bits for any order of rows.
double packing_fraction_by_id(State const& state) {
  double sum = 0.0;
  for (std::uint32_t const row : rows_in_order(state.agents.ids())) {
    double const radius = state.agents.column<Radius>()[row];
    sum += radius * radius;
  }
  return std::numbers::pi * sum / state.box.area();
}

void scale_velocities(Disks& disks, double factor) {
  for (double& v : disks.column<VelocityX>()) v *= factor;
  for (double& v : disks.column<VelocityY>()) v *= factor;
}

void check_settings(GrowthSettings const& settings, std::vector<Problem>& problems) {
  auto const refuse = [&](std::string what, std::string hint, char const* key) {
    problems.push_back({.what = std::move(what), .hint = std::move(hint), .key = key});
  };
  if (!(settings.rate >= slowest_growth && settings.rate <= fastest_growth)) {
    refuse(fmt::format("a rate of growth of {} is not from {} to {}", settings.rate, slowest_growth, fastest_growth),
           "use 1e-3 or less for dense states, 1e-2 for a quick look", "growth.rate");
  }
  if (!settings.packing_fraction && !settings.pressure) {
    refuse("the disks would grow without end", "give growth.packing_fraction, growth.pressure or both", "growth");
  }
  if (settings.pressure && !(*settings.pressure > 1.0)) {
    refuse(fmt::format("a reduced pressure of {} is not above 1, that of disks without size", *settings.pressure),
           "use for example 1e5", "growth.pressure");
  }
  if (!(settings.collisions_per_rescaling >= 1.0 && settings.collisions_per_rescaling <= 1e9)) {
    refuse(fmt::format("{} collisions a disk from one rescaling to the next are not between 1 and 1e9",
                       settings.collisions_per_rescaling),
           "use 20", "growth.collisions_per_rescaling");
  }
}

void check_ends(GrowthSettings const& settings, State const& state, std::vector<Problem>& problems) {
  double const now = packing_fraction_of(state);
  double const closest = closest_packing(state);
  if (settings.packing_fraction && !(*settings.packing_fraction >= now && *settings.packing_fraction < closest)) {
    problems.push_back(
        {.what = fmt::format("packing fraction {} cannot be grown to: it is {:.6g} now, and {:.6g} is full",
                             *settings.packing_fraction, now, closest),
         .hint = "use a value in between",
         .key = "growth.packing_fraction"});
  }
  double const most = largest_pressure(state);
  if (settings.pressure && !(*settings.pressure <= most)) {
    problems.push_back(
        {.what = fmt::format(
             "at a reduced pressure of {:.6g} the gaps between these disks are fewer than {} last digits of "
             "their coordinates",
             *settings.pressure, digits_of_gap),
         .hint = fmt::format("use at most {:.3g}", most),
         .key = "growth.pressure"});
  }
}

/// Reports growth to a size at which a disk would touch two images of the same partner.
void check_room(GrowthSettings const& settings, State const& state, std::vector<Problem>& problems) {
  if (!state.box.has_images()) return;
  double const last = settings.pressure ? closest_packing(state) : settings.packing_fraction.value_or(0.0);
  double const end = std::min(last, settings.packing_fraction.value_or(last));
  State grown = state;
  double const scale = std::sqrt(std::max(1.0, end / packing_fraction_of(state)));
  for (double& r : grown.agents.column<Radius>()) r *= scale;
  if (auto const needed = side_for_images(grown); state.box.shortest_period() <= needed) {
    problems.push_back(
        {.what = fmt::format("in a periodic box of {} × {} disks grown to packing fraction {:.6g} could touch "
                             "two images of the same partner; they need sides above {:.6g}",
                             state.box.width(), state.box.height(), end, needed),
         .hint = "use more disks, a lower packing fraction or box.edge = \"wall\"",
         .key = "growth.packing_fraction"});
  }
}

void require_growth(GrowthSettings const& settings, State const& state, double temperature) {
  std::vector<Problem> problems;
  check_settings(settings, problems);
  if (state.agents.size() < 2) {
    problems.push_back({.what = fmt::format("there are {} disks, and growth needs two", state.agents.size()),
                        .hint = "use more disks",
                        .key = "disks.count"});
  } else if (!(temperature > 0.0)) {
    problems.push_back(
        {.what = "no disk moves relative to the others, and the rate of growth is measured by their speed",
         .hint = "draw velocities",
         .key = "velocities"});
  }
  if (problems.empty()) check_ends(settings, state, problems);
  if (problems.empty()) check_room(settings, state, problems);
  if (!problems.empty()) throw Error(std::move(problems));
}

}  // namespace

Growth::Growth(GrowthSettings const& settings, State const& state)
    : settings_(settings), temperature_(temperature_by_id(state)), left_(std::make_unique<exact::LeftState>()) {
  require_exact_start(state);
  require_growth(settings, state, temperature_);
  diameter_rate_ = settings.rate * std::sqrt(temperature_ / mass_of_smallest(state.agents));
  hits_per_rescaling_ = static_cast<std::uint64_t>(
      std::llround(2.0 * settings.collisions_per_rescaling * static_cast<double>(state.agents.size())));
}

Growth::~Growth() = default;

void Growth::start_from(State const& state) {
  require_exact_start(state);
  double const temperature = temperature_by_id(state);
  require_growth(settings_, state, temperature);
  double const diameter = 2.0 * radius_range(state.agents).smallest;
  dynamics_ = nullptr;  // the old memory is freed before the new is allocated
  dynamics_ = std::make_unique<exact::Dynamics>(state, exact::DynamicsOptions{.rate = diameter_rate_ / diameter});
  start_time_ = state.clock.time;
  last_scale_ = settings_.packing_fraction ? std::sqrt(*settings_.packing_fraction / packing_fraction_by_id(state))
                                           : std::numeric_limits<double>::infinity();
  measured_from_temperature_ = temperature;
  hits_at_rescaling_ = hits_per_rescaling_;
  hits_at_renewal_ = hits_per_renewal * dynamics_->size();
}

bool Growth::advance(State& state, Counters& counters, std::function<bool()> const& should_continue) {
  if (is_finished_) return true;
  if (dynamics_ == nullptr || !left_->is(state)) start_from(state);
  bool is_stopped = false;
  std::function<bool()> ask;
  if (should_continue) {
    ask = [&] {
      is_stopped = is_stopped || !should_continue();
      return !is_stopped;
    };
  }
  while (!is_stopped) {
    std::uint64_t const before = counters.pair_collisions;
    bool is_at_end = false;
    std::uint64_t const hits = std::min(hits_at_rescaling_, hits_at_renewal_);
    try {
      is_at_end = dynamics_->grow({.scale = last_scale_, .hits = hits}, settings_.audit_every, counters, ask);
    } catch (RunFailure const&) {
      leave_at_last_event(state);
      throw;
    }
    collisions_ += counters.pair_collisions - before;
    if (is_at_end) {
      finish_at_density(state);
    } else if (dynamics_->hits() >= hits_at_rescaling_) {
      rescale(state);
    } else if (dynamics_->hits() >= hits_at_renewal_) {
      dynamics_->renew();
      hits_at_renewal_ = dynamics_->hits() + hits_per_renewal * dynamics_->size();
    }
    if (is_finished_) return true;
  }
  leave_at_last_event(state);
  return false;
}

void Growth::leave_at_last_event(State& state) {
  state.clock.time = start_time_ + dynamics_->last_event();
  dynamics_->write_at_last_event(state);
  left_->remember(state);
}

/// Measures the reduced pressure. kT rises between two rescalings; the mean of its two ends is used.
void Growth::measure_pressure(State const& state) {
  auto const [time, virial] = dynamics_->measurement();
  double const temperature = 0.5 * (measured_from_temperature_ + temperature_by_id(state));
  double const thermal = static_cast<double>(dynamics_->size()) * temperature * time;
  if (thermal > 0.0) reduced_pressure_ = 1.0 + 0.5 * virial / thermal;
}

void Growth::rescale(State& state) {
  leave_at_last_event(state);
  measure_pressure(state);
  if (settings_.pressure && reduced_pressure_ >= settings_.pressure) {
    finish(state);
    return;
  }
  require_gaps_of_some_digits(state);
  dynamics_->renew(std::sqrt(temperature_ / temperature_by_id(state)));
  dynamics_->begin_measurement();
  measured_from_temperature_ = temperature_;
  hits_at_rescaling_ = dynamics_->hits() + hits_per_rescaling_;
  hits_at_renewal_ = dynamics_->hits() + hits_per_renewal * dynamics_->size();
  ++rescalings_;
}

void Growth::finish_at_density(State& state) {
  state.clock.time = start_time_ + dynamics_->time_of(last_scale_);
  dynamics_->write_grown(last_scale_, state);
  // A pressure from fewer than two hits for each disk is too inaccurate to replace the last one.
  bool const has_seen_enough = dynamics_->hits() + hits_per_rescaling_ >= hits_at_rescaling_ + 2 * dynamics_->size();
  if (has_seen_enough || !reduced_pressure_) measure_pressure(state);
  finish(state);
}

void Growth::require_gaps_of_some_digits(State const& state) const {
  if (!reduced_pressure_ || !(*reduced_pressure_ > largest_pressure(state))) return;
  throw RunFailure(fmt::format(
      "time {}: the disks have jammed at packing fraction {:.9g}{}: the reduced pressure is {:.3g}, and the "
      "gaps between the disks are the last digits of their coordinates\n  hint: end the growth by a "
      "pressure, or grow more slowly for a higher packing fraction",
      state.clock.time, packing_fraction_of(state),
      settings_.packing_fraction ? fmt::format(" and cannot grow to {:.6g}", *settings_.packing_fraction)
                                 : std::string(),
      *reduced_pressure_));
}

void Growth::finish(State& state) {
  scale_velocities(state.agents, std::sqrt(temperature_ / temperature_by_id(state)));
  dynamics_ = nullptr;
  is_finished_ = true;
}

void Growth::serialize(Archive& archive, State const& state) {
  bool is_growing = dynamics_ != nullptr;
  bool has_pressure = reduced_pressure_.has_value();
  double pressure = reduced_pressure_.value_or(0.0);
  archive.visit("is_growing", is_growing);
  archive.visit("is_finished", is_finished_);
  archive.visit("temperature", temperature_);
  archive.visit("diameter_rate", diameter_rate_);
  archive.visit("has_pressure", has_pressure);
  archive.visit("pressure", pressure);
  archive.visit("collisions", collisions_);
  archive.visit("rescalings", rescalings_);
  if (archive.is_restoring()) {
    reduced_pressure_ = has_pressure ? std::optional(pressure) : std::nullopt;
    archive.require(temperature_ > 0.0 && diameter_rate_ > 0.0, "these disks do not grow");
    dynamics_ = nullptr;
  }
  if (!is_growing) return;
  archive.visit("start_time", start_time_);
  archive.visit("last_scale", last_scale_);
  archive.visit("measured_from_temperature", measured_from_temperature_);
  archive.visit("hits_at_rescaling", hits_at_rescaling_);
  archive.visit("hits_at_renewal", hits_at_renewal_);
  if (archive.is_restoring()) {
    double const diameter = 2.0 * radius_range(state.agents).smallest;
    dynamics_ = std::make_unique<exact::Dynamics>(state, exact::DynamicsOptions{.rate = diameter_rate_ / diameter});
  }
  serialize_inside(archive, "dynamics", [&] { dynamics_->serialize(archive); });
  left_->remember(state);
}

}  // namespace gridlock
