// Swap Monte Carlo of σ⁻³ disks: trial moves in a second, and the sweeps in which the fluid relaxes.
//
//     gridlock_bench_swap_monte_carlo DENSITY DISKS SWEEPS SWAP_FRACTION

#include "gridlock/engine/swap_monte_carlo.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <string>

#include "gridlock/grid/neighbour_search.hpp"
#include "gridlock/lattice/start.hpp"

namespace {

using namespace gridlock;

/// The factor by which all disks can grow, up to `most`, before two of them touch.
double room_to_grow(State const& state, double most) {
  auto const radii = state.agents.column<Radius>();
  double const cutoff = 3.0 * radius_range(state.agents).largest;
  NeighbourSearch const search(state.box, cutoff, state.agents.column<X>(), state.agents.column<Y>());
  double room = most;
  search.for_each_pair([&](std::size_t i, std::size_t j, Vector separation) {
    room = std::min(room, (1.0 - 1e-9) * std::sqrt(squared_length(separation)) / (radii[i] + radii[j]));
  });
  return room;
}

/// Makes a fluid dense: in turns some sweeps, and all disks grow until two touch.
void compress(State& state, double packing_fraction) {
  for (std::uint64_t round = 0; covered_area(state.agents) < packing_fraction * state.box.area() * (1.0 - 1e-6);
       ++round) {
    SwapMonteCarlo swaps({.sweeps = 20, .step = 0.05, .stage = 1000 + round}, state);
    swaps.advance(state);
    double const growth =
        room_to_grow(state, std::sqrt(packing_fraction * state.box.area() / covered_area(state.agents)));
    for (double& radius : state.agents.column<Radius>()) radius *= growth;
  }
}

std::string text(std::optional<double> value) { return value ? fmt::format("{:.4g}", *value) : "none"; }

}  // namespace

int main(int argc, char** argv) {
  if (argc != 5) {
    fmt::print(stderr, "usage: {} DENSITY DISKS SWEEPS SWAP_FRACTION\n", argv[0]);
    return 2;
  }
  double const packing_fraction = std::stod(argv[1]);
  DisksSettings const disks{.count = std::stoull(argv[2]),
                            .packing_fraction = std::min(packing_fraction, 0.5),
                            .sizes = SizeDistribution::inverse_cube,
                            .start = StartKind::random};
  State state = make_start(Box(1.0, 1.0, Edge::periodic), disks, 3);
  compress(state, packing_fraction);
  SwapSettings const settings{.sweeps = std::stoull(argv[3]), .swap_fraction = std::stod(argv[4])};
  SwapMonteCarlo swaps(settings, state);
  auto const start = std::chrono::steady_clock::now();
  swaps.advance(state);
  double const seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  SwapReport const report = swaps.report();
  fmt::print("moves_per_second,step,displacements_accepted,swaps_accepted,overlap_relaxation,bond_relaxation\n");
  fmt::print("{:.3g},{:.4f},{},{},{},{}\n", static_cast<double>(settings.sweeps * *disks.count) / seconds, report.step,
             text(report.displacement_acceptance), text(report.swap_acceptance), text(report.overlap_relaxation_time),
             text(report.bond_relaxation_time));
  if (!report.warning.empty()) fmt::print("{}\n", report.warning);
}
