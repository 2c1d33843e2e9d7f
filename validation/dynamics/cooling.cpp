// Grains that cool: Haff's law, the fourth moment of the velocities, and inelastic collapse.

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <complex>
#include <string>
#include <utility>

#include "dynamics/sections.hpp"

namespace gridlock::validation {
namespace {

EngineSettings grains(double restitution, double contact_time = 0.0) {
  EngineSettings settings = exact();
  settings.collisions = {.restitution = restitution, .contact_time = contact_time};
  return settings;
}

double temperature(State const& state) {
  return kinetic_energy(state.agents) / static_cast<double>(state.agents.size() - 1);
}

/// |Σ v_y e^(2πix/L)|²/(N T), 1 in equilibrium: it grows with the vortices that end Haff's law.
double transverse_mode(State const& state) {
  std::complex<double> sum;
  for (std::size_t i = 0; i < state.agents.size(); ++i) {
    sum += std::polar(velocity(state.agents, i).y, 2.0 * pi * position(state.agents, i).x / state.box.width());
  }
  return std::norm(sum) / (static_cast<double>(state.agents.size()) * temperature(state));
}

constexpr std::array collisions{5.0, 20.0, 50.0, 100.0, 200.0, 400.0};  ///< of a disk

/// Haff's law T = (1 + t/t₀)^−2, 1/t₀ = (1 − e²) ω₀/4, and T = exp(−(1 − e²) τ/2) after τ collisions a disk.
void haffs_law() {
  struct Gas {
    double restitution;
    double packing_fraction;
    double rate;  ///< ω₀, collisions of a disk in a unit of time at e = 1
    std::array<Estimate, collisions.size()> over_haff;
    std::array<Estimate, collisions.size()> exponent;
    Estimate transverse_mode;
  };
  std::array const gases{
      Gas{0.95,
          0.1,
          0.5325,
          {{{1.003, 0.002}, {1.008, 0.003}, {1.019, 0.004}, {1.022, 0.004}, {1.025, 0.004}, {1.025, 0.004}}},
          {{{0.989, 0.005}, {0.993, 0.002}, {0.992, 0.002}, {0.993, 0.001}, {0.9935, 0.001}, {0.9935, 0.0006}}},
          {1.6, 0.2}},
      Gas{0.9,
          0.1,
          0.5325,
          {{{1.008, 0.003}, {1.026, 0.005}, {1.052, 0.006}, {1.060, 0.006}, {1.050, 0.006}, {1.057, 0.006}}},
          {{{0.987, 0.005}, {0.986, 0.003}, {0.984, 0.002}, {0.984, 0.001}, {0.984, 0.001}, {0.983, 0.001}}},
          {2.0, 0.2}},
      Gas{0.95,
          0.3,
          2.394,
          {{{1.003, 0.001}, {1.016, 0.003}, {1.035, 0.004}, {1.073, 0.006}, {1.103, 0.007}, {1.122, 0.009}}},
          {{{0.999, 0.005}, {0.990, 0.003}, {0.988, 0.002}, {0.981, 0.002}, {0.974, 0.002}, {0.971, 0.001}}},
          {4.1, 0.5}},
      Gas{0.9,
          0.3,
          2.394,
          {{{1.012, 0.003}, {1.073, 0.005}, {1.220, 0.011}, {1.71, 0.04}, {3.24, 0.08}, {3.97, 0.08}}},
          {{{0.991, 0.005}, {0.967, 0.003}, {0.944, 0.003}, {0.895, 0.004}, {0.799, 0.005}, {0.716, 0.003}}},
          {47.0, 5.0}}};
  for (Gas const& gas : gases) {
    double const loss = 1.0 - gas.restitution * gas.restitution;
    auto const found = means(240, [&](std::uint64_t seed) {
      State state = fluid(256, gas.packing_fraction, seed);
      auto const engine = make_engine(grains(gas.restitution), state);
      Counters counters;
      Numbers numbers;
      for (double const tau : collisions) {
        engine->advance(state, counters, {.pair_collisions = static_cast<std::uint64_t>(128.0 * tau)});
        double const haff = std::pow(1.0 + loss * gas.rate / 4.0 * state.clock.time, -2.0);
        numbers.push_back(temperature(state) / haff);
        numbers.push_back(std::log(temperature(state)) / (-loss * tau / 2.0));
      }
      numbers.push_back(transverse_mode(state));
      return numbers;
    });
    std::string const name = fmt::format("e {} phi {}", gas.restitution, gas.packing_fraction);
    for (std::size_t k = 0; k < collisions.size(); ++k) {
      within_errors(fmt::format("T over Haff's law: {} tau {}", name, collisions[k]), found[2 * k], gas.over_haff[k]);
      within_errors(fmt::format("ln T over its exponent: {} tau {}", name, collisions[k]), found[2 * k + 1],
                    gas.exponent[k]);
    }
    within_errors(fmt::format("transverse mode: {} tau 400", name), found.back(), gas.transverse_mode);
  }
}

/// a₂ = ⟨v⁴⟩/(2⟨v²⟩²) − 1, the mean of those after 5, 10 and 20 collisions a disk: expected are the means of three
/// instants of the independent program, and the first Sonine approximation (van Noije & Ernst 1998).
void fourth_moments() {
  for (auto const& [e, expected] : {std::pair{0.95, -0.021}, std::pair{0.9, -0.030}, std::pair{0.7, 0.0043}}) {
    auto const found = means(240, [e = e](std::uint64_t seed) -> Numbers {
      State state = fluid(1000, 0.02, seed);
      auto const engine = make_engine(grains(e), state);
      Counters counters;
      double sum = 0.0;
      for (std::uint64_t const tau : {5, 10, 20}) {
        engine->advance(state, counters, {.pair_collisions = 500 * tau});
        double second = 0.0;
        double fourth = 0.0;
        for (std::size_t i = 0; i < 1000; ++i) {
          double const square = squared_length(velocity(state.agents, i));
          second += square / 1000.0;
          fourth += square * square / 1000.0;
        }
        sum += fourth / (2.0 * second * second) - 1.0;
      }
      return {sum / 3.0};
    });
    within_errors(fmt::format("a2: e {} phi 0.02", e), found[0], {expected, 0.0025});
    double const sonine = 16.0 * (1.0 - e) * (1.0 - 2.0 * e * e) / (57.0 - 25.0 * e + 30.0 * e * e * (1.0 - e));
    within(fmt::format("a2 beside Sonine: e {} phi 0.02", e), found[0], sonine, 0.004);
  }
}

/// The TC model ends what would collapse, and changes nothing where nothing collapses.
void lasting_contacts() {
  for (double const e : {0.4, 0.2}) {
    auto const found = means(24, [&](std::uint64_t seed) -> Numbers {
      State state = fluid(256, 0.5, seed);
      Counters counters;
      make_engine(grains(e, 1e-4), state)->advance(state, counters, {.pair_collisions = 300 * 128});
      return {static_cast<double>(counters.pair_collisions) / 128.0};
    });
    within(fmt::format("collisions a disk: e {} phi 0.5 contact_time 1e-4", e), found[0], 300.0, 0.0);
  }
  constexpr std::array times{2.0, 10.0, 50.0};
  auto const found = means(240, [&](std::uint64_t seed) {
    State without = fluid(256, 0.5, seed);
    State with = without;
    auto const engine_without = make_engine(grains(0.5), without);
    auto const engine_with = make_engine(grains(0.5, 1e-4), with);
    Counters counters;
    Numbers numbers;
    for (double const time : times) {
      engine_without->advance(without, counters, {.time = time});
      engine_with->advance(with, counters, {.time = time});
      numbers.push_back(std::log(temperature(with) / temperature(without)));
    }
    return numbers;
  });
  for (std::size_t k = 0; k < times.size(); ++k) {
    within_errors(fmt::format("ln of T with over T without contact_time: e 0.5 phi 0.5 t {}", times[k]), found[k], {});
  }
}

}  // namespace

void cooling() {
  haffs_law();
  fourth_moments();
  lasting_contacts();
}

}  // namespace gridlock::validation
