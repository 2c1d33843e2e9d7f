#include "gridlock/grid/neighbour_lists.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>

#include "core/magnitude.hpp"
#include "grid/require.hpp"
#include "grid/sorted_points.hpp"
#include "gridlock/core/detail/thread_pool.hpp"
#include "gridlock/grid/detail/find_neighbours.hpp"
#include "gridlock/grid/detail/row_block.hpp"

namespace gridlock {

namespace {

/// Where the cells of points begin to count: points without a box keep their coordinates, so that distances round as the user
/// would round them.
struct SearchFrame {
  Box box;
  Vector origin;
};

/// Grows by halves; what is behind size() is not initialized.
class Found {
 public:
  std::uint32_t* room_for(std::size_t count) {
    if (size_ + count > capacity_) grow(size_ + count);
    return memory_.get() + size_;
  }
  void add(std::size_t count) { size_ += count; }
  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] std::uint32_t const* begin() const { return memory_.get(); }
  [[nodiscard]] std::uint32_t const* end() const { return memory_.get() + size_; }

 private:
  void grow(std::size_t least) {
    std::size_t const capacity = std::max(least, capacity_ + capacity_ / 2 + 4096);
    auto larger = std::make_unique_for_overwrite<std::uint32_t[]>(capacity);
    std::copy(begin(), end(), larger.get());
    memory_ = std::move(larger);
    capacity_ = capacity;
  }
  std::unique_ptr<std::uint32_t[]> memory_;
  std::size_t size_ = 0;
  std::size_t capacity_ = 0;
};

/// What a band of cells has found: the neighbours of its rows, one after the other, and how many each row has.
struct Band {
  Found neighbours;
  Found counts;
};

enum class Half { no, yes };

/// The neighbours of all rows of a band, as rows; with Half::yes those of every pair for one of the two alone.
template <Half half>
void search_band(SortedPoints const& points, Box const& box, double cutoff, int first_row, int end_row, Band& band) {
  RowBlocks const blocks(points.layout(), [&](std::size_t cell) { return points.first_of(cell); });
  bool const has_halves = half == Half::yes && blocks.has_halves();
  points.for_each_cell(first_row, end_row, [&](int column, int cell_row, RowRange rows) {
    RowBlock block = has_halves ? blocks.after(column, cell_row) : blocks.around(column, cell_row);
    std::uint32_t* const counts = band.counts.room_for(rows.end - rows.first);
    std::size_t counted = 0;
    for (std::size_t row = rows.first; row < rows.end; ++row) {
      // The own cell comes first: pairs in it are found from the row that comes first.
      if (has_halves) block.rows[0].first = row + 1;
      std::uint32_t* const found = band.neighbours.room_for(block.candidates + neighbour_slack);
      std::size_t count = find_neighbours({.x = points.x(),
                                           .y = points.y(),
                                           .size = points.size(),
                                           .p = {points.x()[row], points.y()[row]},
                                           .squared_cutoff = cutoff * cutoff,
                                           .left_out = row,
                                           .box = block.is_at_edge && box.is_periodic() ? &box : nullptr},
                                          block.ranges(), found);
      if (half == Half::yes && !has_halves) {
        count = static_cast<std::size_t>(
            std::remove_if(found, found + count, [&](std::uint32_t other) { return other < row; }) - found);
      }
      band.neighbours.add(count);
      counts[counted++] = static_cast<std::uint32_t>(count);
    }
    band.counts.add(counted);
  });
}

/// The box around points, no smaller than the cutoff.
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
    if (!(length <= most_magnitude)) {
      throw Error({.what = "the points span " + std::to_string(length) + " in one direction",
                   .hint = "use coordinates of at most 1e60"});
    }
    return std::max(length, cutoff);
  };
  return {Box(side(least.x, most.x), side(least.y, most.y), Edge::wall), least};
}

/// Sorts and searches; what is found stays in bands.
class Search {
 public:
  Search(SearchFrame const& frame, double cutoff, PointsInMemory const& points, std::uint64_t threads)
      : box_(frame.box),
        cutoff_(cutoff),
        pool_(threads),
        points_(sorted_for_cutoff(frame.box, frame.origin, cutoff, points, pool_)) {
    ends_ = bands_of(points_, pool_);
    bands_.resize(ends_.size() - 1);
    begin_.resize(bands_.size() + 1, 0);
  }

