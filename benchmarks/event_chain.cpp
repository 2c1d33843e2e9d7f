// The engine `event_chain` beside the engine `exact`: disks in a periodic square, one core.
//
//     gridlock_bench_event_chain speed PACKING_FRACTION N [ROUNDS EVENTS_PER_CHAIN SIZE_RATIO]
//     gridlock_bench_event_chain compare|exact|straight|newtonian PACKING_FRACTION N SAMPLES COLLISIONS EQUILIBRATION
//                                SEED EVENTS_PER_CHAIN RATIO [1]
//
// speed: nanoseconds of processor time an event, in turns; with a SIZE_RATIO other than 1 half of the disks are so many
// times as large. compare: pressure, orientation and their correlation times
// from the same start, which `exact` made by EQUILIBRATION / 2 pair collisions a disk. A sample is taken every so many
// pair collisions of `exact`, and every RATIO times as many events of the chains. With a last 1 it prints
// ⟨|Ψ(t) − Ψ(0)|²⟩ and ⟨|Ψ|²⟩, both times N, against t in events a disk, for the mean of ψ6 and three shells of its
// Fourier modes.

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <memory>
#include <numbers>
#include <string_view>
#include <vector>

#include "core/temperature.hpp"
#include "gridlock/core/random.hpp"
#include "gridlock/engine/engine.hpp"
#include "gridlock/engine/growth.hpp"
#include "gridlock/lattice/start.hpp"
#include "measure.hpp"

namespace gridlock::benchmark {
namespace {

/// An engine that advances by events and measures βP/ρ.
class Dynamics {
 public:
  Dynamics(State const& start, EngineSettings const& settings)
      : start_(start), state_(start), is_exact_(settings.kind == "exact"), engine_(make_engine(settings, state_)) {}

  /// Advances by about so many events; returns βP/ρ while it does, whose weight in a mean is duration().
  double advance(double events) {
    double const virial = counters_.pair_virial;
    double const time = state_.clock.time;
    auto const n = static_cast<double>(state_.agents.size());
    StopCondition stop;
    if (is_exact_) {
      stop.pair_collisions = counters_.pair_collisions + static_cast<std::uint64_t>(events);
    } else {
      stop.step = state_.clock.step + static_cast<std::uint64_t>(std::max(1.0, std::round(events / n)));
    }
    engine_->advance(state_, counters_, stop);
    duration_ = state_.clock.time - time;
    return 1.0 + (counters_.pair_virial - virial) / (2.0 * n * temperature(state_).value() * duration_);
  }
  [[nodiscard]] std::uint64_t events() const { return counters_.pair_collisions; }
  [[nodiscard]] double duration() const { return duration_; }
  [[nodiscard]] State const& state() const { return state_; }
  [[nodiscard]] std::vector<Vector> disks() const {
    std::vector<Vector> result;
    for (std::size_t i = 0; i < state_.agents.size(); ++i) result.push_back(position(state_.agents, i));
    return result;
  }
  /// The sum of the displacements of all disks so far.
  [[nodiscard]] Vector displacement() const {
    Vector sum;
    for (std::size_t i = 0; i < state_.agents.size(); ++i) {
      sum = sum + (position(state_.agents, i) - position(start_.agents, i)) +
            state_.box.offset_of_image(state_.agents.column<ImageX>()[i], state_.agents.column<ImageY>()[i]);
    }
    return sum;
  }

