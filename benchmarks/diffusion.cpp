// A field of 1,000 × 1,000 cells that spreads for one time step, exactly, beside two loops that the compiler vectorises:
// the same exact step without edges, and the explicit step of five cells, which needs λ = D t / h² < 1/4.

#include <algorithm>
#include <cmath>
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

/// The weights e^(−2λ) Iₙ(2λ), n = 0, 1 …
std::vector<double> weights_of(double lambda) {
  std::vector<double> weights;
  for (double n = 0.0; weights.empty() || weights.back() > 1e-17; n += 1.0) {
    weights.push_back(std::exp(-2.0 * lambda) * std::cyl_bessel_i(n, 2.0 * lambda));
  }
  return weights;
}

/// Adds weights[n] (now[k − n distance] + now[k + n distance]) over n to each cell farther than the last n from the edges.
[[gnu::noinline]] void add_weighted(double const* __restrict now, double* __restrict next,
                                    std::vector<double> const& weights, std::size_t distance) {
  std::size_t const reach = weights.size() - 1;
  for (std::size_t row = reach; row + reach < side; ++row) {
    std::size_t const first = row * side + reach;
    std::size_t const last = (row + 1) * side - reach;
    for (std::size_t k = first; k < last; ++k) next[k] = weights[0] * now[k];
    for (std::size_t n = 1; n <= reach; ++n) {
      double const weight = weights[n];
      for (std::size_t k = first; k < last; ++k) next[k] += weight * (now[k - n * distance] + now[k + n * distance]);
    }
  }
}

void race_to_spread(double lambda, std::uint64_t threads) {
  Box const box(side, side, Edge::periodic);
  Field field("heat", side, side);
  for (std::size_t k = 0; k < field.size(); ++k) field.values()[k] = static_cast<double>(k * 7919 % 1000);
  std::vector<double> now(field.values().begin(), field.values().end());
  std::vector<double> next = now;
  std::vector<double> const weights = weights_of(lambda);
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
        {.name = "exact, plain loops",
         .items = steps * side * side,
         .run =
             [&] {
               for (double k = 0.0; k < steps; k += 1.0) {
                 add_weighted(now.data(), next.data(), weights, 1);
                 add_weighted(next.data(), now.data(), weights, side);
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
