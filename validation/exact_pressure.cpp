// The pressure of small periodic systems from long runs of the engine `exact`, against published values, with the audit
// on: too long for the tests.
//
//     gridlock_validate_exact_pressure [millions of collisions per system]      200 where no number is given
//
// 72, 224 and 870 disks; three times as many collisions near the transition.
//
// Published: Li et al. 2022, P* = βPσ² of N hard disks in a periodic square box, by event-driven dynamics.

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <vector>

#include "gridlock/engine/engine.hpp"
#include "periodic_systems.hpp"

namespace gridlock::validation {
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

void measure(Published const& p, std::uint64_t collisions) {
  constexpr int blocks = 50;
  State state = rows_of_disks(p.columns, p.rows, p.packing_fraction);
  auto const engine = make_engine({.kind = "exact", .audit_every = 1'000'000}, state);
  Counters counters;
  engine->advance(state, counters, {.pair_collisions = collisions / 20});
  std::vector<double> pressures;
  for (int block = 0; block < blocks; ++block) {
    pressures.push_back(pressure_up_to({.pair_collisions = counters.pair_collisions + collisions / blocks}, *engine,
                                       state, counters, p.packing_fraction));
  }
  double mean = 0.0;
  double squares = 0.0;
  for (double const x : pressures) mean += x / blocks;
  for (double const x : pressures) squares += (x - mean) * (x - mean);
  double const error = std::sqrt(squares / (blocks * (blocks - 1.0)));
  std::printf("%zu,%.3f,%llu,%.6f,%.6f,%.6f,%.6f,%.2f\n", state.agents.size(), p.packing_fraction,
              static_cast<unsigned long long>(collisions), mean, error, p.pressure, p.error,
              (mean - p.pressure) / std::hypot(error, p.error));
  std::fflush(stdout);
}

}  // namespace
}  // namespace gridlock::validation

int main(int argument_count, char** arguments) {
  using namespace gridlock::validation;
  std::uint64_t const millions = argument_count > 1 ? std::strtoull(arguments[1], nullptr, 10) : 200;
  std::printf("n,packing_fraction,collisions,pressure,error,published,published_error,difference_in_errors\n");
  for (Published const& system : small) measure(system, 1'000'000 * millions * system.length);
}
