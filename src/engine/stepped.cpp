#include "stepped.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <string>
#include <vector>

#include "gridlock/core/error.hpp"
#include "gridlock/grid/linked_grid.hpp"
#include "gridlock/grid/validate.hpp"
#include "turn.hpp"

namespace gridlock {

namespace {

/// Rows in the order of their Ids, the order in which disks take their turns.
std::vector<std::size_t> rows_by_id(Disks const& disks) {
  std::vector<std::size_t> rows(disks.size());
  std::iota(rows.begin(), rows.end(), std::size_t{0});
  std::ranges::sort(rows, {}, [ids = disks.ids()](std::size_t row) { return ids[row]; });
  return rows;
}

/// How far from its place at the start of a turn a disk can meet the centre of another: contact distance and way.
class Reach {
 public:
  Reach(State const& state, double largest_radius, double duration, std::uint64_t substeps)
      : largest_radius_(largest_radius),
        duration_(duration),
        // Every sub-step may round the position by an ulp of the box, which adds up for slow disks and many sub-steps.
        rounding_(static_cast<double>(substeps) * std::numeric_limits<double>::epsilon() *
                  std::max(state.box.width(), state.box.height())) {}

  [[nodiscard]] double of(double radius, double squared_speed) const {
    return radius + largest_radius_ + std::sqrt(squared_speed) * duration_ + rounding_;
  }

 private:
  double largest_radius_;
  double duration_;
  double rounding_;
};

void require_bounds(EngineSettings const& settings, State const& state) {
  if (!(std::isfinite(settings.time_step) && settings.time_step > 0.0)) {
    throw Error({.what = fmt::format("the time step is {}, not a positive number", settings.time_step),
                 .hint = "the usual value is 0.1",
                 .key = "engine.time_step"});
  }
  if (settings.substeps == 0) {
    throw Error({.what = "a time step of 0 sub-steps goes nowhere",
                 .hint = "the paper's value is 5",
                 .key = "engine.substeps"});
  }
  if (state.disks.empty()) {
    throw Error({.what = "there are no disks to move", .hint = "give at least one", .key = "disks.count"});
  }
}

/// A disk that covers a contact distance in one sub-step could come out behind the disk it should have met.
bool is_short(double squared_way, double contact) { return squared_way < contact * contact; }

std::string jump_text(State const& state, std::size_t i, double way, double contact) {
  return fmt::format("disk {} covers {:.6g} in one sub-step and could jump over a disk at contact distance {:.6g}",
                     state.disks.ids()[i], way, contact);
}

constexpr char const* jump_hint = "use a smaller engine.time_step or more engine.substeps";

void require_no_jumps(State const& state, double substep) {
  double const smallest = radius_range(state.disks).smallest;
  for (std::size_t i = 0; i < state.disks.size(); ++i) {
    double const squared_way = squared_length(velocity(state.disks, i)) * substep * substep;
    double const contact = state.disks.column<Radius>()[i] + smallest;
    if (is_short(squared_way, contact)) continue;
    throw Error(
        {.what = jump_text(state, i, std::sqrt(squared_way), contact), .hint = jump_hint, .key = "engine.time_step"});
  }
}

/// Pairs scatter along the vector to the nearest image, which is the image that was hit as long as contact distance and
/// sub-step together stay below half the box.
void require_room_for_images(State const& state, double substep) {
  if (!state.box.is_periodic() || state.disks.size() < 2) return;
  double const shorter = std::min(state.box.width(), state.box.height());
  double const needed = 2.0 * (2.0 * radius_range(state.disks).largest + largest_speed(state.disks) * substep);
  if (needed <= shorter) return;
  throw Error({.what = fmt::format("a periodic box with a side of {:.6g} is too small: a disk could meet two images of "
                                   "another at once, which needs sides of at least {:.6g}",
                                   shorter, needed),
               .hint = "use more disks, a lower packing fraction, or walls",
               .key = "box"});
}

}  // namespace

CellLayout stepped_layout(EngineSettings const& settings, State const& state) {
  if (settings.cells) return {state.box, *settings.cells, *settings.cells};
  double const way = largest_speed(state.disks) * step_duration(settings, state);
  double const reach = 2.0 * radius_range(state.disks).largest + way;
  return layout_for_reach(state.box, reach, state.disks.size());
}

SteppedEngine::SteppedEngine(EngineSettings const& settings, State const& state)
    : settings_(settings), duration_(step_duration(settings, state)), box_(state.box) {
  require_bounds(settings, state);
  validate(state);
  double const substep = duration_ / static_cast<double>(settings.substeps);
  require_no_jumps(state, substep);
  require_room_for_images(state, substep);
  layout_ = stepped_layout(settings, state);
}

void SteppedEngine::advance(State& state, Tally& tally, Horizon const& horizon) {
  if (state.box != box_) {
    box_ = state.box;
    layout_ = stepped_layout(settings_, state);
  }
  TurnView const view = view_for_turns(state, settings_, duration_);
  LinkedGrid grid(layout_, view.x, view.y);
  std::vector<std::size_t> const order = rows_by_id(state.disks);
  RadiusRange const radii = radius_range(state.disks);
  Reach const reach(state, radii.largest, duration_, settings_.substeps);
  auto const take_turns = [&] {
    for (std::size_t const i : order) {
      double const squared_speed = squared_length(view.velocity(i));
      require_short_substep(state, i, squared_speed, radii.smallest);
      double const distance = reach.of(view.radius[i], squared_speed);
      int const columns = layout_.columns_within(distance);
      int const rows = layout_.rows_within(distance);
      int const cell = grid.cell_of(i);
      take_turn(view, i, tally, [&](Partner& partner) {
        grid.for_each_in_block(cell, columns, rows, [&](std::size_t j) { partner.consider(j); });
      });
      grid.move(i, view.position(i));
    }
  };
  while (state.clock.step < horizon.step && state.clock.time < horizon.time &&
         tally.pair_collisions < horizon.pair_collisions) {
    take_turns();
    ++state.clock.step;
    state.clock.time += duration_;
  }
}

void SteppedEngine::require_short_substep(State const& state, std::size_t i, double squared_speed,
                                          double smallest_radius) const {
  double const substep = duration_ / static_cast<double>(settings_.substeps);
  double const contact = state.disks.column<Radius>()[i] + smallest_radius;
  double const squared_way = squared_speed * substep * substep;
  if (is_short(squared_way, contact)) return;
  throw RunFailure(fmt::format("step {}: {}\n  hint: {}", state.clock.step,
                               jump_text(state, i, std::sqrt(squared_way), contact), jump_hint));
}

}  // namespace gridlock
