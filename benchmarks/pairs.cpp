// Updating the grid and visiting every pair within the cutoff, at about six neighbours an agent: the paper's layout,
// the packed grid and, where it is installed, nanoflann's k-d tree. Nanoseconds per agent.

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <memory>
#include <numbers>
#include <numeric>
#include <span>
#include <vector>

#ifdef GRIDLOCK_HAVE_NANOFLANN
#include <nanoflann.hpp>
#endif

#include "grid/candidate_pairs.hpp"
#include "grid/pairs.hpp"
#include "gridlock/core/random.hpp"
#include "measure.hpp"

namespace gridlock::benchmark {
namespace {

/// Uniform points, the rows in no order.
State uniform_points(std::size_t n) {
  State state{.box = Box(1.0, 1.0, Edge::wall), .seed = 1};
  state.agents.reserve(n);
  RandomStream random(1, 0, 0, Purpose::start_position);
  for (std::size_t i = 0; i < n; ++i) state.agents.add(random.uniform(), random.uniform(), 0, 0, 1e-9, 1, 0, 0);
  return state;
}

/// The same points, the rows in the order of their cells.
State in_cell_order(State const& state, double cutoff) {
  LinkedGrid const grid = grid_for_cutoff<LinkedGrid>(state, cutoff);
  State ordered{.box = state.box, .seed = state.seed};
  ordered.agents.reserve(state.agents.size());
  for (int cell = 0; cell < grid.layout().count(); ++cell) {
    grid.for_each_in_cell(cell, [&](std::size_t i) {
      Vector const p = position(state.agents, i);
      ordered.agents.add(p.x, p.y, 0, 0, 1e-9, 1, 0, 0);
    });
  }
  return ordered;
}

/// A sum that neither depends on which agent is named first nor can be left out by the compiler.
struct Sum {
  std::uint64_t pairs = 0;
  double squared_distances = 0.0;
};

/// The packed grid as it is on a processor without AVX-512.
class PlainGrid : public PackedGrid {
 public:
  using PackedGrid::PackedGrid;
  template <class Visit, class Expect = ExpectNothing>
  void for_each_candidate_pair(double cutoff, Visit visit, Expect expect = {}) const {
    gridlock::find_candidate_pairs(*this, cutoff, add_pairs_of_row_scalar,
                                   [&](std::span<AgentPair const> pairs) { visit_pairs(pairs, visit, expect); });
  }
};

/// Every round the agents move a little and back, as in one time step.
template <NeighbourGrid Grid>
Contestant grid_contestant(std::string name, State const& start, double cutoff) {
  auto const state = std::make_shared<State>(start);
  auto const grid = std::make_shared<Grid>(grid_for_cutoff<Grid>(*state, cutoff));
  auto const sum = std::make_shared<Sum>();
  auto const sign = std::make_shared<double>(1.0);
  return {.name = std::move(name),
          .items = static_cast<double>(start.agents.size()),
          .run =
              [=] {
                *sum = {};
                for (double& x : state->agents.column<X>()) x += *sign * 0.02 * cutoff;
                *sign = -*sign;
                grid->move_all(state->agents.column<X>(), state->agents.column<Y>());
                for_each_pair(*state, *grid, cutoff, [&](std::size_t, std::size_t, Vector separation) {
                  ++sum->pairs;
                  sum->squared_distances += squared_length(separation);
                });
              },
          .result = [=] { return sum->pairs; }};
}

/// The paper's own search: every agent looks at the nine lists around it, so that each pair is met twice.
Contestant literal_contestant(State const& start, double cutoff) {
  auto const state = std::make_shared<State>(start);
  auto const grid = std::make_shared<LinkedGrid>(grid_for_cutoff<LinkedGrid>(*state, cutoff));
  auto const sum = std::make_shared<Sum>();
  auto const sign = std::make_shared<double>(1.0);
  return {.name = "the paper's lists",
          .items = static_cast<double>(start.agents.size()),
          .run =
              [=] {
                *sum = {};
                for (double& x : state->agents.column<X>()) x += *sign * 0.02 * cutoff;
                *sign = -*sign;
                grid->move_all(state->agents.column<X>(), state->agents.column<Y>());
                for (std::size_t i = 0; i < state->agents.size(); ++i) {
                  Vector const here = position(state->agents, i);
                  grid->for_each_in_block(grid->cell_of(i), 1, 1, [&](std::size_t j) {
                    Vector const separation = position(state->agents, j) - here;
                    if (j == i || !(squared_length(separation) < cutoff * cutoff)) return;
                    sum->pairs += j < i ? 1 : 0;
                    sum->squared_distances += squared_length(separation);
                  });
                }
              },
          .result = [=] { return sum->pairs; }};
}

#ifdef GRIDLOCK_HAVE_NANOFLANN
struct Cloud {
  std::vector<double> x, y;
  [[nodiscard]] std::size_t kdtree_get_point_count() const { return x.size(); }
  [[nodiscard]] double kdtree_get_pt(std::size_t i, std::size_t axis) const { return axis == 0 ? x[i] : y[i]; }
  template <class BoundingBox>
  bool kdtree_get_bbox(BoundingBox&) const {
    return false;
  }
};

Contestant nanoflann_contestant(State const& start, double cutoff) {
  auto const cloud = std::make_shared<Cloud>();
  cloud->x.assign(start.agents.column<X>().begin(), start.agents.column<X>().end());
  cloud->y.assign(start.agents.column<Y>().begin(), start.agents.column<Y>().end());
  auto const sum = std::make_shared<Sum>();
  auto const sign = std::make_shared<double>(1.0);
  return {.name = "nanoflann: agents in cell order",
          .items = static_cast<double>(start.agents.size()),
          .run =
              [=] {
                *sum = {};
                for (double& x : cloud->x) x += *sign * 0.02 * cutoff;
                *sign = -*sign;
                using Tree = nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<double, Cloud>, Cloud, 2,
                                                                 std::uint32_t>;
                Tree tree(2, *cloud, nanoflann::KDTreeSingleIndexAdaptorParams(16));
                std::vector<std::pair<std::uint32_t, double>> found;
                nanoflann::SearchParams parameters;
                parameters.sorted = false;
                for (std::uint32_t i = 0; i < cloud->x.size(); ++i) {
                  double const p[2] = {cloud->x[i], cloud->y[i]};
                  found.clear();
                  tree.radiusSearch(p, cutoff * cutoff, found, parameters);
                  for (auto const& [j, squared] : found) {
                    if (j >= i) continue;
                    ++sum->pairs;
                    sum->squared_distances += squared;
                  }
                }
              },
          .result = [=] { return sum->pairs; }};
}
#endif

void race_at(std::size_t n, int rounds) {
  // n π r² = 6 neighbours in the unit box.
  double const cutoff = std::sqrt(6.0 / (std::numbers::pi * static_cast<double>(n)));
  State const scattered = uniform_points(n);
  State const ordered = in_cell_order(scattered, cutoff);
  std::vector<Contestant> contestants;
  contestants.push_back(literal_contestant(scattered, cutoff));
  contestants.push_back(grid_contestant<LinkedGrid>("linked grid: agents in no order", scattered, cutoff));
  contestants.push_back(grid_contestant<LinkedGrid>("linked grid: agents in cell order", ordered, cutoff));
  contestants.push_back(grid_contestant<PackedGrid>("packed grid: agents in no order", scattered, cutoff));
  contestants.push_back(
      grid_contestant<PlainGrid>("packed grid without AVX-512: agents in cell order", ordered, cutoff));
  contestants.push_back(grid_contestant<PackedGrid>("packed grid: agents in cell order", ordered, cutoff));
#ifdef GRIDLOCK_HAVE_NANOFLANN
  contestants.push_back(nanoflann_contestant(ordered, cutoff));
#endif
  race("pairs", n, 0.0, rounds, std::move(contestants));
}

}  // namespace
}  // namespace gridlock::benchmark

int main(int argc, char** argv) {
  using namespace gridlock::benchmark;
  print_header();
  if (argc > 1) {
    race_at(std::strtoull(argv[1], nullptr, 10), 5);
    return 0;
  }
  race_at(10'000, 50);
  race_at(100'000, 10);
  race_at(1'000'000, 5);
}
