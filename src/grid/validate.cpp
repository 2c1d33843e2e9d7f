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

namespace gridlock {

namespace {

/// Keeps the first few problems of one kind and counts the rest.
class ProblemList {
 public:
  void add(std::string what, std::string hint) {
    if (++count_ <= most_shown) problems_.push_back({.what = std::move(what), .hint = std::move(hint), .key = "disks"});
  }
  void move_into(std::vector<Problem>& all) {
    if (count_ > most_shown) problems_.back().what += fmt::format(" (and {} more like it)", count_ - most_shown);
    std::ranges::move(problems_, std::back_inserter(all));
  }

 private:
  static constexpr std::size_t most_shown = 3;
  std::vector<Problem> problems_;
  std::size_t count_ = 0;
};

bool is_positive(double value) { return std::isfinite(value) && value > 0.0; }

/// Numbers so large or small that their squares would no longer be what they stand for.
std::vector<Problem> find_extreme_magnitudes(State const& state) {
  std::vector<Problem> problems;
  if (auto problem = find_extreme_sides(state.box)) problems.push_back(*std::move(problem));
  ProblemList extreme_disks;
  double largest_speed = 0.0;
  Disks const& disks = state.agents;
  for (std::size_t i = 0; i < disks.size(); ++i) {
    double const r = disks.column<Radius>()[i];
    double const m = disks.column<Mass>()[i];
    Vector const v = velocity(disks, i);
    // Not their squares, which may be what is out of range.
    largest_speed = std::max({largest_speed, std::abs(v.x), std::abs(v.y)});
    if (has_bounded_magnitude(r) && has_bounded_magnitude(m)) continue;
    extreme_disks.add(
        fmt::format("disk {} has radius {} and mass {}, too large or too small to compute with", disks.ids()[i], r, m),
        magnitude_hint);
  }
  extreme_disks.move_into(problems);
  if (largest_speed != 0.0 && !has_bounded_magnitude(largest_speed)) {
    problems.push_back({.what = fmt::format("the largest component of a velocity is {}, too large or too small to "
                                            "compute with",
                                            largest_speed),
                        .hint = magnitude_hint,
                        .key = "disks"});
  }
  return problems;
}

/// Problems that make a search for overlaps meaningless.
std::vector<Problem> find_broken_rows(State const& state, double beyond_walls) {
  ProblemList not_finite;
  ProblemList not_inside;
  Disks const& disks = state.agents;
  for (std::size_t i = 0; i < disks.size(); ++i) {
    Vector const p = position(disks, i);
    Vector const v = velocity(disks, i);
    double const r = disks.column<Radius>()[i];
    double const m = disks.column<Mass>()[i];
    if (!std::isfinite(p.x + p.y + v.x + v.y) || !is_positive(r) || !is_positive(m)) {
      not_finite.add(fmt::format("disk {} has position ({}, {}), velocity ({}, {}), radius {} and mass {}",
                                 disks.ids()[i], p.x, p.y, v.x, v.y, r, m),
                     "every value must be finite, radius and mass above 0");
      continue;
    }
    double const margin = state.box.is_periodic() ? 0.0 : r - beyond_walls;
    bool const is_inside =
        p.x >= margin && p.x <= state.box.width() - margin && p.y >= margin && p.y <= state.box.height() - margin;
    // A centre exactly on the upper edge of a periodic box is the same point as 0 and must be written so.
    bool const is_on_upper_edge = state.box.is_periodic() && (p.x == state.box.width() || p.y == state.box.height());
    if (!is_inside || is_on_upper_edge) {
      not_inside.add(fmt::format("disk {} at ({}, {}) with radius {} is not inside the box of {} × {}", disks.ids()[i],
                                 p.x, p.y, r, state.box.width(), state.box.height()),
                     state.box.is_periodic() ? "centres lie in [0, width) × [0, height)"
                                             : "centres lie at least one radius away from every wall");
    }
  }
  std::vector<Problem> problems;
  not_finite.move_into(problems);
  not_inside.move_into(problems);
  return problems;
}

/// Calls visit(i, j, gap) for every pair that overlaps, gap < 0 being the distance between the rims.
template <class Visit>
void for_each_overlap(State const& state, Visit visit) {
  if (state.agents.empty()) return;
  auto const r = state.agents.column<Radius>();
  double const cutoff = 2.0 * radius_range(state.agents).largest;
  for_each_pair(state, grid_for_cutoff(state, cutoff), cutoff, [&](std::size_t i, std::size_t j, Vector separation) {
    double const gap = gap_of_overlap(r[i] + r[j], squared_length(separation), 0.0);
    if (gap < 0.0) visit(i, j, gap);
  });
}

/// Refuses disks that overlap their own image.
void find_own_images(Box const& box, double largest_radius, std::vector<Problem>& problems) {
  double const diameter = 2.0 * largest_radius;
  if (!box.is_periodic() || diameter <= std::min(box.width(), box.height())) return;
  problems.push_back({.what = fmt::format("a disk of diameter {} overlaps its own image in a periodic box of {} × {}",
                                          diameter, box.width(), box.height()),
                      .hint = "use a larger box or smaller disks",
                      .key = "disks"});
}

void require_whole_rows(State const& state, double beyond_walls) {
  std::vector<Problem> problems = find_broken_rows(state, beyond_walls);
  if (problems.empty()) problems = find_extreme_magnitudes(state);
  if (!problems.empty()) throw Error(std::move(problems));
}

}  // namespace

double gap_of_overlap(double contact, double squared_distance, double tolerance) {
  double const missing = contact * contact - squared_distance;
  if (!(missing > 0.0)) return 0.0;
  // √(d²) − contact would round an overlap of the last bit to nothing; this quotient stays below 0.
  double const gap = -missing / (contact + std::sqrt(squared_distance));
  return -gap > tolerance ? gap : 0.0;
}

std::vector<Problem> problems_of_overlaps(std::span<OverlappingPair const> first, std::size_t count) {
  std::vector<Problem> problems;
  for (auto const& [one, other, gap] : first.first(std::min(first.size(), most_overlaps_named))) {
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
  require_whole_rows(state, tolerance.beyond_walls);
  std::vector<OverlappingPair> overlaps;
  std::size_t count = 0;
  for_each_overlap(state, [&](std::size_t i, std::size_t j, double gap) {
    if (-gap <= tolerance.overlap) return;
    if (++count <= most_overlaps_named) overlaps.push_back({state.agents.ids()[i], state.agents.ids()[j], gap});
  });
  std::vector<Problem> problems = problems_of_overlaps(overlaps, count);
  find_own_images(state.box, radius_range(state.agents).largest, problems);
  if (!problems.empty()) throw Error(std::move(problems));
}

void validate_rows(State const& some, DisksOverview const& all) {
  require_whole_rows(some, 0.0);
  std::vector<Problem> problems;
  find_own_images(some.box, all.radii.largest, problems);
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
