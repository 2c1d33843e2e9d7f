#include "engine/soft/lists.hpp"

#include <algorithm>

#include "gridlock/grid/cell_layout.hpp"
#include "gridlock/grid/detail/cell_list.hpp"
#include "gridlock/grid/detail/find_neighbours.hpp"

namespace gridlock::soft {

namespace {

/// Lists for disks that lie in the order of the points of a cell list.
class ListMaker {
 public:
  ListMaker(Box const& box, ListReach const& reach, Disks const& disks, CellList const& points)
      : box_(box),
        reach_(reach),
        disks_(disks),
        points_(points),
        range_(reach.cutoff * reach.largest_sigma + reach.skin),
        squared_range_(range_ * range_) {}

  [[nodiscard]] Band band(int first_row, int end_row) const {
    auto const first_of = [&](int row) {
      return points_.first_of(static_cast<std::size_t>(row) * static_cast<std::size_t>(points_.layout().columns()));
    };
    Band band{.first = first_of(first_row), .end = first_of(end_row), .begin = {0}, .entries = {}, .is_at_edge = {}};
    auto const blocks = points_.blocks();
    points_.for_each_cell(first_row, end_row, [&](int column, int cell_row, RowRange rows) {
      RowBlock const block = blocks.around(column, cell_row);
      for (std::size_t row = rows.first; row < rows.end; ++row) add(block, row, band);
    });
    return band;
  }

 private:
  void add(RowBlock const& block, std::size_t row, Band& band) const {
    std::size_t const begin = band.begin.back();
    std::size_t const room = begin + block.candidates + neighbour_slack + entries_at_once;
    if (band.entries.size() < room) band.entries.resize(std::max(room, band.entries.size() * 3 / 2));
    std::uint32_t* const found = band.entries.data() + begin;
    Vector const p{points_.x()[row], points_.y()[row]};
    std::size_t count = find_neighbours({.x = points_.x(),
                                         .y = points_.y(),
                                         .size = points_.size(),
                                         .p = p,
                                         .squared_cutoff = squared_range_,
                                         .left_out = row,
                                         .box = block.is_at_edge && box_.has_images() ? &box_ : nullptr},
                                        block.ranges(), found);
    if (!reach_.are_equal) count = without_far(row, found, count);
    for (; count % entries_at_once != 0; ++count) found[count] = static_cast<std::uint32_t>(disks_.size());
    band.begin.push_back(static_cast<std::uint32_t>(begin + count));
    band.is_at_edge.push_back(is_near_edge(p) ? 1 : 0);
  }

  /// Removes neighbours that are far for their own sizes; returns how many are left.
  std::size_t without_far(std::size_t row, std::uint32_t* found, std::size_t count) const {
    auto const is_far = [&](std::uint32_t other) {
      double const sigma = disks_.identities[row].radius + disks_.identities[other].radius;
      double const range = reach_.cutoff * sigma + reach_.skin;
      return squared_length(box_.displacement(disks_.places[row], disks_.places[other])) >= range * range;
    };
    return static_cast<std::size_t>(std::remove_if(found, found + count, is_far) - found);
  }

  [[nodiscard]] bool is_near_edge(Vector p) const {
    double const margin = range_ + reach_.skin;
    return p.x < margin || p.x > box_.width() - margin || p.y < margin || p.y > box_.height() - margin;
  }

  Box box_;
  ListReach reach_;
  Disks const& disks_;
  CellList const& points_;
  double range_;
  double squared_range_;
};

}  // namespace

std::vector<Band> make_lists(Box const& box, ListReach const& reach, Disks& disks, ThreadPool& pool) {
  double const range = reach.cutoff * reach.largest_sigma + reach.skin;
  CellLayout const layout = layout_for_cutoff(box, range, disks.size());
  PointsInMemory const centres{
      .x = &disks.places.data()->x, .y = &disks.places.data()->y, .count = disks.size(), .stride = 2};
  CellList const points(layout, {}, centres, pool);
  disks.reorder(points.indices());
  for (std::size_t row = 0; row < disks.size(); ++row) disks.motions[row].listed_at = disks.places[row];
  std::vector<int> const ends = bands_of(points, pool);
  std::vector<Band> bands(ends.size() - 1);
  ListMaker const maker(box, reach, disks, points);
  pool.for_each(bands.size(), [&](std::size_t b) { bands[b] = maker.band(ends[b], ends[b + 1]); });
  return bands;
}

}  // namespace gridlock::soft
