// One birth and one death at random places among 10⁶ agents, population and grid together, and the memory that 10⁸ of
// each leave behind.

#include <cstdio>
#include <fstream>
#include <memory>
#include <string>
#include <vector>

#include "gridlock/core/random.hpp"
#include "gridlock/grid/packed_grid.hpp"
#include "gridlock/model/open_world.hpp"
#include "measure.hpp"

namespace gridlock::benchmark {
namespace {

struct Points {
  static constexpr Schedule schedule = Schedule::events;
  using Agents = Population<X, Y>;
};

/// A fast generator of its own, so that the drawing of places is no part of what is measured.
struct Places {
  std::uint64_t word = 88172645463325252ULL;
  std::uint64_t next() {
    word ^= word << 13;
    word ^= word >> 7;
    word ^= word << 17;
    return word;
  }
  double uniform() { return static_cast<double>(next() >> 11) * 0x1.0p-53; }
};

/// Kibibytes of memory in use.
double resident() {
  std::ifstream file("/proc/self/status");
  for (std::string word; file >> word;) {
    double kibibytes = 0.0;
    if (word == "VmRSS:" && file >> kibibytes) return kibibytes;
  }
  return 0.0;
}

}  // namespace
}  // namespace gridlock::benchmark

int main() {
  using namespace gridlock;
  using namespace gridlock::benchmark;
  constexpr std::size_t agents = 1'000'000;
  World<Points> world{.box = Box(1000.0, 1000.0, Edge::periodic), .seed = 1};
  PackedGrid grid(layout_for_reach(world.box, 1.4, agents));
  OpenWorld<Points> open(world, grid, false);
  Places places;
  for (std::size_t n = 0; n < agents; ++n) open.add(1000.0 * places.uniform(), 1000.0 * places.uniform());
  auto const churn = [&](std::size_t times) {
    for (std::size_t k = 0; k < times; ++k) {
      open.remove(open.agent_in_row(places.next() % agents));
      open.add(1000.0 * places.uniform(), 1000.0 * places.uniform());
    }
  };
  // The same deaths and births, a thousand of each known at a time.
  std::vector<Id> dying(1000);
  std::vector<Points::Agents::Values> newborn(dying.size());
  auto const churn_known = [&](std::size_t times) {
    for (std::size_t k = 0; k < times; k += dying.size()) {
      // One of every thousandth of the rows, so that nobody is drawn twice.
      for (std::size_t n = 0; n < dying.size(); ++n) {
        dying[n] = open.agent_in_row(n * (agents / dying.size()) + places.next() % (agents / dying.size()));
      }
      for (auto& values : newborn) values = {1000.0 * places.uniform(), 1000.0 * places.uniform()};
      open.remove_all(dying);
      open.add_all(newborn);
    }
  };
  print_header();
  race("population", agents, 0.0, 6,
       {{.name = "one birth and one death",
         .items = 1e6,
         .run = [&] { churn(1'000'000); },
         .result = [&] { return hash(world); }},
        {.name = "a thousand known beforehand",
         .items = 1e6,
         .run = [&] { churn_known(1'000'000); },
         .result = [&] { return hash(world); }}});
  double const before = resident();
  churn_known(100'000'000);
  std::printf("# memory before and after 1e8 births and deaths: %.1f and %.1f MiB\n", before / 1024.0,
              resident() / 1024.0);
}
