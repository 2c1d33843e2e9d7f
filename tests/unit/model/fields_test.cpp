// What agents of models in C++ do with fields, counted by hand, and what a run keeps of them.

#include "gridlock/model/fields.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>
#include <numeric>
#include <set>
#include <string>
#include <vector>

#include "gridlock/core/error.hpp"
#include "gridlock/io/h5md.hpp"
#include "gridlock/io/settings_file.hpp"
#include "gridlock/model/model.hpp"
#include "gridlock/simulation/configuration.hpp"
#include "gridlock/workspace/run_directory.hpp"
#include "gridlock/workspace/verify.hpp"
#include "herd.hpp"
#include "model_on_ranks.hpp"
#include "simulation/check.hpp"

namespace gridlock {
namespace {

using test::Grass;
using test::Herd;
using test::Scent;
using test::Stomach;

/// Agents that do to a field of 4 × 2 cells what the test says in their turn.
template <Schedule order>
struct Grazing {
  static constexpr std::string_view name = "grazing";
  static constexpr Schedule schedule = order;
  using Agents = Population<X, Y, Stomach>;
  using Fields = FieldSet<Scent, Grass>;

  std::function<void(Turn<Grazing>&)> script;
  double first_value = 1.0;

  [[nodiscard]] std::size_t columns(Scent) const { return 1; }
  [[nodiscard]] std::size_t columns(Grass) const { return 4; }
  [[nodiscard]] double cutoff() const { return 0.1; }
  [[nodiscard]] double time_step() const { return 0.5; }
  [[nodiscard]] std::uint64_t agents_at_start() const { return 3; }
  typename Agents::Values first_agent(World<Grazing> const& world, std::uint64_t number) const {
    return {number < 2 ? 0.25 : 1.75, 0.25, 10.0 * field_of<Grass>(world).values()[0]};
  }
  void start_fields(World<Grazing>& world) const { std::ranges::fill(field_of<Grass>(world).values(), first_value); }
  void turn(Turn<Grazing>& self) const { script(self); }
};

Box small_box() { return {2.0, 1.0, Edge::periodic, Edge::wall}; }

template <class Model>
World<Model> after_one_step(Model const& model, std::uint64_t threads = 1) {
  World<Model> world{.box = small_box(), .seed = 3};
  start_agents(model, world);
  ModelEngine<Model>(model, world.box, {.threads = threads}).advance(world, {.step = 1});
  return world;
}

template <class Model>
double stomach_of(World<Model> const& world, Id id) {
  return world.agents.template column<Stomach>()[world.agents.index_of(id)];
}

std::vector<double> values_in(Field const& field) { return {field.values().begin(), field.values().end()}; }

TEST(ModelFields, LieInTheOrderOfTheirNamesWithRowsOfSquaresAndAreFilledBeforeTheFirstAgents) {
  using Model = Grazing<Schedule::synchronous>;
  World<Model> world{.box = small_box()};
  start_agents(Model{.script = {}, .first_value = 0.5}, world);
  ASSERT_EQ(world.fields.size(), 2U);
  EXPECT_EQ(&field_of<Grass>(world), &world.fields[0]);
  EXPECT_EQ(world.fields[0].name(), "grass");
  EXPECT_EQ(world.fields[0].rows(), 2U);
  EXPECT_EQ(world.fields[1].rows(), 1U);
  EXPECT_EQ(stomach_of(world, 0), 5.0);
}

template <Schedule order>
void expect_fields_to_change_after_the_turns() {
  using Model = Grazing<order>;
  std::vector<double> seen(3);
  Model const model{.script = [&](Turn<Model>& self) {
    self.template deposit<Grass>(0.5);
    self.template deposit<Grass>({-0.25, 0.75}, 2.0);  // the last column of the upper row, around the edge
    self.template take<Grass, Stomach>(0.25);
    seen[self.id()] = self.template at<Grass>();
  }};
  World<Model> const world = after_one_step(model);
  EXPECT_EQ(seen, (std::vector<double>{1.0, 1.0, 1.0}));
  EXPECT_EQ(values_in(world.fields[0]), (std::vector<double>{1.5, 1.0, 1.0, 1.25, 1.0, 1.0, 1.0, 7.0}));
  for (Id const id : {0, 1, 2}) EXPECT_EQ(stomach_of(world, id), 10.25);
}

TEST(ModelFields, ChangeAfterTheTurnsOfASynchronousOrTiledModel) {
  expect_fields_to_change_after_the_turns<Schedule::synchronous>();
  expect_fields_to_change_after_the_turns<Schedule::tiled>();
}

TEST(ModelFields, ChangeAtOnceInASequentialModel) {
  using Model = Grazing<Schedule::sequential>;
  std::vector<double> got(3);
  Model const model{.script = [&](Turn<Model>& self) {
    got[self.id()] = self.take<Grass>(0.75);
    self.deposit<Scent>(self.at<Grass>());
  }};
  World<Model> const world = after_one_step(model);
  EXPECT_EQ(got, (std::vector<double>{0.75, 0.25, 0.75}));
  EXPECT_EQ(world.fields[1].values()[0], 0.25 + 0.0 + 0.25);
}

TEST(ModelFields, GiveNoMoreThanThereIsAndDrawAnewInEachStepWhoIsFirst) {
  using Model = Grazing<Schedule::synchronous>;
  Model const model{.script = [](Turn<Model>& self) { self.take<Grass, Stomach>(0.75); }};
  World<Model> world{.box = small_box(), .seed = 3};
  start_agents(model, world);
  ModelEngine<Model> engine(model, world.box, {});
  int firsts = 0;
  for (std::uint64_t step = 1; step <= 200; ++step) {
    std::ranges::fill(world.agents.column<Stomach>(), 0.0);
    std::ranges::fill(world.fields[0].values(), 1.0);
    engine.advance(world, {.step = step});
    EXPECT_EQ(world.fields[0].values()[0], 0.0);
    EXPECT_EQ(stomach_of(world, 0) + stomach_of(world, 1), 1.0);
    EXPECT_EQ(stomach_of(world, 2), 0.75);
    firsts += stomach_of(world, 0) == 0.75 ? 1 : 0;
  }
  EXPECT_NEAR(firsts, 100, 40) << "5.6 standard deviations";
}

TEST(ModelFields, SumDepositsExactlyInAnyOrder) {
  using Model = Grazing<Schedule::synchronous>;
  std::vector<double> amounts{1e17, 1.0, -1e17};
  std::ranges::sort(amounts);
  do {
    Model const model{.script =
                          [&](Turn<Model>& self) {
                            self.deposit<Grass>({0.25, 0.25}, amounts[self.id()]);
                          },
                      .first_value = 0.5};
    EXPECT_EQ(after_one_step(model).fields[0].values()[0], 1.5);
  } while (std::ranges::next_permutation(amounts).found);
}

template <class Act>
std::string refusal_by(Act act) {
  try {
    act();
  } catch (RunFailure const& failure) {
    return failure.what();
  } catch (Error const& error) {
    return error.what();
  }
  return "nothing";
}

template <Schedule order>
void expect_words(std::string const& words, std::function<void(Turn<Grazing<order>>&)> script) {
  std::string const failure = refusal_by([&] { after_one_step(Grazing<order>{.script = std::move(script)}); });
  EXPECT_NE(failure.find(words), std::string::npos) << failure;
}

TEST(ModelFields, RefuseWhatAMistakenModelAsksOfThem) {
  using InTurn = Turn<Grazing<Schedule::synchronous>>;
  expect_words<Schedule::synchronous>("outside the box of 2 × 1", [](InTurn& self) {
    self.deposit<Grass>({0.5, 1.5}, 1.0);
  });
  expect_words<Schedule::synchronous>("outside the box of 2 × 1", [](InTurn& self) {
    self.deposit<Grass>({std::nan(""), 0.5}, self.at<Grass>());
  });
  expect_words<Schedule::synchronous>("agent 0 is to take -1 from the field grass",
                                      [](InTurn& self) { self.take<Grass, Stomach>(-1.0); });
  expect_words<Schedule::synchronous>("the field grass has the value inf in row 0, column 0",
                                      [](InTurn& self) { self.deposit<Grass>(1e308); });
  expect_words<Schedule::sequential>("the field grass has the value nan in row 0, column 0",
                                     [](auto& self) { self.template deposit<Grass>(std::nan("")); });
  World<Grazing<Schedule::synchronous>> const without{.box = small_box()};
  EXPECT_NE(refusal_by([&] { require_fields(Grazing<Schedule::synchronous>{}, without); }).find("other fields"),
            std::string::npos);
}

template <Schedule order>
void expect_world_as_before_an_overflow() {
  using Model = Grazing<order>;
  Model const model{.script = [](Turn<Model>& self) {
    self.template deposit<Grass>(self.id() == 1 ? 1e308 : 9e307);
    self.move_by({0.1, 0.0});
  }};
  World<Model> world{.box = small_box(), .seed = 3};
  start_agents(model, world);
  std::uint64_t const before = hash(world);
  ModelEngine<Model> engine(model, world.box, {.threads = 2});
  EXPECT_THROW(engine.advance(world, {.step = 1}), RunFailure);
  EXPECT_EQ(hash(world), before);
}

TEST(ModelFields, LeaveTheWorldAsItWasBeforeAnOverflow) {
  expect_world_as_before_an_overflow<Schedule::synchronous>();
  expect_world_as_before_an_overflow<Schedule::tiled>();
}

template <Schedule order>
std::uint64_t herd_after(std::uint64_t steps, std::uint64_t threads, std::uint64_t chunk) {
  World<Herd<order>> world{.box = Box(2.0, 1.0, Edge::periodic), .seed = 5};
  start_agents(Herd<order>{}, world);
  ModelEngine<Herd<order>> engine({}, world.box, {.threads = threads, .verify_every = 9});
  for (std::uint64_t step = chunk; step <= steps; step += chunk) engine.advance(world, {.step = step});
  EXPECT_GT(world.agents.size(), 100U);
  EXPECT_LT(world.agents.size(), 1000U);
  return hash(world);
}

template <Schedule order>
void expect_same_bits() {
  std::uint64_t const expected = herd_after<order>(60, 1, 60);
  for (std::uint64_t const threads : {2, 3, 8}) EXPECT_EQ(herd_after<order>(60, threads, 60), expected) << threads;
  EXPECT_EQ(herd_after<order>(60, 2, 1), expected) << "chunks of one step";
}

TEST(ModelFields, HaveTheSameBitsOnAnyThreadsAndInAnyChunks) {
  expect_same_bits<Schedule::synchronous>();
  expect_same_bits<Schedule::tiled>();
  expect_same_bits<Schedule::sequential>();
}

/// A model of events that moves heat with its only agent.
struct Carrier {
  static constexpr std::string_view name = "carrier";
  static constexpr Schedule schedule = Schedule::events;
  using Agents = Population<X, Y>;
  using Fields = FieldSet<Grass>;
  [[nodiscard]] std::size_t columns(Grass) const { return 2; }
  [[nodiscard]] double cutoff() const { return 0.1; }
  [[nodiscard]] double time_step() const { return 1.0; }
  void start(World<Carrier>& world) const { field_of<Grass>(world).values()[0] = 3.0; }
  void step(MutableWorld<Carrier>& world) const {
    double const taken = world.take<Grass>({0.5, 0.5}, 2.0);
    world.deposit<Grass>({1.5, 0.5}, taken + world.at<Grass>({-0.5, 0.5}));
  }
};

TEST(ModelFields, ChangeAtOnceInAModelOfEvents) {
  World<Carrier> world{.box = Box(2.0, 1.0, Edge::periodic)};
  start_agents(Carrier{}, world);
  ModelEngine<Carrier> engine({}, world.box, {});
  engine.advance(world, {.step = 1});
  EXPECT_EQ(values_in(world.fields[0]), (std::vector<double>{1.0, 2.0}));
  engine.advance(world, {.step = 2});
  EXPECT_EQ(values_in(world.fields[0]), (std::vector<double>{0.0, 5.0}));
}

class FieldsOfRun : public testing::Test {
 protected:
  using Kept = Herd<Schedule::synchronous>;
  ~FieldsOfRun() override { std::filesystem::remove_all(directory_); }

