#include "gridlock/packing/pressure_ramp.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string_view>
#include <utility>

#include "gridlock/core/error.hpp"
#include "gridlock/packing/contact_network.hpp"
#include "gridlock/packing/elasticity.hpp"
#include "packing/serialized_columns.hpp"
#include "packing/site_forces.hpp"

namespace gridlock {

namespace {

constexpr double min_share_of_goal = 0.3;
/// Least pressure of a step down over the present pressure, where a ramp up has passed its goal.
constexpr double share_of_step_back = 0.32;
/// Largest number of halvings of a step down. Disks that lose all contacts even at a thousandth of the step have no
/// packing at lower pressures.
constexpr std::uint64_t max_halvings_of_ramp = 12;
/// Largest number of minima between two levels; usual are five. Towards a tiny goal there would be no end.
constexpr std::uint64_t max_minima_between_levels = 300;
/// Largest number of minima near the final pressure; usual are one to three.
constexpr std::uint64_t max_minima_near_end = 20;

/// Contacts for each disk that the first step up shall make; a jammed packing has about two.
constexpr double pairs_of_a_disk = 1.5;

/// Longest displacement of a disk by the response to growth, in smallest diameters.
constexpr double longest_step_of_ramp = 0.1;

/// Slope du/dφ while none is measured: that of random packings of two sizes.
constexpr double usual_slope_harmonic = 0.27;
constexpr double usual_slope_hertzian = 0.36;

/// Returns the root x of xⁿ = value for value > 0 by Newton's method: the same bits on every processor and library.
double nth_root(double value, std::uint64_t n) {
  double x = std::max(value, 1.0);
  for (int k = 0; k < 2000; ++k) {
    double power = 1.0;
    for (std::uint64_t i = 1; i < n; ++i) power *= x;
    double const next = x - (x * power - value) / (static_cast<double>(n) * power);
    if (!(next < x)) break;  // from above, steps lead down until rounding ends them
    x = next;
  }
  return x;
}

/// Returns the function of p that is linear in the distance to jamming: p, or p^(2/3).
double linear_pressure(double pressure, Potential potential) {
  if (pressure <= 0.0) return 0.0;
  return potential == Potential::harmonic ? pressure : nth_root(pressure * pressure, 3);
}

PressureRampSettings const& checked(PressureRampSettings const& settings) {
  if (!(settings.pressure > 0.0 && settings.pressure < 1.0)) {
    throw Error({.what = fmt::format("a pressure of {} cannot be reached", settings.pressure),
                 .hint = "use a number above 0 and below 1, in units of ε/D²",
                 .key = "protocol.until_pressure"});
  }
  if (settings.levels_per_decade < 1 || settings.levels_per_decade > PressureRampSettings::max_levels_per_decade) {
    throw Error({.what = fmt::format("{} levels of pressure in a decade", settings.levels_per_decade),
                 .hint = fmt::format("use 1 to {}", PressureRampSettings::max_levels_per_decade),
                 .key = "protocol.levels_per_decade"});
  }
  if (settings.packing_fraction &&
      !(*settings.packing_fraction >= min_packing_fraction && *settings.packing_fraction <= max_packing_fraction)) {
    throw Error({.what = fmt::format("a packing fraction of {} cannot be reached", *settings.packing_fraction),
                 .hint = fmt::format("use a number from {} to {}", min_packing_fraction, max_packing_fraction),
                 .key = "protocol.until_packing_fraction"});
  }
  if (!(settings.step >= PressureRampSettings::min_step && settings.step <= PressureRampSettings::max_step)) {
    throw Error({.what = fmt::format("steps of {} in packing fraction", settings.step),
                 .hint = fmt::format("use a number from {} to {}", PressureRampSettings::min_step,
                                     PressureRampSettings::max_step),
                 .key = "protocol.step"});
  }
  return settings;
}

}  // namespace

void require_countable_levels(double from, double to, double step, std::string const& key) {
  double const distance = std::abs(to - from);
  if (distance <= step * PressureRampSettings::max_levels) return;
  throw Error(
      {.what = fmt::format("steps of {} from packing fraction {:.6g} to {:.6g} are {:.3g} levels, each of which "
                           "is kept",
                           step, from, to, distance / step),
       .hint = fmt::format("use a step of {:.2g} or more, for at most {} levels",
                           1.05 * distance / PressureRampSettings::max_levels, PressureRampSettings::max_levels),
       .key = key});
}

char const* to_text(RampStatus status) {
  switch (status) {
    case RampStatus::running:
      return "running";
    case RampStatus::reached:
      return "reached";
    case RampStatus::unjammed:
      return "unjammed";
    case RampStatus::unconverged:
      return "unconverged";
    case RampStatus::missed:
      break;
  }
  return "missed";
}

PressureRamp::PressureRamp(PressureRampSettings const& settings, Packing packing)
    : settings_(checked(settings)), good_(std::move(packing)), minimizer_(settings.minimizer, good_) {
  if (!settings_.packing_fraction) return;
  require_countable_levels(gridlock::packing_fraction(good_), *settings_.packing_fraction, settings_.step,
                           "protocol.step");
}

bool PressureRamp::advance(std::function<bool()> const& should_continue) {
  while (status_ == RampStatus::running) {
    if (!minimizer_.advance(should_continue)) return false;
    take_minimum();
    if (status_ == RampStatus::running && should_continue && !should_continue()) return false;
  }
  return true;
}

void PressureRamp::try_packing_fraction(double packing_fraction) {
  tried_ = packing_fraction;
  Packing next = good_;
  double const factor = std::sqrt(packing_fraction / packing_fraction_);
  for (double& radius : next.radius) radius *= factor;
  bool const is_near_minimum = move_with_growth(next, factor - 1.0);
  is_near_minimum ? minimizer_.restart_near_minimum(std::move(next)) : minimizer_.restart(std::move(next));
}

/// Displaces the disks by the response of the last minimum, so that all forces grow or shrink by one factor; otherwise
/// weak contacts near jamming open, and the minimizer must find the network anew. Returns whether it has displaced
/// them.
bool PressureRamp::move_with_growth(Packing& packing, double growth) {
  if (pressure_ == 0.0) return false;
  if (!response_) {
    response_ =
        find_growth_response(find_contact_network(good_, settings_.minimizer.potential), settings_.minimizer.box_shape);
  }
  if (!response_) return false;
  double const strain_squared =
      response_->pure_shear * response_->pure_shear + response_->simple_shear * response_->simple_shear;
  double square = strain_squared * packing.box.area();
  for (Vector const step : response_->displacement) square = std::max(square, squared_length(step));
  double const longest = longest_step_of_ramp * smallest_diameter(packing);
  if (!(growth * growth * square <= longest * longest)) return false;
  for (std::size_t i = 0; i < packing.size(); ++i) {
    packing.x[i] += growth * response_->displacement[i].x;
    packing.y[i] += growth * response_->displacement[i].y;
  }
  if (settings_.minimizer.box_shape == BoxShape::free)
    deform(packing, growth * response_->pure_shear, growth * response_->simple_shear);
  return true;
}

void PressureRamp::take_minimum() {
  if (minimizer_.status() == MinimumStatus::unconverged) return end(RampStatus::unconverged);
  bool const is_jammed = minimizer_.status() == MinimumStatus::converged;
  double const pressure = is_jammed ? minimizer_.pressure() : 0.0;
  double const found = gridlock::packing_fraction(minimizer_.packing());
  if (!has_minimum_) {
    has_minimum_ = true;
    first_pressure_ = pressure;
    bool const is_harmonic = settings_.minimizer.potential == Potential::harmonic;
    slope_ = is_harmonic ? usual_slope_harmonic : usual_slope_hertzian;
    return accept(found, pressure);
  }
  bool const is_too_low = tried_ < packing_fraction_ && pressure < min_share_of_goal * goal_;
  if (settings_.packing_fraction || !is_too_low) return accept(found, pressure);
  if (++halvings_ > max_halvings_of_ramp) return end(RampStatus::unjammed);
  try_packing_fraction(packing_fraction_ + 0.5 * (tried_ - packing_fraction_));
}

void PressureRamp::accept(double packing_fraction, double pressure) {
  Potential const potential = settings_.minimizer.potential;
  double const linear = linear_pressure(pressure, potential);
  double const rise = linear - linear_pressure(pressure_, potential);
  bool const has_slope = pressure_ > 0.0 && pressure > 0.0 && rise / (packing_fraction - packing_fraction_) > 0.0;
  if (has_slope) slope_ = rise / (packing_fraction - packing_fraction_);
  jamming_packing_fraction_ = has_slope ? packing_fraction - linear / slope_ : std::numeric_limits<double>::quiet_NaN();
  good_ = minimizer_.packing();
  response_.reset();
  packing_fraction_ = packing_fraction;
  pressure_ = pressure;
  halvings_ = 0;
  minima_since_level_ = is_level() || pressure == 0.0 ? 0 : minima_since_level_ + 1;
  if (minima_since_level_ > max_minima_between_levels) return end(RampStatus::unjammed);
  if (is_level()) add_level();
  settings_.packing_fraction ? next_packing_fraction() : next_goal();
}

/// Returns whether the pressure is the final one.
bool PressureRamp::is_at_end() const {
  return std::abs(pressure_ - settings_.pressure) <= precision * settings_.pressure;
}

/// Returns whether the last minimum is a level: on the way up each minimum with pressure, down one for each goal.
bool PressureRamp::is_level() const {
  if (levels_.empty() || settings_.packing_fraction) return true;
  if (!leads_down()) return pressure_ > 0.0;
  return goal_ > settings_.pressure ? pressure_ <= max_share_of_goal * goal_ : is_at_end();
}

void PressureRamp::add_level() {
  std::uint64_t const iterations = minimizer_.iterations();
  levels_.push_back(level_of(good_, find_contact_network(good_, settings_.minimizer.potential)));
  levels_.back().iterations = iterations - iterations_before_;
  levels_.back().jamming_packing_fraction = jamming_packing_fraction_;
  iterations_before_ = iterations;
}

void PressureRamp::end(RampStatus status) {
  status_ = status;
  bool const is_kept = !levels_.empty() && levels_.back().packing_fraction == packing_fraction_;
  if (has_minimum_ && !is_kept) add_level();
}

void PressureRamp::next_packing_fraction() {
  double const goal = *settings_.packing_fraction;
  double const left = goal - packing_fraction_;
  // The radii are as near to the goal as rounding allows.
  if (left == 0.0 || tried_ == goal) return end(RampStatus::reached);
  try_packing_fraction(
      std::abs(left) <= (1.0 + 1e-9) * settings_.step ? goal : packing_fraction_ + std::copysign(settings_.step, left));
}

void PressureRamp::next_goal() {
  if (is_at_end()) return end(RampStatus::reached);
  bool const is_near =
      pressure_ >= min_share_of_goal * settings_.pressure && pressure_ <= max_share_of_goal * settings_.pressure;
  // Steps as long as `step` are still on the way and are not counted.
  if (is_near && aims_at_end_) ++minima_near_end_;
  if (minima_near_end_ > max_minima_near_end) return end(RampStatus::missed);
  if (!leads_down() && packing_fraction_ > max_packing_fraction) return end(RampStatus::unjammed);
  if (!leads_down()) return approach(settings_.pressure);
  // Levels are powers of one factor, so they do not depend on the pressure at the start.
  double const factor = 1.0 / nth_root(10.0, settings_.levels_per_decade);
  double level = 1.0;
  double const last = max_share_of_goal * settings_.pressure;
  while (level > last && pressure_ <= max_share_of_goal * level) level *= factor;
  approach(level > last ? level : settings_.pressure);
}

/// Tries the packing fraction at which a straight line reaches the goal; without contacts, the next step up.
void PressureRamp::approach(double goal) {
  if (pressure_ == 0.0) {
    goal_ = goal;
    aims_at_end_ = false;
    // The step leads beyond the first contacts to the goal, because minima with hardly any pressure are found slowly.
    if (step_up_ == 0.0)
      step_up_ = step_to_first_contacts() + linear_pressure(goal, settings_.minimizer.potential) / slope_;
    step_up_ = std::min(settings_.step, step_up_);
    try_packing_fraction(packing_fraction_ + step_up_);
    step_up_ *= 2.0;
    return;
  }
  goal_ = leads_down() ? goal : std::max(goal, share_of_step_back * pressure_);
  Potential const potential = settings_.minimizer.potential;
  double const rise = linear_pressure(goal_, potential) - linear_pressure(pressure_, potential);
  double const step = rise / slope_;
  aims_at_end_ = goal_ == settings_.pressure && step <= settings_.step;
  try_packing_fraction(packing_fraction_ + std::min(step, settings_.step));
}

/// Returns the growth of φ after which `pairs_of_a_disk` pairs for each disk overlap, and disks press hardly at all.
double PressureRamp::step_to_first_contacts() const {
  double const largest_gap = settings_.step / packing_fraction_;
  std::vector<Contact> pairs = find_contacts(good_, largest_gap);
  auto const count = static_cast<std::size_t>(pairs_of_a_disk * static_cast<double>(good_.size()));
  if (pairs.size() <= count) return settings_.step;
  auto const middle = pairs.begin() + static_cast<std::ptrdiff_t>(count);
  std::ranges::nth_element(pairs, middle, std::ranges::greater(), &Contact::overlap);
  // φ grows with the square of the radii.
  return std::max(-2.0 * packing_fraction_ * middle->overlap(), 0.0);
}

std::optional<double> PressureRamp::error_of_jamming_packing_fraction() const {
  if (levels_.size() < 2) return std::nullopt;
  double const difference =
      levels_.back().jamming_packing_fraction - levels_[levels_.size() - 2].jamming_packing_fraction;
  if (!std::isfinite(difference)) return std::nullopt;
  return std::abs(difference);
}

void PressureRamp::serialize(Archive& archive) {
  auto place = static_cast<std::uint64_t>(status_);
  archive.visit("status", place);
  archive.require(place <= static_cast<std::uint64_t>(RampStatus::missed), "a ramp of pressure has no such status");
  status_ = static_cast<RampStatus>(place);
  serialize_inside(archive, "minimizer", [&] { minimizer_.serialize(archive); });
  std::size_t const disks = good_.size();
  serialize_places(archive, good_, settings_.minimizer.box_shape);
  archive.visit("radius", good_.radius);
  archive.require(good_.x.size() == disks && good_.y.size() == disks && good_.radius.size() == disks,
                  "a ramp of pressure has another number of positions than of disks");
  archive.visit("has_minimum", has_minimum_);
  archive.visit("first_pressure", first_pressure_);
  archive.visit("packing_fraction", packing_fraction_);
  archive.visit("pressure", pressure_);
  archive.visit("slope", slope_);
  archive.visit("goal", goal_);
  archive.visit("tried", tried_);
  archive.visit("halvings", halvings_);
  archive.visit("step_up", step_up_);
  archive.visit("minima_since_level", minima_since_level_);
  archive.visit("aims_at_end", aims_at_end_);
  archive.visit("minima_near_end", minima_near_end_);
  archive.visit("jamming_packing_fraction", jamming_packing_fraction_);
  archive.visit("iterations_before", iterations_before_);
  gridlock::serialize(archive, levels_);
}

PressureLevel level_of(Packing const& packing, ContactNetwork const& network) {
  PressureLevel level{.packing_fraction = packing_fraction(packing),
                      .pressure = network.pressure,
                      .energy = network.energy,
                      .residual = network.residual_force,
                      .backbone_disks = network.backbone_disks,
                      .backbone_contacts = network.backbone_contacts,
                      .contact_number = network.contact_number(),
                      .excess_contacts = static_cast<double>(network.excess_contacts())};
  if (std::optional<ElasticModuli> const moduli = find_elastic_moduli(packing, network)) {
    level.bulk_modulus = moduli->bulk();
    level.shear_modulus = moduli->shear();
    level.simple_shear_modulus = simple_shear_modulus(*moduli, network);
    level.pure_shear_modulus = pure_shear_modulus(*moduli, network);
    level.least_shear_modulus = moduli->min_shear();
  }
  return level;
}

void serialize(Archive& archive, std::vector<PressureLevel>& levels) {
  std::uint64_t count = levels.size();
  archive.visit("levels", count);
  serialize_column(archive, "level_packing_fraction", count, levels, &PressureLevel::packing_fraction);
  serialize_column(archive, "level_pressure", count, levels, &PressureLevel::pressure);
  serialize_column(archive, "level_energy", count, levels, &PressureLevel::energy);
  serialize_column(archive, "level_residual", count, levels, &PressureLevel::residual);
  serialize_column(archive, "level_iterations", count, levels, &PressureLevel::iterations);
  serialize_column(archive, "level_backbone_disks", count, levels, &PressureLevel::backbone_disks);
  serialize_column(archive, "level_backbone_contacts", count, levels, &PressureLevel::backbone_contacts);
  serialize_column(archive, "level_contact_number", count, levels, &PressureLevel::contact_number);
  serialize_column(archive, "level_excess_contacts", count, levels, &PressureLevel::excess_contacts);
  serialize_column(archive, "level_bulk_modulus", count, levels, &PressureLevel::bulk_modulus);
  serialize_column(archive, "level_shear_modulus", count, levels, &PressureLevel::shear_modulus);
  serialize_column(archive, "level_simple_shear_modulus", count, levels, &PressureLevel::simple_shear_modulus);
  serialize_column(archive, "level_pure_shear_modulus", count, levels, &PressureLevel::pure_shear_modulus);
  serialize_column(archive, "level_least_shear_modulus", count, levels, &PressureLevel::least_shear_modulus);
  serialize_column(archive, "level_jamming_packing_fraction", count, levels, &PressureLevel::jamming_packing_fraction);
}

}  // namespace gridlock
