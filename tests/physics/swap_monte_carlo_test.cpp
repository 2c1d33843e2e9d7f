// Swap Monte Carlo against small systems that can be enumerated, and against the fluid of hard disks.

#include "gridlock/engine/swap_monte_carlo.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <span>
#include <vector>

#include "gridlock/grid/neighbour_search.hpp"
#include "gridlock/grid/validate.hpp"
#include "gridlock/lattice/start.hpp"

namespace gridlock {
namespace {

struct Mean {
  double value = 0.0;
  double error = 0.0;  ///< standard error
};

/// Over twenty blocks, each far longer than the memory of these systems.
Mean mean_of(std::vector<double> const& samples) {
  constexpr std::size_t blocks = 20;
  std::size_t const length = samples.size() / blocks;
  std::array<double, blocks> means{};
  for (std::size_t k = 0; k < blocks * length; ++k) means[k / length] += samples[k] / static_cast<double>(length);
  Mean mean;
  for (double const m : means) mean.value += m / blocks;
  for (double const m : means) mean.error += (m - mean.value) * (m - mean.value) / (blocks * (blocks - 1.0));
  mean.error = std::sqrt(mean.error);
  return mean;
}

/// Calls measure(state) every few sweeps after the first tenth of them.
void sample(State& state, SwapSettings const& settings, std::uint64_t every, std::function<void()> const& measure) {
  SwapMonteCarlo swaps(settings, state);
  while (!swaps.advance(state, [&] { return swaps.sweeps_done() % every != 0; })) {
    if (swaps.sweeps_done() > settings.sweeps / 10) measure();
  }
}

// Three disks in a channel in which none passes another. All that is allowed is equally likely, so an order has the
// probability of its area ∫ (free length)³/6 over the heights, the free length being what end radii and the distances
// along the channel at contact, √(σ² − Δy²), leave of it. Disks that are not next to each other never touch.
TEST(SwapMonteCarlo, FindsTheLargestDiskOfThreeInTheMiddleOfAChannelAsOftenAsEnumerationSays) {
  constexpr double length = 1.5;
  constexpr double height = 0.7;
  constexpr std::array<double, 3> radius{0.3, 0.22, 0.15};
  auto const along = [](double sigma, double dy) { return std::sqrt(sigma * sigma - dy * dy); };
  constexpr int cells = 40;
  std::array<double, 3> area{};
  for (std::size_t middle = 0; middle < 3; ++middle) {
    double const a = radius[(middle + 1) % 3];
    double const b = radius[middle];
    double const c = radius[(middle + 2) % 3];
    auto const y = [](double r, int k) { return r + (height - 2.0 * r) * (k + 0.5) / cells; };
    double const cell = (height - 2.0 * a) * (height - 2.0 * b) * (height - 2.0 * c) / (cells * cells * cells);
    for (int i = 0; i < cells; ++i) {
      for (int j = 0; j < cells; ++j) {
        double const first = along(a + b, y(a, i) - y(b, j));
        for (int k = 0; k < cells; ++k) {
          double const free = length - a - c - first - along(b + c, y(b, j) - y(c, k));
          if (free > 0.0) area[middle] += cell * free * free * free / 6.0;
        }
      }
    }
  }
  double const all = area[0] + area[1] + area[2];
  ASSERT_GT(std::abs(area[0] / all - area[2] / all), 0.05) << "orders alike would prove little";

  State state{.box = Box(length, height, Edge::wall), .seed = 11};
  double x = 0.0;
  for (double const r : radius) {
    state.agents.add(x + r, r + 0.01, 0.0, 0.0, r, 1.0, 0, 0);
    x += 2.0 * r + 0.01;
  }
  std::array<std::vector<double>, 3> in_the_middle;
  sample(state, {.sweeps = 2'000'000, .swap_fraction = 0.3, .step = 0.5}, 10, [&] {
    auto const xs = state.agents.column<X>();
    std::array<std::size_t, 3> order{0, 1, 2};
    std::ranges::sort(order, {}, [&](std::size_t i) { return xs[i]; });
    for (std::size_t k = 0; k < 3; ++k) {
      in_the_middle[k].push_back(state.agents.column<Radius>()[order[1]] == radius[k] ? 1.0 : 0.0);
    }
  });
  for (std::size_t k = 0; k < 3; ++k) {
    Mean const share = mean_of(in_the_middle[k]);
    EXPECT_LT(share.error, 0.012);
    EXPECT_NEAR(share.value, area[k] / all, 4.0 * share.error) << "radius " << radius[k];
  }
}

// Two disks between walls: Δx has the density of the difference of two uniform numbers, Δy too, and of the plane of
// (Δx, Δy) the circle of contact is cut out.
TEST(SwapMonteCarlo, FindsTwoDisksInABoxAsNearToEachOtherAsEnumerationSays) {
  constexpr double r = 0.12;
  constexpr double s = 0.25;
  auto const density = [](double d) {
    double const a = 1.0 - 2.0 * r;
    double const b = 1.0 - 2.0 * s;
    return std::max(0.0, std::min(b, 0.5 * (a + b) - std::abs(d)));
  };
  constexpr int cells = 2000;
  double all = 0.0;
  double near = 0.0;
  for (int i = 0; i < cells; ++i) {
    double const dx = (i + 0.5) / cells;
    for (int j = 0; j < cells; ++j) {
      double const dy = (j + 0.5) / cells;
      double const squared = dx * dx + dy * dy;
      if (squared < (r + s) * (r + s)) continue;
      double const weight = density(dx) * density(dy);
      all += weight;
      if (squared < 0.5 * 0.5) near += weight;
    }
  }
  State state{.box = Box(1.0, 1.0, Edge::wall), .seed = 12};
  state.agents.add(0.2, 0.2, 0.0, 0.0, r, 1.0, 0, 0);
  state.agents.add(0.7, 0.7, 0.0, 0.0, s, 1.0, 0, 0);
  std::vector<double> is_near;
  std::vector<double> is_swapped;
  sample(state, {.sweeps = 1'000'000, .step = 1.0}, 10, [&] {
    Vector const d = position(state.agents, 1) - position(state.agents, 0);
    is_near.push_back(squared_length(d) < 0.5 * 0.5 ? 1.0 : 0.0);
    is_swapped.push_back(state.agents.column<Radius>()[0] == s ? 1.0 : 0.0);
  });
  Mean const share = mean_of(is_near);
  EXPECT_LT(share.error, 0.005);
  EXPECT_NEAR(share.value, near / all, 4.0 * share.error);
  Mean const swapped = mean_of(is_swapped);
  EXPECT_NEAR(swapped.value, 0.5, 4.0 * swapped.error);
}

/// The mean packing fraction at constant pressure, from the sweeps that count.
Mean density_at_pressure(State state, double pressure) {
  SwapMonteCarlo swaps({.sweeps = 1'000'000, .swap_fraction = 0.0, .pressure = pressure}, state);
  swaps.advance(state);
  std::vector<double> packing_fractions;
  for (SwapDensity const& density : swaps.densities()) {
    if (!density.is_adjusting) packing_fractions.push_back(density.packing_fraction);
  }
  return mean_of(packing_fractions);
}

/// ⟨φ⟩ over the areas v = A/D² of a square with the weight vᴺ exp(−P v) times the share of all positions without
/// overlap, which is that of D = 1/√v in a square of side 1.
double exact_density(double disks, double pressure, std::function<double(double)> const& share_without_overlap) {
  double sum = 0.0;
  double weights = 0.0;
  constexpr int cells = 200'000;
  for (int k = 0; k < cells; ++k) {
    double const v = 40.0 * (k + 0.5) / cells;
    double const weight = std::pow(v, disks) * std::exp(-pressure * v) * share_without_overlap(1.0 / std::sqrt(v));
    sum += weight * disks * 0.25 * std::numbers::pi / v;
    weights += weight;
  }
  return sum / weights;
}

/// Expects the exact density at some pressures, with a standard error below `max_error`.
void expect_exact_density(State const& state, std::vector<double> const& pressures, double max_error,
                          std::function<double(double)> const& share_without_overlap) {
  for (double const pressure : pressures) {
    Mean const density = density_at_pressure(state, pressure);
    double const exact = exact_density(static_cast<double>(state.agents.size()), pressure, share_without_overlap);
    EXPECT_LT(density.error, max_error);
    EXPECT_NEAR(density.value, exact, 4.0 * density.error) << pressure;
  }
}

TEST(MonteCarloAtConstantPressure, GivesOneDiskBetweenWallsItsExactDensity) {
  State state{.box = Box(1.0, 1.0, Edge::wall), .seed = 5};
  state.agents.add(0.5, 0.5, 0.0, 0.0, 0.2, 1.0, 0, 0);
  auto const share = [](double d) { return d < 1.0 ? (1.0 - d) * (1.0 - d) : 0.0; };
  expect_exact_density(state, {2.0, 20.0}, 0.002, share);
}

// One disk is cut out around the other, and four segments overlap where it is wider than the box.
TEST(MonteCarloAtConstantPressure, GivesTwoDisksInAPeriodicBoxTheirExactDensity) {
  State state{.box = Box(1.0, 1.0, Edge::periodic), .seed = 6};
  state.agents.add(0.2, 0.2, 0.0, 0.0, 0.1, 1.0, 0, 0);
  state.agents.add(0.7, 0.7, 0.0, 0.0, 0.1, 1.0, 0, 0);
  auto const share = [](double d) {
    double cut = std::numbers::pi * d * d;
    if (d > 0.5) cut -= 4.0 * (d * d * std::acos(0.5 / d) - 0.5 * std::sqrt(d * d - 0.25));
    return std::max(0.0, d * d < 0.5 ? 1.0 - cut : 0.0);
  };
  expect_exact_density(state, {1.0, 10.0}, 0.002, share);
}

// v exp(−P v) for D ≤ 1, the side of the box: ⟨φ⟩ = (π/4) ∫ e^(−Pv) dv / ∫ v e^(−Pv) dv = (π/4) P/(1 + P), v > 1.
TEST(MonteCarloAtConstantPressure, LetsNoDiskOverlapItsOwnImage) {
  State state{.box = Box(1.0, 1.0, Edge::periodic), .seed = 7};
  state.agents.add(0.5, 0.5, 0.0, 0.0, 0.2, 1.0, 0, 0);
  Mean const density = density_at_pressure(state, 2.0);
  EXPECT_LT(density.error, 0.003);
  EXPECT_NEAR(density.value, 0.25 * std::numbers::pi * 2.0 / 3.0, 4.0 * density.error);
}

/// Makes dense disks by trial moves and, in between, by letting all grow until two touch.
State compressed(State state, double packing_fraction) {
  auto const radii = state.agents.column<Radius>();
  for (std::uint64_t round = 0;; ++round) {
    SwapMonteCarlo swaps({.sweeps = 20, .step = 0.05, .stage = 1000 + round}, state);
    swaps.advance(state);
    double growth = std::sqrt(packing_fraction * state.box.area() / covered_area(state.agents));
    double const cutoff = 3.0 * radius_range(state.agents).largest;
    NeighbourSearch const search(state.box, cutoff, state.agents.column<X>(), state.agents.column<Y>());
    bool is_limited = false;
    search.for_each_pair([&](std::size_t i, std::size_t j, Vector separation) {
      double const room = std::sqrt(squared_length(separation)) / (radii[i] + radii[j]) * (1.0 - 1e-9);
      if (room < growth) is_limited = true;
      growth = std::min(growth, room);
    });
    for (double& r : radii) r *= growth;
    if (!is_limited || round > 5000) return state;
  }
}

/// βP/ρ = 1 + n(s)/(2 N s) for s → 0, n(s) being the number of pairs nearer than (1 + s) of contact; from three shells
/// of 0.02, carried on to contact by a parabola.
class ContactPressure {
 public:
  explicit ContactPressure(State const& state) : state_(state) {}

