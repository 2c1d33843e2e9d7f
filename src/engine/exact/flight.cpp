#include "engine/exact/flight.hpp"

#include <algorithm>
#include <array>
#include <numeric>
#include <span>
#include <utility>

#include "engine/exact/candidates.hpp"
#include "engine/exact/near_pairs.hpp"

namespace gridlock::exact {

namespace {

/// Largest size in bytes of the records of all disks that stay in the first cache without prefetching.
constexpr std::size_t largest_in_first_cache = std::size_t{3} << 16;
/// Largest size in bytes of disks, cells and lists in the second or third cache, prefetched shortly before an event.
constexpr std::size_t largest_found_in_time = std::size_t{5} << 20;

/// Applies a permutation in place: element i moves to index new_place[i].
template <class Array>
void permute(Array& values, std::vector<Index> new_place) {
  for (Index i = 0; i < new_place.size(); ++i) {
    while (new_place[i] != i) {
      Index const place = new_place[i];
      std::swap(values[i], values[place]);
      std::swap(new_place[i], new_place[place]);
    }
  }
}

}  // namespace

void Flight::take_part(Flight const& whole, std::span<Index const> disks) {
  size_ = disks.size();
  disks_.clear();
  image_.clear();
  radius_.clear();
  mass_.clear();
  disks_.reserve(size_ + 1);
  image_.reserve(size_);
  for (Index const i : disks) {
    disks_.push_back(whole.disks_[i]);
    image_.push_back(whole.image_[i]);
    if (whole.radius_.empty()) continue;
    radius_.push_back(whole.radius_[i]);
    mass_.push_back(whole.mass_[i]);
  }
  disks_.push_back(whole.disks_[whole.size_]);
  if (!whole.radius_.empty()) radius_.push_back(whole.radius_[whole.size_]);
  equal_radius_ = whole.equal_radius_;
  equal_mass_ = whole.equal_mass_;
  now_ = whole.now_;
  epoch_length_ = whole.epoch_length_;
  longest_epoch_ = whole.longest_epoch_;
  disks_in_box_ = whole.disks_in_box_;
  size_of_cells_ = whole.size_of_cells_;
  smallest_radius_ = whole.smallest_radius_;
  largest_radius_ = whole.largest_radius_;
  mean_squared_radius_ = whole.mean_squared_radius_;
  lists_.wish = whole.lists_.wish;
  growth_ = whole.growth_;
  gravity_ = whole.gravity_;
  losses_ = whole.losses_;
  kind_.clear();
  for (Index const i : disks) {
    if (!whole.kind_.empty()) kind_.push_back(whole.kind_[i]);
  }
  obstacles_ = whole.obstacles_;
  pipeline_.clear();
}

/// Predicts the event of every disk. No disk may wait for an event yet; their order does not matter. Of two disks that
/// touch first, each predicts the collision, and the first of the two events serves both.
void Flight::predict_all(double time) {
  // Lists may name a disk whose list does not name them, and then each disk finds its own event.
  if (time == 0.0 && !is_growing() && !has_lists() && has_room_for_registers(prediction_input_)) {
    predict_all_at_zero();
    return;
  }
  LargeArray<double> times(size_);
  for (Index i = 0; i < size_; ++i) disks_[i].event_time = never;
  for (Index i = 0; i < size_; ++i) {
    Prediction const first = predictor_.one(prediction_input_, i, time);
    times[i] = first.time;
    disks_[i].partner = first.partner;
  }
  for (Index i = 0; i < size_; ++i) disks_[i].event_time = times[i];
  complete_predictions(time);
}

/// The same at the start of an epoch, when no disk has been hit, from cells: each pair is looked at once for both its
/// disks.
void Flight::predict_all_at_zero() {
  PredictionInput const& s = prediction_input_;
  NearPairs const near = near_pairs_for(target(), s);
  for (Index i = 0; i < size_; ++i) {
    Prediction const border = predict_border(s, i, 0.0);
    disks_[i].event_time = border.time;
    disks_[i].partner = border.partner;
  }
  auto const offer = [&](Index i, Index j, double time) {
    MovingDisk& disk = disks_[i];
    Prediction const first = earlier_of({disk.event_time, disk.partner}, time, 1U, &j, disks_.data());
    disk.event_time = first.time;
    disk.partner = first.partner;
  };
  Pairs pairs;
  for (Index next = 0; next < size_; pairs.count = 0) {
    next = near.add(s, next, static_cast<Index>(size_), pairs);
    std::fill_n(&pairs.one[pairs.count], Pairs::slack, s.nobody);
    std::fill_n(&pairs.other[pairs.count], Pairs::slack, s.nobody);
    near.find_times(s, pairs);
    std::size_t touching = 0;
    for (std::size_t k = 0; k < pairs.count; ++k) {
      pairs.one[touching] = pairs.one[k];
      pairs.other[touching] = pairs.other[k];
      pairs.times[touching] = pairs.times[k];
      touching += pairs.times[k] < never ? 1 : 0;
    }
    for (std::size_t k = 0; k < touching; ++k) {
      offer(pairs.one[k], pairs.other[k], pairs.times[k]);
      offer(pairs.other[k], pairs.one[k], pairs.times[k]);
    }
  }
  complete_predictions(0.0);
}

/// Adds the hits of obstacles, and the counts that tell whether a prediction is void.
void Flight::complete_predictions(double time) {
  for (Index i = 0; i < size_; ++i) {
    MovingDisk& disk = disks_[i];
    if (obstacles_ != nullptr) [[unlikely]] {
      Prediction const first = first_of_obstacles(i, {disk.event_time, disk.partner}, time);
      disk.event_time = first.time;
      disk.partner = first.partner;
    }
    if (disk.partner < first_obstacle) disk.partner_collision_count = disks_[disk.partner].collision_count;
  }
}

void Flight::refresh_prediction_input() {
  SlotGrid const& grid = size_classes_.front().grid;
  prediction_input_ = {.disks = disks_.data(),
                       .nobody = static_cast<Index>(size_),
                       .cells = cells_.data(),
                       .radius = radius_.empty() ? nullptr : radius_.data(),
                       .equal_radius = equal_radius_,
                       .mass = mass_.empty() ? nullptr : mass_.data(),
                       .slots = grid.slots(),
                       .row_stride = grid.row_stride(),
                       .capacity = grid.capacity(),
                       .column_limits = grid.column_limits(),
                       .row_limits = grid.row_limits(),
                       .columns = grid.columns(),
                       .rows = grid.rows(),
                       .width = box_.width(),
                       .height = box_.height(),
                       .period_x = box_.period_x(),
                       .period_y = box_.period_y(),
                       .walls = {box_.is_periodic_x() ? 0.0 : 1.0, box_.is_periodic_y() ? 0.0 : 1.0},
                       .has_images = box_.has_images(),
                       .has_walls = box_.has_walls(),
                       .falls = falls(),
                       .gravity = gravity_,
                       .scale = growth_.scale,
                       .neighbours = has_lists() ? lists_.neighbours.data() : nullptr,
                       .long_lists = lists_.long_lists.data(),
                       .places = has_lists() ? lists_.places.data() : nullptr,
                       .room = lists_.room,
                       .margin = reach_with(lists_.room, lists_.max_scale),
                       .lean = box_.shift()};
  predictor_ = fastest_predictor(prediction_input_);
}

void Flight::open_calendar() {
  calendar_.open(epoch_length_, expected_events_, size_);
  for (Index i = 0; i < size_; ++i) calendar_.add(disks_[i].event_time, i, disks_.data());
}

/// Chooses how far ahead memory is prefetched. Contract: it is decided whether there are lists.
void Flight::choose_fetching() {
  std::size_t const of_lists = has_lists() ? sizeof(Neighbours) + sizeof(Place) : 0;
  std::size_t const of_mixture = radius_.empty() ? 0 : 2 * sizeof(double);
  std::size_t const of_disk = sizeof(MovingDisk) + sizeof(Cell) + of_lists + of_mixture;
  fetching_ = size_ * sizeof(MovingDisk) <= largest_in_first_cache ? Fetching::nothing
              : size_ * of_disk <= largest_found_in_time           ? Fetching::near
                                                                   : Fetching::far;
}

/// Sorts disks by cell, so that a prediction finds its candidates in few cache lines and pages. The trajectory does not
/// depend on the order.
/// Contract: all events are predicted anew.
void Flight::sort_disks_by_cell(double time) {
  // The last grid has the smallest cells; it sorts disks of all sizes.
  SlotGrid const& grid = size_classes_.back().grid;
  auto const columns = static_cast<std::size_t>(grid.columns());
  std::vector<Index> begin_of_cell(columns * static_cast<std::size_t>(grid.rows()) + 1, 0);
  std::vector<Index> new_name(size_);
  for (Index i = 0; i < size_; ++i) {
    Cell const cell = grid.cell_of_image(position_at(i, time));
    new_name[i] =
        static_cast<Index>(static_cast<std::size_t>(cell.row) * columns + static_cast<std::size_t>(cell.column));
    ++begin_of_cell[new_name[i] + 1];
  }
  std::partial_sum(begin_of_cell.begin(), begin_of_cell.end(), begin_of_cell.begin());
  for (Index& name : new_name) name = begin_of_cell[name]++;
  for (SizeClass& like_disks : size_classes_) like_disks.grid.rename(new_name);
  if (!radius_.empty()) {
    permute(radius_, new_name);
    permute(mass_, new_name);
  }
  permute(image_, new_name);
  if (!kind_.empty()) permute(kind_, new_name);
  if (!last_contact_.empty()) permute(last_contact_, new_name);
  permute(cells_, new_name);
  if (has_lists()) permute(lists_.places, new_name);
  permute(disks_, std::move(new_name));  // the last use of new_name
  if (has_lists()) find_all_neighbours();
}

/// Adds the disks of a coming bucket to the pipeline and moves it on twice for each event handled.
void Flight::fetch_far() {
  constexpr std::uint32_t buckets_ahead = 2;
  constexpr std::uint64_t max_waiting = 48;
  if (calendar_.open_bucket() != seen_bucket_) {
    seen_bucket_ = calendar_.open_bucket();
    std::uint64_t entered = 0;
    calendar_.for_each_ahead(buckets_ahead, [&](Index i, double time) {
      if (++entered <= max_waiting) pipeline_.enter(i, time);
    });
  }
  auto const grid_of_disk = [this](Index i) -> SlotGrid const& { return grid_of(i); };
  do {
    pipeline_.step(prediction_input_, grid_of_disk, size_);
    pipeline_.step(prediction_input_, grid_of_disk, size_);
  } while (pipeline_.waiting() > max_waiting);
}

/// Prefetches the memory of the next events, one to four ahead. Disks around are prefetched only from lists: cells may
/// hold so many that they would evict each other from the cache.
void Flight::fetch_near() {
  PredictionInput const& s = prediction_input_;
  // A border has no partner: the last disk is prefetched instead of it, which is cheaper than a branch.
  auto const with_partner = [this](Index i) {
    return std::array{i, std::min(disks_[i].partner, static_cast<Index>(size_ - 1))};
  };
  if (Index const later = calendar_.disk_after_next(3); later != no_disk) {
    for (Index const i : with_partner(later)) {
      prefetch_near(&disks_[i]);
      if (s.neighbours != nullptr) {
        prefetch_near(&s.neighbours[i]);
        prefetch_near(&s.places[i]);
      } else {
        prefetch_near(&cells_[i]);
      }
    }
  }
  Index const soon = calendar_.disk_after_next(1);
  if (soon == no_disk) return;
  for (Index const i : with_partner(soon)) {
    if (s.neighbours != nullptr) {
      for (std::size_t k = 0; k < batch; ++k) prefetch_near(&disks_[s.neighbours[i].disks[k]]);
    } else {
      Index const* run = first_slot_around(s, i);
      for (int row = 0; row < 3; ++row, run += s.row_stride) prefetch_near(run);
    }
  }
}

void Flight::cross_into_next_cell(Index i, Side side) {
  SlotGrid const& grid = size_classes_.front().grid;
  Cell cell = cells_[i];
  auto const next = [](std::int32_t index, std::int32_t step, std::int32_t count) {
    return index + step == count ? 0 : index + step < 0 ? count - 1 : index + step;
  };
  if (side == Side::left || side == Side::right) {
    cell.column = next(cell.column, side == Side::right ? 1 : -1, grid.columns());
  } else {
    cell.row = next(cell.row, side == Side::top ? 1 : -1, grid.rows());
  }
  move_to_cell(i, cell, now_);
}

/// Moves a disk across the edge of a periodic box. Its new coordinate is rounded, so events predicted before are made
/// void, as by a hit: the trajectory then does not depend on when other disks predicted theirs.
void Flight::cross_edge(Index i, Side side) {
  MovingDisk& disk = disks_[i];
  std::int32_t const across = side == Side::right || side == Side::top ? 1 : -1;
  bool const is_vertical = side == Side::left || side == Side::right;
  double const shift = -across * (is_vertical ? box_.width() : box_.height());
  (is_vertical ? disk.x : disk.y) += shift;
  (is_vertical ? image_[i].x : image_[i].y) += across;
  ++disk.collision_count;
  if (has_lists()) (is_vertical ? lists_.places[i].x : lists_.places[i].y) += shift;
  if (box_.is_oblique() && !is_vertical) move_sideways(i, -across * box_.shift());
}

/// Moves a disk that has crossed the lower or the upper edge of an oblique box along x to its image in the box.
/// Contract: there are lists.
void Flight::move_sideways(Index i, double shift) {
  double const x = position_at(i, now_).x + shift;
  std::int32_t const across = x >= box_.width() ? 1 : x < 0.0 ? -1 : 0;
  shift -= across * box_.width();
  disks_[i].x += shift;
  lists_.places[i].x += shift;
  image_[i].x += across;
}

void Flight::report_collision(Index i, Index j, Vector separation, double impulse_per_length) const {
  (*reporting_.report)({.time = reporting_.start + elapsed_at_last_event(),
                        .i = disks_[i].id_index,
                        .j = disks_[j].id_index,
                        .separation = separation,
                        .velocity_i = velocity_at(disks_[i], gravity_, now_),
                        .velocity_j = velocity_at(disks_[j], gravity_, now_),
                        .mass_i = mass_of(i),
                        .mass_j = mass_of(j),
                        .impulse = impulse_per_length * separation});
}

std::vector<Index> Flight::disks_by_id_index() const {
  std::vector<Index> disks(size_);
  for (Index i = 0; i < size_; ++i) disks[disks_[i].id_index] = i;
  return disks;
}

}  // namespace gridlock::exact
