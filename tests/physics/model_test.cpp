// The shipped models against numbers that have a source or a derivation.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "models/catalyst.hpp"
#include "models/epidemic.hpp"
#include "models/flocking.hpp"
#include "models/predation.hpp"
#include "models/segregation.hpp"
#include "reference/mean_and_error.hpp"

namespace gridlock {
namespace {

using reference::Estimate;
using reference::mean_of;

template <class Model>
World<Model> start_of(Model const& model, Box const& box, std::uint64_t seed) {
  World<Model> world{.box = box, .seed = seed};
  start_agents(model, world);
  return world;
}

Box const walls(1.0, 1.0, Edge::wall);

constexpr double disk_area(double radius) { return std::numbers::pi * radius * radius; }

TEST(Catalyst, RandomSequentialAdsorptionFollowsTheAvailableSurfaceAndSaturates) {
  // θ(t) of the reference table, t = tries · πR²/A; saturation 0.547069 (Wang 1994) from θ(∞) − θ(t) ∝ t^−½.
  double const radius = 0.0085;
  Catalyst const model{.radius = radius, .adsorption_rate = 1.0 / disk_area(radius), .step_length = 0.01};
  Box const box(1.0, 1.0, Edge::periodic);
  struct Point {
    double time;
    double coverage;
  };
  std::vector<Point> const table{{0.12539, 0.10}, {0.33917, 0.20}, {0.79332, 0.30}, {2.3389, 0.40}, {5.5128, 0.45}};
  std::vector<std::vector<double>> coverages(table.size());
  std::vector<double> saturations;
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    World<Catalyst> world = start_of(model, box, seed);
    for (std::size_t k = 0; k < table.size(); ++k) {
      // Up to the moment itself: the rest of it is a step of its own length.
      Catalyst rest = model;
      rest.step_length = table[k].time - world.clock.time;
      ModelEngine<Catalyst>(rest, box, {}).advance(world, {.step = world.clock.step + 1});
      coverages[k].push_back(Catalyst::coverage(world));
    }
    std::vector<double> x;
    std::vector<double> y;
    for (double const time : {50.0, 100.0, 200.0, 400.0}) {
      Catalyst rest = model;
      rest.step_length = time - world.clock.time;
      ModelEngine<Catalyst>(rest, box, {}).advance(world, {.step = world.clock.step + 1});
      x.push_back(1.0 / std::sqrt(time));
      y.push_back(Catalyst::coverage(world));
    }
    Estimate const mx = mean_of(x);
    Estimate const my = mean_of(y);
    double xy = 0.0;
    double xx = 0.0;
    for (std::size_t k = 0; k < x.size(); ++k) {
      xy += (x[k] - mx.value) * (y[k] - my.value);
      xx += (x[k] - mx.value) * (x[k] - mx.value);
    }
    saturations.push_back(my.value - xy / xx * mx.value);
  }
  for (std::size_t k = 0; k < table.size(); ++k) {
    Estimate const m = mean_of(coverages[k]);
    EXPECT_NEAR(m.value, table[k].coverage, 5.0 * m.error + 2e-5) << "at " << table[k].time;
  }
  Estimate const saturation = mean_of(saturations);
  EXPECT_LT(saturation.error, 0.001);
  EXPECT_NEAR(saturation.value, 0.547069, 5.0 * saturation.error);
}

TEST(Catalyst, ReversibleAdsorptionFollowsTheIsotherm) {
  // zπR² = k_a πR²/k_d of the reference for each coverage.
  struct Point {
    double activity;
    double coverage;
  };
  double const radius = 0.02;
  for (auto const& [activity, coverage] :
       {Point{0.157358, 0.10}, Point{1.92231, 0.30}, Point{8.24429, 0.40}, Point{62.9361, 0.50}}) {
    Catalyst const model{.radius = radius,
                         .adsorption_rate = activity / disk_area(radius),
                         .desorption_rate = 1.0,
                         .hop_rate = 20.0,
                         .hop = 0.6 * radius,
                         .step_length = 2.0};
    Box const box(1.0, 1.0, Edge::periodic);
    std::vector<double> coverages;
    for (std::uint64_t seed = 1; seed <= 4; ++seed) {
      World<Catalyst> world = start_of(model, box, seed);
      ModelEngine<Catalyst> engine(model, box, {});
      engine.advance(world, {.step = 8});
      double sum = 0.0;
      for (std::uint64_t step = 9; step <= 28; ++step) {
        engine.advance(world, {.step = step});
        sum += Catalyst::coverage(world) / 20.0;
      }
      coverages.push_back(sum);
    }
    Estimate const m = mean_of(coverages);
    EXPECT_LT(m.error, 0.003);
    EXPECT_NEAR(m.value, coverage, 5.0 * m.error + 1e-4) << activity;
  }
}

/// Well mixed: hops go anywhere and meet a partner with probability (partners) · 4πR²/A, so that dc/dt = −k c².
Catalyst well_mixed(Reaction reaction) {
  return {.radius = 0.0005,
          .adsorption_rate = 0.0,
          .hop_rate = 1.0,
          .hop = 0.0,
          .reaction = reaction,
          .count = 20'000,
          .step_length = 4.0};
}

TEST(Catalyst, AWithAFollowsTheRateEquationWhereItIsWellMixed) {
  // Every hop onto another A takes two: dN/dt = −2ν N (N − 1) 4πR²/A, thus N = N₀/(1 + k N₀ t) with k = 8πR²ν/A.
  Catalyst const model = well_mixed(Reaction::a_with_a);
  double const k = 8.0 * disk_area(model.radius);
  std::vector<double> counts;
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    World<Catalyst> world = start_of(model, Box(1.0, 1.0, Edge::periodic), seed);
    ModelEngine<Catalyst>(model, world.box, {}).advance(world, {.step = 5});
    counts.push_back(static_cast<double>(world.agents.size()));
  }
  Estimate const m = mean_of(counts);
  // A point has at most one other centre within 2R but for a share of about 4θ, here 2 %·¼ of the hops that meet one.
  double const expected = 20'000.0 / (1.0 + k * 20'000.0 * 20.0);
  EXPECT_LT(expected, 6000.0);
  EXPECT_NEAR(m.value / expected, 1.0, 5.0 * m.error / expected + 0.02);
}

