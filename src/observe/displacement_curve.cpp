#include "observe/displacement_curve.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "gridlock/core/error.hpp"
#include "observe/displacement.hpp"
#include "observe/mobile.hpp"

namespace gridlock {

namespace {

std::uint64_t samples_between_origins(std::uint64_t max_lag, std::uint64_t origin_every) {
  return origin_every > 0 ? origin_every : (max_lag + 7) / 8;
}

/// Returns the mean squared displacement from these sites, of mobile agents; nothing if none is left.
std::optional<double> mean_squared_displacement_from(Snapshot const& now, Attached<Site> const& from) {
  Sites const sites(now.box, now.agents);
  MobileAgents const mobile(now.agents);
  auto const ids = now.agents.ids();
  auto const [squares, count] = now.sum([&](std::size_t i) {
    Site const* const then = mobile.has(i) ? from.find(ids[i], i) : nullptr;
    if (then == nullptr) return std::array{0.0, 0.0};
    return std::array{squared_length(sites.moved(*then, i)), 1.0};
  });
  return count > 0.0 ? std::optional(squares / count) : std::nullopt;
}

}  // namespace

std::uint64_t DisplacementCurve::origins_in_use(std::uint64_t max_lag, std::uint64_t origin_every) {
  return max_lag == 0 ? 0 : (max_lag - 1) / samples_between_origins(max_lag, origin_every) + 1;
}

DisplacementCurve::DisplacementCurve(std::uint64_t max_lag, std::uint64_t origin_every)
    : max_lag_(max_lag),
      origin_every_(samples_between_origins(max_lag, origin_every)),
      lags_(lags_of_curve(max_lag)),
      early_(early_lag_of(max_lag)) {
  std::uint64_t const in_use = origins_in_use(max_lag, origin_every);
  if (in_use > max_origins) {
    throw Error(
        {.what = fmt::format("lags up to {} samples with an origin every {} samples keep {} origins at one time",
                             max_lag_, origin_every_, in_use),
         .hint = fmt::format("take origins at least {} samples apart: at most {} are kept at one time",
                             (max_lag_ + max_origins - 1) / max_origins, max_origins),
         .key = "observe.displacement_origin_every"});
  }
  origins_.resize(in_use);
  origins_of_group_ = 2 * in_use;
}

Requirements DisplacementCurve::requirements(Box const& box) const { return Displacement().requirements(box); }

std::vector<ColumnInfo> DisplacementCurve::columns() const {
  return {
      {"diffusion_coefficient", "length² / time",
       "Slope of the mean squared displacement over four, from the origin whose longest lag ended in this sample."}};
}

void DisplacementCurve::begin(Snapshot const& start) {
  has_begun_ = false;
  samples_since_origin_ = 0;
  for (Origin& origin : origins_) {
    origin = {};
    origin.sites = start.attached<Site>();
  }
  times_.assign(lags_.size(), no_value);
  curve_.assign(lags_.size(), {});
  coefficient_ = {};
}

void DisplacementCurve::sample(Snapshot const& now, std::span<double> row, bool counts_for_average) {
  row[0] = no_value;
  if (!has_begun_ && !counts_for_average) return;
  for (Origin& origin : origins_) {
    if (!origin.is_used) continue;
    ++origin.age;
    if (std::ranges::binary_search(lags_, origin.age)) take_lag(now, origin, row);
    if (origin.age == max_lag_) origin.is_used = false;
  }
  if (!has_begun_ || samples_since_origin_ == origin_every_) open_origin(now);
  has_begun_ = true;
  ++samples_since_origin_;
}

void DisplacementCurve::open_origin(Snapshot const& now) {
  samples_since_origin_ = 0;
  auto const free = std::ranges::find(origins_, false, &Origin::is_used);
  if (free == origins_.end()) return;
  Sites const sites(now.box, now.agents);
  *free = {
      .sites = now.attached<Site>([&](std::size_t i) { return sites[i]; }), .is_used = true, .time = now.clock.time};
}

void DisplacementCurve::take_lag(Snapshot const& now, Origin& origin, std::span<double> row) {
  auto const place = static_cast<std::size_t>(std::ranges::lower_bound(lags_, origin.age) - lags_.begin());
  double const lag = now.clock.time - origin.time;
  if (std::isnan(times_[place])) times_[place] = lag;
  // The last sample of a run may come early and then belongs to no point of the curve.
  if (!(std::abs(lag - times_[place]) <= 1e-9 * lag)) return;
  auto const displacement = mean_squared_displacement_from(now, origin.sites);
  if (!displacement) return;
  curve_[place].add(*displacement, origins_of_group_);
  if (origin.age == early_) {
    origin.early_lag = lag;
    origin.early_displacement = *displacement;
  }
  if (origin.age != max_lag_ || !(lag > origin.early_lag)) return;
  double const slope = (*displacement - origin.early_displacement) / (lag - origin.early_lag);
  row[0] = slope / 4.0;
  coefficient_.add(row[0], origins_of_group_);
}

std::vector<NamedEstimate> DisplacementCurve::results() const {
  auto const estimate = coefficient_.estimate();
  if (!estimate) return {};
  return {{columns()[0].name, *estimate, columns()[0].unit}};
}

std::vector<Distribution> DisplacementCurve::distributions() const {
  std::vector<std::vector<double>> values(4);
  for (std::size_t place = 0; place < curve_.size(); ++place) {
    auto const estimate = curve_[place].estimate();
    if (!estimate) continue;
    values[0].push_back(times_[place]);
    values[1].push_back(estimate->value);
    values[2].push_back(estimate->error.value_or(no_value));
    values[3].push_back(curve_[place].origins(origins_of_group_));
  }
  if (values[0].empty()) return {};
  return {{.name = "mean_squared_displacement",
           .columns =
               {{"lag", "time", "Time since an origin."},
                {"mean_squared_displacement", "length²", "⟨|r(t₀ + t) − r(t₀)|²⟩ over agents and origins t₀."},
                {"error", "length²", "One standard error, from groups of neighbouring origins."},
                {.name = "origins", .unit = "", .documentation = "Number of origins with this lag.", .is_count = true}},
           .columns_of_values = std::move(values)}};
}

void DisplacementCurve::serialize(Archive& archive) {
  archive.visit("has_begun", has_begun_);
  archive.visit("samples_since_origin", samples_since_origin_);
  for (std::size_t k = 0; k < origins_.size(); ++k) {
    Origin& origin = origins_[k];
    serialize_inside(archive, "origin_" + std::to_string(k), [&] {
      archive.visit("is_used", origin.is_used);
      archive.visit("age", origin.age);
      archive.visit("time", origin.time);
      archive.visit("early_lag", origin.early_lag);
      archive.visit("early_displacement", origin.early_displacement);
      origin.sites.serialize_ids(archive);
      origin.sites.serialize_member(archive, X::name, &Site::x);
      origin.sites.serialize_member(archive, Y::name, &Site::y);
      origin.sites.serialize_member(archive, ImageX::name, &Site::image_x);
      origin.sites.serialize_member(archive, ImageY::name, &Site::image_y);
    });
  }
  archive.visit("times", times_);
  archive.require(times_.size() == lags_.size(), "the lags differ in number");
  gridlock::serialize(archive, "curve", curve_);
  gridlock::serialize(archive, "coefficient", std::span(&coefficient_, 1));
}

}  // namespace gridlock
