// What a model does wrong ends its run in every build, with the agent, the step and the numbers.

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "gridlock/core/error.hpp"
#include "gridlock/model/model.hpp"

namespace gridlock {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double infinity = std::numeric_limits<double>::infinity();

/// Three agents; in step 2 the agent 1 does what the test says.
template <Schedule order>
struct ActsOnce {
  static constexpr std::string_view name = "scripted";
  static constexpr Schedule schedule = order;
  static constexpr std::array<std::string_view, 2> events{"first", "second"};
  using Agents = Population<X, Y>;
  using Act = std::function<void(Turn<ActsOnce>&)>;

  Act act;
  double declared = 0.1;
  std::vector<Vector> places{{0.2, 0.2}, {0.5, 0.5}, {0.55, 0.5}};

  double cutoff() const { return declared; }
  double time_step() const { return 1.0; }
  void start(World<ActsOnce>& world) const {
    for (Vector const p : places) world.agents.add(p.x, p.y);
  }
  void turn(Turn<ActsOnce>& self) const {
    if (self.clock().step == 2 && self.id() == 1) act(self);
  }
};

/// What the run of a model ends with; "no failure" where it goes on to its end.
template <class Model>
std::string failure_of(Model const& model, Box const& box) {
  World<Model> world{.box = box, .seed = 1};
  start_agents(model, world);
  try {
    ModelEngine<Model>(model, box, {}).advance(world, {.step = 4});
  } catch (RunFailure const& failure) {
    return failure.what();
  }
  return "no failure";
}

template <class Order>
class EveryScheduleOfTurns : public ::testing::Test {
 protected:
  using Model = ActsOnce<Order::value>;

