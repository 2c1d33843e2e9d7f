#include "study/physics_or_step.hpp"

#include <gtest/gtest.h>

#include <string>

#include "unit/study/holds.hpp"

namespace gridlock {
namespace {

Crossing crossing(double x) {
  return {.kind = CrossingKind::crossed, .last_above = x - 0.01, .first_below = x + 0.01, .x = x, .statistical = 0.002};
}

Crossing no_crossing() { return {.kind = CrossingKind::stays_above}; }

/// Made up: a rule that is like exact disks in everything.
StepEvidence evidence_of_agreement() {
  StepEvidence evidence{.steps = 10'000};
  for (StartKind const start : {StartKind::square, StartKind::triangular}) {
    evidence.points.push_back({.start = start,
                               .packing_fraction = 0.5,
                               .rule = {.value = 0.40, .error = 0.01},
                               .exact = {.value = 0.41, .error = 0.01},
                               .seeds = 4});
    evidence.lines.push_back({.start = start,
                              .rule_early = crossing(0.60),
                              .rule_late = crossing(0.70),
                              .exact_early = crossing(0.60),
                              .exact_late = crossing(0.701)});
    evidence.contacts.push_back(
        {.start = start,
         .packing_fraction = 0.8,
         .time_step = 0.1,
         .always = {.runs = 5, .displacement = {.value = 0.01}, .collision_rate = 400.0},
         .approaching = {.runs = 5, .displacement = {.value = 0.01}, .collision_rate = 390.0},
         .exact = ContactResult{.runs = 5, .displacement = {.value = 0.01}, .collision_rate = 410.0}});
  }
  return evidence;
}

/// All conclusions of the chapter, one after the other.
std::string conclusions_of(StepEvidence const& evidence) {
  std::string text;
  for (std::string const& conclusion : chapter_from(evidence).conclusions) text += conclusion + "\n";
  return text;
}

TEST(PhysicsOrStep, SaysSoWhereTheRuleAgreesWithExactDisks) {
  std::string const text = conclusions_of(evidence_of_agreement());
  EXPECT_TRUE(holds(text, "At none of the 2 points do the rule and the exact dynamics differ")) << text;
  EXPECT_TRUE(holds(text, "The rule is behind the exact disks at 2 of 2 points")) << text;
  EXPECT_TRUE(holds(text, "is within three standard errors")) << text;
  EXPECT_TRUE(holds(text, "that it is crossed is physics")) << text;
  EXPECT_TRUE(holds(text, "that it moves with the length of the run is physics")) << text;
  EXPECT_TRUE(holds(text, "With contact = \"approaching\" none of 10 runs came to rest")) << text;
  EXPECT_TRUE(holds(text, "With contact = \"always\" none of 10 runs came to rest")) << text;
  EXPECT_FALSE(holds(text, "every standstill is the rule's")) << text;
}

TEST(PhysicsOrStep, SaysWhichPointsDiffer) {
  StepEvidence evidence = evidence_of_agreement();
  evidence.points[1].packing_fraction = 0.8;
  evidence.points[1].rule = {.value = 0.82, .error = 0.01};
  std::string const text = conclusions_of(evidence);
  EXPECT_TRUE(holds(text, "At 1 of 2 points the rule and the exact dynamics agree")) << text;
  EXPECT_TRUE(holds(text, "φ = 0.8 triangular (2.00 times as far as exact disks)")) << text;
  EXPECT_TRUE(holds(text, "The rule is behind the exact disks at 1 of 2 points")) << text;
}

TEST(PhysicsOrStep, CallsACrossingThatExactDisksDoNotMakeTheTimeSteps) {
  StepEvidence evidence = evidence_of_agreement();
  for (LineBesideExact& line : evidence.lines) line.exact_early = line.exact_late = no_crossing();
  std::string text = conclusions_of(evidence);
  EXPECT_TRUE(holds(text, "Exact disks do not cross it: that it is crossed under the rule is the time step")) << text;
  EXPECT_FALSE(holds(text, "that it is crossed is physics")) << text;
  EXPECT_TRUE(holds(text, "whether it moves without a step cannot be told")) << text;

  evidence = evidence_of_agreement();
  evidence.lines[0].exact_late = no_crossing();
  text = conclusions_of(evidence);
  EXPECT_TRUE(holds(text, "The rule crosses it from 2 and exact disks from 1 of 2 starts")) << text;

  evidence = evidence_of_agreement();
  for (LineBesideExact& line : evidence.lines) line.rule_early = line.rule_late = no_crossing();
  EXPECT_TRUE(holds(conclusions_of(evidence), "that it is not crossed is the time step"));
}

TEST(PhysicsOrStep, SaysSoWhereTheCrossingLiesElsewhereOrStaysWithoutAStep) {
  StepEvidence evidence = evidence_of_agreement();
  for (LineBesideExact& line : evidence.lines) {
    line.exact_early = crossing(0.75);
    line.exact_late = crossing(0.751);
  }
  std::string text = conclusions_of(evidence);
  EXPECT_TRUE(holds(text, "is beyond three standard errors")) << text;
  EXPECT_TRUE(holds(text, "that it moves without a step does not show")) << text;
  EXPECT_FALSE(holds(text, "length of the run is physics")) << text;
  evidence.lines[0].exact_early = crossing(0.60);
  text = conclusions_of(evidence);
  EXPECT_TRUE(holds(text, "from 1 of 2 starts")) << text;
}

TEST(PhysicsOrStep, PutsStandstillsBesideTheExactRunsWithNumbers) {
  StepEvidence evidence = evidence_of_agreement();
  evidence.contacts[1].approaching = {
      .arrested = 3, .runs = 5, .displacement = {.value = 0.04}, .collision_rate = 41.0};
  std::string text = conclusions_of(evidence);
  EXPECT_TRUE(holds(text,
                    "With contact = \"approaching\" 3 of 10 runs came to rest: φ = 0.8 triangular with steps of 0.1 "
                    "(3 of 5). There the disks collide 0.1 times as often as exact ones at the same density and "
                    "have moved 4 times as far"))
      << text;
  EXPECT_TRUE(holds(text, "With contact = \"always\" none of 10 runs came to rest")) << text;
  EXPECT_TRUE(holds(text, "An exact run cannot come to rest, by construction")) << text;
  EXPECT_TRUE(holds(text, "every standstill is the rule's")) << text;
  PageTable const table = chapter_from(evidence).tables.back();
  ASSERT_EQ(table.rows.size(), 2U);
  EXPECT_EQ(table.rows[1].size(), table.header.size());

  evidence.contacts[1].exact.reset();
  text = conclusions_of(evidence);
  EXPECT_TRUE(holds(text, "3 of 10 runs came to rest")) << text;
  EXPECT_FALSE(holds(text, "as often as exact ones")) << text;
}

TEST(PhysicsOrStep, SaysThatItKnowsNothingWithoutRuns) {
  EXPECT_TRUE(holds(conclusions_of({}), "Too few runs to tell"));
}

}  // namespace
}  // namespace gridlock
