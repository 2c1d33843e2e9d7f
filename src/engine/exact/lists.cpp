#include <algorithm>
#include <cmath>
#include <numbers>

#include "engine/exact/flight.hpp"

namespace gridlock::exact {

namespace {

/// Lists of neighbours are faster than cells where the mean number of disks in nine cells, times the square of the
/// packing fraction, is above this. Measured with equal disks and with mixtures of size ratio 1.4 to 10.
constexpr double candidates_for_lists = 4.5;
/// Least room around the place of a growing disk, in diameters of the smallest disk.
constexpr double min_room_of_growing = 0.02;
/// The room in a gas, in mean distances between disks.
constexpr double rooms_in_distance = 0.5;
/// Factor by which the radii may grow before the lists are renewed.
constexpr double growth_of_lists = 1.001;

double squared(double number) { return number * number; }

}  // namespace

double Flight::packing_fraction() const {
  double const mean_area = std::numbers::pi * mean_squared_radius_ * squared(growth_.scale.at_zero);
  return static_cast<double>(disks_in_box_) * mean_area / box_.area();
}

bool Flight::wants_lists() const {
  if (box_.is_oblique()) return true;
  if (lists_.wish != Lists::where_they_pay) return lists_.wish == Lists::always;
  double const candidates = disks_in_nine_cells(2.0 * largest_radius_ * growth_.scale.at_zero);
  return candidates * squared(packing_fraction()) >= candidates_for_lists;
}

/// Returns the room around a place: how far its disk may move from it, in x and in y. Disks leave a small room often, a
/// large one makes long lists; the numbers are a measured compromise, in root mean square diameters. Growing disks get
/// less room the shorter their epochs are.
double Flight::room_for_lists() const {
  double const diameter = 2.0 * std::sqrt(mean_squared_radius_) * growth_.scale.at_zero;
  double const room = (0.2 + std::max(0.0, 0.8 - packing_fraction())) * diameter;
  if (!is_growing()) return room;
  double const least = min_room_of_growing * 2.0 * smallest_radius_ * growth_.scale.at_zero;
  return std::clamp(room * epoch_length_ / longest_epoch_, least, std::max(room, least));
}

/// In an oblique box there are lists in a gas too, where disks fly far, and in a small box. Of two disks that touch,
/// each within the room around its place, the nearest image now must be the one that touches: a distance at contact and
/// four rooms are less than half a period.
double Flight::room_in_oblique_box(double max_scale) const {
  double const distance = std::sqrt(box_.area() / static_cast<double>(disks_in_box_));
  double const room = std::max(room_for_lists(), is_growing() ? 0.0 : rooms_in_distance * distance);
  return std::min(room, (box_.shortest_period() - 4.0 * largest_radius_ * max_scale) / 8.5);
}

/// Returns the distance from an edge of the box within which the place of a disk lies if the disk may meet another
/// across the edge: two disks in contact, each anywhere within `room` of its place.
double Flight::reach_with(double room, double scale) const { return 2.0 * largest_radius_ * scale + 5.0 * room; }

/// Returns whether a disk with this place meets no other across an edge of the box.
bool Flight::is_inside(Place const& place) const {
  double const margin = reach_with(lists_.room, lists_.max_scale);
  return place.x >= margin && place.x <= box_.width() - margin && place.y >= margin &&
         place.y <= box_.height() - margin;
}

void Flight::end_lists() {
  lists_.neighbours.clear();
  lists_.long_lists.clear();
  lists_.unused.clear();
  lists_.places.clear();
  lists_.room = 0.0;
  lists_.max_scale = 1.0;
}

/// Begins, renews or ends the use of lists, which an oblique box always has. Contract: all events are predicted anew.
void Flight::renew_lists(double time) {
  bool wants = wants_lists();
  double const scale = growth_.scale.at(epoch_length_);
  if (wants && has_lists() && scale <= lists_.max_scale) return;
  double const max_scale = is_growing() ? growth_of_lists * scale : 1.0;
  double const room = box_.is_oblique() && size_ > 0 ? room_in_oblique_box(max_scale) : room_for_lists();
  // Kernels read sixteen entries of a list at once, and each neighbour must have one image that is the nearest.
  double const min_side = 3.0 * reach_with(room, max_scale);
  wants &= box_.is_oblique() ? size_ > 0 : size_ >= 16 && box_.shortest_period() >= min_side;
  if (!wants) {
    if (has_lists()) size_classes_.clear();
    end_lists();
    return;
  }
  lists_.room = room;
  lists_.max_scale = max_scale;
  lists_.places.resize(size_);
  for (Index i = 0; i < size_; ++i) lists_.places[i] = place_of(disks_[i], gravity_, time);
  lay_cells_by_size();
  find_all_neighbours();
}

void Flight::find_all_neighbours() {
  lists_.long_lists.clear();
  lists_.unused.clear();
  lists_.neighbours.clear();
  lists_.neighbours.resize(size_, {});
  for (Index i = 0; i < size_; ++i) find_neighbours(i, false);
}

/// Writes the list of the disks that may touch i before one of the two leaves the room around its place; `tells_them`
/// also adds i to the lists of those disks.
void Flight::find_neighbours(Index i, bool tells_them) {
  std::span<Index const> const names = collect_neighbours(i);
  write_list(i, names);
  if (!tells_them) return;
  lists_.to_tell.assign(names.begin(), names.end());
  for (Index const j : lists_.to_tell) tell(j, i);
}

/// Returns the neighbours of disk i. Contract: use the result before the next call, which overwrites it.
std::span<Index const> Flight::collect_neighbours(Index i) {
  Place const place = lists_.places[i];
  double const rooms = 2.0 * lists_.room;
  std::vector<Index>& names = lists_.around;
  std::size_t count = 0;
  for_each_run_around({place.x, place.y}, radius_of(i), lists_.max_scale, rooms, [&](std::span<Index const> slots) {
    std::size_t const room = count + slots.size() + names_per_batch;
    if (names.size() < room) names.resize(2 * room);
    count += near_places_.collect(slots.data(), slots.size(), i, names.data() + count);
  });
  bool const is_oblique = box_.is_oblique();
  bool const is_inside_of_oblique = is_oblique && is_inside(place);
  PlacesAround const around{.places = lists_.places.data(),
                            .radius = radius_.empty() ? nullptr : radius_.data(),
                            .place = place,
                            .own_radius = radius_of(i),
                            .rooms = rooms,
                            // A factor above 1 covers the rounding of places and paths.
                            .scale = lists_.max_scale * (1.0 + 1e-9),
                            .period_x = box_.period_x(),
                            .period_y = box_.period_y(),
                            .has_images = box_.has_images() && !is_inside_of_oblique,
                            .lean = box_.shift()};
  auto const keep = is_oblique && !is_inside_of_oblique ? keep_in_oblique_box : near_places_.keep;
  return {names.data(), keep(around, names.data(), count)};
}

void Flight::write_list(Index i, std::span<Index const> names) {
  Neighbours& list = lists_.neighbours[i];
  auto const nobody = static_cast<Index>(size_);
  if (names.size() <= Neighbours::most) {
    if (!list.has_all()) lists_.unused.push_back(list.long_list());
    list.clear(nobody);
    std::ranges::copy(names, list.disks);
    list.count = static_cast<std::uint32_t>(names.size());
    return;
  }
  if (list.has_all()) {
    if (lists_.unused.empty()) {
      lists_.unused.push_back(static_cast<Index>(lists_.long_lists.size()));
      lists_.long_lists.emplace_back();
      prediction_input_.long_lists = lists_.long_lists.data();
    }
    list.refer_to(lists_.unused.back(), nobody);
    lists_.unused.pop_back();
  }
  LongList& long_list = lists_.long_lists[list.long_list()];
  // Reserved for half as many more, since neighbours are added and none removed until the list is full.
  long_list.reserve(names.size() + names.size() / 2);
  long_list.assign(names.begin(), names.end());
}

/// Adds disk i, which has come near, to the list of the disk `other`.
void Flight::tell(Index other, Index i) {
  Neighbours& list = lists_.neighbours[other];
  if (list.has_all()) {
    if (list.has(i)) return;
    if (list.count < Neighbours::most) {
      list.disks[list.count++] = i;
      return;
    }
  } else {
    LongList& names = lists_.long_lists[list.long_list()];
    if (std::ranges::find(names, i) != names.end()) return;
    if (names.size() < names.capacity()) {
      names.push_back(i);
      return;
    }
  }
  // A full list may hold disks that have left, so it is made anew.
  find_neighbours(other, false);
}

/// Gives a disk that has left the room around its place a new place, and renews the lists that change by it.
void Flight::take_new_place(Index i, double time) {
  lists_.places[i] = place_of(disks_[i], gravity_, time);
  move_to_cell(i, cell_of(i, time), time);
  find_neighbours(i, true);
}

}  // namespace gridlock::exact
