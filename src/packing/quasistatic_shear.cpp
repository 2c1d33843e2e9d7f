#include "gridlock/packing/quasistatic_shear.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <string_view>
#include <utility>

#include "core/decay.hpp"
#include "gridlock/core/error.hpp"
#include "gridlock/packing/elasticity.hpp"
#include "packing/serialized_columns.hpp"

namespace gridlock {

namespace {

constexpr double moved_in_event = 0.01;      ///< in D
constexpr double moved_in_cycle = 0.001;     ///< in D
constexpr std::uint64_t steps_of_cycle = 4;  ///< amplitudes that a cycle is long

/// Returns e^(γ/2), by which pure shear stretches a box along x.
double stretch_of(double strain) { return strain < 0.0 ? decay(-0.5 * strain) : 1.0 / decay(0.5 * strain); }

/// Minima are searched along the way down that begins at the deformed packing, without the stages for random starts.
MinimizerSettings near_minimum(MinimizerSettings settings) {
  settings.descent_residual = std::numeric_limits<double>::infinity();
  return settings;
}

void require(bool holds, std::string what, std::string hint, char const* key) {
  if (!holds) throw Error({.what = std::move(what), .hint = std::move(hint), .key = key});
}

QuasistaticShearSettings const& checked(QuasistaticShearSettings const& settings) {
  require_valid(settings);
  return settings;
}

Packing const& checked(Packing const& packing) {
  require(packing.box.is_periodic(), fmt::format("shear of a box that is {}", edges_in_words(packing.box)),
          "only a box that is periodic along x and y can be sheared: box.edge = \"periodic\"", "box.edge");
  return packing;
}

std::uint64_t steps_until(QuasistaticShearSettings const& settings) {
  double const steps = std::ceil(std::abs(settings.until_strain) / settings.step - 1e-9);
  return static_cast<std::uint64_t>(std::max(steps, 1.0));
}

/// Returns the motion of each disk from one packing to another, without that of their centre.
std::vector<Vector> motions_between(Packing const& from, Packing const& to) {
  std::vector<Vector> motions;
  Vector mean;
  for (std::size_t i = 0; i < from.size(); ++i) {
    motions.push_back({to.x[i] - from.x[i], to.y[i] - from.y[i]});
    mean = mean + motions.back();
  }
  mean = (1.0 / static_cast<double>(std::max<std::size_t>(from.size(), 1))) * mean;
  for (Vector& motion : motions) motion = motion - mean;
  return motions;
}

/// Returns a function that returns a member of a member.
template <class Item, class Part>
auto member_of(Part Item::*part, double Part::*member) {
  return [=](Item& item) -> double& { return item.*part.*member; };
}

}  // namespace

void require_valid(QuasistaticShearSettings const& settings) {
  double const strain = settings.until_strain;
  require(settings.step > 0.0 && settings.step <= 0.1, fmt::format("steps of {} in strain", settings.step),
          "use a number above 0 and at most 0.1: disks must still touch those that they touched",
          "protocol.strain_step");
  require(std::isfinite(strain) && strain != 0.0, fmt::format("a strain until {}", strain),
          "give a number other than 0; below 0 it is the other direction", "protocol.until_strain");
  require(settings.deformation == Deformation::simple_shear || std::abs(strain) <= 1.0,
          fmt::format("pure shear until {}", strain), "use a strain between -1 and 1, or simple shear",
          "protocol.until_strain");
  double const steps = std::abs(strain) / settings.step *
                       static_cast<double>(settings.cycles > 0 ? steps_of_cycle * settings.cycles : 1);
  require(steps <= QuasistaticShearSettings::max_steps,
          fmt::format("steps of {} until {} are {:.3g} minima, each of which is kept", settings.step, strain, steps),
          fmt::format("use a longer step, for at most {:.0g}", QuasistaticShearSettings::max_steps),
          "protocol.strain_step");
  require(settings.accuracy > 0.0, fmt::format("an accuracy of {}", settings.accuracy), "use a number above 0",
          "protocol.strain_accuracy");
  require(settings.until_stress > 0.0, fmt::format("a stress until {}", settings.until_stress),
          "use a number above 0, in ε/D²", "protocol.until_stress");
}

void serialize(Archive& archive, std::vector<ShearedMinimum>& minima) {
  std::uint64_t count = minima.size();
  archive.visit("minima", count);
  serialize_column(archive, "strain", count, minima, &ShearedMinimum::strain);
  serialize_column(archive, "shear_stress", count, minima, &ShearedMinimum::shear_stress);
  serialize_column(archive, "stress_xx", count, minima, member_of(&ShearedMinimum::stress, &StressTensor::xx));
  serialize_column(archive, "stress_xy", count, minima, member_of(&ShearedMinimum::stress, &StressTensor::xy));
  serialize_column(archive, "stress_yy", count, minima, member_of(&ShearedMinimum::stress, &StressTensor::yy));
  serialize_column(archive, "energy", count, minima, &ShearedMinimum::energy);
  serialize_column(archive, "contacts", count, minima, &ShearedMinimum::contacts);
}

void serialize(Archive& archive, std::vector<ShearEvent>& events) {
  std::uint64_t count = events.size();
  archive.visit("events", count);
  serialize_column(archive, "event_strain", count, events, &ShearEvent::strain);
  serialize_column(archive, "event_width", count, events, &ShearEvent::width);
  serialize_column(archive, "stress_drop", count, events, &ShearEvent::stress_drop);
  serialize_column(archive, "energy_drop", count, events, &ShearEvent::energy_drop);
  serialize_column(archive, "moved_disks", count, events, &ShearEvent::moved_disks);
  serialize_column(archive, "participation", count, events, &ShearEvent::participation);
  serialize_column(archive, "largest_motion", count, events, &ShearEvent::largest_motion);
  serialize_column(archive, "softest_mode", count, events, &ShearEvent::softest_mode);
  serialize_column(archive, "mode_overlap", count, events, &ShearEvent::mode_overlap);
}

void serialize(Archive& archive, std::vector<EventMotion>& motions) {
  std::uint64_t count = motions.size();
  archive.visit("motions", count);
  serialize_column(archive, "motion_event", count, motions, &EventMotion::event);
  serialize_column(archive, "motion_disk", count, motions, &EventMotion::disk);
  serialize_column(archive, "place_x", count, motions, member_of(&EventMotion::place, &Vector::x));
  serialize_column(archive, "place_y", count, motions, member_of(&EventMotion::place, &Vector::y));
  serialize_column(archive, "motion_x", count, motions, member_of(&EventMotion::motion, &Vector::x));
  serialize_column(archive, "motion_y", count, motions, member_of(&EventMotion::motion, &Vector::y));
}

/// A cycle is saved as its largest motion, from which the rest follows.
void serialize(Archive& archive, std::vector<ShearCycle>& cycles) {
  std::uint64_t count = cycles.size();
  archive.visit("cycles", count);
  serialize_column(archive, "cycle_motion", count, cycles, &ShearCycle::largest_motion);
  for (ShearCycle& cycle : cycles) cycle.is_reversible = cycle.largest_motion <= moved_in_cycle;
}

QuasistaticShear::QuasistaticShear(QuasistaticShearSettings const& settings, Packing packing)
    : settings_(checked(settings)),
      first_box_(checked(packing).box),
      diameter_(smallest_diameter(packing)),
      steps_per_amplitude_(steps_until(settings)),
      all_steps_(settings.cycles > 0 ? steps_of_cycle * steps_per_amplitude_ * settings.cycles : steps_per_amplitude_),
      kept_(std::move(packing)),
      crossed_x_(kept_.size()),
      crossed_y_(kept_.size()),
      minimizer_(near_minimum(settings.minimizer), kept_) {
  settings_.min_drop = settings_.min_drop.value_or(0.2 * settings_.step);
}

double QuasistaticShear::strain_at(std::uint64_t whole_steps) const {
  double const step = settings_.until_strain / static_cast<double>(steps_per_amplitude_);
  if (settings_.cycles == 0) return static_cast<double>(whole_steps) * step;
  std::uint64_t const place = whole_steps % (steps_of_cycle * steps_per_amplitude_);
  auto const amplitude = static_cast<double>(steps_per_amplitude_);
  auto const along = static_cast<double>(place);
  if (along <= amplitude) return along * step;
  if (along <= 3.0 * amplitude) return (2.0 * amplitude - along) * step;
  return (along - 4.0 * amplitude) * step;
}

double QuasistaticShear::strain_of(double share) const {
  double const from = strain_at(whole_steps_);
  return share == 0.0 ? from : from + share * (strain_at(whole_steps_ + 1) - from);
}

Box QuasistaticShear::box_at(double strain) const {
  if (settings_.deformation == Deformation::simple_shear)
    return first_box_.shifted(first_box_.shift() + strain * first_box_.height());
  double const stretch = stretch_of(strain);
  Box const box(first_box_.width() * stretch, first_box_.height() / stretch, Edge::periodic);
  return box.shifted(first_box_.shift() * stretch);
}

Packing QuasistaticShear::deformed(double strain) const {
  Packing packing = kept_;
  packing.box = box_at(strain);
  double const further = strain - strain_of(kept_share_);
  if (settings_.deformation == Deformation::simple_shear) {
    for (std::size_t i = 0; i < packing.size(); ++i) packing.x[i] += further * packing.y[i];
  } else {
    double const stretch = stretch_of(further);
    for (std::size_t i = 0; i < packing.size(); ++i) {
      packing.x[i] *= stretch;
      packing.y[i] /= stretch;
    }
  }
  return packing;
}

ShearedMinimum QuasistaticShear::measured(double strain) const {
  Packing const& packing = minimizer_.packing();
  std::vector<Contact> const contacts = minimizer_.contacts();
  double const unit = diameter_ * diameter_ / packing.box.area();
  StressTensor stress;
  for (Contact const& contact : contacts) stress.add(contact, unit * force_of(contact, settings_.minimizer.potential));
  bool const is_simple = settings_.deformation == Deformation::simple_shear;
  return {.strain = strain,
          .shear_stress = is_simple ? stress.xy : 0.5 * (stress.xx - stress.yy),
          .stress = stress,
          .energy = minimizer_.energy(),
          .contacts = contacts.size()};
}

bool QuasistaticShear::advance(std::function<bool()> const& should_continue) {
  while (status_ == ShearStatus::running) {
    if (!minimizer_.advance(should_continue)) return false;
    take_minimum();
    if (status_ == ShearStatus::running && should_continue && !should_continue()) return false;
  }
  return true;
}

void QuasistaticShear::take_minimum() {
  if (minimizer_.status() == MinimumStatus::unconverged) {
    status_ = ShearStatus::unconverged;
    return;
  }
  ShearedMinimum const minimum = measured(strain_of(tried_share_));
  if (!has_minimum_) {
    has_minimum_ = true;
    accept(minimum);
    minima_.push_back(minimum);
    if (settings_.cycles > 0) end_cycle();
    try_share(1.0);
    return;
  }
  double const width = std::abs(minimum.strain - minimum_.strain);
  double const fallen = minimum.strain > minimum_.strain ? minimum_.shear_stress - minimum.shear_stress
                                                         : minimum.shear_stress - minimum_.shear_stress;
  bool const is_drop = fallen > *settings_.min_drop;
  if (is_drop && width > settings_.accuracy) {
    drop_share_ = tried_share_;
    try_share(0.5 * (kept_share_ + drop_share_));
    return;
  }
  if (is_drop) add_event(minimum);
  accept(minimum);
  kept_share_ = tried_share_;
  if (drop_share_ <= kept_share_) drop_share_ = none;
  if (kept_share_ == 1.0) {
    end_step();
    if (status_ != ShearStatus::running) return;
  }
  try_share(next_share());
}

double QuasistaticShear::next_share() const {
  if (drop_share_ == none) return 1.0;
  bool const is_narrow = std::abs(strain_of(drop_share_) - strain_of(kept_share_)) <= settings_.accuracy;
  return is_narrow ? drop_share_ : 0.5 * (kept_share_ + drop_share_);
}

void QuasistaticShear::try_share(double share) {
  tried_share_ = share;
  minimizer_.restart(deformed(strain_of(share)));
}

void QuasistaticShear::accept(ShearedMinimum const& minimum) {
  kept_ = minimizer_.packing();
  minimum_ = minimum;
  Box const& box = kept_.box;
  std::int32_t const back = widths_shifted_back();
  for (std::size_t i = 0; i < kept_.size(); ++i) {
    Vector const before{kept_.x[i], kept_.y[i]};
    Vector const inside = box.inside(before);
    auto const up = static_cast<std::int32_t>(std::lround((before.y - inside.y) / box.height()));
    auto const right = static_cast<std::int32_t>(std::lround((before.x - inside.x - up * box.shift()) / box.width()));
    kept_.x[i] = inside.x;
    kept_.y[i] = inside.y;
    crossed_x_[i] += right - back * up;
    crossed_y_[i] += up;
  }
}

std::int32_t QuasistaticShear::widths_shifted_back() const {
  if (settings_.deformation == Deformation::pure_shear) return 0;
  double const shift = first_box_.shift() + minimum_.strain * first_box_.height();
  return static_cast<std::int32_t>(first_box_.widths_in(shift));
}

std::vector<std::int32_t> QuasistaticShear::crossed_x() const {
  std::vector<std::int32_t> crossed = crossed_x_;
  std::int32_t const back = widths_shifted_back();
  for (std::size_t i = 0; i < crossed.size(); ++i) crossed[i] += back * crossed_y_[i];
  return crossed;
}

void QuasistaticShear::add_event(ShearedMinimum const& minimum) {
  ShearEvent event{.strain = minimum_.strain,
                   .width = std::abs(minimum.strain - minimum_.strain),
                   .stress_drop = std::abs(minimum_.shear_stress - minimum.shear_stress),
                   .energy_drop = minimum_.energy - minimum.energy};
  std::vector<Vector> const motions = motions_between(deformed(minimum.strain), minimizer_.packing());
  double squares = 0.0;
  double fourths = 0.0;
  for (std::uint32_t i = 0; i < motions.size(); ++i) {
    double const square = squared_length(motions[i]) / (diameter_ * diameter_);
    squares += square;
    fourths += square * square;
    event.largest_motion = std::max(event.largest_motion, std::sqrt(square));
    if (square <= moved_in_event * moved_in_event) continue;
    event.moved_disks += 1.0;
    motions_.push_back({.event = static_cast<std::uint32_t>(events_.size()),
                        .disk = i,
                        .place = {kept_.x[i], kept_.y[i]},
                        .motion = motions[i]});
  }
  if (fourths > 0.0) event.participation = squares * squares / fourths;
  ContactNetwork const network = find_contact_network(kept_, settings_.minimizer.potential);
  if (std::optional<VibrationMode> const mode = find_softest_mode(network)) {
    double along = 0.0;
    for (std::size_t i = 0; i < motions.size(); ++i) along += dot(motions[i], mode->displacement[i]);
    event.softest_mode = mode->eigenvalue;
    if (squares > 0.0) event.mode_overlap = std::abs(along) / (diameter_ * std::sqrt(squares));
  }
  events_.push_back(event);
}

void QuasistaticShear::end_step() {
  ++whole_steps_;
  kept_share_ = 0.0;
  minima_.push_back(minimum_);
  if (settings_.cycles > 0 && whole_steps_ % (steps_of_cycle * steps_per_amplitude_) == 0) end_cycle();
  bool const is_strong = std::abs(minimum_.shear_stress) >= settings_.until_stress;
  if (whole_steps_ == all_steps_ || is_strong) status_ = ShearStatus::reached;
}

void QuasistaticShear::end_cycle() {
  std::vector<double> x, y;
  std::vector<std::int32_t> const crossed_x = this->crossed_x();
  for (std::size_t i = 0; i < kept_.size(); ++i) {
    Vector const offset = kept_.box.offset_of_image(crossed_x[i], crossed_y_[i]);
    x.push_back(kept_.x[i] + offset.x);
    y.push_back(kept_.y[i] + offset.y);
  }
  if (!x_of_cycle_.empty()) {
    Packing const before{.box = kept_.box, .x = x_of_cycle_, .y = y_of_cycle_, .radius = kept_.radius};
    Packing const now{.box = kept_.box, .x = x, .y = y, .radius = kept_.radius};
    double largest = 0.0;
    for (Vector const motion : motions_between(before, now)) largest = std::max(largest, squared_length(motion));
    double const motion = std::sqrt(largest) / diameter_;
    cycles_.push_back({.largest_motion = motion, .is_reversible = motion <= moved_in_cycle});
  }
  x_of_cycle_ = std::move(x);
  y_of_cycle_ = std::move(y);
}

void QuasistaticShear::serialize(Archive& archive) {
  auto place = static_cast<std::uint64_t>(status_);
  archive.visit("status", place);
  archive.require(place <= static_cast<std::uint64_t>(ShearStatus::unconverged), "a shear has no such status");
  status_ = static_cast<ShearStatus>(place);
  std::size_t const disks = kept_.size();
  archive.visit("x", kept_.x);
  archive.visit("y", kept_.y);
  archive.visit("crossed_x", crossed_x_);
  archive.visit("crossed_y", crossed_y_);
  archive.require(
      kept_.x.size() == disks && kept_.y.size() == disks && crossed_x_.size() == disks && crossed_y_.size() == disks,
      "a shear has another number of positions than of disks");
  archive.visit("whole_steps", whole_steps_);
  archive.visit("kept_share", kept_share_);
  archive.visit("tried_share", tried_share_);
  archive.visit("drop_share", drop_share_);
  archive.visit("has_minimum", has_minimum_);
  archive.require(whole_steps_ <= all_steps_, "a shear has taken more steps than it has");
  std::vector<ShearedMinimum> last{minimum_};
  serialize_inside(archive, "last", [&] { gridlock::serialize(archive, last); });
  archive.require(last.size() == 1, "a shear has no last minimum");
  minimum_ = last.front();
  gridlock::serialize(archive, minima_);
  gridlock::serialize(archive, events_);
  gridlock::serialize(archive, motions_);
  gridlock::serialize(archive, cycles_);
  archive.visit("x_of_cycle", x_of_cycle_);
  archive.visit("y_of_cycle", y_of_cycle_);
  archive.require(x_of_cycle_.size() == y_of_cycle_.size() && (x_of_cycle_.empty() || x_of_cycle_.size() == disks),
                  "a shear has another number of positions at the end of a cycle than of disks");
  if (archive.is_restoring()) {
    kept_.box = box_at(minimum_.strain);
    if (has_minimum_ && status_ == ShearStatus::running) minimizer_.restart(deformed(strain_of(tried_share_)));
  }
  serialize_inside(archive, "minimizer", [&] { minimizer_.serialize(archive); });
}

}  // namespace gridlock
