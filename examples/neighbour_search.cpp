// All pairs of 100,000 points of your own that are nearer than a cutoff, in a periodic box, and the neighbours of one
// point.
#include "gridlock/grid/neighbour_search.hpp"

#include <cstdio>
#include <random>
#include <vector>

int main() {
  gridlock::Box const box(1.0, 1.0, gridlock::Edge::periodic);
  std::vector<double> x(100'000);
  std::vector<double> y(x.size());
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  for (std::size_t i = 0; i < x.size(); ++i) {
    x[i] = uniform(random);
    y[i] = uniform(random);
  }

  gridlock::NeighbourSearch const search(box, 0.005, x, y);
  std::size_t pairs = 0;
  search.for_each_pair([&](std::size_t, std::size_t, gridlock::Vector) { ++pairs; });
  std::printf("%zu pairs, %.2f neighbours a point\n", pairs,
              2.0 * static_cast<double>(pairs) / static_cast<double>(x.size()));

  std::printf("the neighbours of point 7:\n");
  search.for_each_neighbour(7, [](std::size_t j, gridlock::Vector separation) {
    std::printf("point %zu at (%+.4f, %+.4f) from it\n", j, separation.x, separation.y);
  });
}
