// A stranger's points: the search finds what looking at every pair finds, and refuses what it cannot search.

#include <cmath>
#include <cstddef>
#include <cstdio>
#include <limits>
#include <map>
#include <random>
#include <utility>
#include <vector>

#include "gridlock/core/error.hpp"
#include "gridlock/grid/neighbour_search.hpp"

using gridlock::Box;
using gridlock::Edge;
using gridlock::NeighbourSearch;
using gridlock::Vector;

namespace {

using Pairs = std::map<std::pair<std::size_t, std::size_t>, std::pair<double, double>>;

double nearest_image(double d, double side, Edge edge) {
  return edge == Edge::periodic ? d - side * std::round(d / side) : d;
}

Pairs by_brute_force(Box const& box, double cutoff, std::vector<double> const& x, std::vector<double> const& y) {
  Pairs pairs;
  for (std::size_t i = 0; i < x.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      double const dx = nearest_image(x[j] - x[i], box.width(), box.edge_x());
      double const dy = nearest_image(y[j] - y[i], box.height(), box.edge_y());
      if (std::hypot(dx, dy) < cutoff) pairs[{i, j}] = {dx, dy};
    }
  }
  return pairs;
}

bool are_equal(Pairs const& found, Pairs const& expected) {
  if (found.size() != expected.size()) return false;
  for (auto const& [pair, d] : expected) {
    auto const other = found.find(pair);
    if (other == found.end()) return false;
    if (std::hypot(other->second.first - d.first, other->second.second - d.second) > 1e-12) return false;
  }
  return true;
}

/// How many of random points are found wrongly.
int mistakes(Edge edge) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  Box const box(3.0, 2.0, edge);
  int wrong = 0;
  for (double const cutoff : {0.05, 0.3, 1.0}) {
    std::vector<double> x, y;
    for (int n = 0; n < 300; ++n) {
      x.push_back(3.0 * uniform(random));
      y.push_back(2.0 * uniform(random));
    }
    Pairs const expected = by_brute_force(box, cutoff, x, y);
    NeighbourSearch const search(box, cutoff, x, y);
    Pairs by_pairs, by_neighbours;
    search.for_each_pair([&](std::size_t i, std::size_t j, Vector r) { by_pairs[{i, j}] = {r.x, r.y}; });
    for (std::size_t i = 0; i < x.size(); ++i) {
      search.for_each_neighbour(i, [&](std::size_t j, Vector r) {
        if (j < i) by_neighbours[{i, j}] = {r.x, r.y};
      });
    }
    if (expected.empty() || !are_equal(by_pairs, expected) || !are_equal(by_neighbours, expected)) ++wrong;
  }
  return wrong;
}

int accepted(Box const& box, double cutoff, std::vector<double> const& x, std::vector<double> const& y) {
  try {
    NeighbourSearch const search(box, cutoff, x, y);
    return 1;
  } catch (gridlock::Error const&) {
    return 0;
  }
}

}  // namespace

int main() {
  Box const box(1.0, 1.0, Edge::periodic);
  std::vector<double> const good{0.1, 0.2};
  double const nan = std::numeric_limits<double>::quiet_NaN();
  double const infinity = std::numeric_limits<double>::infinity();
  int wrong = mistakes(Edge::wall) + mistakes(Edge::periodic);
  for (double const cutoff : {0.0, -1.0, nan, infinity, 0.51}) wrong += accepted(box, cutoff, good, good);
  for (double const bad : {nan, infinity, -infinity}) wrong += accepted(box, 0.1, {0.1, bad}, good);
  wrong += accepted(box, 0.1, good, {0.1});
  wrong += 1 - accepted(box, 0.5, good, good);
  std::printf("%d mistakes\n", wrong);
  return wrong == 0 ? 0 : 1;
}
