#include "moves_apart.hpp"

#include <algorithm>
#include <cstddef>
#include <limits>

#include "gridlock/core/vector.hpp"
#include "gridlock/grid/cell_layout.hpp"
#include "gridlock/grid/detail/packed_grid.hpp"

namespace gridlock::python {

namespace {

/// Moves disks one after the other on a grid of their present positions.
class DisksInTurn {
 public:
  DisksInTurn(DisksToMove const& disks, MovesApart& ends)
      : disks_(disks), ends_(ends), largest_(std::ranges::max(disks.radius)), turn_(disks.x.size()) {
    for (std::uint32_t turn = 0; turn < disks.order.size(); ++turn) turn_[disks.order[turn]] = turn;
    CellLayout const layout = layout_for_cutoff(disks.box, 2.0 * largest_, disks.x.size());
    grid_ = PackedGrid(layout, disks.x, disks.y);
  }

  void move(std::size_t row, Vector displacement) {
    if (displacement.x == 0.0 && displacement.y == 0.0) return;
    Vector const part = (1.0 / static_cast<double>(disks_.parts)) * displacement;
    for (std::uint64_t k = 0; k < disks_.parts && advance(row, part); ++k) {
    }
    grid_.move(row, place_of(row));
  }

 private:
  [[nodiscard]] Vector place_of(std::size_t row) const { return {disks_.x[row], disks_.y[row]}; }

  /// Moves a disk by a part of its displacement. Returns whether nothing has halted it.
  bool advance(std::size_t row, Vector part) {
    Vector trial = place_of(row) + part;
    if (meets_wall(row, trial, part)) return false;
    int crossed_x = 0;
    int crossed_y = 0;
    trial = disks_.box.wrap(trial, crossed_x, crossed_y);
    std::int64_t const partner = partner_at(row, trial);
    if (partner >= 0) {
      ends_.partners[row] = partner;
      return false;
    }
    disks_.x[row] = trial.x;
    disks_.y[row] = trial.y;
    ends_.crossed[2 * row] += crossed_x;
    ends_.crossed[2 * row + 1] += crossed_y;
    return true;
  }

  bool meets_wall(std::size_t row, Vector trial, Vector part) {
    double const r = disks_.radius[row];
    auto const meets = [r](double place, double side, double by) {
      return (place < r && by < 0.0) || (place > side - r && by > 0.0) || place < 0.0 || place > side;
    };
    bool const meets_x = !disks_.box.is_periodic_x() && meets(trial.x, disks_.box.width(), part.x);
    bool const meets_y = !disks_.box.is_periodic_y() && meets(trial.y, disks_.box.height(), part.y);
    if (meets_x) ends_.walls[2 * row] = 1;
    if (meets_y) ends_.walls[2 * row + 1] = 1;
    return meets_x || meets_y;
  }

  /// Returns the row of the disk that forbids a move to `trial`, or −1.
  [[nodiscard]] std::int64_t partner_at(std::size_t row, Vector trial) const {
    Vector const here = place_of(row);
    double nearest = std::numeric_limits<double>::infinity();
    std::int64_t partner = -1;
    grid_.for_each_candidate(trial, disks_.radius[row] + largest_, [&](std::size_t other) {
      if (other == row) return;
      double const contact = disks_.radius[row] + disks_.radius[other];
      double const distance = squared_length(disks_.box.displacement_inside(trial, place_of(other)));
      if (!(distance < contact * contact)) return;
      if (distance >= squared_length(disks_.box.displacement_inside(here, place_of(other)))) return;
      bool const is_nearer =
          distance < nearest || (distance == nearest && turn_[other] < turn_[static_cast<std::size_t>(partner)]);
      if (!is_nearer) return;
      nearest = distance;
      partner = static_cast<std::int64_t>(other);
    });
    return partner;
  }

  DisksToMove const& disks_;
  MovesApart& ends_;
  double largest_;
  std::vector<std::uint32_t> turn_;  ///< of each row
  PackedGrid grid_;
};

}  // namespace

MovesApart move_apart(DisksToMove const& disks, std::span<double const> by) {
  std::size_t const count = disks.x.size();
  MovesApart ends{.walls = std::vector<std::uint8_t>(2 * count),
                  .partners = std::vector<std::int64_t>(count, -1),
                  .crossed = std::vector<std::int32_t>(2 * count)};
  if (count == 0) return ends;
  DisksInTurn in_turn(disks, ends);
  for (std::size_t const row : disks.order) in_turn.move(row, {by[2 * row], by[2 * row + 1]});
  return ends;
}

}  // namespace gridlock::python
