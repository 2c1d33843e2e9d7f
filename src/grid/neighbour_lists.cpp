#include "gridlock/grid/neighbour_lists.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>

#include "core/magnitude.hpp"
#include "grid/candidate_pairs.hpp"
#include "grid/oblique_lists.hpp"
#include "grid/require.hpp"
#include "grid/sorted_pairs.hpp"
#include "gridlock/core/detail/thread_pool.hpp"
#include "gridlock/grid/detail/cell_list.hpp"
#include "gridlock/grid/detail/find_neighbours.hpp"

namespace gridlock {

namespace {

/// Box and origin of the cells. Points without a box keep their coordinates, so distances round as the user expects.
struct SearchFrame {
  Box box;
  Vector origin;
};

/// An array that grows; entries behind size() are not initialized.
template <class Value>
class Found {
 public:
  Value* room_for(std::size_t count) {
    if (size_ + count > memory_.size()) memory_.resize(std::max(size_ + count, memory_.size() + memory_.size() / 2));
    return memory_.data() + size_;
  }
  void add(std::size_t count) { size_ += count; }
  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] std::span<Value const> all() const { return std::span(memory_).first(size_); }

 private:
  UninitializedArray<Value> memory_;
  std::size_t size_ = 0;
};

/// The neighbours of the rows of a band of cells, row after row, and the number of neighbours of each row.
struct Band {
  Found<std::uint32_t> neighbours;
  Found<std::uint32_t> counts;
};

/// Finds the neighbours of all rows of a band, as rows.
void search_band(CellList const& points, Box const& box, double cutoff, int first_row, int end_row, Band& band) {
  auto const blocks = points.blocks();
  points.for_each_cell(first_row, end_row, [&](int column, int cell_row, RowRange rows) {
    RowBlock const block = blocks.around(column, cell_row);
    std::uint32_t* const counts = band.counts.room_for(rows.end - rows.first);
    for (std::size_t row = rows.first; row < rows.end; ++row) {
      std::uint32_t* const found = band.neighbours.room_for(block.candidates + neighbour_slack);
      std::size_t const count = find_neighbours({.x = points.x(),
                                                 .y = points.y(),
                                                 .size = points.size(),
                                                 .p = {points.x()[row], points.y()[row]},
                                                 .squared_cutoff = cutoff * cutoff,
                                                 .left_out = row,
                                                 .box = block.is_at_edge && box.has_images() ? &box : nullptr},
                                                block.ranges(), found);
      band.neighbours.add(count);
      counts[row - rows.first] = static_cast<std::uint32_t>(count);
    }
    band.counts.add(rows.end - rows.first);
  });
}

/// Returns the box around points, no smaller than the cutoff.
SearchFrame frame_around(PointsInMemory const& points, double cutoff) {
  Vector least{std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
  Vector most = -1.0 * least;
  for (std::size_t i = 0; i < points.count; ++i) {
    Vector const p{points.x[i * points.stride], points.y[i * points.stride]};
    least = {std::min(least.x, p.x), std::min(least.y, p.y)};
    most = {std::max(most.x, p.x), std::max(most.y, p.y)};
  }
  if (points.count == 0) least = most = {};
  auto const side = [&](double from, double to) {
    double const length = (to - from) * (1.0 + 1e-12);
    if (!(length <= max_magnitude)) {
      throw Error({.what = "the points span " + std::to_string(length) + " in one direction",
                   .hint = "use coordinates of at most 1e60"});
    }
    return std::max(length, cutoff);
  };
  return {Box(side(least.x, most.x), side(least.y, most.y), Edge::wall), least};
}

/// Sorts the points into cells with sides of at least `cutoff`. Where the points crowd in a part of the box, the cells
/// are as small as that allows, and only occupied ones are stored.
CellList sorted(SearchFrame const& frame, double cutoff, PointsInMemory const& points, ThreadPool& pool) {
  CellLayout const layout = layout_for_cutoff(frame.box, cutoff, points.count);
  return {layout, frame.origin, points, pool, layout_for_crowd(frame.box, cutoff, points.count, layout)};
}

/// Sorts points and searches their neighbours; results are kept in bands.
class Search {
 public:
  Search(SearchFrame const& frame, double cutoff, PointsInMemory const& points, ThreadPool& pool)
      : box_(frame.box), cutoff_(cutoff), pool_(pool), points_(sorted(frame, cutoff, points, pool_)) {
    ends_ = bands_of(points_, pool_);
  }

  PointPairs pairs() const {
    std::vector<Found<AgentPair>> bands(ends_.size() - 1);
    pool_.for_each(bands.size(), [&](std::size_t b) {
      OnPairs const keep = [&](std::span<AgentPair const> pairs) {
        std::ranges::copy(pairs, bands[b].room_for(pairs.size()));
        bands[b].add(pairs.size());
      };
      PairBuffer buffer(keep);
      add_pairs_of_cells(points_, box_, cutoff_ * cutoff_, ends_[b], ends_[b + 1], buffer);
      buffer.flush();
    });
    std::vector<std::size_t> const begin = first_of_each(bands);
    PointPairs pairs;
    pairs.indices.resize(2 * begin.back());
    std::uint32_t* const first = pairs.indices.data();
    std::uint32_t* const second = first + begin.back();
    pool_.for_each(bands.size(), [&](std::size_t b) {
      std::size_t k = begin[b];
      for (AgentPair const& pair : bands[b].all()) {
        first[k] = pair.first;
        second[k++] = pair.second;
      }
    });
    return pairs;
  }

  /// Returns the rows of the points that are nearer than the cutoff to a point in the box; valid until `found` is
  /// changed.
  /// Contract: the cutoff is at most that of the search.
  std::span<std::uint32_t const> near(Vector place, double cutoff, Found<std::uint32_t>& found) const {
    CellLayout const& layout = points_.layout();
    auto const blocks = points_.blocks();
    Vector const p = layout.image_in_cell(place);
    RowBlock const block = blocks.around(layout.column_of(p.x), layout.row_of(p.y));
    if (block.candidates == 0) return {};
    std::uint32_t* const rows = found.room_for(block.candidates + neighbour_slack);
    std::size_t const count = find_neighbours({.x = points_.x(),
                                               .y = points_.y(),
                                               .size = points_.size(),
                                               .p = p,
                                               .squared_cutoff = cutoff * cutoff,
                                               .left_out = points_.size(),
                                               .box = block.is_at_edge && box_.has_images() ? &box_ : nullptr},
                                              block.ranges(), rows);
    return {rows, count};
  }
  [[nodiscard]] CellList const& points() const { return points_; }

  NeighbourLists lists(std::size_t count) const {
    std::vector<Band> bands(ends_.size() - 1);
    pool_.for_each(bands.size(),
                   [&](std::size_t b) { search_band(points_, box_, cutoff_, ends_[b], ends_[b + 1], bands[b]); });
    NeighbourLists lists{.begin = std::vector<std::uint64_t>(count + 1, 0), .neighbours = {}};
    pool_.for_each(bands.size(), [&](std::size_t b) {
      for_each_row(b, bands[b], [&](std::size_t row, std::span<std::uint32_t const> neighbours) {
        lists.begin[points_.index(row) + 1] = neighbours.size();
      });
    });
    for (std::size_t i = 0; i < count; ++i) lists.begin[i + 1] += lists.begin[i];
    lists.neighbours.resize(lists.begin.back());
    pool_.for_each(bands.size(), [&](std::size_t b) {
      for_each_row(b, bands[b], [&](std::size_t row, std::span<std::uint32_t const> neighbours) {
        std::size_t k = lists.begin[points_.index(row)];
        for (std::uint32_t const other : neighbours) lists.neighbours[k++] = points_.index(other);
      });
    });
    return lists;
  }

 private:
  /// Returns the index of the first result of each band, and the total number.
  static std::vector<std::size_t> first_of_each(std::vector<Found<AgentPair>> const& bands) {
    std::vector<std::size_t> begin{0};
    for (Found<AgentPair> const& band : bands) begin.push_back(begin.back() + band.size());
    return begin;
  }

  /// Calls visit(row, neighbours) for every row of band `b`.
  template <class Visit>
  void for_each_row(std::size_t b, Band const& band, Visit visit) const {
    auto row =
        points_.first_of(static_cast<std::size_t>(ends_[b]) * static_cast<std::size_t>(points_.layout().columns()));
    std::uint32_t const* neighbours = band.neighbours.all().data();
    for (std::uint32_t const count : band.counts.all()) {
      visit(row++, std::span(neighbours, count));
      neighbours += count;
    }
  }

  Box box_;
  double cutoff_;
  ThreadPool& pool_;
  CellList points_;
  std::vector<int> ends_;  ///< 0, then the end of each band in rows of cells
};

SearchFrame frame_of(Box const& box, double cutoff, PointsInMemory const& points) {
  require_bounded_cutoff(cutoff);
  require_point_count(points.count);  // finiteness of coordinates is checked when points are sorted
  require_box_for(box, cutoff);
  return {box, {}};
}

SearchFrame frame_of(double cutoff, PointsInMemory const& points) {
  require_search(points, cutoff);
  return frame_around(points, cutoff);
}

/// Disks of similar size that share a grid of cells.
struct SizeClass {
  double largest_radius = 0.0;
  std::vector<std::uint32_t> members;  ///< disks of the class; empty for all disks
  std::vector<double> x, y;
  PointsInMemory all;

  [[nodiscard]] PointsInMemory centres() const {
    return members.empty() ? all : PointsInMemory{.x = x.data(), .y = y.data(), .count = members.size()};
  }
  [[nodiscard]] std::uint32_t disk(std::size_t member) const {
    return members.empty() ? static_cast<std::uint32_t>(member) : members[member];
  }
};

/// Returns as few classes as possible, the largest disks first. In each class the largest disk is less than twice as
/// large as the smallest, or nine of its cells hold few disks.
std::vector<SizeClass> classes_of(Box const& box, DiskReach const& reach, PointsInMemory const& centres,
                                  std::span<double const> radius) {
  constexpr double few_disks = 64.0;
  constexpr std::size_t max_halvings = 63;
  double const largest = std::ranges::max(radius);
  auto const halvings_of = [&](double r) {
    return std::min(static_cast<std::size_t>(std::ilogb(largest / r)), max_halvings);
  };
  std::array<double, max_halvings + 1> largest_of{};
  std::array<std::size_t, max_halvings + 1> count_of{};
  for (double const r : radius) {
    std::size_t const halvings = halvings_of(r);
    largest_of[halvings] = std::max(largest_of[halvings], r);
    ++count_of[halvings];
  }
  std::vector<SizeClass> classes;
  std::array<std::size_t, max_halvings + 1> class_of{};
  std::size_t count = 0;
  for (std::size_t halvings = 0; halvings < count_of.size(); ++halvings) {
    if (count_of[halvings] == 0) continue;
    if (!classes.empty()) {
      double const cutoff = 2.0 * reach.factor * classes.back().largest_radius + reach.gap;
      double const disks = static_cast<double>(count + count_of[halvings]);
      if (9.0 * cutoff * cutoff * disks > few_disks * box.area()) count = 0;
    }
    if (count == 0)
      classes.push_back({.largest_radius = largest_of[halvings], .members = {}, .x = {}, .y = {}, .all = centres});
    count += count_of[halvings];
    class_of[halvings] = classes.size() - 1;
  }
  if (classes.size() == 1) return classes;
  for (std::uint32_t i = 0; i < centres.count; ++i) {
    SizeClass& like_disks = classes[class_of[halvings_of(radius[i])]];
    like_disks.members.push_back(i);
    like_disks.x.push_back(centres.x[i * centres.stride]);
    like_disks.y.push_back(centres.y[i * centres.stride]);
  }
  return classes;
}

/// A list of the pairs of disks that are near enough.
class NearPairs {
 public:
  NearPairs(Box const& box, DiskReach const& reach, PointsInMemory const& centres, std::span<double const> radius)
      : box_(box), reach_(reach), centres_(centres), radius_(radius) {}

  void make_room_for(std::size_t more) {
    if (pairs_.size() < count_ + more) pairs_.resize(std::max(count_ + more, 2 * pairs_.size()));
  }
  /// Adds the pair if it is near enough. Contract: there is memory for it.
  void add(std::uint32_t i, std::uint32_t j) {
    double const contact = reach_.factor * (radius_[i] + radius_[j]) + reach_.gap;
    // Without a branch, because no processor guesses which pairs are near enough.
    pairs_[count_] = {i, j};
    count_ += squared_length(box_.displacement(at(i), at(j))) < contact * contact ? 1 : 0;
  }
  /// Appends the pairs of another list.
  void append(NearPairs const& other) {
    make_room_for(other.count_);
    std::copy_n(other.pairs_.begin(), other.count_, pairs_.begin() + static_cast<std::ptrdiff_t>(count_));
    count_ += other.count_;
  }
  [[nodiscard]] PointPairs pairs() const { return in_columns(std::span(pairs_).first(count_)); }

 private:
  [[nodiscard]] Vector at(std::uint32_t i) const {
    return {centres_.x[i * centres_.stride], centres_.y[i * centres_.stride]};
  }
  Box box_;
  DiskReach reach_;
  PointsInMemory centres_;
  std::span<double const> radius_;
  UninitializedArray<AgentPair> pairs_;
  std::size_t count_ = 0;
};

/// Adds the pairs that search(part, parts, pairs) finds for each part of the work, in the order of the parts.
template <class SearchPart>
void add_in_parts(ThreadPool& pool, NearPairs const& none, NearPairs& all, SearchPart search) {
  if (pool.size() == 1) {
    search(0, 1, all);
    return;
  }
  std::size_t const parts = 8 * pool.size();
  std::vector<NearPairs> found(parts, none);
  pool.for_each(parts, [&](std::size_t part) { search(part, parts, found[part]); });
  for (NearPairs const& part : found) all.append(part);
}

}  // namespace

PointPairs find_pairs_of_disks(Box const& box, DiskReach const& reach, PointsInMemory const& centres,
                               std::span<double const> radius, std::uint64_t threads) {
  require_points_in_memory(centres);
  require_radii(radius, centres.count);
  require_reach(reach);
  NearPairs const none(box, reach, centres, radius);
  NearPairs all = none;
  if (centres.count == 0) return all.pairs();
  if (box.is_oblique()) return find_pairs_of_disks_in_oblique(box, reach, centres, radius, threads);
  ThreadPool pool(threads);
  std::vector<SizeClass> const classes = classes_of(box, reach, centres, radius);
  auto const reach_of = [&](SizeClass const& a, SizeClass const& b) {
    return reach.factor * (a.largest_radius + b.largest_radius) + reach.gap;
  };
  SearchFrame const frame = frame_of(box, reach_of(classes.front(), classes.front()), centres);
  double const most = std::min(0.5 * box.shortest_period(), std::numeric_limits<double>::max());
  // A factor above 1 covers rounding; add() decides by the coordinates as they were given.
  auto const cutoff_of = [&](SizeClass const& a, SizeClass const& b) {
    return std::min(most, reach_of(a, b) * (1.0 + 1e-9));
  };
  std::vector<std::unique_ptr<Search>> searches;
  for (SizeClass const& like_disks : classes) {
    searches.push_back(std::make_unique<Search>(frame, cutoff_of(like_disks, like_disks), like_disks.centres(), pool));
    PointPairs const pairs = searches.back()->pairs();
    add_in_parts(pool, none, all, [&](std::size_t part, std::size_t parts, NearPairs& near) {
      std::size_t const end = (part + 1) * pairs.size() / parts;
      near.make_room_for(end - part * pairs.size() / parts);
      for (std::size_t k = part * pairs.size() / parts; k < end; ++k) {
        near.add(like_disks.disk(pairs.first()[k]), like_disks.disk(pairs.second()[k]));
      }
    });
  }
  for (std::size_t small = 1; small < classes.size(); ++small) {
    CellList const& seeking = searches[small]->points();
    for (std::size_t large = 0; large < small; ++large) {
      Search const& found_among = *searches[large];
      double const cutoff = cutoff_of(classes[small], classes[large]);
      add_in_parts(pool, none, all, [&](std::size_t part, std::size_t parts, NearPairs& near) {
        Found<std::uint32_t> rows;
        std::size_t const end = (part + 1) * seeking.size() / parts;
        for (std::size_t row = part * seeking.size() / parts; row < end; ++row) {
          std::uint32_t const seeker = classes[small].disk(seeking.index(row));
          auto const found = found_among.near({seeking.x()[row], seeking.y()[row]}, cutoff, rows);
          near.make_room_for(found.size());
          for (std::uint32_t const other : found) {
            near.add(seeker, classes[large].disk(found_among.points().index(other)));
          }
        }
      });
    }
  }
  return all.pairs();
}

PointPairs find_pairs(Box const& box, double cutoff, PointsInMemory const& points, std::uint64_t threads) {
  if (box.is_oblique()) return find_pairs_in_oblique(box, cutoff, points, threads);
  ThreadPool pool(threads);
  return Search(frame_of(box, cutoff, points), cutoff, points, pool).pairs();
}

NeighbourLists find_neighbour_lists(Box const& box, double cutoff, PointsInMemory const& points,
                                    std::uint64_t threads) {
  if (box.is_oblique()) return lists_of(find_pairs_in_oblique(box, cutoff, points, threads), points.count);
  ThreadPool pool(threads);
  return Search(frame_of(box, cutoff, points), cutoff, points, pool).lists(points.count);
}

PointPairs find_pairs(double cutoff, PointsInMemory const& points, std::uint64_t threads) {
  ThreadPool pool(threads);
  return Search(frame_of(cutoff, points), cutoff, points, pool).pairs();
}

NeighbourLists find_neighbour_lists(double cutoff, PointsInMemory const& points, std::uint64_t threads) {
  ThreadPool pool(threads);
  return Search(frame_of(cutoff, points), cutoff, points, pool).lists(points.count);
}

}  // namespace gridlock
