// All pairs of disks whose rims are near, for disks of unequal size: find_pairs_of_disks() beside find_pairs() with the
// distance at contact of the largest, of which the near ones are kept. Nanoseconds a disk; the last column is the
// number of pairs.
//
//     gridlock_bench_unequal_disks [N]        default: 100000

#include <fmt/format.h>

#include <cmath>
#include <cstdlib>
#include <numbers>
#include <string>
#include <vector>

#include "gridlock/core/random.hpp"
#include "gridlock/grid/neighbour_lists.hpp"
#include "measure.hpp"

namespace gridlock::benchmark {
namespace {

constexpr double packing_fraction = 0.8;
/// In radii of the small disks.
constexpr double gap = 0.1;

struct Mixture {
  double ratio;
  double share_of_large;
};

struct Disks {
  Box box;
  std::vector<double> x, y, radius;
  [[nodiscard]] PointsInMemory centres() const { return {.x = x.data(), .y = y.data(), .count = x.size()}; }
};

/// At random points, overlapping; the small ones have radius 1.
Disks disks_of(Mixture const& mixture, std::size_t n) {
  double const mean_square = 1.0 + mixture.share_of_large * (mixture.ratio * mixture.ratio - 1.0);
  double const side = std::sqrt(static_cast<double>(n) * std::numbers::pi * mean_square / packing_fraction);
  Disks disks{.box = Box(side, side, Edge::periodic), .x = {}, .y = {}, .radius = {}};
  RandomStream random(1, 0, 0, Purpose::start_position);
  for (std::size_t i = 0; i < n; ++i) {
    disks.x.push_back(side * random.uniform());
    disks.y.push_back(side * random.uniform());
    disks.radius.push_back(random.uniform() < mixture.share_of_large ? mixture.ratio : 1.0);
  }
  return disks;
}

std::uint64_t near_pairs(Disks const& disks, PointPairs const& pairs) {
  std::uint64_t near = 0;
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    std::uint32_t const i = pairs.first()[k];
    std::uint32_t const j = pairs.second()[k];
    double const reach = disks.radius[i] + disks.radius[j] + gap;
    Vector const d = disks.box.displacement({disks.x[i], disks.y[i]}, {disks.x[j], disks.y[j]});
    near += squared_length(d) < reach * reach ? 1 : 0;
  }
  return near;
}

void measure(Mixture const& mixture, std::size_t n) {
  Disks const disks = disks_of(mixture, n);
  std::uint64_t of_all = 0;
  std::uint64_t of_classes = 0;
  auto const items = static_cast<double>(n);
  std::string const name =
      fmt::format("pairs of disks 1:{}; {:.3g} % large", mixture.ratio, 100.0 * mixture.share_of_large);
  race(
      name.c_str(), n, packing_fraction, 5,
      {{.name = "cells of the largest",
        .items = items,
        .run = [&] { of_all = near_pairs(disks, find_pairs(disks.box, 2.0 * mixture.ratio + gap, disks.centres())); },
        .result = [&] { return of_all; }},
       {.name = "cells by size",
        .items = items,
        .run = [&] { of_classes = find_pairs_of_disks(disks.box, {.gap = gap}, disks.centres(), disks.radius).size(); },
        .result = [&] { return of_classes; }}});
}

}  // namespace
}  // namespace gridlock::benchmark

int main(int argument_count, char** arguments) {
  using namespace gridlock::benchmark;
  std::size_t const n = argument_count > 1 ? std::strtoull(arguments[1], nullptr, 10) : 100'000;
  print_header();
  for (Mixture const& mixture : {Mixture{1.0, 0.0}, Mixture{1.4, 0.5}, Mixture{3.0, 0.5}, Mixture{10.0, 0.5},
                                 Mixture{3.0, 0.1}, Mixture{10.0, 0.01}, Mixture{30.0, 0.001}}) {
    measure(mixture, n);
  }
}
