// The pressure of small periodic systems from long runs of the engine `exact`, against published values, with the audit
// on: too long for the tests.
//
//     gridlock_validate_exact_pressure small [millions of collisions per system]      200 where no number is given
//     gridlock_validate_exact_pressure plateau [millions of collisions per system]    600
//
// `small`: 72, 224 and 870 disks; three times as many collisions near the transition. `plateau`: about 256²
// disks from the liquid through the coexistence of liquid and hexatic phase, a quarter of the collisions before the
// measurement.
//
// Published: Li et al. 2022, P* = βPσ² of N hard disks in a periodic square box, by event-driven dynamics.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <numbers>
#include <span>
#include <string_view>
#include <vector>

#include "gridlock/core/random.hpp"
#include "gridlock/engine/engine.hpp"

namespace gridlock::benchmark {
namespace {

struct Published {
  std::uint64_t columns;
  std::uint64_t rows;
  double packing_fraction;
  double pressure;
  double error;
  std::uint64_t length = 1;  ///< of the run; near the transition the blocks scatter more
};

constexpr Published small[] = {
    {8, 9, 0.65, 6.901074, 0.000071},   {8, 9, 0.66, 7.383221, 0.000087},   {8, 9, 0.67, 7.85637, 0.00011},
    {8, 9, 0.68, 8.23631, 0.00034},     {8, 9, 0.69, 8.41814, 0.00038, 3},  {8, 9, 0.70, 8.55170, 0.00059, 3},
    {14, 16, 0.67, 7.979479, 0.000058}, {14, 16, 0.68, 8.49105, 0.00019},   {29, 30, 0.67, 7.986779, 0.000025},
    {29, 30, 0.68, 8.513249, 0.000037}, {29, 30, 0.69, 8.969898, 0.000075},
};

/// From two starts each: rows as far apart as the disks in them, which melt at once, and a crystal. Equilibrium is where
/// they meet.
constexpr Published plateau[] = {
    {256, 256, 0.698, 9.17059, 0.00018}, {256, 256, 0.700, 9.18896, 0.00024}, {256, 256, 0.704, 9.18903, 0.00039},
    {256, 256, 0.708, 9.18226, 0.00026}, {256, 256, 0.712, 9.17715, 0.00021}, {256, 256, 0.716, 9.17823, 0.00041},
    {256, 256, 0.720, 9.22350, 0.00075}, {239, 276, 0.720, 9.22350, 0.00075}, {239, 276, 0.716, 9.17823, 0.00041},
    {239, 276, 0.712, 9.17715, 0.00021}, {239, 276, 0.708, 9.18226, 0.00026}, {239, 276, 0.704, 9.18903, 0.00039},
};

/// Which systems to measure, and for how long.
struct Plan {
  std::span<Published const> systems;
  std::uint64_t millions;  ///< of collisions per system
  double equilibration;    ///< part of them before the measurement
};

/// Disks of diameter 1 on stretched, shifted rows, Maxwell velocities without a common drift.
State rows_of_disks(Published const& p) {
  std::uint64_t const n = p.columns * p.rows;
  double const side = std::sqrt(static_cast<double>(n) * std::numbers::pi / 4.0 / p.packing_fraction);
  State state{.box = Box(side, side, Edge::periodic), .seed = 1};
  Vector sum;
  for (std::uint64_t i = 0; i < n; ++i) {
    RandomStream random(1, 0, i, Purpose::start_velocity);
    std::uint64_t const row = i / p.columns;
    // About half a site from row to row, and whole sites once around the box.
    double const shift = static_cast<double>(row * (p.rows / 2) % p.rows) / static_cast<double>(p.rows);
    Vector const v{random.normal(), random.normal()};
    sum = sum + v;
    state.disks.add((static_cast<double>(i % p.columns) + shift) * side / static_cast<double>(p.columns),
                    (static_cast<double>(row) + 0.5) * side / static_cast<double>(p.rows), v.x, v.y, 0.5, 1.0, 0, 0);
  }
  for (double& v : state.disks.column<VelocityX>()) v -= sum.x / static_cast<double>(n);
  for (double& v : state.disks.column<VelocityY>()) v -= sum.y / static_cast<double>(n);
  return state;
}

void measure(Published const& p, std::uint64_t collisions, double equilibration) {
  constexpr int blocks = 50;
  State state = rows_of_disks(p);
  double const n = static_cast<double>(state.disks.size());
  double const kt = kinetic_energy(state.disks) / (n - 1.0);
  auto const engine =
      make_engine({.kind = "exact", .audit_every = std::max<std::uint64_t>(1'000'000, 20 * state.disks.size())}, state);
  Tally tally;
  engine->advance(state, tally,
                  {.pair_collisions = static_cast<std::uint64_t>(equilibration * static_cast<double>(collisions))});
  std::vector<double> pressures;
  for (int block = 0; block < blocks; ++block) {
    double const virial = tally.pair_virial;
    double const time = state.clock.time;
    engine->advance(state, tally, {.pair_collisions = tally.pair_collisions + collisions / blocks});
    double const z = 1.0 + (tally.pair_virial - virial) / (2.0 * n * kt * (state.clock.time - time));
    pressures.push_back(z * 4.0 * p.packing_fraction / std::numbers::pi);
  }
  double mean = 0.0;
  double squares = 0.0;
  for (double const x : pressures) mean += x / blocks;
  for (double const x : pressures) squares += (x - mean) * (x - mean);
  double const error = std::sqrt(squares / (blocks * (blocks - 1.0)));
  std::printf("%.0f,%.3f,%llu,%.6f,%.6f,%.6f,%.6f,%.2f\n", n, p.packing_fraction,
              static_cast<unsigned long long>(collisions), mean, error, p.pressure, p.error,
              (mean - p.pressure) / std::hypot(error, p.error));
  std::fflush(stdout);
}

}  // namespace
}  // namespace gridlock::benchmark

int main(int argument_count, char** arguments) {
  using namespace gridlock::benchmark;
  std::string_view const name = argument_count > 1 ? arguments[1] : "";
  if (name != "small" && name != "plateau") {
    std::fprintf(stderr, "say small or plateau, and then perhaps how many millions of collisions\n");
    return 2;
  }
  Plan plan = name == "small" ? Plan{small, 200, 0.05} : Plan{plateau, 600, 0.25};
  if (argument_count > 2) plan.millions = std::strtoull(arguments[2], nullptr, 10);
  std::printf("n,packing_fraction,collisions,pressure,error,published,published_error,difference_in_errors\n");
  for (Published const& system : plan.systems) {
    measure(system, 1'000'000 * plan.millions * system.length, plan.equilibration);
  }
}