  void measure() {
    constexpr double width = 0.02;
    auto const radii = state_.agents.column<Radius>();
    double const cutoff = 2.0 * (1.0 + 3.0 * width) * radius_range(state_.agents).largest;
    std::array<double, 3> pairs{};
    double sum = 0.0;
    double squares = 0.0;
    double product = 0.0;
    double touching = 0.0;
    for (double const r : radii) sum += r;
    double const mean = sum / static_cast<double>(radii.size());
    for (double const r : radii) squares += (r - mean) * (r - mean);
    NeighbourSearch const search(state_.box, cutoff, state_.agents.column<X>(), state_.agents.column<Y>());
    search.for_each_pair([&](std::size_t i, std::size_t j, Vector separation) {
      double const s = std::sqrt(squared_length(separation)) / (radii[i] + radii[j]) - 1.0;
      if (s < 0.0 || s >= 3.0 * width) return;
      ++pairs[static_cast<std::size_t>(s / width)];
      product += (radii[i] - mean) * (radii[j] - mean);
      ++touching;
    });
    auto const shell = [&](std::size_t k) {
      double const middle = (static_cast<double>(k) + 0.5) * width;
      return pairs[k] / (2.0 * static_cast<double>(radii.size()) * width * (1.0 + middle));
    };
    pressures_.push_back(1.0 + (15.0 * shell(0) - 10.0 * shell(1) + 3.0 * shell(2)) / 8.0);
    if (squares > 0.0) correlations_.push_back(product / touching / (squares / static_cast<double>(radii.size())));
  }

