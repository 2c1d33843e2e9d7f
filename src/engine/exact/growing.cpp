#include <algorithm>
#include <cmath>
#include <numbers>

#include "engine/exact/dynamics.hpp"

namespace gridlock::exact {

namespace {

/// An epoch lasts for about as long as each disk is hit this often, where they are hit often.
constexpr double hits_in_epoch = 64.0;

/// Lists of neighbours pay where epochs are shorter than the longest by this factor: where disks are hit often on a short way.
constexpr double shortening_for_lists = 16.0;
/// The room around the place of a disk, in diameters of the smallest.
constexpr double room_in_diameters = 0.02;
/// By how much the disks may grow before the lists are renewed.
constexpr double growth_of_lists = 1.001;
/// Two disks each cross the room around their places, twice the room along each axis, at most.
constexpr double rooms_in_reach = 4.0 * std::numbers::sqrt2;

}  // namespace

void Dynamics::start_growing(GrowthOfRadii const& growth) {
  if (radius_.empty()) {
    radius_.assign(size_, equal_radius_);
    mass_.assign(size_, equal_mass_);
  }
  growth_.scale.rate = growth.rate;
  growth_.size_of_cells = growth.size_of_cells;
  growth_.largest_radius = size_ > 0 ? std::ranges::max(radius_) : 0.0;
  growth_.last_hit.assign(size_, 0.0);
  longest_epoch_ = longest_growing_epoch();
  epoch_length_ = longest_epoch_;
  make_room_in_cells();
}

/// In which a disk crosses two of the largest; from nothing but the motion, in the order of the Ids.
double Dynamics::longest_growing_epoch() const {
  double squared_speeds = 0.0;
  for (Index const i : disks_by_id_index()) {
    squared_speeds += disks_[i].velocity_x * disks_[i].velocity_x + disks_[i].velocity_y * disks_[i].velocity_y;
  }
  if (!(squared_speeds > 0.0)) return 0.0;
  double const diameter = 2.0 * growth_.largest_radius * growth_.scale.at_zero;
  return power_of_two_below(2.0 * diameter / std::sqrt(squared_speeds / static_cast<double>(size_)));
}

void Dynamics::renew(double factor_of_velocities) {
  double length = epoch_length_;
  std::uint64_t const hits = growth_.hits - growth_.hits_before_epoch;
  if (hits >= 2 * size_) {
    double const longer = hits_in_epoch * static_cast<double>(size_) / static_cast<double>(hits);
    double const duration = now_ * longer / factor_of_velocities;
    if (duration > 0.0) length = std::min(power_of_two_below(duration), longest_epoch_);
  }
  begin_growing_epoch(now_, length, factor_of_velocities);
}

void Dynamics::begin_growing_epoch(double zero, double length, double factor_of_velocities) {
  move_zero_of_time(zero);
  growth_.scale.move_zero(zero);
  growth_.measured_time += zero;
  growth_.hits_before_epoch = growth_.hits;
  std::ranges::fill(growth_.last_hit, 0.0);
  if (factor_of_velocities != 1.0) {
    for (std::size_t i = 0; i < size_; ++i) {
      disks_[i].velocity_x *= factor_of_velocities;
      disks_[i].velocity_y *= factor_of_velocities;
    }
  }
  longest_epoch_ = longest_growing_epoch();
  epoch_length_ = std::min(length, longest_epoch_);
  renew_neighbours();
  make_room_in_cells();
  refresh_prediction_input();
  predict_all(disks_by_id_index());
  start_epoch();
}

/// A cell must be as wide as the largest diameter at the end of the epoch, and hold the neighbours of a list in its block.
double Dynamics::side_of_cells() const {
  double const scale = growth_.room > 0.0 ? growth_.scale_of_lists : growth_.scale.at(epoch_length_);
  return 2.0 * growth_.largest_radius * scale + rooms_in_reach * growth_.room;
}

void Dynamics::make_room_in_cells() {
  double const side = side_of_cells() * growth_.size_of_cells;
  bool const has_room = box_.width() / grid_.columns() >= side && box_.height() / grid_.rows() >= side;
  if (has_room || size_ == 0) return;
  CellLayout const layout = layout_for_cutoff(box_, side, size_);
  if (layout.columns() != grid_.columns() || layout.rows() != grid_.rows()) lay_cells(layout);
}

/// Begins, renews or ends the use of lists, as the length of the epoch tells how dense the disks are.
void Dynamics::renew_neighbours() {
  bool const has_lists = !growth_.neighbours.empty();
  double const factor = has_lists ? 0.5 * shortening_for_lists : shortening_for_lists;
  bool const wants_lists = epoch_length_ * factor <= longest_epoch_;
  bool const is_crowded = std::ranges::any_of(growth_.neighbours, [](auto const& list) { return !list.has_all(); });
  double const scale = growth_.scale.at(epoch_length_);
  if (wants_lists && has_lists && !is_crowded && scale <= growth_.scale_of_lists) return;
  growth_.neighbours.clear();
  growth_.places.clear();
  growth_.room = 0.0;
  if (wants_lists) {
    growth_.room = room_in_diameters * 2.0 * std::ranges::min(radius_) * growth_.scale.at_zero;
    growth_.scale_of_lists = growth_of_lists * scale;
  }
  make_room_in_cells();
  // In fewer cells a side the nearest image of a disk may not be the one in the neighbouring cell.
  bool const has_images = !box_.is_periodic() || (grid_.columns() >= 5 && grid_.rows() >= 5);
  if (!wants_lists || !has_images) {
    growth_.room = 0.0;
    return;
  }
  growth_.places.resize(size_);
  for (Index i = 0; i < size_; ++i) growth_.places[i] = {disks_[i].x, disks_[i].y};
  find_all_neighbours();
}

void Dynamics::find_all_neighbours() {
  growth_.neighbours.assign(size_, Neighbours{});
  for (Index i = 0; i < size_; ++i) find_neighbours(i, false);
}

/// Those who may touch i before one of the two leaves the room around its place; `tells_them` puts i into their lists.
void Dynamics::find_neighbours(Index i, bool tells_them) {
  MovingDisk const& disk = disks_[i];
  Neighbours& list = growth_.neighbours[i];
  list.count = 0;
  double const now = std::max(now_, 0.0);
  for (std::int32_t row = disk.row - 1; row <= disk.row + 1; ++row) {
    Index const* const slots = grid_.slots_of(disk.column - 1, row);
    for (std::size_t k = 0; k < 3 * grid_.capacity(); ++k) {
      Index const j = slots[k];
      if (j == no_disk || j == i) continue;
      MovingDisk const& other = disks_[j];
      Vector const d = box_.displacement_inside({}, {(other.x - disk.x) + (other.velocity_x - disk.velocity_x) * now,
                                                     (other.y - disk.y) + (other.velocity_y - disk.velocity_y) * now});
      double const reach = (radius_[i] + radius_[j]) * growth_.scale_of_lists + rooms_in_reach * growth_.room;
      if (squared_length(d) > reach * reach) continue;
      list.add(j);
      if (tells_them && !growth_.neighbours[j].has(i)) growth_.neighbours[j].add(i);
    }
  }
}

/// A disk that has left the room around its place has other neighbours, and is one of theirs.
void Dynamics::take_new_place(Index i) {
  growth_.places[i] = {disks_[i].x + disks_[i].velocity_x * now_, disks_[i].y + disks_[i].velocity_y * now_};
  find_neighbours(i, true);
}

/// Contract: the zero of time is now, and all events are predicted anew.
void Dynamics::lay_cells(CellLayout const& layout) {
  grid_ = SlotGrid(layout, box_);
  auto const index_of = [](double place, double cells_per_length, std::int32_t count) {
    // A disk beyond the edge of a periodic box by rounding has not crossed it yet: it belongs to the last cell before.
    return static_cast<std::int32_t>(std::clamp(place * cells_per_length, 0.0, static_cast<double>(count - 1)));
  };
  for (Index i = 0; i < size_; ++i) {
    MovingDisk& disk = disks_[i];
    disk.column = index_of(disk.x, layout.columns_per_length(), layout.columns());
    disk.row = index_of(disk.y, layout.rows_per_length(), layout.rows());
    grid_.insert(i, disk.column, disk.row);
  }
}

/// The elastic rule in the frame in which the two rims rest: the velocity v along the line of centres becomes −v + 2a.
void Dynamics::collide_growing(Index i, Index j, Counters& counters) {
  MovingDisk& a = disks_[i];
  MovingDisk& b = disks_[j];
  double const w_x = b.velocity_x - a.velocity_x;
  double const w_y = b.velocity_y - a.velocity_y;
  auto const [d_x, d_y] = box_.displacement_inside({}, {(b.x - a.x) + w_x * now_, (b.y - a.y) + w_y * now_});
  double const sum = radius_[i] + radius_[j];
  double const contact = sum * growth_.scale.at(now_);
  double const growth = sum * growth_.scale.rate;
  double const squared_distance = d_x * d_x + d_y * d_y;
  double const approach = (w_x * d_x + w_y * d_y) - growth * contact;
  double const along = 2.0 * approach / ((mass_[i] + mass_[j]) * squared_distance);
  double const along_a = mass_[j] * along;
  double const along_b = mass_[i] * along;
  change_velocity(a, along_a * d_x, along_a * d_y, now_);
  change_velocity(b, -along_b * d_x, -along_b * d_y, now_);
  growth_.last_hit[i] = now_;
  growth_.last_hit[j] = now_;
  growth_.hits += 2;
  double const virial = -(mass_[i] * mass_[j]) * along * squared_distance;
  growth_.measured_virial += virial;
  ++counters.pair_collisions;
  counters.pair_virial += virial;
}

/// A disk that leaves a periodic box goes on with another coordinate, which is rounded anew: as if it had been hit, events
/// predicted before are void, so that it does not matter when others looked at it.
void Dynamics::hit_or_cross_growing(MovingDisk& disk, Index i, Counters& counters) {
  BorderEvent const event = border_event_growing(prediction_input_, i);
  Image const before = image_[i];
  if (event.border == Border::of_place) {
    take_new_place(i);
  } else if (event.border == Border::wall) {
    hit_wall_growing(disk, i, event.side, counters);
  } else if (event.side == Side::left || event.side == Side::right) {
    cross_vertical_border(disk, i, event.side == Side::right);
  } else {
    cross_horizontal_border(disk, i, event.side == Side::top);
  }
  if (image_[i].x == before.x && image_[i].y == before.y) return;
  ++disk.collision_count;
  if (growth_.places.empty()) return;
  growth_.places[i].x -= box_.width() * (image_[i].x - before.x);
  growth_.places[i].y -= box_.height() * (image_[i].y - before.y);
}

/// The wall rests, the rim comes to meet it: v becomes −v plus twice the speed of growth, inwards.
void Dynamics::hit_wall_growing(MovingDisk& disk, Index i, Side side, Counters& counters) {
  bool const is_vertical = side == Side::left || side == Side::right;
  double const inwards = side == Side::left || side == Side::bottom ? 1.0 : -1.0;
  double& velocity = is_vertical ? disk.velocity_x : disk.velocity_y;
  double& place = is_vertical ? disk.x : disk.y;
  double const change = 2.0 * (inwards * radius_[i] * growth_.scale.rate - velocity);
  velocity += change;
  place -= change * now_;
  ++disk.collision_count;
  growth_.last_hit[i] = now_;
  ++growth_.hits;
  auto const wall = static_cast<std::size_t>(side);  // in the order of Counters::Wall
  double const impulse = mass_[i] * std::abs(change);
  ++counters.wall_hits[wall];
  counters.wall_impulse[wall] += impulse;
  growth_.measured_virial += radius_[i] * growth_.scale.at(now_) * impulse;
}

void Dynamics::serialize_growth(Archive& archive) {
  std::vector<double> radius;
  std::vector<double> last_hit;
  std::vector<std::uint64_t> cells{static_cast<std::uint64_t>(grid_.columns()),
                                   static_cast<std::uint64_t>(grid_.rows())};
  std::vector<Index> const disks = disks_by_id_index();
  for (Index const i : disks) {
    radius.push_back(radius_[i]);
    last_hit.push_back(growth_.last_hit[i]);
  }
  archive.visit("radius", radius);
  archive.visit("last_hit", last_hit);
  archive.visit("cells", cells);
  archive.visit("growth_rate", growth_.scale.rate);
  archive.visit("scale", growth_.scale.at_zero);
  archive.visit("scale_rest", growth_.scale.rest);
  archive.visit("hits", growth_.hits);
  archive.visit("hits_before_epoch", growth_.hits_before_epoch);
  archive.visit("measured_time", growth_.measured_time);
  archive.visit("measured_virial", growth_.measured_virial);
  serialize_places(archive, disks);
  if (!archive.is_restoring()) return;
  archive.require(radius.size() == size_ && last_hit.size() == size_, "the engine has other disks than the state");
  for (std::size_t id_index = 0; id_index < size_; ++id_index) {
    archive.require(radius[id_index] > 0.0 && std::isfinite(last_hit[id_index]), "a disk cannot be so");
    radius_[disks[id_index]] = radius[id_index];
    growth_.last_hit[disks[id_index]] = last_hit[id_index];
  }
  growth_.largest_radius = std::ranges::max(radius_);
  archive.require(growth_.scale.rate > 0.0 && growth_.scale.at_zero >= 1.0, "the disks do not grow");
  restore_cells(archive, cells);
}

/// The lists are found again; when disks leave their places is seen in the number of events.
void Dynamics::serialize_places(Archive& archive, std::vector<Index> const& disks) {
  std::vector<double> x;
  std::vector<double> y;
  if (!growth_.places.empty()) {
    for (Index const i : disks) {
      x.push_back(growth_.places[i].x);
      y.push_back(growth_.places[i].y);
    }
  }
  archive.visit("place_x", x);
  archive.visit("place_y", y);
  archive.visit("room", growth_.room);
  archive.visit("scale_of_lists", growth_.scale_of_lists);
  if (!archive.is_restoring()) return;
  archive.require(x.size() == y.size() && (x.size() == size_ || (x.empty() && growth_.room == 0.0)),
                  "the engine has other disks than the state");
  growth_.places.resize(x.size());
  for (std::size_t id_index = 0; id_index < x.size(); ++id_index)
    growth_.places[disks[id_index]] = {x[id_index], y[id_index]};
}

/// The cells that the saved disks are in.
void Dynamics::restore_cells(Archive const& archive, std::vector<std::uint64_t> const& cells) {
  constexpr std::uint64_t most = 46340;
  archive.require(cells.size() == 2 && cells[0] >= 1 && cells[1] >= 1 && cells[0] <= most && cells[1] <= most,
                  "these cells cannot be");
  lay_cells(CellLayout(box_, cells[0], cells[1]));
  double const side = side_of_cells();
  archive.require((cells[0] == 1 || box_.width() / grid_.columns() >= side) &&
                      (cells[1] == 1 || box_.height() / grid_.rows() >= side),
                  "the cells are smaller than the disks");
}

}  // namespace gridlock::exact
