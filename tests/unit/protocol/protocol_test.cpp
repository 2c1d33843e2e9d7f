#include "gridlock/protocol/protocol.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "gridlock/core/error.hpp"
#include "gridlock/grid/validate.hpp"
#include "io/checkpoint.hpp"
#include "protocol/stage.hpp"
#include "unit/protocol/fluid.hpp"

namespace gridlock {
namespace {

/// Every kind of stage, each short.
ProtocolSettings all_stages(std::uint64_t threads = 1) {
  return {.stages = {{.kind = "grow", .rate = 0.05, .until_packing_fraction = 0.7},
                     {.kind = "run", .collisions_per_disk = 200.0},
                     {.kind = "swap", .sweeps = 200},
                     {.kind = "quench", .packing_fraction = 0.9},
                     {.kind = "decompress", .until_pressure = 1e-4},
                     {.kind = "compress", .until_pressure = 1e-3},
                     {.kind = "separate"},
                     {.kind = "run", .until_time = 0.01}},
          .threads = threads};
}

std::uint64_t hash_after(ProtocolSettings const& settings, State state) {
  Protocol protocol(settings, state);
  EXPECT_TRUE(protocol.advance(state));
  return hash(state);
}

class ProtocolOf : public testing::TestWithParam<Edge> {};
INSTANTIATE_TEST_SUITE_P(Edges, ProtocolOf, testing::Values(Edge::periodic, Edge::wall),
                         [](auto const& edge) { return edge.param == Edge::wall ? "wall" : "periodic"; });

TEST_P(ProtocolOf, CarriesOutItsStagesInOrder) {
  State state = fluid(GetParam());
  Protocol protocol(all_stages(), state);
  EXPECT_EQ(protocol.name_of_stage(), "grow");
  ASSERT_TRUE(protocol.advance(state));
  EXPECT_EQ(protocol.name_of_stage(), "");
  std::vector<StageResult> const& results = protocol.results();
  ASSERT_EQ(results.size(), 8U);
  EXPECT_NEAR(results[0].packing_fraction, 0.7, 1e-12);
  EXPECT_GT(*results[1].pressure, 5.0);  // a dense fluid
  EXPECT_TRUE(results[2].swap.has_value());
  EXPECT_NEAR(results[3].packing_fraction, 0.9, 1e-12);
  EXPECT_NEAR(*results[4].pressure, 1e-4, 0.1e-4);
  EXPECT_NEAR(*results[5].pressure, 1e-3, 0.1e-3);
  EXPECT_TRUE(*results[5].is_converged);
  EXPECT_LT(results[6].packing_fraction, results[5].packing_fraction);
  EXPECT_GT(state.clock.time, 0.01);
  std::uint64_t work = 0;
  for (StageResult const& result : results) work += result.work;
  EXPECT_EQ(protocol.work(), work) << "of all stages";
  // What is left is one of hard disks.
  EXPECT_NO_THROW(validate(state));
}

TEST_P(ProtocolOf, HasTheSameBitsWhenItIsKilledAnywhereAndRestored) {
  ProtocolSettings const settings = all_stages();
  State const start = fluid(GetParam());
  std::uint64_t const expected = hash_after(settings, start);
  State state = start;
  Protocol protocol(settings, state);
  std::vector<std::size_t> tries(settings.stages.size() + 1, 0);
  std::size_t restored_in_stages = 0;
  for (bool is_done = false; !is_done;) {
    is_done = protocol.advance(state, [] { return false; });
    if (++tries[protocol.stage()] != 3 && tries[protocol.stage()] != 40) continue;
    std::string const saved = to_checkpoint([&](Archive& archive) {
      serialize(archive, state);
      protocol.serialize(archive, state);
    });
    // From another start, all of which is restored.
    State other = fluid(GetParam());
    other.agents.column<X>()[0] += 1e-3;
    Protocol resumed(settings, other);
    from_checkpoint(saved, "saved", [&](Archive& archive) {
      serialize(archive, other);
      resumed.serialize(archive, other);
    });
    ASSERT_EQ(resumed.stage(), protocol.stage());
    ASSERT_TRUE(resumed.advance(other));
    ASSERT_EQ(hash(other), expected) << "from stage " << protocol.stage() << ", piece " << tries[protocol.stage()];
    ASSERT_EQ(resumed.results().size(), settings.stages.size());
    ++restored_in_stages;
  }
  EXPECT_EQ(hash(state), expected);
  EXPECT_GE(restored_in_stages, 5U);
}

TEST(Protocol, HasTheSameBitsForAnyNumberOfThreads) {
  std::uint64_t const expected = hash_after(all_stages(1), fluid());
  for (std::uint64_t const threads : {2U, 3U, 8U}) EXPECT_EQ(hash_after(all_stages(threads), fluid()), expected);
}

/// The key and the text of every problem that the stages have.
std::vector<Problem> problems_of(std::vector<StageSettings> const& stages, std::optional<double> start = {}) {
  try {
    require_valid(stages, start);
  } catch (Error const& error) {
    return error.problems();
  }
  return {};
}

TEST(Protocol, CountsTheEdgesThatDisksCrossWhileTheyAreQuenched) {
  State state = fluid();
  auto const unwrapped = [&](std::size_t i) {
    Disks const& disks = state.agents;
    return Vector{disks.column<X>()[i] + state.box.width() * static_cast<double>(disks.column<ImageX>()[i]),
                  disks.column<Y>()[i] + state.box.height() * static_cast<double>(disks.column<ImageY>()[i])};
  };
  std::vector<Vector> before;
  // Images of their own, unequal along x and y, and a start from which many cross an edge.
  for (std::size_t i = 0; i < state.agents.size(); ++i) {
    state.agents.column<ImageX>()[i] = 2;
    state.agents.column<ImageY>()[i] = -3;
    before.push_back(unwrapped(i));
  }
  ProtocolSettings const settings{.stages = {{.kind = "quench", .packing_fraction = 0.95}}};
  Protocol protocol(settings, state);
  protocol.advance(state);
  int crossed_x = 0;
  int crossed_y = 0;
  for (std::size_t i = 0; i < state.agents.size(); ++i) {
    EXPECT_LT(std::sqrt(squared_length(unwrapped(i) - before[i])), 0.3) << "unwrapped, a disk moves by a few radii";
    EXPECT_TRUE(state.agents.column<X>()[i] >= 0.0 && state.agents.column<X>()[i] < state.box.width());
    EXPECT_TRUE(state.agents.column<Y>()[i] >= 0.0 && state.agents.column<Y>()[i] < state.box.height());
    crossed_x += state.agents.column<ImageX>()[i] == 2 ? 0 : 1;
    crossed_y += state.agents.column<ImageY>()[i] == -3 ? 0 : 1;
  }
  EXPECT_GT(crossed_x, 0);
  EXPECT_GT(crossed_y, 0);
}

TEST(Protocol, MeasuresThePressureOfARunOverItsOwnTime) {
  ProtocolSettings const settings{
      .stages = {{.kind = "run", .collisions_per_disk = 100.0}, {.kind = "run", .collisions_per_disk = 300.0}}};
  auto const pressures = [&](double clock) {
    State state = fluid();
    state.clock.time = clock;
    Protocol protocol(settings, state);
    EXPECT_TRUE(protocol.advance(state));
    return std::pair(*protocol.results()[0].pressure, *protocol.results()[1].pressure);
  };
  // At φ = .4 the reduced pressure is about 2.5, whatever has passed before.
  auto const [first, second] = pressures(0.0);
  EXPECT_NEAR(first, second, 0.25 * first);
  auto const [first_later, second_later] = pressures(64.0);
  EXPECT_NEAR(first_later, first, 1e-6 * first);
  EXPECT_NEAR(second_later, second, 0.25 * second);
}

TEST(Protocol, RefusesToDecompressDisksThatDoNotPress) {
  State state = fluid();
  for (StageSettings const& down : {StageSettings{.kind = "decompress", .until_pressure = 1e-4},
                                    StageSettings{.kind = "decompress", .until_packing_fraction = 0.3}}) {
    try {
      Protocol const protocol({.stages = {down}}, state);
      ADD_FAILURE() << "nothing presses";
    } catch (Error const& error) {
      EXPECT_EQ(error.problems().front().key, "protocol[0].stage");
      EXPECT_NE(error.problems().front().what.find("no two disks press on each other"), std::string::npos);
    }
    // A stage takes what the one before leaves: of many starts some do not jam.
    EXPECT_NO_THROW(Protocol({.stages = {{.kind = "quench"}, down}}, state));
  }
  for (double& radius : state.agents.column<Radius>()) radius *= 1.6;
  EXPECT_NO_THROW(Protocol({.stages = {{.kind = "decompress", .until_pressure = 1e-4}}}, state));
}

TEST(Protocol, RefusesSoftDisksInAChannelBeforeItBegins) {
  State state = make_start(Box(1.3, 0.9, Edge::periodic, Edge::wall), {.count = 30, .packing_fraction = 0.3}, 1);
  try {
    Protocol const protocol({.stages = {{.kind = "swap", .sweeps = 2}, {.kind = "quench"}}}, state);
    ADD_FAILURE() << "a quench in a channel was accepted";
  } catch (Error const& error) {
    EXPECT_EQ(error.problems().at(0).key, "box");
    EXPECT_NE(error.problems().at(0).what.find("x-periodic, y-walled"), std::string::npos);
  }
}

TEST(Protocol, RefusesMoreLevelsThanAnybodyKeepsWhereTheyAreKnown) {
  StageSettings const quench{.kind = "quench", .packing_fraction = 0.9};
  StageSettings const down{.kind = "decompress", .until_packing_fraction = 0.7, .step = 1e-7};
  std::vector<Problem> const problems = problems_of({quench, down});
  ASSERT_EQ(problems.size(), 1U);
  EXPECT_EQ(problems.front().key, "protocol[1].step");
  EXPECT_NE(problems.front().what.find("2e+06 levels"), std::string::npos) << problems.front().what;
  EXPECT_EQ(problems_of({down}, 0.9).size(), 1U);
  EXPECT_TRUE(problems_of({down}, 0.75).empty());
}

TEST(Protocol, RefusesStagesThatContradictThemselves) {
  struct Case {
    std::vector<StageSettings> stages;
    std::string key;
    std::string what;
  };
  std::vector<Case> const cases{
      {{{.kind = "grow"}}, "protocol[0]", "does not say when it ends"},
      {{{.kind = "run"}}, "protocol[0]", "does not say when it ends"},
      {{{.kind = "decompress"}}, "protocol[0]", "does not say when it ends"},
      {{{.kind = "quench", .rate = 1e-3}}, "protocol[0].rate", "has no setting rate"},
      {{{.kind = "separate", .until_time = 1.0}}, "protocol[0].until_time", "has no setting until_time"},
      {{{.kind = "compress", .until_packing_fraction = 0.9, .until_pressure = 1e-3}},
       "protocol[0].until_packing_fraction",
       "at a pressure and at a packing fraction"},
      {{{.kind = "quench"}, {.kind = "run", .until_time = 1.0}}, "protocol[1]", "leaves overlaps"},
      {{{.kind = "compress", .until_pressure = 1.0}}, "protocol[0].until_pressure", "at a pressure of 1"},
      {{{.kind = "grow", .until_pressure = 1.0}}, "protocol[0].until_pressure", "at a pressure of 1"},
      {{{.kind = "run", .until_time = 1.0}, {.kind = "quench"}, {.kind = "run", .until_time = 1.0}},
       "protocol[2]",
       "leaves overlaps"},
  };
  for (Case const& one : cases) {
    std::vector<Problem> const problems = problems_of(one.stages);
    ASSERT_EQ(problems.size(), 1U) << one.what;
    EXPECT_EQ(problems.front().key, one.key);
    EXPECT_NE(problems.front().what.find(one.what), std::string::npos) << problems.front().what;
    EXPECT_FALSE(problems.front().hint.empty());
  }
  EXPECT_TRUE(problems_of(all_stages().stages).empty());
}

TEST(Protocol, RefusesAnEndOnTheOtherSideWhereTheStartOfTheStageIsKnown) {
  StageSettings const quench{.kind = "quench", .packing_fraction = 0.9};
  StageSettings const down{.kind = "decompress", .until_packing_fraction = 0.95};
  StageSettings const up{.kind = "compress", .until_packing_fraction = 0.85};
  StageSettings const grow{.kind = "grow", .until_packing_fraction = 0.4};
  StageSettings const to_pressure{.kind = "compress", .until_pressure = 1e-3};
  for (StageSettings const& wrong : {down, up}) {
    std::vector<Problem> const problems = problems_of({quench, wrong});
    ASSERT_EQ(problems.size(), 1U);
    EXPECT_EQ(problems.front().key, "protocol[1].until_packing_fraction");
  }
  EXPECT_EQ(problems_of({{.kind = "run", .until_time = 1.0}, grow}, 0.5).size(), 1U);
  EXPECT_TRUE(problems_of({{.kind = "run", .until_time = 1.0}, grow}).empty()) << "the start is not known";
  StageSettings const below{.kind = "grow", .until_packing_fraction = 0.3};
  EXPECT_THROW(Protocol({.stages = {{.kind = "run", .until_time = 1.0}, below}}, fluid()), Error);
  EXPECT_TRUE(problems_of({quench, to_pressure, down}).empty()) << "the disks decide where a pressure is reached";
  StageSettings const separate{.kind = "separate"};
  StageSettings const grow_to{.kind = "grow", .until_packing_fraction = 0.8};
  EXPECT_TRUE(problems_of({quench, separate, grow_to}).empty()) << "the disks decide how far they shrink";
  StageSettings const same{.kind = "decompress", .until_packing_fraction = 0.9};
  EXPECT_TRUE(problems_of({quench, same}).empty());
}

/// The settings that are described, by key.
class Bounds final : public SettingVisitor {
 public:
  std::map<std::string, SettingInfo, std::less<>> infos;
  void enter(std::string_view, std::string_view) override {}
  void leave() override {}
  void visit(SettingInfo const& info, double&) override { note(info); }
  void visit(SettingInfo const& info, std::optional<double>&) override { note(info); }
  void visit(SettingInfo const& info, std::uint64_t&) override { note(info); }
  void visit(SettingInfo const& info, std::optional<std::uint64_t>&) override { note(info); }
  void visit(SettingInfo const& info, bool&) override { note(info); }
  void visit(SettingInfo const& info, std::string&) override { note(info); }
  void visit(SettingInfo const& info, std::vector<double>&) override { note(info); }
  void visit_choice(SettingInfo const& info, std::span<std::string_view const>, std::size_t&) override { note(info); }
  void visit_tables(SettingInfo const& info, std::size_t, std::function<void(std::size_t)> const&,
                    std::function<void(std::size_t, SettingVisitor&)> const&) override {
    note(info);
  }

