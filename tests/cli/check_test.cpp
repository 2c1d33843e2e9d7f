// The program tells what a run will do, and knows words that a newcomer looks for.
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <sstream>
#include <string>
#include <vector>

#include "cli/program.hpp"

namespace {

using namespace gridlock::test;

fs::path const scenes = fs::path(GRIDLOCK_SOURCE_DIR) / "scenes";

void expect_words(std::string const& text, std::vector<std::string> const& words) {
  for (std::string const& word : words) EXPECT_NE(text.find(word), std::string::npos) << word << "\nin: " << text;
}

void expect_no_words(std::string const& text, std::vector<std::string> const& words) {
  for (std::string const& word : words) EXPECT_EQ(text.find(word), std::string::npos) << word << "\nin: " << text;
}

TEST(Check, SaysTheStagesOfAProtocolInOrderAndNoEngineThatIsNotUsed) {
  Workplace const workplace;
  std::string const scene = (scenes / "jamming.toml").string();
  Outcome const outcome = in(workplace, {"check", scene, "--set", "box.width=1.6", "--set", "box.height=0.7"});
  expect_good(outcome);
  expect_words(outcome.out, {"periodic box 1.6 × 0.7, protocol of 2 stages\n"
                             "  stage 1: quench: packing_fraction = 0.86\n"
                             "  stage 2: decompress: until_pressure = 1e-08\n"});
  expect_no_words(outcome.out, {"engine", "of time", "estimate"});
}

TEST(Check, SaysWhichEngineFollowsAProtocol) {
  Workplace const workplace;
  write(workplace / "a.toml",
        "box.edge = \"periodic\"\nvelocities.kind = \"maxwell\"\nengine.kind = \"exact\"\nrun.steps = 20\n"
        "[disks]\ncount = 32\npacking_fraction = 0.4\nstart = \"random\"\n"
        "[[protocol]]\nstage = \"grow\"\nrate = 0.01\nuntil_packing_fraction = 0.6\n");
  Outcome const outcome = in(workplace, {"check", "a.toml"});
  expect_good(outcome);
  expect_words(outcome.out, {"protocol of 1 stage, then engine exact, step ",
                             " of time\n  stage 1: grow: rate = 0.01, ", "until_packing_fraction = 0.6\n"});
  expect_good(in(workplace, {"run", "a.toml", "-o", "out", "-q", "--no-pictures"}));
  auto const summary = nlohmann::json::parse(text_of(workplace / "out/summary.json"));
  EXPECT_EQ(summary["engine"], "exact");
  EXPECT_GT(summary["time_step"], 0.0);
}

TEST(Check, OfARunWithoutStepsIsTrueToItsSummary) {
  Workplace const workplace;
  expect_good(in(workplace, {"run", (scenes / "jamming.toml").string(), "-o", "out", "-q", "--no-pictures"}));
  auto const summary = nlohmann::json::parse(text_of(workplace / "out/summary.json"));
  EXPECT_FALSE(summary.contains("engine"));
  EXPECT_FALSE(summary.contains("time_step"));
  EXPECT_EQ(summary["steps"], 0);
}

TEST(Check, OfALargeRunEstimatesMemoryTimeAndFrames) {
  Workplace const workplace;
  write(workplace / "a.toml",
        "disks.count = 20000\ndisks.packing_fraction = 0.3\nrun.steps = 1_000_000\ntrajectory.every = 100_000\n"
        "trajectory.columns = \"x y\"\nbox.width = 2.0\n");
  Outcome const outcome = in(workplace, {"check", "a.toml"});
  expect_good(outcome);
  // Eleven frames of two coordinates and an Id, of eight bytes each.
  expect_words(outcome.out, {"  estimate: about ", " MB of memory, ", " on one core of this machine, ",
                             "11 frames of 5 MB at most in all\n"});
}

TEST(Check, OfASmallRunEstimatesNothing) {
  Workplace const workplace;
  write(workplace / "a.toml", std::string(small_run) + "[trajectory]\nevery = 10\n");
  Outcome const outcome = in(workplace, {"check", "a.toml"});
  expect_good(outcome);
  EXPECT_EQ(std::ranges::count(outcome.out, '\n'), 2) << outcome.out;
}

TEST(UnknownTable, ThatGridlockHasNotIsSaidToBeLacking) {
  for (std::string const word : {"pressure", "forces", "barostat"}) {
    Workplace const workplace;
    write(workplace / "a.toml", "[" + word + "]\nvalue = 1.0\n");
    Outcome const outcome = in(workplace, {"check", "a.toml"});
    EXPECT_EQ(outcome.exit_code, 2);
    expect_words(outcome.err,
                 {"there is no table \"" + word + "\"", "a.toml:1", "Gridlock has no " + word + ": ", "limits"});
  }
}

TEST(UnknownTable, ThatIsNearToAnotherOneIsStillASlip) {
  Workplace const workplace;
  write(workplace / "a.toml", "[disk]\ncount = 10\n");
  expect_words(in(workplace, {"check", "a.toml"}).err, {"did you mean disks?"});
}

struct Looked {
  char const* word;
  std::vector<std::string> found;
};

TEST(Explain, FindsWhatANewcomerLooksFor) {
  Workplace const workplace;
  for (auto const& [word, found] :
       std::vector<Looked>{{"temperature", {"kT", "kinetic_energy / N", "[velocities]"}},
                           {"kT", {"kT is the mean", "[velocities]"}},
                           {"g(r)", {"pair_correlation\n", "column of pair_correlation.csv"}},
                           {"grow", {"a stage of a [[protocol]]", "protocol.stage"}},
                           {"quench", {"a stage of a [[protocol]]"}},
                           {"sweep", {"[sweep] lists values", "gridlock sweep"}},
                           {"shear", {"a stage of a [[protocol]]"}},
                           {"gravity", {"gravity.y", "length / time²"}},
                           {"friction", {"thermostat.friction"}}}) {
    Outcome const outcome = in(workplace, {"explain", word});
    expect_good(outcome);
    expect_words(outcome.out, found);
  }
}

TEST(Explain, NamesEachNearNameOnce) {
  Workplace const workplace;
  std::string const said = in(workplace, {"explain", "forces"}).out;
  std::size_t const names = said.find("names near to it: ");
  ASSERT_NE(names, std::string::npos) << said;
  std::istringstream words(said.substr(names + 18));
  std::vector<std::string> all;
  for (std::string word; words >> word;) all.push_back(word.substr(0, word.find(',')));
  EXPECT_GE(all.size(), 1U);
  std::ranges::sort(all);
  EXPECT_EQ(std::ranges::adjacent_find(all), all.end()) << said;
}

}  // namespace
