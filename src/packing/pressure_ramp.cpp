#include "gridlock/packing/pressure_ramp.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "gridlock/core/error.hpp"
#include "gridlock/packing/contact_network.hpp"
#include "gridlock/packing/elasticity.hpp"

namespace gridlock {

namespace {

constexpr double least_share_of_goal = 0.3;
/// On the way up a minimum up to this multiple of the pressure asked for is taken, and the end approached from there; steps back aim lower.
constexpr double most_overshoot = 2.0;
constexpr double aim_of_overshoot = 1.3;
constexpr std::uint64_t most_halvings = 60;  // of a step up
/// Of a step down: disks that no thousandth of it leaves pressing have nothing to lean on at lower pressures. They rearrange at once.
constexpr std::uint64_t most_halvings_down = 12;
/// Minima between two levels; usually there are five. A pressure that nothing tells from none is approached for ever.
constexpr std::uint64_t most_minima_between_levels = 300;
/// Minima near the pressure asked for before it is given up; usually there are one to three.
constexpr std::uint64_t most_minima_near_end = 20;

/// du/dφ where nothing better is known: that of random packings of two sizes.
constexpr double usual_slope_harmonic = 0.27;
constexpr double usual_slope_hertzian = 0.36;

/// The root x of xⁿ = value for value > 0, by Newton's method: every processor and library gives the same bits.
double nth_root(double value, std::uint64_t n) {
  double x = std::max(value, 1.0);
  for (int k = 0; k < 2000; ++k) {
    double power = 1.0;
    for (std::uint64_t i = 1; i < n; ++i) power *= x;
    double const next = x - (x * power - value) / (static_cast<double>(n) * power);
    if (!(next < x)) break;  // from above the steps lead down until rounding ends them
    x = next;
  }
  return x;
}

/// What is linear in the distance to jamming: p, or p^(2/3).
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
  if (settings.levels_per_decade < 1 || settings.levels_per_decade > PressureRampSettings::most_levels_per_decade) {
    throw Error({.what = fmt::format("{} levels of pressure in a decade", settings.levels_per_decade),
                 .hint = fmt::format("use 1 to {}", PressureRampSettings::most_levels_per_decade),
                 .key = "protocol.levels_per_decade"});
  }
  if (settings.packing_fraction &&
      !(*settings.packing_fraction >= least_packing_fraction && *settings.packing_fraction <= most_packing_fraction)) {
    throw Error({.what = fmt::format("a packing fraction of {} cannot be reached", *settings.packing_fraction),
                 .hint = fmt::format("use a number from {} to {}", least_packing_fraction, most_packing_fraction),
                 .key = "protocol.until_packing_fraction"});
  }
  if (!(settings.step > 0.0 && settings.step <= PressureRampSettings::most_step)) {
    throw Error({.what = fmt::format("steps of {} in packing fraction", settings.step),
                 .hint = fmt::format("use a number above 0, at most {}", PressureRampSettings::most_step),
                 .key = "protocol.step"});
  }
  return settings;
}

}  // namespace

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
    : settings_(checked(settings)), good_(std::move(packing)), minimizer_(settings.minimizer, good_) {}

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
  minimizer_.restart(std::move(next));
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
  bool const is_too_low = leads_down() && pressure < least_share_of_goal * goal_;
  bool const is_too_high = !leads_down() && pressure > most_overshoot * goal_;
  if (settings_.packing_fraction || (!is_too_low && !is_too_high)) return accept(found, pressure);
  if (++halvings_ > (leads_down() ? most_halvings_down : most_halvings)) return end(RampStatus::unjammed);
  if (is_too_high) return step_back(pressure);
  try_packing_fraction(packing_fraction_ + 0.5 * (tried_ - packing_fraction_));
}

/// From the last minimum to where a straight line reaches the goal between it and the one just found, whose pressure is too high.
void PressureRamp::step_back(double pressure) {
  Potential const potential = settings_.minimizer.potential;
  double const linear = linear_pressure(pressure, potential);
  if (tried_ < least_too_high_) {
    double const slope = (linear_too_high_ - linear) / (least_too_high_ - tried_);
    if (slope > 0.0 && std::isfinite(slope)) slope_ = slope;
    least_too_high_ = tried_;
    linear_too_high_ = linear;
  }
  try_packing_fraction(below_too_high());
}

/// A packing fraction between the last minimum and the lowest one with too high a pressure: where the line through that one reaches the
/// goal, or half the way where it leaves this range.
double PressureRamp::below_too_high() const {
  double const goal = linear_pressure(aim_of_overshoot * goal_, settings_.minimizer.potential);
  double const crossing = least_too_high_ - (linear_too_high_ - goal) / slope_;
  // Every fourth step halves what is left, whatever the line says.
  bool const is_inside = crossing > packing_fraction_ && crossing < least_too_high_ && halvings_ % 4 != 3;
  return is_inside ? crossing : packing_fraction_ + 0.5 * (least_too_high_ - packing_fraction_);
}

