// Self-diffusion and pressure of Brownian disks, and Brownian swimmers.

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "dynamics/sections.hpp"
#include "reference/unwrapped.hpp"

namespace gridlock::validation {
namespace {

using reference::mean_squared_displacement;
using reference::unwrapped;

EngineSettings brownian(double interval) {
  EngineSettings settings = exact();
  settings.thermostat = {.kind = ThermostatKind::brownian, .temperature = 1.0, .interval = interval};
  return settings;
}

/// Lags in units of σ²/D₀, between which the slope of the mean squared displacement over 4 D₀ is D/D₀.
struct Window {
  double from;
  double to;
};
constexpr std::array windows{Window{1.0, 2.0}, Window{2.0, 6.0}, Window{0.0, 0.125}, Window{0.25, 0.5}};
constexpr std::size_t long_windows = 2;  ///< the first ones, for which two samples in σ²/D₀ suffice

/// Returns D/D₀ in the first `count` windows for 256 disks and a duration in units of σ²/D₀. All origins are kicks.
Numbers diffusion_in_windows(double packing_fraction, double interval, std::size_t count, double duration,
                             std::uint64_t seed) {
  double const samples_in_unit = count > long_windows ? 8.0 : 2.0;
  double const unit = 2.0 / interval;  // σ²/D₀
  State state = fluid(256, packing_fraction, seed);
  auto const engine = make_engine(brownian(interval), state);
  Counters counters;
  std::vector<std::vector<Vector>> places;
  for (double sample = 0.0; sample <= duration * samples_in_unit; ++sample) {
    engine->advance(state, counters, {.time = sample * unit / samples_in_unit});
    places.push_back(unwrapped(state));
  }
  auto const after = [&](double time) {
    auto const lag = static_cast<std::size_t>(time * samples_in_unit);
    double sum = 0.0;
    for (std::size_t k = lag; k < places.size(); ++k) sum += mean_squared_displacement(places[k - lag], places[k]);
    return sum / static_cast<double>(places.size() - lag);
  };
  Numbers slopes;
  for (std::size_t k = 0; k < count; ++k) {
    slopes.push_back((after(windows[k].to) - after(windows[k].from)) / (4.0 * (windows[k].to - windows[k].from)));
  }
  return slopes;
}

std::string in_window(std::size_t k, double packing_fraction, double interval) {
  return fmt::format("D({} to {})/D0 at phi {} interval {}", windows[k].from, windows[k].to, packing_fraction,
                     interval);
}

void diffusion_of_fluids() {
  struct Fluid {
    double packing_fraction;
    std::array<Estimate, windows.size()> diffusion;
  };
  for (auto const& [packing_fraction, expected] :
       {Fluid{0.1, {{{0.8320, 0.0025}, {0.8136, 0.0042}, {0.9296, 0.0006}, {0.8686, 0.0012}}}},
        Fluid{0.2, {{{0.6847, 0.0022}, {0.6678, 0.0039}, {0.8438, 0.0006}, {0.7318, 0.0011}}}},
        Fluid{0.3, {{{0.5591, 0.0018}, {0.5474, 0.0027}, {0.7404, 0.0004}, {0.5980, 0.0009}}}},
        Fluid{0.5, {{{0.3340, 0.0015}, {0.3294, 0.0023}, {0.4789, 0.0003}, {0.3475, 0.0008}}}}}) {
    auto const found = means(24, [packing_fraction = packing_fraction](std::uint64_t seed) {
      return diffusion_in_windows(packing_fraction, 0.1, windows.size(), 100.0, seed);
    });
    for (std::size_t k = 0; k < found.size(); ++k) {
      within_errors(in_window(k, packing_fraction, 0.1), found[k], expected[k]);
    }
  }
}

/// If the mean squared displacement is 4 D_L t + c ln t, the slopes in the two long windows give D_L. To first order
/// in φ, D_L/D₀ is 1 − 2φ.
void diffusion_of_a_dilute_gas() {
  auto const found = means(24, [](std::uint64_t seed) {
    Numbers slopes = diffusion_in_windows(0.02, 0.1, long_windows, 100.0, seed);
    slopes.push_back(slopes[1] - 0.657 * (slopes[0] - slopes[1]));
    return slopes;
  });
  within_errors(in_window(0, 0.02, 0.1), found[0], {0.9685, 0.0019});
  within_errors(in_window(1, 0.02, 0.1), found[1], {0.962, 0.004});
  within("D_L/D0 at phi 0.02", found[2], 0.955, 0.025);
}

/// Diffusion is linear in the interval; the line is weighted by the errors.
void diffusion_without_an_interval() {
  constexpr std::array intervals{0.2, 0.1, 0.05, 0.025};
  constexpr std::array<std::uint64_t, intervals.size()> runs{16, 16, 12, 8};  // the shorter the interval, the slower
  constexpr std::array<Estimate, long_windows> expected{{{0.347, 0.004}, {0.339, 0.004}}};
  std::array<std::vector<Estimate>, long_windows> found;
  for (std::size_t i = 0; i < intervals.size(); ++i) {
    auto const slopes = means(
        runs[i], [&](std::uint64_t seed) { return diffusion_in_windows(0.5, intervals[i], long_windows, 60.0, seed); });
    for (std::size_t k = 0; k < long_windows; ++k) found[k].push_back(slopes[k]);
  }
  for (std::size_t k = 0; k < long_windows; ++k) {
    double s = 0.0, sx = 0.0, sy = 0.0, sxx = 0.0, sxy = 0.0;
    auto const sum = [&](auto use) {
      for (std::size_t i = 0; i < intervals.size(); ++i) {
        use(1.0 / (found[k][i].error * found[k][i].error), intervals[i], found[k][i].value);
      }
    };
    sum([&](double w, double x, double y) { s += w, sx += w * x, sy += w * y, sxx += w * x * x, sxy += w * x * y; });
    double const determinant = s * sxx - sx * sx;
    double const slope = (s * sxy - sx * sy) / determinant;
    double const limit = (sxx * sy - sx * sxy) / determinant;
    double squares = 0.0;
    sum([&](double w, double x, double y) { squares += w * std::pow(y - limit - slope * x, 2); });
    within_errors(in_window(k, 0.5, 0.0), {limit, std::sqrt(sxx / determinant)}, expected[k]);
    // χ² of two degrees of freedom is above 13.8 once in a thousand times.
    within("its residuals from a line: root of mean square in errors", {std::sqrt(squares / 2.0), 0.0}, 0.0, 2.63);
  }
}

void pressures_of_brownian_disks() {
  for (auto const& [packing_fraction, expected] :
       {std::pair{0.1, 1.234}, std::pair{0.2, 1.570}, std::pair{0.4, 2.824}}) {
    auto const found = means(16, [packing_fraction = packing_fraction](std::uint64_t seed) -> Numbers {
      State state = fluid(256, packing_fraction, seed);
      Counters counters;
      make_engine(brownian(0.05), state)->advance(state, counters, {.time = 1000.0});
      return {1.0 + counters.pair_virial / (2.0 * 256.0 * 1000.0)};
    });
    within_errors(fmt::format("Z at phi {} interval 0.05", packing_fraction), found[0], {expected, 0.002});
  }
}

/// Returns v(φ)/v₀ of 200 Brownian swimmers at Pe = v₀σ/D₀ with D_R = 3 D₀/σ², as Ni, Cohen Stuart and Dijkstra (2013,
/// doi:10.1038/ncomms3704) have them in three dimensions.
Numbers effective_speed(double packing_fraction, double peclet, double interval, std::uint64_t seed) {
  double const diffusion = interval / 2.0;
  State state = fluid(200, packing_fraction, seed);
  EngineSettings settings = brownian(interval);
  settings.propulsion = {.speed = peclet * diffusion, .rotational_diffusion = 3.0 * diffusion};
  auto const engine = make_engine(settings, state);
  Counters counters;
  engine->advance(state, counters, {.time = 200.0});
  double const swum = counters.swum;
  double const if_free = counters.swum_if_free;
  engine->advance(state, counters, {.time = 700.0});
  return {(counters.swum - swum) / (counters.swum_if_free - if_free)};
}

}  // namespace

void diffusion() {
  diffusion_of_fluids();
  diffusion_of_a_dilute_gas();
  diffusion_without_an_interval();
  pressures_of_brownian_disks();
}

void swimmers() {
  constexpr std::array intervals{0.1, 0.05, 0.025};
  struct Crowd {
    double packing_fraction;
    double peclet;
    std::array<Estimate, 3> speed;
  };
  for (auto const& [packing_fraction, peclet, expected] :
       {Crowd{0.2, 10.0, {{{0.756, 0.005}, {0.770, 0.004}, {0.767, 0.007}}}},
        Crowd{0.2, 40.0, {{{0.723, 0.002}, {0.769, 0.003}, {0.778, 0.003}}}},
        Crowd{0.4, 10.0, {{{0.517, 0.004}, {0.539, 0.004}, {0.548, 0.013}}}},
        Crowd{0.4, 40.0, {{{0.468, 0.005}, {0.522, 0.005}, {0.528, 0.010}}}}}) {
    for (std::size_t k = 0; k < intervals.size(); ++k) {
      auto const found = means(10, [&, packing_fraction = packing_fraction, peclet = peclet](std::uint64_t seed) {
        return effective_speed(packing_fraction, peclet, intervals[k], seed);
      });
      within_errors(fmt::format("v/v0 at phi {} Pe {} interval {}", packing_fraction, peclet, intervals[k]), found[0],
                    expected[k]);
    }
  }
}

}  // namespace gridlock::validation
