#include "gridlock/grid/validate.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "core/magnitude.hpp"
#include "grid/pairs.hpp"
#include "grid/validate_rows.hpp"
#include "gridlock/core/error.hpp"
#include "gridlock/grid/neighbour_search.hpp"

namespace gridlock {

namespace {

bool is_positive(double value) { return std::isfinite(value) && value > 0.0; }

std::string text_of_broken(Disks const& disks, std::size_t i) {
  Vector const p = position(disks, i);
  Vector const v = velocity(disks, i);
  return fmt::format("disk {} has position ({}, {}), velocity ({}, {}), radius {} and mass {}", disks.ids()[i], p.x,
                     p.y, v.x, v.y, disks.column<Radius>()[i], disks.column<Mass>()[i]);
}

/// Returns whether a disk is inside a box; it may be beyond a wall by `beyond_walls`.
bool is_inside(Box const& box, Vector p, double radius, double beyond_walls) {
  // A centre on the upper edge of a periodic box is the same point as 0 and must be given as 0.
  double const margin = radius - beyond_walls;
  auto const is_between = [margin](double place, double side, bool is_periodic) {
    return is_periodic ? place >= 0.0 && place < side : place >= margin && place <= side - margin;
  };
  return is_between(p.x, box.width(), box.is_periodic_x()) && is_between(p.y, box.height(), box.is_periodic_y());
}

std::string hint_of_inside(Box const& box) {
  if (box.is_periodic()) return "centres lie in [0, width) × [0, height)";
  if (!box.has_images()) return "centres lie at least one radius away from every wall";
  return fmt::format("centres lie in {} and at least one radius away from the walls",
                     box.is_periodic_x() ? "[0, width)" : "[0, height)");
}

/// Calls visit(i, j, gap) for every pair that overlaps; gap < 0 is the distance between the rims.
template <class Visit>
void for_each_overlap(State const& state, Visit visit) {
  if (state.agents.empty()) return;
  auto const r = state.agents.column<Radius>();
  double const cutoff = 2.0 * radius_range(state.agents).largest;
  auto const visit_overlap = [&](std::size_t i, std::size_t j, Vector separation) {
    double const gap = gap_of_overlap(r[i] + r[j], squared_length(separation), 0.0);
    if (gap < 0.0) visit(i, j, gap);
  };
  if (state.box.is_oblique()) {
    double const longest = std::min(cutoff, 0.5 * state.box.shortest_period());
    NeighbourSearch(state.box, longest, state.agents.column<X>(), state.agents.column<Y>())
        .for_each_pair(visit_overlap);
  } else {
    for_each_pair(state, grid_for_cutoff(state, cutoff), cutoff, visit_overlap);
  }
}

/// Counts overlaps and keeps those of the first rows, whatever the order in which they are added.
class FirstOverlaps {
 public:
  void add(std::size_t i, std::size_t j, double gap) {
    ++count_;
    RowPair const pair{std::min(i, j), std::max(i, j), gap};
    if (first_.size() == max_overlaps_named && !is_before(pair, first_.back())) return;
    first_.insert(std::ranges::upper_bound(first_, pair, is_before), pair);
    if (first_.size() > max_overlaps_named) first_.pop_back();
  }
  [[nodiscard]] std::size_t count() const { return count_; }
  [[nodiscard]] std::vector<OverlappingPair> pairs(Disks const& disks) const {
    std::vector<OverlappingPair> pairs;
    for (auto const& [row, other_row, gap] : first_) pairs.push_back({disks.ids()[row], disks.ids()[other_row], gap});
    return pairs;
  }

 private:
  struct RowPair {
    std::size_t row;
    std::size_t other_row;
    double gap;
  };
  static bool is_before(RowPair const& a, RowPair const& b) {
    return std::pair(a.row, a.other_row) < std::pair(b.row, b.other_row);
  }