void PressureRamp::accept(double packing_fraction, double pressure) {
  Potential const potential = settings_.minimizer.potential;
  double const linear = linear_pressure(pressure, potential);
  double const rise = linear - linear_pressure(pressure_, potential);
  bool const has_slope = pressure_ > 0.0 && pressure > 0.0 && rise / (packing_fraction - packing_fraction_) > 0.0;
  if (has_slope) slope_ = rise / (packing_fraction - packing_fraction_);
  jamming_packing_fraction_ = has_slope ? packing_fraction - linear / slope_ : std::numeric_limits<double>::quiet_NaN();
  good_ = minimizer_.packing();
  packing_fraction_ = packing_fraction;
  pressure_ = pressure;
  halvings_ = 0;
  minima_since_level_ = is_level() || pressure == 0.0 ? 0 : minima_since_level_ + 1;
  if (minima_since_level_ > most_minima_between_levels) return end(RampStatus::unjammed);
  if (is_level()) add_level();
  settings_.packing_fraction ? next_packing_fraction() : next_goal();
}

/// Whether the pressure is the one asked for.
bool PressureRamp::is_at_end() const {
  return std::abs(pressure_ - settings_.pressure) <= precision * settings_.pressure;
}

/// Whether the last minimum is kept: going up each that presses, going down one for each goal.
bool PressureRamp::is_level() const {
  if (levels_.empty() || settings_.packing_fraction) return true;
  if (!leads_down()) return pressure_ > 0.0;
  return goal_ > settings_.pressure ? pressure_ <= most_share_of_goal * goal_ : is_at_end();
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
  // The radii come as near as their rounding allows.
  if (left == 0.0 || tried_ == goal) return end(RampStatus::reached);
  try_packing_fraction(
      std::abs(left) <= (1.0 + 1e-9) * settings_.step ? goal : packing_fraction_ + std::copysign(settings_.step, left));
}

void PressureRamp::next_goal() {
  if (is_at_end()) return end(RampStatus::reached);
  bool const is_near =
      pressure_ >= least_share_of_goal * settings_.pressure && pressure_ <= most_share_of_goal * settings_.pressure;
  if (is_near || minima_near_end_ > 0) ++minima_near_end_;
  if (minima_near_end_ > most_minima_near_end) return end(RampStatus::missed);
  if (!leads_down() && packing_fraction_ > most_packing_fraction) return end(RampStatus::unjammed);
  if (!leads_down()) return approach(settings_.pressure);
  // The levels are powers of the same factor, whatever the pressure of the start.
  double const factor = 1.0 / nth_root(10.0, settings_.levels_per_decade);
  double level = 1.0;
  double const last = most_share_of_goal * settings_.pressure;
  while (level > last && pressure_ <= most_share_of_goal * level) level *= factor;
  approach(level > last ? level : settings_.pressure);
}

/// Tries the packing fraction at which a straight line reaches the goal; while nothing presses, the next step up.
void PressureRamp::approach(double goal) {
  goal_ = goal;
  Potential const potential = settings_.minimizer.potential;
  double const rise = linear_pressure(goal_, potential) - linear_pressure(pressure_, potential);
  double const step = std::min(pressure_ > 0.0 ? rise / slope_ : settings_.step, settings_.step);
  bool const is_known = pressure_ == 0.0 && packing_fraction_ + step >= least_too_high_;
  try_packing_fraction(is_known ? below_too_high() : packing_fraction_ + step);
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
  archive.visit("x", good_.x);
  archive.visit("y", good_.y);
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
  archive.visit("least_too_high", least_too_high_);
  archive.visit("linear_too_high", linear_too_high_);
  archive.visit("minima_since_level", minima_since_level_);
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
    level.least_shear_modulus = moduli->least_shear();
  }
  return level;
}

void serialize(Archive& archive, std::vector<PressureLevel>& levels) {
  std::uint64_t count = levels.size();
  archive.visit("levels", count);
  archive.require(count <= 100'000, "a ramp of pressure has too many levels");
  levels.resize(count);
  for (std::size_t k = 0; k < count; ++k) {
    PressureLevel& level = levels[k];
    serialize_inside(archive, fmt::format("level_{}", k), [&] {
      archive.visit("packing_fraction", level.packing_fraction);
      archive.visit("pressure", level.pressure);
      archive.visit("energy", level.energy);
      archive.visit("residual", level.residual);
      archive.visit("iterations", level.iterations);
      archive.visit("backbone_disks", level.backbone_disks);
      archive.visit("backbone_contacts", level.backbone_contacts);
      archive.visit("contact_number", level.contact_number);
      archive.visit("excess_contacts", level.excess_contacts);
      archive.visit("bulk_modulus", level.bulk_modulus);
      archive.visit("shear_modulus", level.shear_modulus);
      archive.visit("least_shear_modulus", level.least_shear_modulus);
      archive.visit("jamming_packing_fraction", level.jamming_packing_fraction);
    });
  }
}

}  // namespace gridlock
