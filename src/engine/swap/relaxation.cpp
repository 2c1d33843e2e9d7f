#include "engine/swap/relaxation.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "core/bond_direction.hpp"
#include "core/disks_overview.hpp"

namespace gridlock {

namespace {

constexpr std::uint64_t origins_in_a_run = 16;
constexpr std::size_t max_watched = 4096;
constexpr double cage = 0.3;  // radius of a cage in mean diameters

/// Returns 1.5 spacings of a triangular lattice of this density, but no more than keeps second images away.
double distance_of_neighbours(State const& state) {
  double const density = static_cast<double>(state.agents.size()) / state.box.area();
  double const distance = 1.5 * std::sqrt(2.0 / (std::numbers::sqrt3 * density));
  return std::min(distance, 0.5 * state.box.shortest_period());
}

/// Finds the disks within `distance` of disk i, sorted, so that the grid does not show in the order of sums.
void find_neighbours(SwapTrials const& trials, std::size_t i, double distance, std::vector<std::uint32_t>& found) {
  found.clear();
  Vector const p = trials.position(i);
  trials.grid().for_each_candidate(p, distance, [&](std::size_t j) {
    if (j == i) return;
    if (squared_length(trials.box().displacement(p, trials.position(j))) < distance * distance) {
      found.push_back(static_cast<std::uint32_t>(j));
    }
  });
  std::ranges::sort(found);
}

Vector bond_orientation(SwapTrials const& trials, std::size_t i, std::vector<std::uint32_t> const& neighbours) {
  Vector sum;
  for (std::uint32_t const j : neighbours) {
    Vector const bond = trials.box().displacement(trials.position(i), trials.position(j));
    if (squared_length(bond) > 0.0) sum = sum + sixth_power_of_direction(bond);
  }
  return neighbours.empty() ? sum : (1.0 / static_cast<double>(neighbours.size())) * sum;
}

/// Returns the vector from the mean position of the neighbours to disk i, also across edges of the box.
template <class Neighbours>
Vector relative_position(SwapTrials const& trials, std::size_t i, Neighbours const& neighbours) {
  Vector sum;
  for (std::uint32_t const j : neighbours) sum = sum + trials.unwrapped(j);
  if (std::ranges::empty(neighbours)) return trials.unwrapped(i);
  return trials.unwrapped(i) - (1.0 / static_cast<double>(std::ranges::size(neighbours))) * sum;
}

}  // namespace

Relaxation::Relaxation(State const& state, std::uint64_t sweeps)
    : disks_(state.agents.size()),
      stride_((disks_ + max_watched - 1) / max_watched),
      neighbour_distance_(distance_of_neighbours(state)),
      squared_cage_(cage * mean_diameter(state.agents) * cage * mean_diameter(state.agents)),
      spacing_(std::max<std::uint64_t>(1, (sweeps + origins_in_a_run - 1) / origins_in_a_run)) {}

bool Relaxation::is_due(std::uint64_t sweep) const {
  std::uint64_t lag = sweep % spacing_;
  if (lag == 0) return true;
  // The lags between origins are 2ⁿ and 3·2ⁿ.
  while (lag % 2 == 0) lag /= 2;
  return (lag == 1 || lag == 3) && !origins_.empty();
}

void Relaxation::look_at(SwapTrials const& trials, std::uint64_t sweep) {
  if (!is_due(sweep)) return;
  Origin now = look(trials, sweep);
  if (sweep % spacing_ != 0) return compare(origins_.back(), now, trials);
  for (Origin const& origin : origins_) compare(origin, now, trials);
  if (origins_.size() < origins_in_a_run) origins_.push_back(std::move(now));
}

Relaxation::Origin Relaxation::look(SwapTrials const& trials, std::uint64_t sweep) const {
  Origin origin{.sweep = sweep, .first = {0}};
  std::vector<std::uint32_t> neighbours;
  for (std::size_t i = 0; i < disks_; i += stride_) {
    find_neighbours(trials, i, neighbour_distance_, neighbours);
    Vector const order = bond_orientation(trials, i, neighbours);
    Vector const relative = relative_position(trials, i, neighbours);
    origin.relative_x.push_back(relative.x);
    origin.relative_y.push_back(relative.y);
    origin.order_x.push_back(order.x);
    origin.order_y.push_back(order.y);
    origin.neighbours.insert(origin.neighbours.end(), neighbours.begin(), neighbours.end());
    origin.first.push_back(static_cast<std::uint32_t>(origin.neighbours.size()));
  }
  return origin;
}

void Relaxation::compare(Origin const& origin, Origin const& now, SwapTrials const& trials) {
  std::uint64_t const lag = now.sweep - origin.sweep;
  auto place = std::ranges::lower_bound(sums_, lag, {}, &Sums::lag);
  if (place == sums_.end() || place->lag != lag) place = sums_.insert(place, {.lag = lag});
  std::uint64_t near = 0;
  for (std::size_t k = 0; k < watched(); ++k) {
    std::span const neighbours =
        std::span(origin.neighbours).subspan(origin.first[k], origin.first[k + 1] - origin.first[k]);
    Vector const before{origin.relative_x[k], origin.relative_y[k]};
    Vector const moved = relative_position(trials, k * stride_, neighbours) - before;
    if (squared_length(moved) < squared_cage_) ++near;
    Vector const order{origin.order_x[k], origin.order_y[k]};
    place->bond += dot(order, {now.order_x[k], now.order_y[k]});
    place->bond_at_origin += squared_length(order);
  }
  place->near += static_cast<double>(near) / static_cast<double>(watched());
  ++place->origins;
}

std::vector<SwapCorrelation> Relaxation::correlations() const {
  std::vector<SwapCorrelation> correlations;
  for (Sums const& sums : sums_) {
    correlations.push_back({.lag = sums.lag,
                            .origins = sums.origins,
                            .self_overlap = sums.near / static_cast<double>(sums.origins),
                            .bond_orientation = sums.bond_at_origin > 0.0 ? sums.bond / sums.bond_at_origin : 0.0});
  }
  return correlations;
}

RelaxationTimes Relaxation::times(std::uint64_t sweeps) const {
  std::vector<SwapCorrelation> const all = correlations();
  RelaxationTimes times{.overlap = relaxation_time(all, &SwapCorrelation::self_overlap),
                        .bond = relaxation_time(all, &SwapCorrelation::bond_orientation),
                        .in_run = {}};
  if (times.overlap && times.bond) times.in_run = static_cast<double>(sweeps) / std::max(*times.overlap, *times.bond);
  times.is_enough = times.in_run.value_or(0.0) >= enough_relaxation_times;
  return times;
}

void Relaxation::serialize(Archive& archive, Origin& origin) {
  archive.visit("sweep", origin.sweep);
  archive.visit("first", origin.first);
  archive.visit("neighbours", origin.neighbours);
  archive.visit("relative_x", origin.relative_x);
  archive.visit("relative_y", origin.relative_y);
  archive.visit("order_x", origin.order_x);
  archive.visit("order_y", origin.order_y);
}

void Relaxation::serialize(Archive& archive, std::size_t disks, std::uint64_t sweep) {
  // These two follow from settings and start. They are saved because the sums are valid for no other values.
  archive.visit("squared_cage", squared_cage_);
  archive.visit("neighbour_distance", neighbour_distance_);
  archive.require(disks == disks_, "the correlations are of another number of disks");
  std::uint64_t origins = origins_.size();
  std::uint64_t lags = sums_.size();
  archive.visit("origins", origins);
  archive.visit("lags", lags);
  archive.require(origins <= origins_in_a_run && lags <= 1000, "there are too many correlations");
  origins_.resize(origins);
  sums_.resize(lags);
  for (std::size_t k = 0; k < origins; ++k) {
    serialize_inside(archive, "origin_" + std::to_string(k), [&] { serialize(archive, origins_[k]); });
  }
  for (std::size_t k = 0; k < lags; ++k) {
    serialize_inside(archive, "lag_" + std::to_string(k), [&] {
      archive.visit("lag", sums_[k].lag);
      archive.visit("origins", sums_[k].origins);
      archive.visit("near", sums_[k].near);
      archive.visit("bond", sums_[k].bond);
      archive.visit("bond_at_origin", sums_[k].bond_at_origin);
    });
  }
  if (archive.is_restoring()) require_restored(archive, sweep);
}

void Relaxation::require_restored(Archive const& archive, std::uint64_t sweep) const {
  char const* const what = "the correlations are not those of such a run";
  for (Origin const& origin : origins_) {
    archive.require(origin.first.size() == watched() + 1 && origin.relative_x.size() == watched() &&
                        origin.relative_y.size() == watched() && origin.order_x.size() == watched() &&
                        origin.order_y.size() == watched(),
                    what);
    archive.require(origin.sweep <= sweep, what);
    archive.require(origin.first.front() == 0 && std::ranges::is_sorted(origin.first) &&
                        origin.first.back() == origin.neighbours.size(),
                    what);
    archive.require(std::ranges::all_of(origin.neighbours, [&](std::uint32_t j) { return j < disks_; }), what);
  }
  archive.require(std::ranges::is_sorted(sums_, {}, &Sums::lag), what);
  archive.require(std::ranges::is_sorted(origins_, {}, &Origin::sweep), what);
  archive.require(std::ranges::all_of(sums_, [](Sums const& sums) { return sums.lag > 0 && sums.origins > 0; }), what);
}

std::optional<double> relaxation_time(std::vector<SwapCorrelation> const& correlations,
                                      double SwapCorrelation::*quantity) {
  double const end = 1.0 / std::numbers::e;
  double lag = 0.0;
  double value = 1.0;
  for (SwapCorrelation const& next : correlations) {
    auto const next_lag = static_cast<double>(next.lag);
    double const next_value = next.*quantity;
    if (next_value <= end) return lag + (next_lag - lag) * (value - end) / (value - next_value);
    lag = next_lag;
    value = next_value;
  }
  return std::nullopt;
}

}  // namespace gridlock