TEST(Catalyst, AWithBFollowsTheRateEquationWhereItIsWellMixed) {
  // Hops of either species: dN_A/dt = dN_B/dt = −2ν N_A N_B 4πR²/A; for N_B > N_A,
  // N_A = N_A0 D / (N_B0 e^{kDt} − N_A0) with D = N_B0 − N_A0, k = 8πR²ν/A.
  Catalyst model = well_mixed(Reaction::a_with_b);
  model.count = 8000;
  model.count_b = 12'000;
  double const k = 8.0 * disk_area(model.radius);
  double const expected = 8000.0 * 4000.0 / (12'000.0 * std::exp(k * 4000.0 * 20.0) - 8000.0);
  std::vector<double> counts;
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    World<Catalyst> world = start_of(model, Box(1.0, 1.0, Edge::periodic), seed);
    ModelEngine<Catalyst>(model, world.box, {}).advance(world, {.step = 5});
    auto const species = world.agents.column<Species>();
    auto const a = std::ranges::count(species, 0U);
    EXPECT_EQ(std::ranges::count(species, 1U) - a, 4000) << "A and B leave in pairs";
    counts.push_back(static_cast<double>(a));
  }
  Estimate const m = mean_of(counts);
  EXPECT_NEAR(m.value / expected, 1.0, 5.0 * m.error / expected + 0.02);
}

double mean_order(double noise, double density) {
  Flocking const model{.count = static_cast<std::uint64_t>(100.0 * density), .noise = noise};
  Box const box(10.0, 10.0, Edge::periodic);
  World<Flocking> world = start_of(model, box, 1);
  ModelEngine<Flocking> engine(model, box, {});
  engine.advance(world, {.step = 1500});
  double sum = 0.0;
  for (std::uint64_t step = 1501; step <= 3000; ++step) {
    engine.advance(world, {.step = step});
    sum += Flocking::order(AgentSums<Flocking>(world)) / 1500.0;
  }
  return sum;
}

TEST(Flocking, OrderFallsWithNoiseAndGrowsWithDensity) {
  // Vicsek 1995, Figure 2a for N = 400, L = 10: near 1 without noise, about 1/√N at full noise.
  EXPECT_GT(mean_order(0.1, 4.0), 0.97);
  EXPECT_GT(mean_order(1.0, 4.0), 0.85);
  EXPECT_LT(mean_order(2.0 * std::numbers::pi, 4.0), 3.0 / std::sqrt(400.0));
  EXPECT_GT(mean_order(2.0, 4.0), mean_order(2.0, 0.3) + 0.2);
}

