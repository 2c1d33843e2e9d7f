#include "engine/exact/strips.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

namespace gridlock::exact {

namespace {

/// Hits of each disk in a window. In longer windows errors of copies spread further; in shorter ones renewing costs
/// more.
constexpr double window_hits = 3.0;
/// The depth to which errors of copies spread: some diameters at once, and more diameters and mean free paths for each
/// hit. Measured are 4 + 1.2 per hit at φ = .70 and .85, and 3.5 + 2.2 at .30, where a mean free path is half a
/// diameter.
constexpr double diameters_at_once = 3.0;
constexpr double diameters_per_hit = 1.2;
constexpr double paths_per_hit = 2.4;
/// The distance within which disks on both sides of a border may meet in a window, in diameters and in mean free paths.
constexpr double diameters_checked = 1.5;
constexpr double paths_in_window = 11.0;
/// The distance that disks move in an epoch, in mean free paths.
constexpr double paths_in_epoch = 17.0;
/// The cost of sharing relative to that of the disks' flight: copying records, comparing, waiting.
constexpr double cost_of_sharing = 0.12;
/// Least speed-up over one thread at which strips are used.
constexpr double min_gain = 1.42;
/// Least height of a strip, in depths of its copies, so that only adjacent strips meet and share a disk at most once.
constexpr double min_height = 2.0;

/// Compares the bits of two motions: −0 is not 0.
bool is_same_motion(MovingDisk const& a, MovingDisk const& b) {
  auto const bits_of = [](MovingDisk const& disk) {
    return std::bit_cast<std::array<std::uint64_t, 5>>(
        std::array{disk.x, disk.y, disk.velocity_x, disk.velocity_y, disk.last_hit});
  };
  return bits_of(a) == bits_of(b);
}

/// Merges the events counted in one strip into those of other strips, in the order of time.
void merge(std::vector<Strip::Counted>& merged, std::span<Strip::Counted const> more) {
  if (more.empty()) return;
  std::vector<Strip::Counted> before;
  before.swap(merged);
  merged.resize(before.size() + more.size());
  Strip::Counted* out = merged.data();
  Strip::Counted const* a = before.data();
  Strip::Counted const* b = more.data();
  Strip::Counted const* const end_of_a = a + before.size();
  Strip::Counted const* const end_of_b = b + more.size();
  while (a != end_of_a && b != end_of_b) {
    // Chosen without a branch, because a processor cannot guess which event is first.
    bool const is_a = a->time < b->time;
    *out++ = *(is_a ? a : b);
    a += is_a ? 1 : 0;
    b += is_a ? 0 : 1;
  }
  out = std::copy(a, end_of_a, out);
  std::copy(b, end_of_b, out);
}

std::size_t strip_at(double y, double height, std::size_t strips) {
  double const index = std::clamp(y / height, 0.0, 1.0) * static_cast<double>(strips);
  return std::min(static_cast<std::size_t>(index), strips - 1);
}

}  // namespace

double Strip::height_of(Index i, double time) const {
  double const height = disks_[i].y + disks_[i].velocity_y * time - middle_;
  double const down = height > 0.5 * period_ ? -period_ : 0.0;
  return height + (height < -0.5 * period_ ? period_ : down);
}

/// The distance of a copy from the heights that the disks of the strip had when the window began.
double Strip::depth_of(Index copy, double time) const {
  double const height = height_of(copy, time);
  return std::max(height - extent_.highest, extent_.lowest - height);
}

void Strip::copy(Flight const& whole, Index i) {
  MovingDisk const& disk = whole.disks_[original_[i]];
  std::uint32_t const count = disks_[i].collision_count + 1;
  disks_[i] = disk;
  disks_[i].collision_count = count;  // predictions of a collision with the copy become void
  disks_[i].partner = vertical_border;
  disks_[i].event_time = never;
}

void Strip::load(Flight const& whole, StripPlan const& plan, std::size_t self, double time,
                 std::vector<std::uint16_t>& owner, std::vector<Index>& place) {
  plan_ = plan;
  double const height = box_.height() / static_cast<double>(plan.count);
  middle_ = (static_cast<double>(self) + 0.5) * height;
  period_ = box_.period_y();
  double const deepest = 0.5 * height + plan.reach + plan.margin;
  original_.clear();
  std::vector<Index> copies;
  for (Index i = 0; i < whole.size_; ++i) {
    MovingDisk const& disk = whole.disks_[i];
    double const y = disk.y + disk.velocity_y * time;
    if (strip_at(y, box_.height(), plan.count) == self) {
      owner[i] = static_cast<std::uint16_t>(self);
      place[i] = static_cast<Index>(original_.size());
      original_.push_back(i);
      continue;
    }
    double const off = std::abs(y - middle_);
    if (std::min(off, std::abs(period_ - off)) <= deepest) copies.push_back(i);
  }
  own_ = original_.size();
  original_.insert(original_.end(), copies.begin(), copies.end());
  take_part(whole, original_);
  extent_ = {};
  marks_.assign(size_, 0);
  heights_.resize(own_);
  double const hair = 1e-6 * plan.checked;  // heights are rounded: a strip marks no disk that the strip beside lacks
  for (Index i = 0; i < own_; ++i) {
    double const y = height_of(i, time);
    heights_[i] = y;
    extent_.include(y);
    bool const is_copied_below = std::abs(y + height) <= deepest - hair;
    bool const is_copied_above = std::abs(y - height) <= deepest - hair;
    marks_[i] = static_cast<std::uint8_t>((is_copied_below ? copied_below : 0) | (is_copied_above ? copied_above : 0));
  }
  end_lists();
  size_classes_.clear();
  renew_lists(time);
  make_room_in_cells(time);
  choose_fetching();
  refresh_prediction_input();
  predict_all(time);
  // No disk has flown yet, so the copies beyond `reach` are still right; the first window uses them too.
  expected_events_ = static_cast<std::uint64_t>(static_cast<double>(whole.expected_events_) *
                                                (static_cast<double>(size_) / static_cast<double>(whole.size_)));
  open_calendar();
}

void Strip::prepare(Flight const& whole, Extent const& below, Extent const& above, double time) {
  double const hair = 1e-6 * plan_.checked;
  been_ = {};
  lowest_unchecked_ = never;
  highest_unchecked_ = -never;
  for (Index i = 0; i < own_; ++i) {
    double const height = heights_[i];
    bool const is_near_below = (marks_[i] & copied_below) != 0 && height <= below.highest + plan_.checked - hair;
    bool const is_near_above = (marks_[i] & copied_above) != 0 && height >= above.lowest - plan_.checked + hair;
    marks_[i] = static_cast<std::uint8_t>((marks_[i] & (copied_below | copied_above)) |
                                          (is_near_below ? checked_below : 0) | (is_near_above ? checked_above : 0));
    note(i, height);
  }
  renew_copies(whole, time);
  is_wrong_ = false;
  for (std::vector<Counted>& counted : counted_) counted.clear();
  moves_ = 0;
  own_hits_ = 0;
  last_event_ = -never;
}

/// Replaces copies that have gone wrong by their originals.
void Strip::renew_copies(Flight const& whole, double time) {
  renewed_.clear();
  for (auto i = static_cast<Index>(own_); i < size_; ++i) {
    bool const is_lost = disks_[i].event_time == -never;
    if (is_lost || !is_same_motion(disks_[i], whole.disks_[original_[i]])) {
      copy(whole, i);
      renewed_.push_back(i);
    }
    double const depth = depth_of(i, time);
    marks_[i] = depth <= plan_.checked ? is_checked : 0;
    if (depth > plan_.reach) disks_[i].event_time = -never;
  }
  for (Index const i : renewed_) {
    if (has_lists()) lists_.places[i] = place_of(disks_[i], gravity_, time);
    move_to_cell(i, cell_of(i, time), time);
  }
  for (Index const i : renewed_) {
    if (disks_[i].event_time == -never) continue;
    if (has_lists()) find_neighbours(i, true);
    schedule(i, predictor_.one(prediction_input_, i, time));
  }
}

void Strip::note(Index i, double height) {
  been_.include(height);
  if ((marks_[i] & checked_below) == 0) lowest_unchecked_ = std::min(lowest_unchecked_, height);
  if ((marks_[i] & checked_above) == 0) highest_unchecked_ = std::max(highest_unchecked_, height);
}

struct Strip::Observer {
  Strip& strip;