 private:
  State start_;
  State state_;
  bool is_exact_;
  std::unique_ptr<Engine> engine_;
  Counters counters_;
  double duration_ = 1.0;
};

/// Fourier modes of the orientation: wave vectors 2π/L (column, row) with both from −3 to 3, the sums over all disks of
/// ψ6 e^(−ikr) over N.
constexpr int most = 3;
constexpr int modes_a_side = 2 * most + 1;
using Modes = std::vector<std::complex<double>>;

/// Modes of ψ6, the mean of e^(6iθ) over the disks within 1.5 σ, relative to the centre of mass: straight chains push
/// all disks along.
Modes orientation(std::vector<Vector> const& disks, double side, Vector displacement) {
  constexpr double reach = 1.5;
  int const n = std::max(3, static_cast<int>(side / reach));
  std::vector<std::vector<std::uint32_t>> cells(static_cast<std::size_t>(n * n));
  auto const cell_of = [&](Vector p) {
    return std::min(static_cast<int>(p.y / side * n), n - 1) * n + std::min(static_cast<int>(p.x / side * n), n - 1);
  };
  for (std::uint32_t i = 0; i < disks.size(); ++i) cells[static_cast<std::size_t>(cell_of(disks[i]))].push_back(i);
  std::vector<std::complex<double>> sums(disks.size());
  std::vector<int> neighbours(disks.size());
  auto const pair = [&](std::uint32_t i, std::uint32_t j) {
    double dx = disks[j].x - disks[i].x;
    double dy = disks[j].y - disks[i].y;
    dx -= side * std::round(dx / side);
    dy -= side * std::round(dy / side);
    double const squared = dx * dx + dy * dy;
    if (squared > reach * reach) return;
    double const c = (dx * dx - dy * dy) / squared;
    double const s = 2.0 * dx * dy / squared;
    // e^(6iθ) is the cube of e^(2iθ).
    std::complex<double> const bond(c * c * c - 3.0 * c * s * s, 3.0 * c * c * s - s * s * s);
    sums[i] += bond;
    sums[j] += bond;
    ++neighbours[i];
    ++neighbours[j];
  };
  for (int row = 0; row < n; ++row) {
    for (int column = 0; column < n; ++column) {
      auto const& here = cells[static_cast<std::size_t>(row * n + column)];
      for (std::size_t a = 0; a < here.size(); ++a) {
        for (std::size_t b = a + 1; b < here.size(); ++b) pair(here[a], here[b]);
      }
      for (auto const& [r, c] : {std::pair(0, 1), std::pair(1, -1), std::pair(1, 0), std::pair(1, 1)}) {
        auto const& there = cells[static_cast<std::size_t>((row + r) % n * n + (column + c + n) % n)];
        for (auto const i : here) {
          for (auto const j : there) pair(i, j);
        }
      }
    }
  }
  Modes modes(static_cast<std::size_t>(modes_a_side * modes_a_side));
  auto const count = static_cast<double>(disks.size());
  Vector const drift{displacement.x / count, displacement.y / count};
  for (std::size_t i = 0; i < sums.size(); ++i) {
    if (neighbours[i] == 0) continue;
    std::complex<double> const order = sums[i] / (neighbours[i] * static_cast<double>(disks.size()));
    Vector const place = disks[i] - drift;
    auto const step_x = std::polar(1.0, -2.0 * std::numbers::pi * place.x / side);
    auto const step_y = std::polar(1.0, -2.0 * std::numbers::pi * place.y / side);
    std::complex<double> row = order * std::pow(step_x * step_y, -most);
    std::size_t k = 0;
    for (int y = 0; y < modes_a_side; ++y, row *= step_y) {
      std::complex<double> mode = row;
      for (int x = 0; x < modes_a_side; ++x, mode *= step_x) modes[k++] += mode;
    }
  }
  return modes;
}

struct CorrelationTime {
  double mean = 0.0;
  double variance = 0.0;
  double time = 0.5;   ///< Σ of the correlation function, ½ + Σ_{t ≥ 1}, in samples
  double error = 0.0;  ///< of time
};

/// The integrated correlation time with the window of Sokal, 5 times (6 times) itself; Ψ has the mean 0 by symmetry.
CorrelationTime correlation_time(std::vector<std::complex<double>> const& series, bool subtract) {
  auto const n = series.size();
  std::complex<double> mean;
  for (auto const& z : series) mean += z / static_cast<double>(n);
  std::complex<double> const shift = subtract ? mean : std::complex<double>();
  auto const covariance = [&](std::size_t lag) {
    double sum = 0.0;
    for (std::size_t i = 0; i + lag < n; ++i)
      sum += std::real(std::conj(series[i] - shift) * (series[i + lag] - shift));
    return sum / static_cast<double>(n - lag);
  };
  CorrelationTime result{.mean = std::real(mean), .variance = covariance(0)};
  for (std::size_t lag = 1; lag < n / 2; ++lag) {
    result.time += covariance(lag) / result.variance;
    if (static_cast<double>(lag) >= 6.0 * result.time) {
      result.error = result.time * std::sqrt(2.0 * (2.0 * static_cast<double>(lag) + 1.0) / static_cast<double>(n));
      return result;
    }
  }
  result.error = std::numeric_limits<double>::quiet_NaN();
  return result;
}

EngineSettings exact_settings() { return {.kind = "exact", .time_step = 1e6, .threads = 1}; }

/// Disks on a square lattice with Maxwell's velocities and without momentum, melted by `exact`.
State melted(std::uint64_t n, double packing_fraction, std::uint64_t seed, double collisions_per_disk) {
  auto const columns = static_cast<std::uint64_t>(std::ceil(std::sqrt(static_cast<double>(n))));
  double const side = std::sqrt(static_cast<double>(n) * std::numbers::pi / 4.0 / packing_fraction);
  double const step = side / static_cast<double>(columns);
  State state{.box = Box(side, side, Edge::periodic), .seed = seed};
  Vector sum;
  for (std::uint64_t i = 0; i < n; ++i) {
    RandomStream random(seed, 0, i, Purpose::start_velocity);
    Vector const v{random.normal(), random.normal()};
    sum = sum + v;
    state.agents.add((static_cast<double>(i % columns) + 0.5) * step, (static_cast<double>(i / columns) + 0.5) * step,
                     v.x, v.y, 0.5, 1.0, 0, 0);
  }
  for (double& v : state.agents.column<VelocityX>()) v -= sum.x / static_cast<double>(n);
  for (double& v : state.agents.column<VelocityY>()) v -= sum.y / static_cast<double>(n);
  Dynamics exact(state, exact_settings());
  exact.advance(0.5 * collisions_per_disk * static_cast<double>(n));
  State melted = exact.state();
  for (auto& image : melted.agents.column<ImageX>()) image = 0;
  for (auto& image : melted.agents.column<ImageY>()) image = 0;
  return melted;
}

/// Disks of two sizes and one mass, half of each, which grow from a random start and fly.
State melted_mixture(std::uint64_t n, double packing_fraction, double size_ratio, double collisions_per_disk) {
  DisksSettings disks{.count = n, .packing_fraction = 0.4, .start = StartKind::random};
  disks.species = {{.fraction = 0.5}, {.fraction = 0.5, .size_ratio = size_ratio, .mass = 1.0}};
  State state = make_start(Box(1.0, 1.0, Edge::periodic), disks, 1);
  draw_velocities(state, {.kind = VelocityKind::maxwell});
  GrowthSettings settings{.packing_fraction = packing_fraction};
  settings.rate = 0.01;
  Counters counters;
  Growth(settings, state).advance(state, counters);
  state.clock = {};
  Dynamics exact(state, exact_settings());
  exact.advance(0.5 * collisions_per_disk * static_cast<double>(n));
  return exact.state();
}

std::unique_ptr<Dynamics> make(std::string_view name, State const& state, std::uint64_t seed, double events_per_chain) {
  State start = state;
  start.seed = seed;
  if (name == "exact") return std::make_unique<Dynamics>(start, exact_settings());
  EngineSettings const chains{.kind = "event_chain",
                              .chains = name == "straight" ? ChainKind::straight : ChainKind::newtonian,
                              .chain_length = static_cast<std::uint64_t>(events_per_chain)};
  return std::make_unique<Dynamics>(start, chains);
}

/// Nanoseconds of processor time an event of the three, in turns.
void speed(double packing_fraction, std::uint64_t n, int rounds, double events_per_chain, double size_ratio) {
  double const collisions_per_disk = n < 50'000 ? 100.0 : 20.0;
  State const start = size_ratio == 1.0 ? melted(n, packing_fraction, 1, collisions_per_disk)
                                        : melted_mixture(n, packing_fraction, size_ratio, collisions_per_disk);
  auto const block = static_cast<double>(std::clamp<std::uint64_t>(10 * n, 500'000, 5'000'000));
  std::vector<Contestant> contestants;
  for (auto const* name : {"exact", "straight", "newtonian"}) {
    std::shared_ptr<Dynamics> const dynamics = make(name, start, 1, events_per_chain);
    double const events = std::string_view(name) == "exact" ? block : 4.0 * block;
    contestants.push_back({.name = name, .items = events, .run = [=] { dynamics->advance(events); }});
  }
  race("event_chain", n, packing_fraction, rounds, contestants);
}

/// One dynamics: βP/ρ and Ψ6 of samples taken every so many events, from a start.
void series(std::string_view name, State const& start, double packing_fraction, std::uint64_t samples, double events,
            std::uint64_t seed, double events_per_chain, bool print_correlations) {
  std::unique_ptr<Dynamics> const dynamics = make(name, start, seed, events_per_chain);
  double const side = start.box.width();
  auto const n = static_cast<double>(start.agents.size());
  dynamics->advance(20.0 * events);
  std::uint64_t const events_before = dynamics->events();
  std::vector<std::complex<double>> pressures;
  std::vector<std::complex<double>> orders;
  std::vector<Modes> modes;
  std::vector<std::complex<double>> moduli;
  double seconds = 0.0;
  double weighted = 0.0;
  double weight = 0.0;
  for (std::uint64_t k = 0; k < samples; ++k) {
    double const before = processor_seconds();
    pressures.emplace_back(dynamics->advance(events));
    weighted += pressures.back().real() * dynamics->duration();
    weight += dynamics->duration();
    seconds += processor_seconds() - before;
    modes.push_back(orientation(dynamics->disks(), side, dynamics->displacement()));
    orders.push_back(modes.back()[modes.back().size() / 2]);
    moduli.emplace_back(std::abs(orders.back()));
  }
  double const all = static_cast<double>(dynamics->events() - events_before);
  double const a_sample = all / static_cast<double>(samples) / n;  // events a disk
  auto const z = correlation_time(pressures, true);
  auto const order = correlation_time(orders, false);
  auto const modulus = correlation_time(moduli, true);
  double const count = static_cast<double>(samples);
  auto const error = [&](CorrelationTime const& c) { return std::sqrt(2.0 * c.time * c.variance / count); };
  std::printf("%s,%.4g,%.0f,%llu,%.4g,%.4g,%.1f,%.6f,%.6f,%.4g,%.4g,%.6f,%.6f,%.5g,%.3g,%.5g,%.3g\n",
              std::string(name).c_str(), packing_fraction, n, static_cast<unsigned long long>(samples), a_sample,
              events_per_chain, 1e9 * seconds / all, weighted / weight, error(z), 2.0 * z.time * z.variance * a_sample,
              2.0 * z.error * z.variance * a_sample, modulus.mean, error(modulus), order.time * a_sample,
              order.error * a_sample, modulus.time * a_sample, modulus.error * a_sample);
  if (print_correlations) {
    double lag = 1.0;
    for (std::size_t last = 0; lag < count / 4.0; lag *= std::pow(2.0, 0.25)) {
      auto const t = static_cast<std::size_t>(lag);
      if (t == last) continue;
      last = t;
      // ⟨|Ψ(t) − Ψ(0)|²⟩ N of the mean, of the modes next to it and of those farther out, and their ⟨|Ψ|²⟩ N.
      constexpr int shells = 4;
      double differences[shells]{};
      double squares[shells]{};
      double counts[shells]{};
      for (std::size_t k = 0; k + t < modes.size(); ++k) {
        for (int m = 0; m < modes_a_side * modes_a_side; ++m) {
          int const squared_number = (m / modes_a_side - most) * (m / modes_a_side - most) +
                                     (m % modes_a_side - most) * (m % modes_a_side - most);
          int const shell = squared_number == 0 ? 0 : squared_number <= 2 ? 1 : squared_number <= 8 ? 2 : 3;
          differences[shell] += std::norm(modes[k + t][m] - modes[k][m]);
          squares[shell] += 0.5 * (std::norm(modes[k + t][m]) + std::norm(modes[k][m]));
          counts[shell] += 1.0;
        }
      }
      std::printf("correlation,%s,%.5g", std::string(name).c_str(), static_cast<double>(t) * a_sample);
      for (int k = 0; k < shells; ++k)
        std::printf(",%.5g,%.5g", n * differences[k] / counts[k], n * squares[k] / counts[k]);
      std::printf("\n");
    }
  }
  std::fflush(stdout);
}

}  // namespace
}  // namespace gridlock::benchmark

int main(int argument_count, char** arguments) {
  using namespace gridlock::benchmark;
  auto const number = [&](int k, double otherwise) {
    return argument_count > k ? std::strtod(arguments[k], nullptr) : otherwise;
  };
  std::string_view const mode = argument_count > 3 ? arguments[1] : "";
  double const packing_fraction = number(2, 0.7);
  auto const n = static_cast<std::uint64_t>(number(3, 1024.0));
  if (mode == "speed") {
    print_header();
    speed(packing_fraction, n, static_cast<int>(number(4, 7.0)), number(5, 300.0), number(6, 1.0));
    return 0;
  }
  if (mode.empty()) return 2;
  auto const samples = static_cast<std::uint64_t>(number(4, 1000.0));
  double const events = number(5, 1000.0);
  double const equilibration = number(6, 100.0);
  auto const seed = static_cast<std::uint64_t>(number(7, 1.0));
  double const chain = number(8, 300.0);
  double const ratio = number(9, 4.0);
  bool const correlations = number(10, 0.0) > 0.0;
  std::printf(
      "dynamics,packing_fraction,n,samples,events_per_disk_and_sample,events_per_chain,nanoseconds_per_event,z,z_error,"
      "z_variance_times_events_per_disk,its_error,psi6,psi6_error,psi6_time,psi6_time_error,modulus_time,modulus_time_"
      "error\n");
  auto const start = melted(n, packing_fraction, seed, equilibration);
  for (auto const* name : {"exact", "straight", "newtonian"}) {
    if (mode != "compare" && mode != name) continue;
    series(name, start, packing_fraction, samples, std::string_view(name) == "exact" ? events : ratio * events, seed,
           chain, correlations);
  }
}
