#include "gridlock/device/neighbour_lists.hpp"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "device/backend.hpp"
#include "device/neighbour_kernels.hpp"
#include "device/scan.hpp"
#include "device/sorted_points.hpp"
#include "grid/require.hpp"
#include "gridlock/core/error.hpp"
#include "gridlock/grid/detail/stored_cells.hpp"

namespace gridlock {

namespace {

using namespace device;

void require_room(std::size_t bytes, std::size_t free_memory, char const* what) {
  if (bytes <= free_memory) return;
  throw Error({.what = std::string(what) + " need " + std::to_string(bytes) +
                       " bytes on the graphics processor, of which " + std::to_string(free_memory) + " are free",
               .hint = "use fewer points or a smaller cutoff, or search on the cores",
               .key = "engine.device"});
}

/// Returns the bytes of a search, without what it finds.
std::size_t bytes_for(std::size_t points, CellLayout const& layout) {
  std::size_t const of_sums = sizeof(std::uint64_t) * (points + points / numbers_of_chunk) +
                              sizeof(std::uint32_t) * static_cast<std::size_t>(layout.count()) / numbers_of_chunk;
  return SortedPoints::bytes(points, layout) + 2 * sizeof(double) * points + of_sums;
}

std::vector<double> coordinates(double const* from, PointsInMemory const& points) {
  std::vector<double> values(points.count);
  for (std::size_t i = 0; i < points.count; ++i) values[i] = from[i * points.stride];
  return values;
}

/// A search among points on the device.
class Search {
 public:
  Search(Box const& box, double cutoff, CellLayout const& layout, PointsInMemory const& given, std::size_t free_memory,
         std::uint64_t threads)
      : launcher_(threads),
        count_(given.count),
        squared_cutoff_(cutoff * cutoff),
        left_(free_memory - bytes_for(count_, layout)),
        x_(std::span<double const>(coordinates(given.x, given))),
        y_(std::span<double const>(coordinates(given.y, given))),
        points_(launcher_, box, layout, count_) {
    bool const may_crowd = layout_for_crowd(box, cutoff, count_, layout).has_value();
    are_crowd_ = !points_.sort(x_.data(), y_.data(), may_crowd);
    if (points_.faults().not_finite > 0) require_points_in_memory(given);
  }

  /// Returns whether the cores would use finer cells.
  [[nodiscard]] bool are_crowd() const { return are_crowd_; }

  [[nodiscard]] PointPairs pairs() {
    Array<std::uint64_t> begin(count_ + 1);
    std::size_t const size = count<Partners::later>(begin).back();
    require_room(2 * size * sizeof(std::uint32_t), left_, "the pairs");
    Array<std::uint32_t> indices(2 * size);
    launcher_.for_each(
        count_, WritePairs{points_.memory(), squared_cutoff_, begin.data(), indices.data(), indices.data() + size});
    PointPairs found;
    found.indices.resize(2 * size);
    indices.download(found.indices);
    return found;
  }

  [[nodiscard]] NeighbourLists lists() {
    Array<std::uint64_t> begin(count_ + 1);
    NeighbourLists lists{.begin = count<Partners::all>(begin), .neighbours = {}};
    require_room(lists.begin.back() * sizeof(std::uint32_t), left_, "the neighbours");
    Array<std::uint32_t> neighbours(lists.begin.back());
    launcher_.for_each(count_, WriteNeighbours{points_.memory(), squared_cutoff_, begin.data(), neighbours.data()});
    lists.neighbours.resize(lists.begin.back());
    neighbours.download(lists.neighbours);
    return lists;
  }

 private:
  /// Finds where the partners of each point or row begin.
  template <Partners partners>
  std::vector<std::uint64_t> count(Array<std::uint64_t>& begin) {
    launcher_.for_each(count_, CountPartners<partners>{points_.memory(), squared_cutoff_, begin.data()});
    sum_up(launcher_, begin, count_ + 1);
    std::vector<std::uint64_t> found(count_ + 1);
    begin.download(found);
    return found;
  }

  Launcher launcher_;
  std::size_t count_;
  double squared_cutoff_;
  std::size_t left_;  ///< bytes for what is found
  Array<double> x_;
  Array<double> y_;
  SortedPoints points_;
  bool are_crowd_ = false;
};

/// Returns found(search) of points on the device, or on_cores() where the device does not search.
template <class Found, class OnCores>
auto found_by_device(Box const& box, double cutoff, PointsInMemory const& points, std::uint64_t threads, Found found,
                     OnCores on_cores) {
  require_device();
  require_bounded_cutoff(cutoff);
  require_point_count(points.count);
  require_box_for(box, cutoff);
  CellLayout const layout = layout_for_cutoff(box, cutoff, points.count);
  if (box.is_oblique() || !has_halves(layout) || points.count == 0) return on_cores();
  std::optional<DeviceInfo> const device = find_device();
  std::size_t const free_memory = device ? device->free_memory : 0;
  require_room(bytes_for(points.count, layout), free_memory, "the points");
  Search search(box, cutoff, layout, points, free_memory, threads);
  return search.are_crowd() ? on_cores() : found(search);
}

}  // namespace

PointPairs find_pairs_on_device(Box const& box, double cutoff, PointsInMemory const& points, std::uint64_t threads) {
  return found_by_device(
      box, cutoff, points, threads, [](Search& search) { return search.pairs(); },
      [&] { return find_pairs(box, cutoff, points, threads); });
}

NeighbourLists find_neighbour_lists_on_device(Box const& box, double cutoff, PointsInMemory const& points,
                                              std::uint64_t threads) {
  return found_by_device(
      box, cutoff, points, threads, [](Search& search) { return search.lists(); },
      [&] { return find_neighbour_lists(box, cutoff, points, threads); });
}

}  // namespace gridlock
