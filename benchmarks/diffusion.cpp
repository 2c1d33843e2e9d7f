// A field of 1,000 × 1,000 cells that spreads for one time step, exactly, beside the plain explicit step of five cells,
// which needs λ = D t / h² < 1/4, in a loop that the compiler vectorises.

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <utility>
#include <vector>

#include "gridlock/core/spread.hpp"
#include "gridlock/core/world.hpp"
#include "measure.hpp"

namespace gridlock::benchmark {
namespace {

constexpr std::size_t side = 1000;
constexpr double steps = 10.0;

[[gnu::noinline]] void step_explicitly(double const* __restrict now, double* __restrict next, double lambda) {
  for (std::size_t row = 1; row + 1 < side; ++row) {
    for (std::size_t k = row * side + 1; k + 1 < (row + 1) * side; ++k) {
      next[k] = now[k] + lambda * (now[k - 1] + now[k + 1] + now[k - side] + now[k + side] - 4.0 * now[k]);
    }
  }
}

void race_to_spread(double lambda, std::uint64_t threads) {
  Box const box(side, side, Edge::periodic);
  Field field("heat", side, side);
  for (std::size_t k = 0; k < field.size(); ++k) field.values()[k] = static_cast<double>(k * 7919 % 1000);
  std::vector<double> now(field.values().begin(), field.values().end());
  std::vector<double> next = now;
  ThreadPool pool(threads);
  ThreadPool alone(1);
  Field other = field;
  auto const spread_steps = [&](Field& of, ThreadPool& by) {
    for (double k = 0.0; k < steps; k += 1.0) spread(of, box, {.diffusion = lambda}, by);
  };
  auto const hash_of = [](Field const& of) { return hash_with_fields(0, {&of, 1}); };
  std::string const name = "lambda " + std::to_string(lambda).substr(0, 4);
  Contestant const alone_by_processor{.name = "exact, one thread",
                                      .items = steps * side * side,
                                      .run = [&] { spread_steps(field, alone); },
                                      .result = [&] { return hash_of(field); }};
  race(("diffusion, " + name).c_str(), side, 0.0, 12,
       {{.name = "explicit, one thread",
         .items = steps * side * side,
         .run =
             [&] {
               for (double k = 0.0; k < steps; k += 1.0) {
                 step_explicitly(now.data(), next.data(), lambda);
                 std::swap(now, next);
               }
             }},
        alone_by_processor});
  // Threads are compared by the clock on the wall, which needs a machine that has nothing else to do.
  Contestant one = alone_by_processor;
  one.clock = wall_seconds;
  race(("diffusion by the wall, " + name).c_str(), side, 0.0, 12,
       {one,
        {.name = "exact, threads: " + std::to_string(threads),
         .items = steps * side * side,
         .run = [&] { spread_steps(other, pool); },
         .result = [&] { return hash_of(other); },
         .clock = wall_seconds}});
}

}  // namespace
}  // namespace gridlock::benchmark

int main(int argc, char** argv) {
  std::uint64_t const threads = argc > 1 ? std::strtoull(argv[1], nullptr, 10) : 2;
  gridlock::benchmark::print_header();
  for (double const lambda : {0.02, 0.1, 0.2}) gridlock::benchmark::race_to_spread(lambda, threads);
}
