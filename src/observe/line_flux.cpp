#include "observe/line_flux.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "gridlock/core/error.hpp"
#include "observe/displacement.hpp"
#include "observe/mobile.hpp"
#include "observe/sites.hpp"

namespace gridlock {

Requirements LineFlux::requirements(Box const& box) const { return Displacement().requirements(box); }

void LineFlux::begin(Snapshot const& start) {
  reset(
      {{"crossings_forward", "agents", "Agents that crossed the line towards larger x or y since the sample before."},
       {"crossings_backward", "agents", "Agents that crossed the line towards smaller x or y since the sample before."},
       {"flux_forward", "agents / time", "Crossings of the line towards larger x or y per time."},
       {"flux_backward", "agents / time", "Crossings of the line towards smaller x or y per time."},
       {"net_flux", "agents / time", "Forward flux less backward flux."}});
  double const side = is_vertical() ? start.box.width() : start.box.height();
  if (position_ && !(*position_ >= 0.0 && *position_ <= side)) {
    throw Error({.what = fmt::format("the line {} = {} of the flux is outside the box, which is {} {}",
                                     is_vertical() ? 'x' : 'y', *position_, side, is_vertical() ? "wide" : "high"),
                 .hint = fmt::format("set observe.flux_position from 0 to {}, or leave it out for the middle", side),
                 .key = "observe.flux_position"});
  }
  last_time_ = start.clock.time;
  sides_ = sides_of(start);
}

Attached<LineFlux::Side> LineFlux::sides_of(Snapshot const& now) const {
  Sites const sites(now.box, now.agents);
  double const position = position_.value_or(0.5 * (is_vertical() ? now.box.width() : now.box.height()));
  return now.attached<Side>([&](std::size_t i) {
    Site const site = sites[i];
    // By images no rounding of an unwrapped position moves an agent across the line.
    if (!is_vertical()) return Side{site.image_y + (site.y >= position ? 1 : 0)};
    if (!now.box.is_oblique()) return Side{site.image_x + (site.x >= position ? 1 : 0)};
    return Side{site.image_x + 1 + static_cast<std::int32_t>(std::floor((site.x - position) / now.box.width()))};
  });
}

void LineFlux::sample(Snapshot const& now, std::span<double> row, bool counts_for_average) {
  Attached<Side> sides = sides_of(now);
  MobileAgents const mobile(now.agents);
  auto const ids = now.agents.ids();
  std::array<std::uint64_t, 2> crossings{};
  for (std::size_t i = 0; i < ids.size(); ++i) {
    Side const* const before = mobile.has(i) ? sides_.find(ids[i], i) : nullptr;
    if (before == nullptr) continue;
    std::int64_t const crossed = std::int64_t{sides.find(ids[i], i)->lines} - before->lines;
    crossings[crossed > 0 ? 0 : 1] += static_cast<std::uint64_t>(crossed > 0 ? crossed : -crossed);
  }
  now.counts(crossings);
  sides_ = std::move(sides);
  double const elapsed = now.clock.time - last_time_;
  last_time_ = now.clock.time;
  auto const forward = static_cast<double>(crossings[0]);
  auto const backward = static_cast<double>(crossings[1]);
  row[0] = forward;
  row[1] = backward;
  row[2] = row[3] = row[4] = no_value;
  if (!(elapsed > 0.0)) return;
  row[2] = forward / elapsed;
  row[3] = backward / elapsed;
  row[4] = (forward - backward) / elapsed;
  if (!counts_for_average) return;
  for (std::size_t column = 2; column < 5; ++column) average(column, row[column], elapsed);
}

void LineFlux::serialize(Archive& archive) {
  AveragingObservable::serialize(archive);
  archive.visit("last_time", last_time_);
  serialize_inside(archive, "sides", [&] { sides_.serialize_ids(archive); });
  sides_.serialize_member(archive, "lines", &Side::lines);
}

}  // namespace gridlock
