#include "engine/soft/lists.hpp"

#include <algorithm>

#include "grid/oblique_lists.hpp"
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
    if (reach_.flows) return true;
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

/// Makes the lists of disks in an oblique box, for each band its rows up to the next of `first_rows`.
std::vector<Band> lists_in_oblique(Box const& box, ListReach const& reach, Disks const& disks,
                                   std::vector<std::size_t> const& first_rows, std::uint64_t threads) {
  std::vector<double> radius(disks.size());
  for (std::size_t row = 0; row < disks.size(); ++row) radius[row] = disks.identities[row].radius;
  PointsInMemory const centres{
      .x = &disks.places.data()->x, .y = &disks.places.data()->y, .count = disks.size(), .stride = 2};
  NeighbourLists const lists = lists_of(
      find_pairs_of_disks(box, {.factor = reach.cutoff, .gap = reach.skin}, centres, radius, threads), disks.size());
  std::vector<Band> bands(first_rows.size() - 1);
  for (std::size_t b = 0; b < bands.size(); ++b) {
    Band& band = bands[b];
    band = {.first = first_rows[b], .end = first_rows[b + 1], .begin = {0}, .entries = {}, .is_at_edge = {}};
    for (std::size_t row = band.first; row < band.end; ++row) {
      for (std::uint64_t n = lists.begin[row]; n < lists.begin[row + 1]; ++n)
        band.entries.push_back(lists.neighbours[n]);
      while (band.entries.size() % entries_at_once != 0) {
        band.entries.push_back(static_cast<std::uint32_t>(disks.size()));
      }
      band.begin.push_back(static_cast<std::uint32_t>(band.entries.size()));
      band.is_at_edge.push_back(1);
    }
  }
  return bands;
}

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
  if (box.is_oblique()) {
    std::vector<std::size_t> first_rows;
    for (int const row : ends) {
      first_rows.push_back(points.first_of(static_cast<std::size_t>(row) * static_cast<std::size_t>(layout.columns())));
    }
    return lists_in_oblique(box, reach, disks, first_rows, pool.size());
  }
  std::vector<Band> bands(ends.size() - 1);
  ListMaker const maker(box, reach, disks, points);
  pool.for_each(bands.size(), [&](std::size_t b) { bands[b] = maker.band(ends[b], ends[b + 1]); });
  return bands;
}

}  // namespace gridlock::soft
