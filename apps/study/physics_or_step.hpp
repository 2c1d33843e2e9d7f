#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "study/crossing.hpp"
#include "study/replica_set.hpp"

namespace gridlock {

/// One point of Figure 7 under the rule and without a time step.
struct RuleBesideExact {
  StartKind start = StartKind::square;
  double packing_fraction = 0.0;
  Estimate rule;
  Estimate exact;
  std::size_t seeds = 0;
};

/// Where displacement against density falls through the line of Figure 7, after a tenth of the runs and at their end.
struct LineBesideExact {
  StartKind start = StartKind::square;
  Crossing rule_early;
  Crossing rule_late;
  Crossing exact_early;
  Crossing exact_late;
};

/// How runs of one contact rule ended.
struct ContactResult {
  std::size_t arrested = 0;  ///< see ReplicaResult::arrested()
  std::size_t runs = 0;
  Estimate displacement;
  double collision_rate = 0.0;  ///< over the last fifth
};

/// Both contact rules from one start with one time step, and the same start without one.
struct ContactsBesideExact {
  StartKind start = StartKind::square;
  double packing_fraction = 0.0;
  double time_step = 0.0;
  ContactResult always;
  ContactResult approaching;
  std::optional<ContactResult> exact;  ///< its `arrested` says nothing: exact disks are never halted
};

/// What the chapter is written from, and nothing else.
struct StepEvidence {
  std::uint64_t steps = 0;  ///< of the runs that are compared
  std::vector<RuleBesideExact> points;
  std::vector<LineBesideExact> lines;
  std::vector<ContactsBesideExact> contacts;
};

/// Which part of the figures is physics and which the time step. Every verdict follows from the evidence; what is true
/// by construction is said to be.
Chapter chapter_from(StepEvidence const& evidence);

/// The runs of open_choices() with a time step, for each start, density and step with both contact rules.
std::vector<ContactsBesideExact> contacts_beside_exact(Study const& study);

/// Where displacement against density falls through 10 % after a tenth of the runs of Figure 6's length, and at their end.
Crossing early_crossing(Study const& study, PaperEngine const& engine, StartKind start);
Crossing late_crossing(Study const& study, PaperEngine const& engine, StartKind start);
/// In words.
std::string crossing_text(Crossing const& crossing);

}  // namespace gridlock
