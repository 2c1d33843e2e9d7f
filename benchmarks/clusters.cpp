// Points that crowd in a small part of the box beside as many uniform ones with the same number of neighbours: building
// the search, updating it, all pairs, all neighbours of each, and two models. Nanoseconds per point; a counting sort of
// the points beside, and all pairs by it from scratch.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <memory>
#include <numbers>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

#include "gridlock/core/detail/thread_pool.hpp"
#include "gridlock/core/random.hpp"
#include "gridlock/grid/detail/cell_list.hpp"
#include "gridlock/grid/neighbour_lists.hpp"
#include "gridlock/grid/neighbour_search.hpp"
#include "measure.hpp"
#include "models/epidemic.hpp"
#include "models/flocking.hpp"

namespace gridlock::benchmark {
namespace {

/// Where points are: a share of them in a square in the middle that has a share of the area.
struct Crowd {
  std::string name;
  double share_of_points = 0.0;
  double share_of_area = 1.0;

  /// By how much the mean density around a point exceeds that of uniform points.
  [[nodiscard]] double crowding() const {
    double const inside = share_of_points + (1.0 - share_of_points) * share_of_area;
    return inside * inside / share_of_area + (1.0 - inside) * (1.0 - inside) / (1.0 - share_of_area + 1e-300);
  }
  [[nodiscard]] Vector place(RandomStream& random) const {
    bool const is_inside = random.uniform() < share_of_points;
    Vector p{random.uniform(), random.uniform()};
    double const side = std::sqrt(share_of_area);
    if (is_inside) p = {0.5 + side * (p.x - 0.5), 0.5 + side * (p.y - 0.5)};
    return p;
  }
};

std::vector<Crowd> crowds() {
  return {{"uniform", 0.0, 1.0}, {"clustered", 0.9, 0.01}, {"clustered on 0.1 %", 0.9, 1e-3}};
}

struct Points {
  std::vector<double> x, y;
  double cutoff = 0.0;
};

Points points_of(Crowd const& crowd, std::size_t n, double neighbours) {
  Points points;
  points.cutoff = std::sqrt(neighbours / (std::numbers::pi * static_cast<double>(n) * crowd.crowding()));
  RandomStream random(1, 0, 0, Purpose::start_position);
  for (std::size_t i = 0; i < n; ++i) {
    Vector const p = crowd.place(random);
    points.x.push_back(p.x);
    points.y.push_back(p.y);
  }
  return points;
}

/// The same points row by row of cells of the cutoff.
Points in_cell_order(Points const& points) {
  std::vector<std::size_t> order(points.x.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::sort(order, {}, [&](std::size_t i) {
    return std::pair(std::floor(points.y[i] / points.cutoff), std::floor(points.x[i] / points.cutoff));
  });
  Points ordered{.cutoff = points.cutoff};
  for (std::size_t const i : order) {
    ordered.x.push_back(points.x[i]);
    ordered.y.push_back(points.y[i]);
  }
  return ordered;
}

/// What a short program does: a counting sort, and every point of half the 3×3 block of cells compared.
std::uint64_t count_pairs_plainly(Box const& box, double cutoff, PointsInMemory const& points) {
  ThreadPool pool(1);
  CellLayout const layout = layout_for_cutoff(box, cutoff, points.count);
  CellList const sorted(layout, {}, points, pool);
  double const* const x = sorted.x();
  double const* const y = sorted.y();
  std::uint64_t pairs = 0;
  auto const compare = [&](std::size_t row, std::size_t first, std::size_t end) {
    for (std::size_t other = first; other < end; ++other) {
      Vector const d = box.displacement_inside({x[row], y[row]}, {x[other], y[other]});
      if (squared_length(d) < cutoff * cutoff) ++pairs;
    }
  };
  auto const wrapped = [](int index, int count) {
    return index < 0 ? index + count : index >= count ? index - count : index;
  };
  for (int cell_row = 0; cell_row < layout.rows(); ++cell_row) {
    int const above = wrapped(cell_row + 1, layout.rows());
    for (int column = 0; column < layout.columns(); ++column) {
      std::array<std::pair<int, int>, 4> const around{{{wrapped(column + 1, layout.columns()), cell_row},
                                                       {wrapped(column - 1, layout.columns()), above},
                                                       {column, above},
                                                       {wrapped(column + 1, layout.columns()), above}}};
      std::size_t const end = sorted.first_of(column + 1, cell_row);
      for (std::size_t row = sorted.first_of(column, cell_row); row < end; ++row) {
        compare(row, row + 1, end);
        for (auto const& [c, r] : around) compare(row, sorted.first_of(c, r), sorted.first_of(c + 1, r));
      }
    }
  }
  return pairs;
}

void race_at(Crowd const& crowd, std::string const& order, Points const& start, double neighbours, int rounds) {
  Box const box(1.0, 1.0, Edge::periodic);
  auto const points = std::make_shared<Points>(start);
  auto const found = std::make_shared<std::uint64_t>(0);
  std::size_t const n = points->x.size();
  PointsInMemory const in_memory{.x = points->x.data(), .y = points->y.data(), .count = n};
  auto const contestant = [&](std::string name, std::function<void()> run) {
    return Contestant{.name = std::move(name), .items = static_cast<double>(n), .run = std::move(run), .result = [=] {
                        return *found;
                      }};
  };
  auto const search = std::make_shared<NeighbourSearch>(box, points->cutoff, points->x, points->y);
  auto const sign = std::make_shared<double>(1.0);
  std::vector<Contestant> contestants;
  contestants.push_back(contestant("counting sort", [=] {
    ThreadPool pool(1);
    CellList const sorted(layout_for_cutoff(box, points->cutoff, n), {}, in_memory, pool);
    *found = sorted.index(n / 2) < n ? n : 0;
  }));
  contestants.push_back(contestant("build", [=] {
    NeighbourSearch const built(box, points->cutoff, points->x, points->y);
    *found = built.size();
  }));
  contestants.push_back(contestant("update", [=] {
    for (double& x : points->x) x += *sign * 0.02 * points->cutoff;
    *sign = -*sign;
    search->update(points->x, points->y);
    *found = n;
  }));
  contestants.push_back(contestant("all pairs", [=] {
    std::uint64_t pairs = 0;
    search->for_each_pair([&](std::size_t, std::size_t, Vector) { ++pairs; });
    *found = pairs;
  }));
  contestants.push_back(contestant("counting sort with all pairs",
                                   [=] { *found = count_pairs_plainly(box, points->cutoff, in_memory); }));
  contestants.push_back(contestant("build with all pairs", [=] {
    std::uint64_t pairs = 0;
    NeighbourSearch(box, points->cutoff, points->x, points->y).for_each_pair([&](std::size_t, std::size_t, Vector) {
      ++pairs;
    });
    *found = pairs;
  }));
  contestants.push_back(contestant("neighbours of each", [=] {
    std::uint64_t count = 0;
    for (std::size_t i = 0; i < n; ++i) search->for_each_neighbour(i, [&](std::size_t, Vector) { ++count; });
    *found = count;
  }));
  contestants.push_back(contestant("find_pairs", [=] { *found = find_pairs(box, points->cutoff, in_memory).size(); }));
  contestants.push_back(contestant("find_neighbour_lists", [=] {
    *found = find_neighbour_lists(box, points->cutoff, in_memory).neighbours.size();
  }));
  std::string const name = crowd.name + "; " + order + "; " + std::to_string(static_cast<int>(neighbours)) + " near";
  race(name.c_str(), n, 0.0, rounds, std::move(contestants));
}

template <class Model>
Contestant contestant(std::string name, Model const& model, Box const& box, Crowd const& crowd) {
  constexpr std::uint64_t steps = 2;
  auto const world = std::make_shared<World<Model>>(World<Model>{.box = box, .seed = 1});
  start_agents(model, *world);
  RandomStream random(1, 0, 0, Purpose::start_position);
  for (std::size_t row = 0; row < world->agents.size(); ++row) {
    Vector const p = crowd.place(random);
    world->agents.template column<X>()[row] = p.x * box.width();
    world->agents.template column<Y>()[row] = p.y * box.height();
  }
  auto const engine = std::make_shared<ModelEngine<Model>>(model, box, ModelEngineSettings{});
  return {.name = std::move(name),
          .items = static_cast<double>(world->agents.size() * steps),
          .run = [=] { engine->advance(*world, {.step = world->clock.step + steps}); },
          .result = [=] { return hash(*world); }};
}

void race_models(std::size_t n, int rounds) {
  std::vector<Contestant> contestants;
  for (Crowd const& crowd : crowds()) {
    // Six neighbours within a radius of one, as far as the crowd has them.
    double const side = std::sqrt(static_cast<double>(n) * crowd.crowding() * std::numbers::pi / 6.0);
    Box const box(side, side, Edge::periodic);
    contestants.push_back(contestant("flocking, " + crowd.name, Flocking{.count = n, .speed = 0.05}, box, crowd));
    Epidemic const epidemic{.count = n,
                            .infected_at_start = 0.1,
                            .radius = 1.0,
                            .speed = 1.0,
                            .infection_rate = 0.1,
                            .turnover_rate = 0.02,
                            .step_length = 0.05};
    contestants.push_back(contestant("epidemic, " + crowd.name, epidemic, box, crowd));
  }
  race("models", n, 0.0, rounds, std::move(contestants));
}

}  // namespace
}  // namespace gridlock::benchmark

int main(int argc, char** argv) {
  using namespace gridlock::benchmark;
  print_header();
  std::size_t const n = argc > 1 ? std::strtoull(argv[1], nullptr, 10) : 1'000'000;
  for (Crowd const& crowd : crowds()) {
    for (double const neighbours : {1.0, 6.0}) {
      Points const points = points_of(crowd, n, neighbours);
      race_at(crowd, "no order", points, neighbours, 3);
      race_at(crowd, "cell order", in_cell_order(points), neighbours, 3);
    }
  }
  race_models(n, 3);
}