  static std::string failure(typename Model::Act act, Edge edge = Edge::periodic) {
    return failure_of(Model{.act = std::move(act)}, Box(1.0, 1.0, edge));
  }
  static void expect_failure(typename Model::Act act, std::string const& text) {
    std::string const what = failure(std::move(act));
    EXPECT_EQ(what.rfind("step 2: agent 1 ", 0), 0U) << what;
    EXPECT_NE(what.find(text), std::string::npos) << what;
  }
};

using Schedules = ::testing::Types<std::integral_constant<Schedule, Schedule::synchronous>,
                                   std::integral_constant<Schedule, Schedule::sequential>,
                                   std::integral_constant<Schedule, Schedule::tiled>>;
TYPED_TEST_SUITE(EveryScheduleOfTurns, Schedules);

TYPED_TEST(EveryScheduleOfTurns, RefusesAMoveToAPointOutsideTheBox) {
  this->expect_failure([](auto& self) { self.move_to({7.0, 0.5}); }, "(7, 0.5), outside the box of 1 × 1");
  this->expect_failure([](auto& self) { self.move_to({0.5, -0.25}); }, "(0.5, -0.25)");
  this->expect_failure([](auto& self) { self.move_to({nan, 0.5}); }, "nan");
}

TYPED_TEST(EveryScheduleOfTurns, RefusesADisplacementAsLongAsTheBox) {
  this->expect_failure([](auto& self) { self.move_by({3.2, 0.0}); }, "moves by (3.2, 0) in a box of 1 × 1");
  this->expect_failure([](auto& self) { self.move_by({0.0, -1.0}); }, "moves by (0, -1)");
  this->expect_failure([](auto& self) { self.move_by({0.0, nan}); }, "nan");
  this->expect_failure([](auto& self) { self.move_by({-infinity, 0.0}); }, "inf");
}

TYPED_TEST(EveryScheduleOfTurns, RefusesASearchBeyondTheDeclaredCutoff) {
  auto const ignore = [](auto const&) {};
  this->expect_failure([&](auto& self) { self.for_each_neighbour(0.5, ignore); },
                       "searches within 0.5 of (0.5, 0.5), but the model declares a cutoff of 0.1");
  this->expect_failure([&](auto& self) { self.for_each_neighbour(-0.1, ignore); }, "searches within -0.1");
  this->expect_failure([&](auto& self) { self.for_each_neighbour(nan, ignore); }, "searches within nan");
  this->expect_failure([&](auto& self) { self.for_each_neighbour({nan, 0.5}, 0.1, ignore); }, "nan");
}

TYPED_TEST(EveryScheduleOfTurns, RefusesAnEventThatIsNotDeclared) {
  this->expect_failure([](auto& self) { self.count(7); },
                       "counts event 7, but the model declares 2 events: first, second");
}

TYPED_TEST(EveryScheduleOfTurns, RefusesABirthOutsideTheBox) {
  this->expect_failure([](auto& self) { self.give_birth(1.5, -0.5); }, "puts a newborn agent at (1.5, -0.5)");
}

TYPED_TEST(EveryScheduleOfTurns, RefusesAStartOutsideTheBox) {
  typename TestFixture::Model const model{.places = {{0.2, 0.2}, {0.5, nan}}};
  std::string const what = failure_of(model, Box(1.0, 1.0, Edge::wall));
  EXPECT_EQ(what.rfind("step 0: agent 1 is put at (0.5, nan)", 0), 0U) << what;
}

TEST(FindOutside, AgreesWithIsInsideOnEveryKindOfNumber) {
  Box const box(1.0, 2.0, Edge::wall);
  std::vector<double> const numbers{
      0.0,      -0.0,      0.5,     1.0, std::nextafter(1.0, 2.0), 2.0, std::nextafter(2.0, 3.0), -0.5, nan,
      infinity, -infinity, -5e-324, -nan};
  for (double const x : numbers) {
    for (double const y : numbers) {
      std::vector<double> const xs{0.5, x, 0.5};
      std::vector<double> const ys{0.5, y, 0.5};
      EXPECT_EQ(find_outside(box, xs, ys), is_inside(box, {x, y}) ? 3U : 1U) << x << ' ' << y;
    }
  }
}

TYPED_TEST(EveryScheduleOfTurns, AllowsWhatLiesJustWithinTheLimits) {
  std::size_t found = 0;
  for (Edge const edge : {Edge::wall, Edge::periodic}) {
    EXPECT_EQ(this->failure(
                  [&](auto& self) {
                    self.for_each_neighbour(0.1, [&](auto const&) { ++found; });
                    self.for_each_neighbour({0.53, 0.5}, 0.07, [&](auto const&) { ++found; });
                    self.count(1);
                    self.give_birth(1.0, 0.0);
                    self.move_by({0.999, -0.999});
                  },
                  edge),
              "no failure");
    // In tiles a local agent comes no farther than the next cells.
    bool const goes_anywhere = TypeParam::value != Schedule::tiled;
    EXPECT_EQ(this->failure(
                  [&](auto& self) {
                    self.move_to(goes_anywhere ? Vector{1.0, 0.0} : Vector{0.4, 0.5});
                  },
                  edge),
              "no failure");
  }
  EXPECT_EQ(found, 4U);
}

TEST(SynchronousModel, RefusesASearchAroundAPointFromWhichItSeesNotAll) {
  using Model = ActsOnce<Schedule::synchronous>;
  Model const model{.act = [](Turn<Model>& self) { self.for_each_neighbour({0.54, 0.5}, 0.07, [](auto const&) {}); }};
  std::string const what = failure_of(model, Box(1.0, 1.0, Edge::periodic));
  EXPECT_NE(what.find("searches within 0.07 of (0.54, 0.5) from (0.5, 0.5)"), std::string::npos) << what;
}

/// A model without events.
struct Silent {
  static constexpr std::string_view name = "silent";
  static constexpr Schedule schedule = Schedule::synchronous;
  using Agents = Population<X, Y>;
  double cutoff() const { return 0.1; }
  double time_step() const { return 1.0; }
  void start(World<Silent>& world) const { world.agents.add(0.5, 0.5); }
  void turn(Turn<Silent>& self) const { self.count(7); }
};

TEST(ModelWithoutEvents, CountingOneEndsTheRun) {
  std::string const what = failure_of(Silent{}, Box(1.0, 1.0, Edge::wall));
  EXPECT_EQ(what.rfind("step 0: agent 0 counts event 7, but the model declares no events", 0), 0U) << what;
}

/// A model whose time step is what the test says.
struct Stepping {
  static constexpr std::string_view name = "stepping";
  static constexpr Schedule schedule = Schedule::sequential;
  using Agents = Population<X, Y>;
  double step = 1.0;
  double cutoff() const { return 0.1; }
  double time_step() const { return step; }
  void start(World<Stepping>& world) const { world.agents.add(0.5, 0.5); }
  void turn(Turn<Stepping>&) const {}
};

TEST(ModelEngine, RefusesATimeStepThatIsNoPositiveNumber) {
  for (double const step : {nan, 0.0, -1.0, infinity}) {
    EXPECT_NE(failure_of(Stepping{.step = step}, Box(1.0, 1.0, Edge::wall)).find("time step of"), std::string::npos)
        << step;
  }
}

/// A model of events that does what the test says.
struct Open {
  static constexpr std::string_view name = "open";
  static constexpr Schedule schedule = Schedule::events;
  static constexpr std::array<std::string_view, 1> events{"only"};
  using Agents = Population<X, Y>;
  std::function<void(MutableWorld<Open>&)> act;
  double cutoff() const { return 0.1; }
  double time_step() const { return 1.0; }
  void start(World<Open>& world) const { world.agents.add(0.5, 0.5); }
  void step(MutableWorld<Open>& world) const { act(world); }
};

std::string failure_of_events(std::function<void(MutableWorld<Open>&)> act) {
  return failure_of(Open{.act = std::move(act)}, Box(1.0, 1.0, Edge::periodic));
}

TEST(MutableWorld, RefusesBirthsAndMovesOutsideTheBox) {
  EXPECT_NE(failure_of_events([](auto& world) { world.add(1.5, 0.5); }).find("newborn agent at (1.5, 0.5)"),
            std::string::npos);
  EXPECT_NE(failure_of_events([](auto& world) {
              world.move_to(0, {0.5, nan});
            }).find("agent 0 is put at (0.5, nan)"),
            std::string::npos);
}

TEST(MutableWorld, RefusesSearchesBeyondTheDeclaredCutoff) {
  EXPECT_NE(failure_of_events([](auto& world) {
              static_cast<void>(world.nearest({0.5, 0.5}, 0.2));
            }).find("searches within 0.2 of (0.5, 0.5), but the model declares a cutoff of 0.1"),
            std::string::npos);
  EXPECT_NE(failure_of_events([](auto& world) {
              world.for_each_neighbour({nan, 0.5}, 0.1, [](Id) {});
            }).find("nan"),
            std::string::npos);
}

TEST(MutableWorld, RefusesEventsThatAreNotDeclared) {
  EXPECT_NE(failure_of_events([](auto& world) { world.count(1); }).find("declares 1 events: only"), std::string::npos);
}

TEST(MutableWorld, RefusesAgentsThatAreNotAlive) {
  for (auto const& act : std::vector<std::function<void(MutableWorld<Open>&)>>{
           [](auto& world) { world.remove(5); },
           [](auto& world) {
             world.move_to(5, {0.5, 0.5});
           },
           [](auto& world) { static_cast<void>(world.position(5)); }}) {
    EXPECT_NE(failure_of_events(act).find("step 0: there is no agent 5"), std::string::npos);
  }
}

}  // namespace
}  // namespace gridlock
