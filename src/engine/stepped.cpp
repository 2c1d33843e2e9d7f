#include "stepped.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "gridlock/core/error.hpp"
#include "gridlock/grid/linked_grid.hpp"
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

/// Blocks of cells wide enough for one turn of a disk: the 3×3 block as long as contact distance and way fit a cell.
class Reach {
 public:
  Reach(CellLayout const& layout, double largest_radius, double duration)
      : layout_(layout), cell_(std::min(layout.cell_width(), layout.cell_height())), largest_radius_(largest_radius),
        squared_duration_(duration * duration) {}

  struct Cells {
    int columns;
    int rows;
  };

  [[nodiscard]] Cells of(double radius, double squared_speed) const {
    double const squared_way = squared_speed * squared_duration_;
    double const room = (cell_ - radius - largest_radius_) * (1.0 - 1e-12);
    if (room > 0.0 && squared_way < room * room) return {1, 1};
    double const reach = radius + largest_radius_ + std::sqrt(squared_way);
    return {layout_.columns_within(reach), layout_.rows_within(reach)};
  }

 private:
  CellLayout const& layout_;
  double cell_;
  double largest_radius_;
  double squared_duration_;
};

}  // namespace

CellLayout stepped_layout(EngineSettings const& settings, State const& state) {
  if (settings.cells) return {state.box, *settings.cells, *settings.cells};
  double const way = largest_speed(state.disks) * step_duration(settings, state);
  double const reach = 2.0 * radius_range(state.disks).largest + way;
  return reach > 0.0 ? layout_for_reach(state.box, reach, state.disks.size()) : CellLayout(state.box, 1, 1);
}

SteppedEngine::SteppedEngine(EngineSettings const& settings, State const& state)
    : settings_(settings), duration_(step_duration(settings, state)), layout_(stepped_layout(settings, state)) {}

void SteppedEngine::advance(State& state, Tally& tally, Horizon const& horizon) {
  TurnView const view = view_for_turns(state, settings_, duration_);
  LinkedGrid grid(layout_, view.x, view.y);
  std::vector<std::size_t> const order = rows_by_id(state.disks);
  auto const [smallest, largest] = radius_range(state.disks);
  Reach const reach(layout_, largest, duration_);
  auto const take_turns = [&] {
    for (std::size_t const i : order) {
      double const squared_speed = squared_length(view.velocity(i));
      require_short_substep(state, i, squared_speed, smallest);
      auto const [columns, rows] = reach.of(view.radius[i], squared_speed);
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
  if (squared_speed * substep * substep < contact * contact) return;
  throw RunFailure(fmt::format(
      "step {}: disk {} at speed {:.6g} covers {:.6g} in one sub-step and could jump over a disk at distance {:.6g}\n"
      "  hint: use a smaller engine.time_step or more engine.substeps",
      state.clock.step, state.disks.ids()[i], std::sqrt(squared_speed), std::sqrt(squared_speed) * substep, contact));
}

}  // namespace gridlock
