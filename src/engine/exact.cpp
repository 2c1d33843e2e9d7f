#include "exact.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "engine/exact/dynamics.hpp"
#include "gridlock/core/error.hpp"
#include "gridlock/grid/validate.hpp"

namespace gridlock {

namespace {

/// Overlaps up to this many diameters are rounding: a state written at the very moment of a contact has them.
constexpr double rounding = 1e-12;

/// A periodic box must be wider than two distances at contact, or a disk could touch another from both sides at once.
void require_room_for_images(State const& state) {
  auto const radius = state.disks.column<Radius>();
  if (!state.box.is_periodic() || state.disks.size() < 2) return;
  double largest = 0.0;
  double second = 0.0;
  for (double const r : radius) {
    if (r > largest) {
      second = largest;
      largest = r;
    } else {
      second = std::max(second, r);
    }
  }
  double const needed = 2.0 * (largest + second);
  double const side = std::min(state.box.width(), state.box.height());
  if (side > needed) return;
  throw Error({.what = fmt::format("in a periodic box of {} × {} a disk could touch two images of the same partner; "
                                   "these disks need sides above {:.6g}",
                                   state.box.width(), state.box.height(), needed),
               .hint = "use a larger box, smaller disks or box.edge = \"wall\"",
               .key = "engine.kind"});
}

/// Which Id stands in which row, which hash(State) leaves out on purpose.
std::uint64_t hash_of_rows(Disks const& disks) {
  std::uint64_t hash = 0;
  for (Id const id : disks.ids()) hash = (hash ^ id) * 0x9E3779B97F4A7C15U;
  return hash;
}

bool is_inside_but_for_rounding(State const& state) {
  if (state.box.is_periodic()) return true;
  for (std::size_t i = 0; i < state.disks.size(); ++i) {
    double const r = state.disks.column<Radius>()[i];
    Vector const p = position(state.disks, i);
    double const gap = std::min({p.x - r, state.box.width() - r - p.x, p.y - r, state.box.height() - r - p.y});
    if (!(gap >= -2.0 * rounding * r)) return false;
  }
  return true;
}

void require_hard_disks(State const& state) {
  try {
    validate(state);
  } catch (Error const&) {
    double const diameter = 2.0 * radius_range(state.disks).smallest;
    bool const is_finite = std::isfinite(kinetic_energy(state.disks)) && diameter > 0.0;
    if (is_finite && is_inside_but_for_rounding(state) && largest_overlap(state) <= rounding * diameter) return;
    throw;
  }
}

}  // namespace

ExactEngine::ExactEngine(EngineSettings const& settings, State const& state)
    : audit_every_(settings.audit_every), duration_(step_duration(settings, state)) {
  require_hard_disks(state);
  require_room_for_images(state);
}

ExactEngine::~ExactEngine() = default;

bool ExactEngine::is_as_left(State const& state) const {
  return dynamics_ != nullptr && hash_of_rows(state.disks) == row_hash_ && hash(state) == hash_;
}

void ExactEngine::start_from(State const& state) {
  require_hard_disks(state);
  require_room_for_images(state);
  earlier_audits_ = audits();
  dynamics_ = nullptr;  // first the old memory goes, then the new comes
  dynamics_ = std::make_unique<exact::Dynamics>(state);
  row_hash_ = hash_of_rows(state.disks);
  start_time_ = state.clock.time;
  next_step_time_ = state.clock.time + duration_;
}

void ExactEngine::advance(State& state, Tally& tally, Horizon const& horizon) {
  if (state.disks.empty()) return;
  if (!is_as_left(state)) start_from(state);
  bool const ends_by_collisions_only = horizon.step == Horizon{}.step && !std::isfinite(horizon.time);
  if (ends_by_collisions_only && !dynamics_->can_collide()) {
    throw RunFailure("no two disks can ever collide, so the collisions asked for would be waited for forever");
  }
  while (state.clock.step < horizon.step && state.clock.time < horizon.time &&
         tally.pair_collisions < horizon.pair_collisions) {
    double const target = std::min(next_step_time_, horizon.time);
    if (!dynamics_->run(target - start_time_, horizon.pair_collisions, audit_every_, tally)) {
      state.clock.time = std::min(start_time_ + dynamics_->last_event(), target);
      break;
    }
    state.clock.time = target;
    if (target == next_step_time_) {
      ++state.clock.step;
      next_step_time_ += duration_;
      if (horizon.stops_here()) break;
    }
  }
  dynamics_->write(state.clock.time - start_time_, state);
  hash_ = hash(state);
}

std::uint64_t ExactEngine::audits() const { return earlier_audits_ + (dynamics_ == nullptr ? 0 : dynamics_->audits()); }

std::uint64_t ExactEngine::audits_for_missed_events() const {
  return dynamics_ != nullptr && dynamics_->looks_for_missed_events() ? audits() : 0;
}

void ExactEngine::carry(Archive& archive, State const& state) {
  bool has_started = dynamics_ != nullptr;
  archive.visit("has_started", has_started);
  if (archive.is_restoring()) dynamics_ = has_started ? std::make_unique<exact::Dynamics>(state) : nullptr;
  if (!has_started) return;
  if (audit_every_ > 0) {
    std::uint64_t all_audits = audits();
    archive.visit("audits", all_audits);
    if (archive.is_restoring()) earlier_audits_ = all_audits;
  }
  archive.visit("start_time", start_time_);
  archive.visit("next_step_time", next_step_time_);
  carry_inside(archive, "dynamics", [&] { dynamics_->carry(archive); });
  hash_ = hash(state);
  row_hash_ = hash_of_rows(state.disks);
}

}  // namespace gridlock