/// The shares of susceptible and infected agents that dS/dt = −b S I, dI/dt = b S I − g I lead to, by Heun's method.
struct Shares {
  double susceptible;
  double infected;
};
Shares sir_after(double time, double b, double g, Shares at) {
  constexpr double h = 0.001;
  for (auto left = static_cast<int>(std::lround(time / h)); left > 0; --left) {
    double const infections = b * at.susceptible * at.infected;
    double const change = infections - g * at.infected;
    Shares const next{at.susceptible - h * infections, at.infected + h * change};
    double const next_infections = b * next.susceptible * next.infected;
    double const next_change = next_infections - g * next.infected;
    at.susceptible -= 0.5 * h * (infections + next_infections);
    at.infected += 0.5 * h * (change + next_change);
  }
  return at;
}

TEST(Epidemic, ItsCourseIsThatOfTheSirEquations) {
  // Well mixed: b = β N π r²/A. Many are infected at the start, so that chance plays a small part.
  Epidemic const model{.count = 10'000,
                       .infected_at_start = 0.1,
                       .radius = 0.02,
                       .speed = 4.0,
                       .infection_rate = 0.05,
                       .recovery_rate = 0.2,
                       .step_length = 0.05};
  double const b = model.infection_rate * 10'000.0 * disk_area(model.radius);
  std::vector<double> const times{2.0, 5.0, 8.0, 16.0};
  std::vector<std::vector<double>> susceptible(times.size());
  std::vector<std::vector<double>> infected(times.size());
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    World<Epidemic> world = start_of(model, Box(1.0, 1.0, Edge::periodic), seed);
    ModelEngine<Epidemic> engine(model, world.box, {.threads = 2});
    for (std::size_t k = 0; k < times.size(); ++k) {
      engine.advance(world, {.step = static_cast<std::uint64_t>(std::lround(times[k] / model.step_length))});
      auto const share = [&](Epidemic::State state) {
        return static_cast<double>(
                   std::ranges::count(world.agents.column<Health>(), static_cast<std::uint32_t>(state))) /
               10'000.0;
      };
      susceptible[k].push_back(share(Epidemic::susceptible));
      infected[k].push_back(share(Epidemic::infected));
    }
  }
  for (std::size_t k = 0; k < times.size(); ++k) {
    Shares const expected = sir_after(times[k], b, model.recovery_rate, {0.9, 0.1});
    Estimate const s = mean_of(susceptible[k]);
    Estimate const i = mean_of(infected[k]);
    EXPECT_NEAR(s.value, expected.susceptible, 5.0 * s.error + 0.005) << "at " << times[k];
    EXPECT_NEAR(i.value, expected.infected, 5.0 * i.error + 0.005) << "at " << times[k];
  }
}

TEST(Epidemic, ItsFinalSizeIsThatOfTheSirEquations) {
  // Well mixed: R∞ = S₀ (1 − e^{−R₀ r}) with r = 1 − S∞/N; ln(S∞/S₀) = −R₀ (1 − S∞/N), R₀ = β n/γ, n = Nπr²/A.
  Epidemic const model{.count = 5000,
                       .infected_at_start = 0.02,
                       .radius = 0.028,
                       .speed = 4.0,
                       .turning_rate = 1.0,
                       .infection_rate = 0.03,
                       .recovery_rate = 0.2,
                       .step_length = 0.05};
  double const neighbours = 5000.0 * disk_area(model.radius);
  double const reproduction = model.infection_rate * neighbours / model.recovery_rate;
  double susceptible = 0.2;
  for (int k = 0; k < 200; ++k) susceptible = 0.98 * std::exp(-reproduction * (1.0 - susceptible));
  std::vector<double> shares;
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    World<Epidemic> world = start_of(model, Box(1.0, 1.0, Edge::periodic), seed);
    ModelEngine<Epidemic>(model, world.box, {}).advance(world, {.step = 2000});
    auto const health = world.agents.column<Health>();
    EXPECT_LE(std::ranges::count(health, static_cast<std::uint32_t>(Epidemic::infected)), 5) << "it is over";
    shares.push_back(
        static_cast<double>(std::ranges::count(health, static_cast<std::uint32_t>(Epidemic::susceptible))) / 5000.0);
  }
  Estimate const m = mean_of(shares);
  EXPECT_NEAR(m.value, susceptible, 5.0 * m.error + 0.01) << "R₀ = " << reproduction;
}