  static Configuration configuration(std::uint64_t threads, std::string const& cells = "20") {
    SettingsFile file;
    for (char const* setting :
         {"model.kind=test_herd", "box.edge=periodic", "run.steps=40", "observe.every=5", "trajectory.every=20"}) {
      file.set(setting);
    }
    file.set("engine.threads=" + std::to_string(threads));
    file.set("test_herd.cells=" + cells);
    return read_configuration(file);
  }

  test::KnownModel<Kept> known_;
  std::filesystem::path directory_ =
      std::filesystem::temp_directory_path() / ("gridlock-fields-" + std::to_string(getpid()));
};

TEST_F(FieldsOfRun, AreInFramesAndTheLastFileAndGoOnWithTheSameBitsAfterAnInterruption) {
  RunRecord const whole = run_in(directory_ / "whole", set_up(configuration(1)));
  ASSERT_EQ(whole.status, RunStatus::finished) << whole.failure;
  OnProgress const stops_early = [done = 0](Progress const&) mutable { return ++done < 3; };
  RunRecord parts = run_in(directory_ / "parts", set_up(configuration(2)), {.on_progress = stops_early});
  ASSERT_EQ(parts.status, RunStatus::interrupted);
  parts = resume_in(directory_ / "parts");
  EXPECT_EQ(parts.status, RunStatus::finished) << parts.failure;
  EXPECT_EQ(parts.state_hash, whole.state_hash);
  H5mdReader const one(directory_ / "whole" / "trajectory.h5");
  H5mdReader const other(directory_ / "parts" / "trajectory.h5");
  ASSERT_EQ(one.frame_count(), 3U);
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_EQ(one.frame(k).frame.fields.size(), 2U);
    EXPECT_EQ(one.frame(k).frame.fields, other.frame(k).frame.fields);
  }
  EXPECT_TRUE(std::filesystem::exists(directory_ / "whole" / "final_fields.h5"));
  Verification const found = verify_run(directory_ / "whole");
  EXPECT_EQ(found.difference, "");
  EXPECT_EQ(found.frames, 3U);
}

TEST_F(FieldsOfRun, AreNotSharedByRanksAndNotLargerThanMemory) {
  std::string const refusal = refusal_by([&] { require_shareable(configuration(1), 2); });
  EXPECT_NE(refusal.find("the model \"test_herd\", whose fields no process has in part, cannot be shared by 2 ranks"),
            std::string::npos)
      << refusal;
  std::string const too_large = refusal_by([&] { static_cast<void>(set_up(configuration(1, "30000000"))); });
  EXPECT_NE(too_large.find("the field grass of 30000000 × 30000000 cells"), std::string::npos) << too_large;
}

}  // namespace
}  // namespace gridlock