  std::vector<RowPair> first_;
  std::size_t count_ = 0;
};

/// Reports disks that overlap their own image.
void find_own_images(Box const& box, double largest_radius, std::vector<Problem>& problems) {
  double const diameter = 2.0 * largest_radius;
  if (diameter <= box.shortest_period()) return;
  problems.push_back({.what = fmt::format("a disk of diameter {} overlaps its own image in a periodic box of {} × {}",
                                          diameter, box.width(), box.height()),
                      .hint = "use a larger box or smaller disks",
                      .key = "disks"});
}

}  // namespace

void RowProblems::Kind::add(std::string text) {
  if (++count <= max_named) first.push_back(std::move(text));
}

void RowProblems::Kind::add(Kind const& next) {
  for (std::size_t k = 0; k < next.first.size() && first.size() < max_named; ++k) first.push_back(next.first[k]);
  count += next.count;
}

void RowProblems::Kind::move_into(std::vector<Problem>& problems, std::string const& hint) const {
  for (std::string const& what : first) problems.push_back({.what = what, .hint = hint, .key = "disks"});
  if (count > first.size()) problems.back().what += fmt::format(" (and {} more like it)", count - first.size());
}

RowProblems::RowProblems(State const& some, double beyond_walls) {
  Disks const& disks = some.agents;
  for (std::size_t i = 0; i < disks.size(); ++i) {
    Vector const p = position(disks, i);
    Vector const v = velocity(disks, i);
    double const r = disks.column<Radius>()[i];
    double const m = disks.column<Mass>()[i];
    bool const is_at_rest = is_fixed(disks, i) && v == Vector{};
    if (!std::isfinite(p.x + p.y + v.x + v.y) || !is_positive(r) || !(is_positive(m) || is_at_rest)) {
      not_finite_.add(text_of_broken(disks, i));
      continue;
    }
    if (!is_inside(some.box, p, r, beyond_walls)) {
      not_inside_.add(fmt::format("disk {} at ({}, {}) with radius {} is not inside the box of {} × {}", disks.ids()[i],
                                  p.x, p.y, r, some.box.width(), some.box.height()));
    }
    // Components are compared, because the square of a speed may be out of range.
    largest_speed_ = std::max({largest_speed_, std::abs(v.x), std::abs(v.y)});
    if (has_bounded_magnitude(r) && (has_bounded_magnitude(m) || is_at_rest)) continue;
    extreme_.add(
        fmt::format("disk {} has radius {} and mass {}, too large or too small to compute with", disks.ids()[i], r, m));
  }
}

RowProblems::RowProblems(MessageReader& message) {
  for (Kind* const kind : {&not_finite_, &not_inside_, &extreme_}) {
    kind->count = message.next<std::uint64_t>();
    for (std::size_t k = 0; k < std::min(kind->count, max_named); ++k) kind->first.push_back(message.next_text());
  }
  largest_speed_ = message.next<double>();
}

void RowProblems::write(MessageWriter& message) const {
  for (Kind const* const kind : {&not_finite_, &not_inside_, &extreme_}) {
    message.add(std::uint64_t{kind->count});
    for (std::string const& text : kind->first) message.add_text(text);
  }
  message.add(largest_speed_);
}

void RowProblems::add(RowProblems const& next) {
  not_finite_.add(next.not_finite_);
  not_inside_.add(next.not_inside_);
  extreme_.add(next.extreme_);
  largest_speed_ = std::max(largest_speed_, next.largest_speed_);
}

void RowProblems::require_none(Box const& box) const {
  std::vector<Problem> problems;
  not_finite_.move_into(problems, "every value must be finite, radius and mass above 0");
  not_inside_.move_into(problems, hint_of_inside(box));
  if (!problems.empty()) throw Error(std::move(problems));
  // Reports numbers so large or small that their squares overflow or vanish.
  if (auto problem = find_extreme_sides(box)) problems.push_back(*std::move(problem));
  extreme_.move_into(problems, magnitude_hint);
  if (largest_speed_ != 0.0 && !has_bounded_magnitude(largest_speed_)) {
    problems.push_back({.what = fmt::format("the largest component of a velocity is {}, too large or too small to "
                                            "compute with",
                                            largest_speed_),
                        .hint = magnitude_hint,
                        .key = "disks"});
  }
  if (!problems.empty()) throw Error(std::move(problems));
}

double gap_of_overlap(double contact, double squared_distance, double tolerance) {
  double const missing = contact * contact - squared_distance;
  if (!(missing > 0.0)) return 0.0;
  // √(d²) − contact would round an overlap of the last bit to 0; this quotient stays below 0.
  double const gap = -missing / (contact + std::sqrt(squared_distance));
  return -gap > tolerance ? gap : 0.0;
}

std::vector<Problem> problems_of_overlaps(std::span<OverlappingPair const> first, std::size_t count) {
  std::vector<Problem> problems;
  for (auto const& [one, other, gap] : first.first(std::min(first.size(), max_overlaps_named))) {
    auto const [a, b] = std::minmax(one, other);
    problems.push_back(
        {.what = fmt::format("disks {} and {} overlap by {:.3g}", a, b, -gap),
         .hint = "move them apart or make them smaller; hard disks may touch but not overlap, and a protocol whose "
                 "first stage is a quench of soft disks takes such a start",
         .key = "disks"});
  }
  if (count > problems.size()) {
    problems.back().what += fmt::format(" (and {} more like it)", count - problems.size());
  }
  return problems;
}

void validate(State const& state, Tolerance const& tolerance) {
  RowProblems(state, tolerance.beyond_walls).require_none(state.box);
  FirstOverlaps overlaps;
  for_each_overlap(state, [&](std::size_t i, std::size_t j, double gap) {
    if (-gap > tolerance.overlap) overlaps.add(i, j, gap);
  });
  std::vector<Problem> problems = problems_of_overlaps(overlaps.pairs(state.agents), overlaps.count());
  find_own_images(state.box, radius_range(state.agents).largest, problems);
  if (!problems.empty()) throw Error(std::move(problems));
}

void require_no_own_images(Box const& box, double largest_radius) {
  std::vector<Problem> problems;
  find_own_images(box, largest_radius, problems);
  if (!problems.empty()) throw Error(std::move(problems));
}

double rounding_of_contact(State const& state) {
  return rounding_of_contact(state.box, radius_range(state.agents).smallest);
}

double rounding_of_contact(Box const& box, double smallest_radius) {
  double const last_digit = std::numeric_limits<double>::epsilon() * std::max(box.width(), box.height());
  return std::max(1e-12 * 2.0 * smallest_radius, 4.0 * last_digit);
}

double largest_overlap(State const& state) {
  double largest = 0.0;
  for_each_overlap(state, [&](std::size_t, std::size_t, double gap) { largest = std::max(largest, -gap); });
  return largest;
}

}  // namespace gridlock