TEST(Predation, WolvesWithoutSheepLiveOnWhatTheyHave) {
  // A wolf starts with 0, 1 … 2·13 − 1 of energy, loses 1 in a step, and dies below 0.
  std::uint64_t const steps = 10;
  std::vector<double> wolves;
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    World<Predation> world = start_of(Predation{.sheep = 0, .wolves = 200, .wolf_birth = 0.0}, walls, seed);
    ModelEngine<Predation>(Predation{.wolf_birth = 0.0}, walls, {}).advance(world, {.step = steps});
    wolves.push_back(static_cast<double>(world.agents.size()));
  }
  Estimate const m = mean_of(wolves);
  EXPECT_NEAR(m.value, 200.0 * (26.0 - static_cast<double>(steps)) / 26.0, 3.5 * m.error);
}

TEST(Predation, AFlockEatsWhatItWalksAndItsFoodGrowsByLittlesLaw) {
  // Little 1961, doi:10.1287/opre.9.3.383: as many cells are bare as meals in a step, times the steps of regrowth.
  Predation const model{.wolves = 0};
  World<Predation> world = start_of(model, Box(1.0, 1.0, Edge::periodic), 1);
  ModelEngine<Predation> engine(model, world.box, {});
  auto const energy = [&] {
    return AgentSums<Predation>(world).sum([](auto const& animal) { return animal.template get<Energy>(); });
  };
  double const at_first = energy();
  double walked = 0.0;
  double bare = 0.0;
  for (std::uint64_t step = 1; step <= 300; ++step) {
    walked += static_cast<double>(world.agents.size());
    engine.advance(world, {.step = step});
    auto const values = field_of<Bare>(world).values();
    bare += static_cast<double>(values.size() - static_cast<std::size_t>(std::ranges::count(values, 0.0)));
  }
  double const meals = static_cast<double>(world.events[0]);
  double const starved = static_cast<double>(world.events[4]);
  // Those that starve have less than 0 of energy, and at least −1.
  double const taken_along = energy() - at_first - model.sheep_gain * meals + walked;
  EXPECT_GT(starved, 100.0);
  EXPECT_GE(taken_along, 0.0);
  EXPECT_LE(taken_along, starved);
  // Eaten grass is bare at the end of regrowth − 1 steps; both ends of the run cut some of them off.
  double const regrowth = static_cast<double>(model.regrowth);
  EXPECT_NEAR(bare, (regrowth - 1.0) * meals, 625.0 * regrowth / 2.0);
}

TEST(Segregation, AgentsThatNothingSatisfiesStayMixed) {
  // All 49 others of the own group and 50 of the other one are as likely to be near.
  Segregation const model{.side = 12, .count = 100, .wanted = 9};
  std::vector<double> shares;
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    World<Segregation> world = start_of(model, walls, seed);
    ModelEngine<Segregation>(model, walls, {}).advance(world, {.step = 6});
    EXPECT_EQ(world.events[0], 600U);
    Observations seen;
    model.observe(world, seen);
    shares.push_back(seen.entries()[0].value);
  }
  Estimate const m = mean_of(shares);
  EXPECT_NEAR(m.value, 49.0 / 99.0, 3.5 * m.error);
}

TEST(Segregation, EachAgentHasACellAndTheFieldKnowsIt) {
  Segregation const model{.side = 20, .count = 120};
  Box const box(2.0, 1.0, Edge::wall);
  World<Segregation> world = start_of(model, box, 3);
  ModelEngine<Segregation>(model, box, {}).advance(world, {.step = 5});
  std::vector<double> homes(200);
  for (std::size_t row = 0; row < world.agents.size(); ++row) {
    Vector const p{world.agents.column<X>()[row], world.agents.column<Y>()[row]};
    homes[field_of<Homes>(world).cell_of(box, p)] = 1.0 + world.agents.column<Group>()[row];
  }
  EXPECT_TRUE(std::ranges::equal(homes, field_of<Homes>(world).values()));
  EXPECT_EQ(std::ranges::count(homes, 0.0), 80);
}

}  // namespace
}  // namespace gridlock