  [[nodiscard]] Mean pressure() const { return mean_of(pressures_); }
  /// ⟨(R_i − R̄)(R_j − R̄)⟩ of pairs near contact over the variance.
  [[nodiscard]] Mean size_correlation() const { return mean_of(correlations_); }

 private:
  State const& state_;
  std::vector<double> pressures_;
  std::vector<double> correlations_;
};

// βP/ρ of the fluid: Kolafa & Rottner 2006, which the engine `exact` is held to (validation/). 256 disks differ from
// infinitely many by about a hundredth of Z − 1 at most.
TEST(SwapMonteCarlo, GivesEqualDisksThePressureOfTheirFluid) {
  for (auto const& [packing_fraction, expected] : {std::pair(0.3, 2.063261), {0.5, 4.106364}, {0.6, 6.455337}}) {
    DisksSettings const disks{.count = 256, .packing_fraction = packing_fraction, .start = StartKind::triangular};
    State state = make_start(Box(1.0, 1.0, Edge::periodic), disks, 3);
    ContactPressure contact(state);
    sample(state, {.sweeps = 20'000}, 4, [&] { contact.measure(); });
    Mean const pressure = contact.pressure();
    EXPECT_LT(pressure.error, 0.02 * expected);
    EXPECT_NEAR(pressure.value, expected, 4.0 * pressure.error + 0.01 * (expected - 1.0)) << packing_fraction;
  }
}

TEST(SwapMonteCarlo, GivesAMixtureTheSameMeansWithSwapsAndWithout) {
  DisksSettings const disks{
      .count = 150, .packing_fraction = 0.5, .sizes = SizeDistribution::inverse_cube, .start = StartKind::random};
  State const start = compressed(make_start(Box(1.0, 1.0, Edge::periodic), disks, 3), 0.6);
  std::array<Mean, 2> pressure;
  std::array<Mean, 2> correlation;
  for (std::size_t with_swaps : {0U, 1U}) {
    State state = start;
    ContactPressure contact(state);
    SwapSettings const settings{.sweeps = 40'000, .swap_fraction = with_swaps == 1 ? 0.2 : 0.0};
    sample(state, settings, 8, [&] { contact.measure(); });
    pressure[with_swaps] = contact.pressure();
    correlation[with_swaps] = contact.size_correlation();
  }
  for (auto const& means : {pressure, correlation}) {
    double const error = std::hypot(means[0].error, means[1].error);
    EXPECT_NEAR(means[0].value, means[1].value, 4.0 * error);
  }
  EXPECT_LT(pressure[1].error, 0.01 * pressure[1].value);
  // The sizes of neighbours are known well enough for the comparison to mean something.
  EXPECT_LT(correlation[0].error, 0.02);
}

// Measured: of the cages 0.57 are left with swaps after 4000 sweeps and 0.92 without, of the bond orientations 0.11 and
// 0.64.
TEST(SwapMonteCarlo, RelaxesADenseMixtureFasterWithSwaps) {
  DisksSettings const disks{
      .count = 200, .packing_fraction = 0.5, .sizes = SizeDistribution::inverse_cube, .start = StartKind::random};
  State const start = compressed(make_start(Box(1.0, 1.0, Edge::periodic), disks, 3), 0.77);
  ASSERT_NEAR(covered_area(start.agents), 0.77, 1e-9);
  auto const left_after_4000_sweeps = [&](double swap_fraction) {
    State state = start;
    SwapMonteCarlo swaps({.sweeps = 10'000, .swap_fraction = swap_fraction}, state);
    swaps.advance(state);
    std::vector<SwapCorrelation> const correlations = swaps.correlations();
    return *std::ranges::lower_bound(correlations, 4000U, {}, &SwapCorrelation::lag);
  };
  SwapCorrelation const with_swaps = left_after_4000_sweeps(0.2);
  SwapCorrelation const without = left_after_4000_sweeps(0.0);
  EXPECT_LT(with_swaps.bond_orientation, 0.5 * without.bond_orientation);
  EXPECT_LT(1.0 - without.self_overlap, 0.5 * (1.0 - with_swaps.self_overlap));
}

}  // namespace
}  // namespace gridlock