  PointPairs pairs() {
    search<Half::yes>();
    PointPairs pairs;
    pairs.indices.resize(2 * begin_.back());
    std::uint32_t* const first = pairs.indices.data();
    std::uint32_t* const second = first + begin_.back();
    pool_.for_each(bands_.size(), [&](std::size_t b) {
      std::size_t k = begin_[b];
      for_each_row(b, [&](std::size_t row, std::span<std::uint32_t const> neighbours) {
        for (std::uint32_t const other : neighbours) {
          first[k] = points_.index(row);
          second[k++] = points_.index(other);
        }
      });
    });
    return pairs;
  }

  NeighbourLists lists(std::size_t count) {
    search<Half::no>();
    NeighbourLists lists{.begin = std::vector<std::uint64_t>(count + 1, 0), .neighbours = {}};
    pool_.for_each(bands_.size(), [&](std::size_t b) {
      for_each_row(b, [&](std::size_t row, std::span<std::uint32_t const> neighbours) {
        lists.begin[points_.index(row) + 1] = neighbours.size();
      });
    });
    for (std::size_t i = 0; i < count; ++i) lists.begin[i + 1] += lists.begin[i];
    lists.neighbours.resize(begin_.back());
    pool_.for_each(bands_.size(), [&](std::size_t b) {
      for_each_row(b, [&](std::size_t row, std::span<std::uint32_t const> neighbours) {
        std::size_t k = lists.begin[points_.index(row)];
        for (std::uint32_t const other : neighbours) lists.neighbours[k++] = points_.index(other);
      });
    });
    return lists;
  }

 private:
  template <Half half>
  void search() {
    pool_.for_each(bands_.size(), [&](std::size_t b) {
      search_band<half>(points_, box_, cutoff_, ends_[b], ends_[b + 1], bands_[b]);
    });
    for (std::size_t b = 0; b < bands_.size(); ++b) begin_[b + 1] = begin_[b] + bands_[b].neighbours.size();
  }

  /// Calls visit(row, its neighbours) for every row of a band.
  template <class Visit>
  void for_each_row(std::size_t b, Visit visit) const {
    auto row =
        points_.first_of(static_cast<std::size_t>(ends_[b]) * static_cast<std::size_t>(points_.layout().columns()));
    std::uint32_t const* neighbours = bands_[b].neighbours.begin();
    for (std::uint32_t const count : std::span(bands_[b].counts.begin(), bands_[b].counts.size())) {
      visit(row++, std::span(neighbours, count));
      neighbours += count;
    }
  }

  Box box_;
  double cutoff_;
  ThreadPool pool_;
  SortedPoints points_;
  std::vector<int> ends_;
  std::vector<Band> bands_;
  std::vector<std::size_t> begin_;  ///< of what each band has found, among all
};

SearchFrame frame_of(Box const& box, double cutoff, PointsInMemory const& points) {
  require_bounded_cutoff(cutoff);
  require_point_count(points.count);  // whether all are finite is seen when they are sorted
  require_box_for(box, cutoff);
  return {box, {}};
}

SearchFrame frame_of(double cutoff, PointsInMemory const& points) {
  require_search(points, cutoff);
  return frame_around(points, cutoff);
}

}  // namespace

PointPairs find_pairs(Box const& box, double cutoff, PointsInMemory const& points, std::uint64_t threads) {
  return Search(frame_of(box, cutoff, points), cutoff, points, threads).pairs();
}

NeighbourLists find_neighbour_lists(Box const& box, double cutoff, PointsInMemory const& points,
                                    std::uint64_t threads) {
  return Search(frame_of(box, cutoff, points), cutoff, points, threads).lists(points.count);
}

PointPairs find_pairs(double cutoff, PointsInMemory const& points, std::uint64_t threads) {
  return Search(frame_of(cutoff, points), cutoff, points, threads).pairs();
}

NeighbourLists find_neighbour_lists(double cutoff, PointsInMemory const& points, std::uint64_t threads) {
  return Search(frame_of(cutoff, points), cutoff, points, threads).lists(points.count);
}

}  // namespace gridlock