  [[nodiscard]] bool is_own(Index i) const { return i < strip.own_; }
  void count_hit(Index i, std::size_t kind, double amount) {
    if (!is_own(i)) return;
    ++strip.own_hits_;
    strip.counted_[kind].push_back({strip.now_, amount});
  }

  void pair_collided(Index i, Index j, double virial) {
    bool const is_i_own = is_own(i);
    bool const is_j_own = is_own(j);
    if (!is_i_own && !is_j_own) return;
    if (is_i_own && is_j_own) {
      strip.note(i, strip.height_of(i, strip.now_));
      strip.note(j, strip.height_of(j, strip.now_));
      strip.own_hits_ += 2;
      strip.counted_[0].push_back({strip.now_, virial});
      return;
    }
    Index const own = is_i_own ? i : j;
    Index const copy = is_i_own ? j : i;
    if ((strip.marks_[copy] & is_checked) == 0) strip.is_wrong_ = true;
    strip.note(own, strip.height_of(own, strip.now_));
    ++strip.own_hits_;
    // Two strips see this collision; the one that owns the lower Id counts it.
    if (strip.disks_[own].id_index < strip.disks_[copy].id_index) strip.counted_[0].push_back({strip.now_, virial});
  }
  void wall_hit(Index i, Side wall, double impulse) { count_hit(i, 1 + static_cast<std::size_t>(wall), impulse); }
  void fixed_disk_hit(Index i, double virial) { count_hit(i, 0, virial); }
  void inner_wall_hit(Index i, double impulse) { count_hit(i, kinds_of_counts - 1, impulse); }
  void border_reached(Index i) {
    if (is_own(i)) strip.note(i, strip.height_of(i, strip.now_));
  }
};

void Strip::fly(double start, double end) {
  end_ = end;
  Observer observer{*this};
  // Largest number of events of a strip in a window: disks that collide without end are left to one thread.
  std::uint64_t const max_events = 1000 * size_ + 100'000;
  double const narrowing = end > start ? (plan_.reach - plan_.flown) / (end - start) : 0.0;
  for (std::uint64_t events = 0; !is_wrong_; ++events) {
    ScheduledEvent const* const next = next_event();
    if (next == nullptr || next->time > end) break;
    Index const i = take(next).disk;
    if (events > max_events) is_wrong_ = true;
    if (i < own_) {
      ++moves_;
      last_event_ = now_;
    } else if ((marks_[i] & is_checked) == 0 && depth_of(i, now_) > plan_.flown + narrowing * (end - now_)) {
      // The copy is too far away to matter before the end of the window.
      disks_[i].event_time = -never;
      continue;
    }
    handle<false>(i, observer);
  }
}

bool Strip::agrees_with(std::vector<Strip> const& strips, std::vector<std::uint16_t> const& owner,
                        std::vector<Index> const& place) {
  extent_ = {};
  for (Index i = 0; i < own_; ++i) {
    heights_[i] = height_of(i, end_);
    note(i, heights_[i]);
    extent_.include(heights_[i]);
  }
  slack_ = never;
  for (auto i = static_cast<Index>(own_); i < size_; ++i) {
    Index const original = original_[i];
    if (is_same_motion(disks_[i], strips[owner[original]].disks_[place[original]])) continue;
    if ((marks_[i] & is_checked) != 0) is_wrong_ = true;
    slack_ = std::min(slack_, depth_of(i, end_) - plan_.checked);
  }
  return !is_wrong_;
}

std::span<Strip::Counted const> Strip::counted(std::size_t kind, double start, double end) const {
  std::span<Counted const> const all = counted_[kind];
  auto const first = std::ranges::lower_bound(all, start, {}, &Counted::time);
  auto const last = std::ranges::lower_bound(first, all.end(), end, {}, &Counted::time);
  return all.subspan(static_cast<std::size_t>(first - all.begin()), static_cast<std::size_t>(last - first));
}

void Strip::hand_over(Flight& whole) const {
  for (Index i = 0; i < own_; ++i) {
    whole.disks_[original_[i]] = disks_[i];
    whole.image_[original_[i]] = image_[i];
  }
}

StripPlan Strips::plan(Flight const& whole, std::size_t threads, double hits_per_time, double caution,
                       bool wherever_possible) {
  double squared_speeds = 0.0;
  for (Index i = 0; i < whole.size_; ++i) {
    MovingDisk const& disk = whole.disks_[i];
    squared_speeds += disk.velocity_x * disk.velocity_x + disk.velocity_y * disk.velocity_y;
  }
  double const diameter = 2.0 * whole.largest_radius_;
  double const path = std::sqrt(squared_speeds / static_cast<double>(whole.size_)) / hits_per_time;
  StripPlan plan{.count = 0,
                 .window = window_hits / hits_per_time,
                 .checked = caution * (diameters_checked * diameter + paths_in_window * path),
                 .reach = 0.0,
                 .margin = diameter + paths_in_epoch * path};
  double const spread = caution * window_hits * (diameters_per_hit * diameter + paths_per_hit * path);
  plan.flown = plan.checked + caution * diameters_at_once * diameter;
  plan.reach = plan.flown + spread;
  double best_gain = 1.0;
  for (std::size_t count = 2; count <= std::min<std::size_t>(threads, 1024); ++count) {
    double const height = whole.box_.height() / static_cast<double>(count);
    if (height < min_height * (plan.reach + plan.margin)) break;
    double const copies = 2.0 * plan.flown + spread;
    double const gain = static_cast<double>(count) / (1.0 + cost_of_sharing + copies / height);
    if (gain > best_gain && (gain >= min_gain || wherever_possible)) {
      best_gain = gain;
      plan.count = count;
    }
  }
  return plan;
}

void Strips::begin(Flight const& whole, StripPlan const& plan, double time) {
  plan_ = plan;
  time_ = time;
  contact_ = 2.0 * whole.largest_radius_;
  height_ = whole.box_.height();
  is_periodic_ = whole.box_.is_periodic_y();
  owner_.resize(whole.size_);
  place_.resize(whole.size_);
  while (strips_.size() > plan.count) strips_.pop_back();
  while (strips_.size() < plan.count) strips_.emplace_back(whole.box_);
  threads_.for_each(plan.count, [&](std::size_t k) { strips_[k].load(whole, plan, k, time, owner_, place_); });
}

bool Strips::fly(Flight& whole, double end, Counters& counters) {
  std::size_t const count = strips_.size();
  double const height = height_ / static_cast<double>(count);
  std::vector<Extent> extents;
  for (Strip const& strip : strips_) extents.push_back(strip.extent());
  auto const seen_from = [&](std::size_t k, double middles_apart) {
    return Extent{extents[k].lowest + middles_apart, extents[k].highest + middles_apart};
  };
  constexpr Extent nobody{};
  threads_.for_each(count, [&](std::size_t k) {
    bool const has_below = is_periodic_ || k > 0;
    bool const has_above = is_periodic_ || k + 1 < count;
    Extent const below = has_below ? seen_from((k + count - 1) % count, -height) : nobody;
    Extent const above = has_above ? seen_from((k + 1) % count, height) : nobody;
    strips_[k].prepare(whole, below, above, time_);
    strips_[k].fly(time_, end);
  });
  std::vector<std::uint8_t> is_good(count, 0);
  threads_.for_each(count, [&](std::size_t k) {
    is_good[k] = static_cast<std::uint8_t>(strips_[k].agrees_with(strips_, owner_, place_));
  });
  for (std::size_t k = 0; k < count; ++k) {
    if (is_good[k] == 0) return false;
    if ((is_periodic_ || k + 1 < count) && !are_apart(k, (k + 1) % count)) return false;
  }
  if (!count_window(time_, end, counters)) return false;
  threads_.for_each(count, [&](std::size_t k) { strips_[k].hand_over(whole); });
  time_ = end;
  return true;
}

/// Returns whether uncompared disks of two adjacent strips were too far apart to meet, and whether no disk moved so far
/// that it could have met disks of a strip further away.
bool Strips::are_apart(std::size_t below, std::size_t above) const {
  double const height = height_ / static_cast<double>(strips_.size());
  Strip const& lower = strips_[below];
  Strip const& upper = strips_[above];
  bool const stays = lower.been().highest < height - contact_ && upper.been().lowest > contact_ - height;
  return stays && lower.been().highest + contact_ < upper.lowest_unchecked() + height &&
         lower.highest_unchecked() + contact_ < upper.been().lowest + height;
}

/// Adds the events of the window to the counters in the order of time, as one thread would, because sums depend on the
/// order by rounding. Returns false for events at exactly the same time: one thread must order them.
bool Strips::count_window(double start, double end, Counters& counters) {
  std::size_t const slices = threads_.size();
  slices_.resize(slices);
  std::vector<std::uint8_t> is_in_order(slices, 0);
  Counters sum = counters;
  for (std::size_t kind = 0; kind < Strip::kinds_of_counts; ++kind) {
    if (std::ranges::all_of(strips_, [&](Strip const& strip) { return strip.has_none(kind); })) continue;
    // Each thread merges the events of a part of the window.
    threads_.for_each(slices, [&](std::size_t slice) {
      auto const time_at = [&](std::size_t k) {
        if (k == 0) return -never;
        return k == slices ? never : start + (end - start) * (static_cast<double>(k) / static_cast<double>(slices));
      };
      std::vector<Strip::Counted>& merged = slices_[slice];
      merged.clear();
      for (Strip const& strip : strips_) merge(merged, strip.counted(kind, time_at(slice), time_at(slice + 1)));
      auto const is_not_before = [](Strip::Counted const& a, Strip::Counted const& b) { return !(a.time < b.time); };
      is_in_order[slice] = static_cast<std::uint8_t>(std::ranges::adjacent_find(merged, is_not_before) == merged.end());
    });
    if (std::ranges::find(is_in_order, 0) != is_in_order.end()) return false;
    auto const add_slices = [&](std::uint64_t& number, double& amount) {
      for (std::vector<Strip::Counted> const& merged : slices_) {
        number += merged.size();
        for (Strip::Counted const& event : merged) amount += event.amount;
      }
    };
    if (kind == 0) {
      add_slices(sum.pair_collisions, sum.pair_virial);
    } else if (kind + 1 == Strip::kinds_of_counts) {
      add_slices(sum.inner_wall_hits, sum.inner_wall_impulse);
    } else {
      add_slices(sum.wall_hits[kind - 1], sum.wall_impulse[kind - 1]);
    }
  }
  sum.moves += moves_in_window();
  counters = sum;
  return true;
}

std::uint64_t Strips::hits_in_window() const {
  std::uint64_t hits = 0;
  for (Strip const& strip : strips_) hits += strip.own_hits();
  return hits;
}

std::uint64_t Strips::moves_in_window() const {
  std::uint64_t moves = 0;
  for (Strip const& strip : strips_) moves += strip.moves();
  return moves;
}

std::uint64_t Strips::events_made() const {
  std::uint64_t made = 0;
  for (Strip const& strip : strips_) made += strip.events_made();
  return made;
}

double Strips::slack() const {
  double slack = never;
  for (Strip const& strip : strips_) slack = std::min(slack, strip.slack());
  return slack;
}

double Strips::last_event() const {
  double last = -never;
  for (Strip const& strip : strips_) last = std::max(last, strip.last_event());
  return last;
}

bool Strips::has_events() {
  return std::ranges::any_of(strips_, [](Strip& strip) { return strip.has_events(); });
}

}  // namespace gridlock::exact
