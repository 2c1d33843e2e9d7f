#include "engine/swap/trials.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <utility>

#include "gridlock/core/detail/look_ahead.hpp"
#include "gridlock/core/detail/rows_in_order.hpp"
#include "gridlock/core/random.hpp"

namespace gridlock {

SwapTrials::SwapTrials(State const& state)
    : box_(state.box),
      seed_(state.seed),
      row_(rows_in_order(state.agents.ids())),
      largest_radius_(radius_range(state.agents).largest) {
  disks_.reserve(row_.size());
  for (std::uint32_t const row : row_) {
    disks_.push_back({.position = gridlock::position(state.agents, row),
                      .radius = state.agents.column<Radius>()[row],
                      .image_x = state.agents.column<ImageX>()[row],
                      .image_y = state.agents.column<ImageY>()[row]});
  }
  fill_grid(1.0);
}

void SwapTrials::fill_grid(double growth) {
  widest_contact_ = 2.0 * largest_radius_ * growth;
  grid_ = PackedGrid(layout_for_cutoff(box_, widest_contact_, disks_.size()), disks_.size());
  limit_per_area_ = 1.001 * grid_.locals_per_length() * grid_.locals_per_length();
  limit_error_ = grid_.local_limit(0.0);
  for (std::size_t i = 0; i < disks_.size(); ++i) grid_.insert(i, disks_[i].position);
}

bool SwapTrials::scale_radii(double factor) {
  radii_before_.clear();
  for (Disk& disk : disks_) {
    if (factor > 1.0) radii_before_.push_back(disk.radius);
    disk.radius *= factor;
  }
  double const largest_before = std::exchange(largest_radius_, largest_radius_ * factor);
  if (factor <= 1.0) return true;
  auto const undo = [&] {
    for (std::size_t k = 0; k < disks_.size(); ++k) disks_[k].radius = radii_before_[k];
    largest_radius_ = largest_before;
    return false;
  };
  if (2.0 * largest_radius_ > box_.shortest_period()) return undo();  // a disk would overlap its own image
  // The margin keeps the grid through many small steps.
  if (2.0 * largest_radius_ > widest_contact_) fill_grid(1.02);
  for (std::uint32_t i = 0; i < disks_.size(); ++i) {
    if (!is_free({disks_[i].position, disks_[i].radius, i, nobody})) return undo();
  }
  return true;
}

void SwapTrials::write_back(State& state) const {
  Disks& to = state.agents;
  for (std::size_t i = 0; i < disks_.size(); ++i) {
    std::uint32_t const row = row_[i];
    to.column<X>()[row] = disks_[i].position.x;
    to.column<Y>()[row] = disks_[i].position.y;
    to.column<Radius>()[row] = disks_[i].radius;
    to.column<ImageX>()[row] = disks_[i].image_x;
    to.column<ImageY>()[row] = disks_[i].image_y;
  }
}

SwapTrials::Trial SwapTrials::draw(Sweep const& sweep, std::uint64_t number) const {
  RandomStream random(seed_, sweep.number, number, Purpose::swap_trial);
  // The product is below N, since a number below 1 is at least 2⁻⁵³ below 1. Some disks are likelier by 2⁻⁵³, which
  // does no harm: a trial and its reverse pick the same disks.
  auto const pick = [&] { return static_cast<std::uint32_t>(random.uniform() * static_cast<double>(disks_.size())); };
  Trial trial{.is_swap = random.uniform() < sweep.swap_fraction, .disk = pick(), .other = nobody, .displacement = {}};
  if (trial.is_swap) {
    trial.other = pick();
  } else {
    trial.displacement.x = sweep.step * (2.0 * random.uniform() - 1.0);
    trial.displacement.y = sweep.step * (2.0 * random.uniform() - 1.0);
  }
  return trial;
}

void SwapTrials::take(Sweep const& sweep, SwapCounts& counts) {
  // Trials are drawn ahead, so that the records of their disks have arrived from memory when they are needed.
  constexpr std::uint64_t ahead = 16;
  std::array<Trial, ahead> trials;
  for (std::uint64_t first = 0; first < disks_.size(); first += ahead) {
    std::uint64_t const count = std::min<std::uint64_t>(ahead, disks_.size() - first);
    for (std::uint64_t n = 0; n < count; ++n) {
      trials[n] = draw(sweep, first + n);
      prefetch(disks_.data() + trials[n].disk);
      grid_.prefetch(trials[n].disk);
      if (trials[n].is_swap) prefetch(disks_.data() + trials[n].other);
    }
    for (std::uint64_t n = 0; n < count; ++n) {
      if (trials[n].is_swap) {
        swap(trials[n], counts);
      } else {
        displace(trials[n], counts);
      }
    }
  }
}

void SwapTrials::displace(Trial const& trial, SwapCounts& counts) {
  ++counts.displacements;
  Disk& disk = disks_[trial.disk];
  int image_x = disk.image_x;
  int image_y = disk.image_y;
  // Wrapping rounds, so it comes first: the position that is checked must be the one that is kept.
  Vector const p = box_.wrap(disk.position + trial.displacement, image_x, image_y);
  if (!is_free({p, disk.radius, trial.disk, nobody})) return;
  disk.position = p;
  disk.image_x = image_x;
  disk.image_y = image_y;
  grid_.move(trial.disk, p);
  ++counts.accepted_displacements;
}

void SwapTrials::swap(Trial const& trial, SwapCounts& counts) {
  double const radius = disks_[trial.disk].radius;
  double const other_radius = disks_[trial.other].radius;
  if (radius == other_radius) return;
  ++counts.swaps;
  // The disk that shrinks cannot overlap, and the contact distance of the two does not change.
  auto const [grows, shrinks] =
      radius < other_radius ? std::pair(trial.disk, trial.other) : std::pair(trial.other, trial.disk);
  if (!is_free({disks_[grows].position, std::max(radius, other_radius), grows, shrinks})) return;
  std::swap(disks_[grows].radius, disks_[shrinks].radius);
  ++counts.accepted_swaps;
}

bool SwapTrials::is_inside(Vector p, double radius) const {
  return (box_.is_periodic_x() || (p.x >= radius && p.x <= box_.width() - radius)) &&
         (box_.is_periodic_y() || (p.y >= radius && p.y <= box_.height() - radius));
}

inline bool SwapTrials::overlaps(Vector p, double radius, std::uint32_t j) const {
  double const contact = radius + disks_[j].radius;
  return squared_length(box_.displacement_inside(p, disks_[j].position)) < contact * contact;
}

bool SwapTrials::is_free(Room const& room) const {
  auto const& [p, radius, disk, other] = room;
  if (!is_inside(p, radius)) return false;
  double const cutoff = radius + largest_radius_;
  int const column = grid_.layout().column_of(p.x);
  int const row = grid_.layout().row_of(p.y);
  PackedGrid::LocalPoint const here = grid_.local(p, column, row);
  float const limit = static_cast<float>(cutoff * cutoff * limit_per_area_) + limit_error_;
  std::array<int, 3> const columns{grid_.column_left_of(column), column, grid_.column_right_of(column)};
  std::array<int, 3> const rows{grid_.row_below(row), row, grid_.row_above(row)};
  // A cell is at least as wide as the largest contact distance, so the 3×3 block is enough. In a box of one or two
  // columns a cell appears more than once, for its images. All positions are compared before any disk is read, so that
  // the processor does not wait for the memory of each.
  std::array<PackedGrid::Block const*, 9> around;
  std::uint64_t near = 0;
  std::uint32_t next = PackedGrid::none;
  for (std::size_t k = 0; k < around.size(); ++k) {
    PackedGrid::Block const& block = grid_.block_at(columns[k % 3], rows[k / 3]);
    PackedGrid::LocalPoint const seen = seen_from(here, k);
    around[k] = &block;
    near |= std::uint64_t{bits_of(PackedGrid::is_near(block, seen, limit))} << (PackedGrid::slots * k);
    next &= block.next;
  }
  // The loop does not end at the first overlap, because a processor cannot guess where that comes.
  bool is_taken = false;
  for (; near != 0; near &= near - 1) {
    auto const bit = static_cast<std::size_t>(std::countr_zero(near));
    std::uint32_t const j = around[bit / PackedGrid::slots]->agent[bit % PackedGrid::slots];
    is_taken |= (j != disk) & (j != other) & overlaps(p, radius, j);
  }
  if (is_taken || next == PackedGrid::none) return !is_taken;
  return is_free_in_further_blocks(around, room);
}

bool SwapTrials::is_free_in_further_blocks(std::array<PackedGrid::Block const*, 9> const& around,
                                           Room const& room) const {
  for (PackedGrid::Block const* block : around) {
    while (block->next != PackedGrid::none) {
      block = &grid_.next_of(*block);
      for (std::uint32_t s = 0; s < block->count; ++s) {
        std::uint32_t const j = block->agent[s];
        if (j != room.disk && j != room.other && overlaps(room.place, room.radius, j)) return false;
      }
    }
  }
  return true;
}

/// Returns a point relative to cell k of the 3×3 block around its own cell, row by row from below left.
PackedGrid::LocalPoint SwapTrials::seen_from(PackedGrid::LocalPoint here, std::size_t k) const {
  return {here.x - static_cast<float>(static_cast<int>(k % 3) - 1) * grid_.local_width(),
          here.y - static_cast<float>(static_cast<int>(k / 3) - 1) * grid_.local_height()};
}

}  // namespace gridlock
