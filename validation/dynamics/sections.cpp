#include "dynamics/sections.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdio>
#include <future>
#include <string>
#include <thread>

#include "gridlock/lattice/start.hpp"

namespace gridlock::validation {
namespace {

bool all_rows_agree = true;

void print_row(std::string_view check, Estimate measured, Estimate expected, double allowed) {
  double const difference = measured.value - expected.value;
  double const error = std::hypot(measured.error, expected.error);
  bool const agrees = std::abs(difference) <= allowed;
  all_rows_agree &= agrees;
  std::string const in_errors = error > 0.0 ? fmt::format("{:.2f}", difference / error) : "";
  fmt::print("{},{:.8g},{:.2g},{:.10g},{:.2g},{:.2g},{},{}\n", check, measured.value, measured.error, expected.value,
             expected.error, allowed, in_errors, agrees ? "agrees" : "DIFFERS");
  std::fflush(stdout);
}

}  // namespace

void within_errors(std::string_view check, Estimate measured, Estimate expected) {
  print_row(check, measured, expected, 4.0 * std::hypot(measured.error, expected.error));
}

void within_scatter(std::string_view check, Estimate measured, std::uint64_t runs, double expected,
                    std::uint64_t expected_runs) {
  double const error = measured.error * std::sqrt(static_cast<double>(runs) / static_cast<double>(expected_runs));
  within_errors(check, measured, {expected, error});
}

void within(std::string_view check, Estimate measured, double expected, double tolerance) {
  print_row(check, measured, {expected, 0.0}, tolerance);
}

bool all_agree() { return all_rows_agree; }

std::vector<Estimate> means(std::uint64_t count, std::function<Numbers(std::uint64_t seed)> const& run) {
  std::vector<Numbers> runs(count);
  std::atomic<std::uint64_t> next{0};
  auto const work = [&] {
    for (std::uint64_t k = next++; k < count; k = next++) runs[k] = run(k + 1);
  };
  std::vector<std::future<void>> workers(std::max(1U, std::thread::hardware_concurrency()));
  for (auto& worker : workers) worker = std::async(std::launch::async, work);
  for (auto& worker : workers) worker.get();
  std::vector<Estimate> estimates;
  for (std::size_t number = 0; number < runs[0].size(); ++number) {
    std::vector<double> values;
    for (Numbers const& numbers : runs) values.push_back(numbers.at(number));
    estimates.push_back(reference::mean_of(values));
  }
  return estimates;
}

void scale_velocities(State& state, double factor) {
  for (double& v : state.agents.column<VelocityX>()) v *= factor;
  for (double& v : state.agents.column<VelocityY>()) v *= factor;
}

EngineSettings exact() { return {.kind = "exact", .time_step = 1e6, .threads = 1}; }

State fluid(std::size_t count, double packing_fraction, std::uint64_t seed) {
  double const side = std::sqrt(static_cast<double>(count) * pi / 4.0 / packing_fraction);
  State state = make_start(Box(side, side, Edge::periodic), {.count = count, .radius = 0.5}, seed);
  draw_velocities(state, {.kind = VelocityKind::maxwell, .max = 2.0});
  Counters counters;
  make_engine(exact(), state)->advance(state, counters, {.pair_collisions = 20 * count});
  scale_velocities(state, std::sqrt(static_cast<double>(count - 1) / kinetic_energy(state.agents)));
  state.clock = {};
  return state;
}

double force_on(Counters::Wall wall, Counters const& counters, Counters const& before, double duration) {
  return (counters.wall_impulse[wall] - before.wall_impulse[wall]) / duration;
}

}  // namespace gridlock::validation
