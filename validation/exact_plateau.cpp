// The pressure of about 256² disks between the liquid and the hexatic phase, from long runs of the engine `exact` with
// the audit on, against published values.
//
//     gridlock_validate_exact_plateau START PACKING_FRACTION [millions of collisions]      5000 where no number is given
//
// START is where the disks come from, and equilibrium is where the starts meet:
//   rows        rows as far apart as the disks in them, which melt at once into many small crystals
//   crystal     one crystal
//   compressed  a liquid at 0.698, its disks grown in small steps, each as far as the closest pair allows
// The second half of the collisions is measured; stderr shows how the pressure comes to rest in the first.
//
// Published: Li et al. 2022, P* = βPσ² of N hard disks in a periodic square box, by event-driven dynamics.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <numbers>
#include <string_view>

#include "gridlock/engine/engine.hpp"
#include "gridlock/grid/neighbour_search.hpp"
#include "gridlock/observe/estimate.hpp"
#include "periodic_systems.hpp"

namespace gridlock::validation {
namespace {

struct Published {
  double packing_fraction;
  double pressure;
  double error;
};

constexpr Published plateau[] = {
    {0.698, 9.17059, 0.00018}, {0.700, 9.18896, 0.00024}, {0.704, 9.18903, 0.00039}, {0.708, 9.18226, 0.00026},
    {0.712, 9.17715, 0.00021}, {0.716, 9.17823, 0.00041}, {0.720, 9.22350, 0.00075},
};

Published const* published_at(double packing_fraction) {
  for (Published const& p : plateau) {
    if (std::abs(p.packing_fraction - packing_fraction) < 1e-9) return &p;
  }
  return nullptr;
}

double diameter_at(State const& state, double packing_fraction) {
  double const area = state.box.width() * state.box.height();
  return std::sqrt(packing_fraction * area * 4.0 / std::numbers::pi / static_cast<double>(state.agents.size()));
}

double closest_pair(State const& state, double cutoff) {
  NeighbourSearch const search(state.box, cutoff, state.agents.column<X>(), state.agents.column<Y>());
  double squared = cutoff * cutoff;
  search.for_each_pair(
      [&](std::size_t, std::size_t, Vector separation) { squared = std::min(squared, squared_length(separation)); });
  return std::sqrt(squared);
}

/// Grows all disks until they fill `packing_fraction` of the box, and lets `duration` pass between two steps of growth.
///
/// A duration, because after a number of collisions the last pair would still touch, and nothing could grow.
void compress(State& state, double packing_fraction, double duration) {
  double const goal = diameter_at(state, packing_fraction);
  double diameter = 2.0 * state.agents.column<Radius>()[0];
  std::uint64_t rounds = 0;
  while (diameter < goal) {
    Counters counters;
    make_engine({.kind = "exact"}, state)->advance(state, counters, {.time = state.clock.time + duration});
    // One part in 10¹⁵ short of contact: what remains is for the rounding of the sum of two radii.
    diameter = std::min(goal, closest_pair(state, 1.5 * diameter) * (1.0 - 1e-15));
    for (double& radius : state.agents.column<Radius>()) radius = 0.5 * diameter;
    if (++rounds % 1000 == 0) {
      std::fprintf(stderr, "%llu steps of growth, %.6f\n", static_cast<unsigned long long>(rounds),
                   std::pow(diameter / goal, 2) * packing_fraction);
    }
  }
}

State start(std::string_view name, double packing_fraction) {
  if (name == "crystal") return rows_of_disks(239, 276, packing_fraction);
  if (name == "rows") return rows_of_disks(256, 256, packing_fraction);
  State state = rows_of_disks(256, 256, 0.698);
  Counters counters;
  make_engine({.kind = "exact"}, state)->advance(state, counters, {.pair_collisions = 100'000'000});
  compress(state, packing_fraction, 0.02);
  return state;
}

void measure(std::string_view start_name, Published const& p, std::uint64_t collisions) {
  State state = start(start_name, p.packing_fraction);
  state.clock = {};
  auto const engine = make_engine({.kind = "exact", .audit_every = 20 * state.agents.size()}, state);
  Counters counters;
  BlockAverage average;
  constexpr std::uint64_t chunks = 1024;
  for (std::uint64_t chunk = 1; chunk <= chunks; ++chunk) {
    double const time = state.clock.time;
    double const pressure =
        pressure_up_to({.pair_collisions = collisions / chunks * chunk}, *engine, state, counters, p.packing_fraction);
    if (chunk > chunks / 2) average.add(pressure, state.clock.time - time);
    if (chunk % 16 == 0) {
      std::fprintf(stderr, "%s %.3f %4llu/%llu %.5f\n", start_name.data(), p.packing_fraction,
                   static_cast<unsigned long long>(chunk), static_cast<unsigned long long>(chunks), pressure);
    }
  }
  Estimate const mean = *average.estimate();
  std::printf("%zu,%.3f,%s,%llu,%.6f,%.6f,%.6f,%.6f,%.2f\n", state.agents.size(), p.packing_fraction, start_name.data(),
              static_cast<unsigned long long>(collisions), mean.value, *mean.error, p.pressure, p.error,
              (mean.value - p.pressure) / std::hypot(*mean.error, p.error));
}

}  // namespace
}  // namespace gridlock::validation

int main(int argument_count, char** arguments) {
  using namespace gridlock::validation;
  std::string_view const start = argument_count > 2 ? arguments[1] : "";
  Published const* const published = argument_count > 2 ? published_at(std::strtod(arguments[2], nullptr)) : nullptr;
  if ((start != "rows" && start != "crystal" && start != "compressed") || published == nullptr) {
    std::fprintf(stderr,
                 "say rows, crystal or compressed, a packing fraction of the published seven from 0.698 to 0.720, "
                 "and then perhaps how many millions of collisions\n");
    return 2;
  }
  measure(start, *published, 1'000'000 * (argument_count > 3 ? std::strtoull(arguments[3], nullptr, 10) : 5000));
}
