#include <fmt/format.h>

#include <vector>

#include "engine/chain/take_step.hpp"
#include "grid/linked_grid.hpp"
#include "gridlock/core/detail/rows_in_order.hpp"
#include "gridlock/core/error.hpp"

namespace gridlock::chain {

namespace {

/// Disks of any sizes in the lists of a grid.
class CellsOfAnySize final : public ChainDisks {
 public:
  explicit CellsOfAnySize(State const& state)
      : box_(state.box),
        longest_(chain::longest_flight * largest_contact_distance(state.agents.column<Radius>())),
        rows_(rows_in_order(state.agents.ids())) {
    double const reach = (1.0 + 1.0 / chain::longest_flight) * longest_;
    grid_ = LinkedGrid(layout_for_cutoff(box_, 0.5 * reach, rows_.size()), rows_.size());
    reach_columns_ = grid_.layout().columns_within(reach);
    reach_rows_ = grid_.layout().rows_within(reach);
    disks_.reserve(rows_.size());
    for (std::uint32_t const row : rows_) {
      grid_.insert(disks_.size(), position(state.agents, row));
      disks_.push_back({.place = position(state.agents, row),
                        .velocity = gridlock::velocity(state.agents, row),
                        .radius = state.agents.column<Radius>()[row]});
    }
  }

  [[nodiscard]] ChainSums take(StepOfChains const& step) override { return take_step(*this, disks_.size(), step); }
  void write_back(State& state) const override {
    Disks& to = state.agents;
    for (std::size_t i = 0; i < disks_.size(); ++i) {
      std::uint32_t const row = rows_[i];
      to.column<X>()[row] = disks_[i].place.x;
      to.column<Y>()[row] = disks_[i].place.y;
      to.column<VelocityX>()[row] = disks_[i].velocity.x;
      to.column<VelocityY>()[row] = disks_[i].velocity.y;
      to.column<ImageX>()[row] += disks_[i].crossed_x;
      to.column<ImageY>()[row] += disks_[i].crossed_y;
    }
  }

  // For carry_out():
  [[nodiscard]] double longest_flight() const { return longest_; }
  [[nodiscard]] Number find(Number disk) const { return disk; }
  [[nodiscard]] Vector place(Number disk) const { return disks_[disk].place; }
  [[nodiscard]] Vector velocity(Number disk) const { return disks_[disk].velocity; }
  void set_velocity(Number disk, Vector velocity) { disks_[disk].velocity = velocity; }
  Vector move(Number disk, Vector to) {
    Disk& moved = disks_[disk];
    moved.place = box_.wrap(to, moved.crossed_x, moved.crossed_y);
    grid_.move(disk, moved.place);
    return moved.place;
  }
  template <Way way>
  void find_contact(Flight const& flight, Contact& contact) const {
    double const radius = disks_[flight.disk].radius;
    grid_.for_each_in_block(grid_.cell_of(flight.disk), reach_columns_, reach_rows_, [&](std::size_t other) {
      double const distance = radius + disks_[other].radius;
      meet<way>(flight, box_.displacement_inside(flight.place, disks_[other].place), distance * distance,
                static_cast<Number>(other), contact);
    });
  }
  void end_chain() {}

 private:
  struct Disk {
    Vector place;
    Vector velocity;
    double radius;
    int crossed_x = 0;
    int crossed_y = 0;
  };

  Box box_;
  double longest_;
  std::vector<std::uint32_t> rows_;  ///< row of each disk in the state
  std::vector<Disk> disks_;
  LinkedGrid grid_;
  int reach_columns_ = 0;
  int reach_rows_ = 0;
};

}  // namespace

void fail_without_end(std::uint64_t contacts) {
  throw RunFailure(
      fmt::format("a chain of event_chain has met {} disks and not come to its end, since rows of disks touch each "
                  "other all around "
                  "the box; use a lower packing fraction, or engine.kind = \"exact\"",
                  contacts));
}

std::unique_ptr<ChainDisks> chain_disks_of_any_size(State const& state) {
  return std::make_unique<CellsOfAnySize>(state);
}

std::unique_ptr<ChainDisks> chain_disks(State const& state, Target target) {
  std::unique_ptr<ChainDisks> disks;
  if (target == Target::avx512) disks = chain_disks_with_avx512(state);
  return disks != nullptr ? std::move(disks) : chain_disks_of_any_size(state);
}

}  // namespace gridlock::chain
