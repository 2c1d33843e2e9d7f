// Agents that sleep, Model::is_awake(), take no turns.

#include <gtest/gtest.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "gridlock/model/model.hpp"

namespace gridlock {
namespace {

struct Fire {
  using type = std::uint32_t;
  static constexpr char const* name = "fire";
};

/// Trees that burn for three steps when a neighbour burns, and stand still or sway.
struct Forest {
  static constexpr std::string_view name = "forest";
  static constexpr Schedule schedule = Schedule::synchronous;
  static constexpr std::array<std::string_view, 1> events{"turns"};
  static constexpr std::uint32_t burnt = 4;
  using Agents = Population<X, Y, Fire>;

  double sway = 0.0;

  [[nodiscard]] double cutoff() const { return 1.5; }
  [[nodiscard]] double time_step() const { return 1.0; }
  [[nodiscard]] std::uint64_t agents_at_start() const { return 400; }
  template <class Model>
  [[nodiscard]] static typename Agents::Values tree(World<Model> const& world, std::uint64_t number) {
    RandomStream random = world.start_random(number);
    Vector const p = world.anywhere(random);
    return {p.x, p.y, number < 4 ? 1U : 0U};
  }
  template <class Model>
  void burn(Turn<Model>& self) const {
    self.count(0);
    std::uint32_t const fire = self.template get<Fire>();
    bool is_near = false;
    self.for_each_neighbour(1.0, [&](Neighbour<Model> const& other) {
      auto const of_other = other.template get<Fire>();
      is_near = is_near || (of_other > 0 && of_other < burnt);
    });
    if (fire > 0 || is_near) self.template set<Fire>(fire + 1);
    self.move_by({sway, 0.0});
  }
};

/// The burnt do not move.
struct Sleepers : Forest {
  Agents::Values first_agent(World<Sleepers> const& world, std::uint64_t number) const { return tree(world, number); }
  [[nodiscard]] bool is_awake(World<Sleepers> const& world, std::size_t row) const {
    return world.agents.column<Fire>()[row] < burnt;
  }
  void turn(Turn<Sleepers>& self) const { burn(self); }
};
struct Idlers : Forest {
  Agents::Values first_agent(World<Idlers> const& world, std::uint64_t number) const { return tree(world, number); }
  void turn(Turn<Idlers>& self) const {
    if (self.get<Fire>() < burnt) burn(self);
  }
};

static_assert(can_be_divided<Idlers>() && !can_be_divided<Sleepers>());

template <class Model>
World<Model> burnt_forest(double sway, std::uint64_t threads) {
  Model model;
  model.sway = sway;
  World<Model> world{.box = Box(20.0, 20.0, Edge::periodic), .seed = 4};
  start_agents(model, world);
  ModelEngine<Model>(model, world.box, {.threads = threads, .verify_every = 3}).advance(world, {.step = 20});
  return world;
}

TEST(Sleepers, TakeNoTurnsSoThatTheBitsAreThoseOfTurnsThatDoNothing) {
  for (double const sway : {0.0, 0.4}) {
    World<Idlers> const expected = burnt_forest<Idlers>(sway, 1);
    EXPECT_GT(expected.events[0], 400U);
    EXPECT_LT(expected.events[0], 7600U);
    for (std::uint64_t const threads : {1, 2, 3, 8}) {
      World<Sleepers> const world = burnt_forest<Sleepers>(sway, threads);
      EXPECT_EQ(hash(world), hash(expected)) << threads;
      EXPECT_EQ(world.events, expected.events) << threads;
    }
  }
}

}  // namespace
}  // namespace gridlock