 private:
  void note(SettingInfo const& info) { infos.emplace(info.key, info); }
};

TEST(Protocol, DescribesTheBoundsThatItsStagesCheck) {
  Bounds bounds;
  StageSettings settings;
  describe(settings, bounds);
  State const state = fluid();
  auto const accepts = [&](StageSettings const& stage) {
    try {
      Protocol const protocol({.stages = {stage}}, state);
      return true;
    } catch (Error const&) {
      return false;
    }
  };
  SettingInfo const& rate = bounds.infos.at("rate");
  auto const grows = [&](double value) {
    return accepts({.kind = "grow", .rate = value, .until_packing_fraction = 0.7});
  };
  EXPECT_TRUE(grows(rate.min) && grows(rate.max));
  EXPECT_FALSE(grows(0.99 * rate.min) || grows(1.01 * rate.max));
  SettingInfo const& share = bounds.infos.at("swap_fraction");
  auto const swaps = [&](double value) { return accepts({.kind = "swap", .sweeps = 10, .swap_fraction = value}); };
  EXPECT_TRUE(swaps(share.min));
  EXPECT_EQ(swaps(share.max), share.max_is_allowed);
  SettingInfo const& step = bounds.infos.at("step");
  auto const steps = [&](double value) {
    return accepts({.kind = "compress", .until_packing_fraction = 0.9, .step = value});
  };
  EXPECT_TRUE(steps(step.max));
  EXPECT_FALSE(steps(1.01 * step.max) || steps(0.99 * step.min));
}

TEST(Protocol, TakesEverySettingThatIsDescribedInSomeStageAndNoOther) {
  Bounds bounds;
  StageSettings settings;
  describe(settings, bounds);
  std::set<std::string, std::less<>> described;
  for (auto const& [key, info] : bounds.infos) described.insert(key);
  std::set<std::string, std::less<>> taken{"stage"};
  for (StageRecord const& record : stage_records()) {
    taken.insert(record.settings.begin(), record.settings.end());
    for (std::string_view const end : record.ends) EXPECT_EQ(std::ranges::count(record.settings, end), 1) << end;
  }
  EXPECT_EQ(taken, described);
}

TEST(Protocol, RefusesAStageThatIsNotKnownWithThoseThatAre) {
  std::vector<Problem> const problems = problems_of({{.kind = "run", .until_time = 1.0}, {.kind = "shake"}});
  ASSERT_EQ(problems.size(), 1U);
  EXPECT_EQ(problems.front().what, "the stage \"shake\" is not known");
  EXPECT_EQ(problems.front().hint,
            "a stage is one of: grow, run, quench, compress, decompress, shear, separate, swap, monte_carlo, "
            "event_chain");
}

TEST(Protocol, FailsWithTheReasonWhereAStageCannotBegin) {
  State state = fluid();
  // Two disks at one place cannot be separated.
  state.agents.column<X>()[1] = state.agents.column<X>()[0];
  state.agents.column<Y>()[1] = state.agents.column<Y>()[0];
  Protocol protocol({.stages = {{.kind = "separate"}}}, state);
  EXPECT_THROW(protocol.advance(state), RunFailure);
}

TEST(Protocol, RefusesAStartThatOverlapsWhereHardDisksAreNeeded) {
  State state = fluid();
  for (double& radius : state.agents.column<Radius>()) radius *= 2.0;
  EXPECT_THROW(Protocol({.stages = {{.kind = "grow", .until_packing_fraction = 0.9}}}, state), Error);
}

}  // namespace
}  // namespace gridlock
